#include "baker/store/buckets.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "formats/base/error.h"

namespace luxel {

PairBuckets::PairBuckets(std::uint32_t bucket_count, std::uint64_t memory_bytes,
                         const std::filesystem::path& scratch_folder)
    : limit_pairs_(memory_bytes / sizeof(PackedPair)),
      held_(bucket_count),
      spilled_(bucket_count),
      scratch_folder_(scratch_folder) {}

PairBuckets::~PairBuckets() {
    if (scratch_ >= 0) ::close(scratch_);
}

void PairBuckets::add(std::uint32_t bucket, std::span<const PackedPair> pairs) {
    held_[bucket].insert(held_[bucket].end(), pairs.begin(), pairs.end());
    held_pairs_ += pairs.size();
}

void PairBuckets::settle() {
    if (held_pairs_ <= limit_pairs_) return;
    std::size_t done = 0;  // of the bucket being written
    const auto refuse = [&](const char* step) {
        return Error(ErrorCode::cannot_write, scratch_folder_.string(),
                     std::string(step) + " the scratch file of pooling at byte " + std::to_string(scratch_bytes_ + done) + ": " +
                         std::strerror(errno),
                     "free some space or choose another bake folder with --work");
    };
    if (scratch_ < 0) {
        std::string name = (scratch_folder_ / "pooling-XXXXXX").string();
        scratch_ = ::mkostemp(name.data(), O_CLOEXEC);
        if (scratch_ < 0) throw refuse("cannot create");
        ::unlink(name.c_str());
    }
    for (std::size_t bucket = 0; bucket < held_.size(); ++bucket) {
        std::vector<PackedPair>& pairs = held_[bucket];
        if (pairs.empty()) continue;
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(pairs.data());
        const std::size_t size = pairs.size() * sizeof(PackedPair);
        for (done = 0; done < size;) {
            const ssize_t put = ::write(scratch_, bytes + done, size - done);
            if (put < 0 && errno == EINTR) continue;
            if (put <= 0) throw refuse("cannot write");
            done += static_cast<std::size_t>(put);
        }
        spilled_[bucket].push_back({scratch_bytes_, pairs.size()});
        scratch_bytes_ += size, done = 0;
        std::vector<PackedPair>().swap(pairs);
    }
    held_pairs_ = 0;
}

std::uint64_t PairBuckets::size(std::uint32_t bucket) const {
    std::uint64_t count = held_[bucket].size();
    for (const Extent& extent : spilled_[bucket]) count += extent.count;
    return count;
}

void PairBuckets::visit(std::uint32_t bucket, const std::function<void(std::span<const PackedPair>)>& body) const {
    body(held_[bucket]);
    constexpr std::uint64_t run_pairs = 1 << 17;
    std::vector<PackedPair> run;
    for (const Extent& extent : spilled_[bucket])
        for (std::uint64_t begin = 0; begin < extent.count; begin += run_pairs) {
            run.resize(std::min(run_pairs, extent.count - begin));
            auto* bytes = reinterpret_cast<std::uint8_t*>(run.data());
            const std::size_t size = run.size() * sizeof(PackedPair);
            for (std::size_t done = 0; done < size;) {
                const auto at = static_cast<off_t>(extent.offset + begin * sizeof(PackedPair) + done);
                const ssize_t got = ::pread(scratch_, bytes + done, size - done, at);
                if (got < 0 && errno == EINTR) continue;
                if (got <= 0)
                    throw Error(ErrorCode::damaged_store, scratch_folder_.string(),
                                "cannot read the scratch file of pooling at byte " + std::to_string(at) + ": " +
                                    (got < 0 ? std::strerror(errno) : "it ends there"),
                                "check the disk, or choose another bake folder with --work, and run the same command again");
                done += static_cast<std::size_t>(got);
            }
            body(run);
        }
}

void PairBuckets::release(std::uint32_t bucket) { std::vector<PackedPair>().swap(held_[bucket]); }

}  // namespace luxel
