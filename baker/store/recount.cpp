#include "baker/store/recount.h"

#include <algorithm>

#include "baker/store/pooling.h"

namespace luxel {
namespace {

/// What the evidence says of each patch itself, in 64 bits: sums that strips cannot hold must not wrap around.
struct Sums {
    explicit Sums(std::size_t patches) : rays(patches), self(patches), open(patches), back(patches) {}
    std::vector<std::uint64_t> rays, self, open, back;

    void add(const NumberedEvidence& e) {
        for (std::size_t r = 0; r < e.block.rows.size(); ++r) {
            const EvidenceBlock::Row& row = e.block.rows[r];
            const PatchNumber i = e.patches[r];
            rays[i] += std::uint64_t{row.open} + row.back;
            open[i] += row.open;
            back[i] += row.back;
            for (std::uint32_t k = row.first; k < row.first + row.count; ++k) {
                rays[i] += e.block.counts[k];
                if (e.targets[e.block.target_index[k]] == i) self[i] += e.block.counts[k];
            }
        }
    }
};

/// Blocks [first, end) of the strips with their counts, from which evidence is taken away.
class Part {
  public:
    Part(const StripStore& strips, std::size_t first, std::uint64_t memory_bytes) : strips_(strips), first_(first), end_(first) {
        std::uint64_t bytes = 0;
        const auto blocks = strips.blocks();
        while (end_ < blocks.size()) {
            const std::uint64_t more = blocks[end_].pair_count * 10 + strips.layout().size(blocks[end_].a) * 4;
            if (end_ > first_ && bytes + more > memory_bytes) break;
            bytes += more;
            held_.emplace_back();
            strips.load(end_, held_.back());
            left_.emplace_back(held_.back().counts.begin(), held_.back().counts.end());
            held_.back().counts = {};
            ++end_;
        }
    }
    [[nodiscard]] std::size_t end() const { return end_; }

    /// Where pair (low, high) is: block in the part and index in it.
    struct Place {
        std::uint32_t block = none_here;
        std::uint32_t pair = 0;
        std::uint32_t count = 0;
    };
    static constexpr std::uint32_t none_here = 0xffffffffu, no_pair = 0xfffffffeu;

    /// Looks a pair up; const, for many threads.
    [[nodiscard]] Place find(PatchNumber low, PatchNumber high, std::uint32_t count) const {
        const ChunkLayout& layout = strips_.layout();
        const ChunkNumber a = layout.chunk_of(low), b = layout.chunk_of(high);
        const auto begin = strips_.blocks().begin() + static_cast<std::ptrdiff_t>(first_);
        const auto end = strips_.blocks().begin() + static_cast<std::ptrdiff_t>(end_);
        const auto at = std::lower_bound(begin, end, std::pair(a, b), [](const BlockInfo& info, const auto& wanted) {
            return std::pair(info.a, info.b) < wanted;
        });
        if (at == end || at->a != a || at->b != b) return {before_or_after(a, b) ? none_here : no_pair, 0, count};
        const auto block = static_cast<std::uint32_t>(at - begin);
        const CountBlock& pairs = held_[block];
        const std::uint32_t row = low - layout.first_patch[a], column = high - layout.first_patch[b];
        const auto row_begin = pairs.columns.begin() + pairs.row_begin[row], row_end = pairs.columns.begin() + pairs.row_begin[row + 1];
        const auto found = std::lower_bound(row_begin, row_end, column);
        if (found == row_end || *found != column) return {no_pair, 0, count};
        return {block, static_cast<std::uint32_t>(found - pairs.columns.begin()), count};
    }
    void take(const Place& place) { left_[place.block][place.pair] -= place.count; }

    /// First pair of each block that is not used up exactly.
    void report(const std::filesystem::path& folder, std::span<const PatchId> ids, std::vector<Finding>& out, std::size_t most) const {
        for (std::size_t k = 0; k < left_.size() && out.size() < most; ++k) {
            const auto wrong = std::find_if(left_[k].begin(), left_[k].end(), [](std::int64_t left) { return left != 0; });
            if (wrong == left_[k].end()) continue;
            const auto pair = static_cast<std::uint32_t>(wrong - left_[k].begin());
            const BlockInfo& info = strips_.blocks()[first_ + k];
            const auto row = std::upper_bound(held_[k].row_begin.begin(), held_[k].row_begin.end(), pair) - held_[k].row_begin.begin() - 1;
            const PatchId i = ids[strips_.layout().first_patch[info.a] + static_cast<std::size_t>(row)];
            const PatchId j = ids[strips_.layout().first_patch[info.b] + held_[k].columns[pair]];
            out.push_back({strip_path(folder, info.a).string() + ": block (" + std::to_string(info.a) + ", " + std::to_string(info.b) + ")",
                           "pair of patches " + std::to_string(i) + " and " + std::to_string(j) + ": the strip counts " +
                               std::to_string(*wrong < 0 ? -*wrong : *wrong) + (*wrong < 0 ? " rays fewer" : " rays more") +
                               " than the evidence"});
        }
    }

  private:
    /// Does block (a, b) belong to another part?
    [[nodiscard]] bool before_or_after(ChunkNumber a, ChunkNumber b) const {
        const auto blocks = strips_.blocks();
        const auto key = std::pair(a, b);
        // Between the last block of the part before and the first of the next one a block would have been ours.
        return (first_ > 0 && key <= std::pair(blocks[first_ - 1].a, blocks[first_ - 1].b)) ||
               (end_ < blocks.size() && key >= std::pair(blocks[end_].a, blocks[end_].b));
    }

    const StripStore& strips_;
    std::size_t first_, end_;
    std::vector<CountBlock> held_;
    std::vector<std::vector<std::int64_t>> left_;
};

/// Pairs of one block of evidence that concern the part.
std::vector<Part::Place> places(const Part& part, const NumberedEvidence& e) {
    std::vector<Part::Place> found;
    for (std::size_t r = 0; r < e.block.rows.size(); ++r) {
        const EvidenceBlock::Row& row = e.block.rows[r];
        for (std::uint32_t k = row.first; k < row.first + row.count; ++k) {
            const PatchNumber i = e.patches[r], j = e.targets[e.block.target_index[k]];
            if (i == j) continue;
            const Part::Place place = part.find(std::min(i, j), std::max(i, j), e.block.counts[k]);
            if (place.block != Part::none_here) found.push_back(place);
        }
    }
    return found;
}

void compare_tallies(const StripStore& strips, const std::filesystem::path& folder, std::span<const PatchId> ids, const Sums& sums,
                     std::size_t most, std::vector<Finding>& out) {
    const RayTallies& t = strips.tallies();
    const auto compare = [&](const char* name, const std::vector<std::uint32_t>& stored, const std::vector<std::uint64_t>& found) {
        for (PatchNumber p = 0; p < ids.size(); ++p)
            if (stored[p] != found[p]) {
                if (out.size() < most)
                    out.push_back({strip_path(folder, strips.layout().chunk_of(p)).string() + ": tallies",
                                   std::string(name) + " of patch " + std::to_string(ids[p]) + ": the strip says " +
                                       std::to_string(stored[p]) + ", the evidence " + std::to_string(found[p])});
                return;
            }
    };
    compare("rays", t.rays, sums.rays);
    compare("rays on itself", t.self, sums.self);
    compare("rays into the open", t.open, sums.open);
    compare("rays on backs", t.back, sums.back);
}

}  // namespace

std::vector<Finding> recount(const StripStore& strips, const std::filesystem::path& strip_folder, std::span<const PatchId> ids,
                             std::span<const EvidenceFile> files, const RecountOptions& options, const ProgressFunction& progress) {
    std::vector<Finding> findings;
    if (ids.size() != strips.layout().patch_count())
        throw Error(ErrorCode::internal, "recount", "one id per patch is needed");
    const IdIndex index(ids);
    Sums sums(ids.size());
    std::vector<std::vector<Part::Place>> ahead(evidence_batch);
    std::size_t first = 0;
    do {
        Part part(strips, first, options.memory_bytes);
        bool missing_told = false;
        const auto prepare = [&](const NumberedEvidence& e, std::size_t k) { ahead[k] = places(part, e); };
        const auto take = [&](const NumberedEvidence& e, std::size_t k) {
            if (first == 0) sums.add(e);
            for (const Part::Place& place : ahead[k]) {
                if (place.block != Part::no_pair) {
                    part.take(place);
                } else if (!missing_told && findings.size() < options.most_findings) {
                    missing_told = true;
                    findings.push_back({e.where, "has rays between two patches whose pair is in no strip"});
                }
            }
        };
        read_evidence(files, index, take, {}, prepare);
        part.report(strip_folder, ids, findings, options.most_findings);
        first = part.end();
        if (progress) progress(first, strips.block_count());
    } while (first < strips.block_count() && findings.size() < options.most_findings);
    compare_tallies(strips, strip_folder, ids, sums, options.most_findings, findings);
    return findings;
}

}  // namespace luxel
