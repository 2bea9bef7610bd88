#include "baker/store/pooling.h"

#include <algorithm>

#include "baker/core/parallel.h"
#include "baker/formfactors/target_sums.h"
#include "baker/store/buckets.h"
#include "baker/store/evidence_reader.h"
#include "baker/store/level_ledger.h"
#include "baker/store/pair_sort.h"
#include "baker/store/ray_sum.h"
#include "formats/bake/evidence_file.h"
#include "formats/bake/strip_file.h"

namespace luxel {
namespace {

/// What one record adds to its own patch.
struct PatchTally {
    PatchNumber patch;
    std::uint64_t rays;
    std::uint32_t self, open, back;
    EvidenceBlock::Row row;
};

struct Tallies {
    explicit Tallies(std::size_t patches) : rays(patches), self(patches), open(patches), back(patches) {}
    std::vector<std::uint32_t> rays, self, open, back;

    /// `self`, `open` and `back` are parts of the rays, so they fit when the rays do.
    void add(const PatchTally& tally, const std::string& where) {
        add_rays(rays[tally.patch], tally.rays, where);
        self[tally.patch] += tally.self;
        open[tally.patch] += tally.open;
        back[tally.patch] += tally.back;
    }
    [[nodiscard]] RayTallies of_chunk(PatchNumber begin, PatchNumber end) const {
        const auto cut = [&](const std::vector<std::uint32_t>& all) {
            return std::vector<std::uint32_t>(all.begin() + begin, all.begin() + end);
        };
        return {cut(rays), cut(self), cut(open), cut(back)};
    }
};

/// Observations on their way to bucket a.
struct Dealt {
    ChunkNumber a;
    std::vector<PackedPair> pairs;
};

/// Rows of one evidence block by number.
struct NumberedBlock {
    std::vector<PatchTally> tallies;
    std::vector<Dealt> dealt;  ///< one per bucket that occurs
};

/// A patch and where it is in its chunk.
struct Place {
    explicit Place(const ChunkLayout& layout, PatchNumber patch)
        : number(patch), chunk(layout.chunk_of(patch)), offset(patch - layout.first_patch[chunk]) {}
    PatchNumber number;
    ChunkNumber chunk;
    std::uint32_t offset;
};

/// A target of an evidence block: each is looked for once per block, not once per pair.
struct Target {
    Place place;
    std::uint32_t bucket;  ///< index of its chunk's bucket in Dealing
};

/// Buckets as they occur in a block.
class Dealing {
  public:
    explicit Dealing(std::size_t chunks) : place_(chunks, unknown) {}
    /// Index of bucket a in `dealt`.
    std::uint32_t bucket(ChunkNumber a) {
        if (place_[a] == unknown) {
            place_[a] = static_cast<std::uint32_t>(dealt.size());
            dealt.push_back({a, {}});
        }
        return place_[a];
    }
    std::vector<Dealt> dealt;

  private:
    static constexpr std::uint32_t unknown = 0xffffffffu;
    std::vector<std::uint32_t> place_;
};

NumberedBlock read_block(const BlockFileReader& file, std::size_t index, const IdIndex& ids, const ChunkLayout& layout) {
    const std::string where = file.name() + ": block " + std::to_string(index);
    const EvidenceBlock block = read_evidence_block(file, index);
    NumberedBlock found;
    Dealing dealing(layout.chunk_count());
    std::vector<Target> targets;
    targets.reserve(block.targets.size());
    for (const PatchId id : block.targets) {
        const Place place(layout, ids.find(id, where));
        targets.push_back({place, dealing.bucket(place.chunk)});
    }
    found.tallies.reserve(block.rows.size());
    // Rows of one patch, its replicates, follow one another. Their sums are right below 2^32 rays; more are refused later.
    TargetSums sums(targets.size());
    for (std::size_t row = 0; row < block.rows.size();) {
        const PatchId id = block.rows[row].patch_id;
        const Place i(layout, ids.find(id, where));
        for (; row < block.rows.size() && block.rows[row].patch_id == id; ++row) {
            const EvidenceBlock::Row& r = block.rows[row];
            PatchTally tally{i.number, std::uint64_t{r.open} + r.back, 0, r.open, r.back, r};
            for (std::uint32_t k = r.first; k < r.first + r.count; ++k) {
                tally.rays += block.counts[k];
                if (targets[block.target_index[k]].place.number == i.number)
                    tally.self += block.counts[k];
                else
                    sums.add(block.target_index[k], block.counts[k]);
            }
            found.tallies.push_back(tally);
        }
        const std::uint32_t own = dealing.bucket(i.chunk);
        sums.drain([&](std::uint32_t target, std::uint32_t count) {
            const auto& [j, bucket] = targets[target];
            if (i.number < j.number)
                append_pairs(dealing.dealt[own].pairs, j.chunk, i.offset, j.offset, count);
            else
                append_pairs(dealing.dealt[bucket].pairs, i.chunk, j.offset, i.offset, count);
        });
    }
    found.dealt = std::move(dealing.dealt);
    return found;
}

class Pooling {
  public:
    Pooling(const ChunkLayout& layout, std::span<const PatchId> ids, const PoolOptions& options)
        : layout_(layout),
          ids_(ids),
          tallies_(ids.size()),
          ledger_(ids.size()),
          memory_(std::max<std::uint64_t>(options.memory_bytes, 8 << 20)),
          buckets_(layout.chunk_count(), memory_ / 2, options.scratch_folder) {
        for (ChunkNumber a = 0; a < layout.chunk_count(); ++a) largest_chunk_ = std::max(largest_chunk_, layout.size(a));
    }

    void deal(const std::filesystem::path& path, const Key& key) {
        const BlockFileReader file(path, FileKind::evidence, evidence_version, &key);
        // A few blocks at a time: decoded in parallel, dealt in order.
        constexpr std::size_t batch = 16;
        std::vector<NumberedBlock> found(batch);
        for (std::size_t begin = 0; begin < file.blocks().size(); begin += batch) {
            const std::size_t count = std::min(batch, file.blocks().size() - begin);
            parallel_for(count, 1, [&](std::size_t k) { found[k] = read_block(file, begin + k, ids_, layout_); });
            for (std::size_t k = 0; k < count; ++k) {
                for (const PatchTally& tally : found[k].tallies) {
                    ledger_.enter(tally.patch, tally.row, file.name() + ": block " + std::to_string(begin + k));
                    tallies_.add(tally, file.name());
                }
                for (const Dealt& dealt : found[k].dealt) buckets_.add(dealt.a, dealt.pairs);
            }
            buckets_.settle();
        }
    }

    /// Strips from `first` on that are sorted at the same time: as many as fit the room together, one at least.
    [[nodiscard]] ChunkNumber group_end(ChunkNumber first) const {
        std::uint64_t pairs = buckets_.size(first);
        ChunkNumber end = first + 1;
        while (end < layout_.chunk_count() && pairs + buckets_.size(end) <= sort_room()) pairs += buckets_.size(end++);
        return end;
    }

    /// Threads: reentrant for different strips.
    void write_strip(ChunkNumber a, const std::filesystem::path& path, const Key& key, Publisher& publisher) {
        StripWriter strip(path, key, tallies_.of_chunk(layout_.first_patch[a], layout_.first_patch[a + 1]));
        // Sorting takes as many passes over the bucket as its size demands, each for a range of b.
        const std::uint64_t room = sort_room();
        for (ChunkNumber begin = a; begin < layout_.chunk_count();) {
            const ChunkNumber end = buckets_.size(a) <= room ? layout_.chunk_count() : range_end(a, begin, room);
            const bool all = begin == a && end == layout_.chunk_count();
            std::vector<PackedPair> pairs;
            if (all) pairs.reserve(buckets_.size(a));
            buckets_.visit(a, [&](std::span<const PackedPair> run) {
                if (all)
                    pairs.insert(pairs.end(), run.begin(), run.end());
                else
                    for (const PackedPair pair : run)
                        if (pair_chunk(pair) >= begin && pair_chunk(pair) < end) pairs.push_back(pair);
            });
            sort_pairs(pairs, layout_.chunk_count(), largest_chunk_);
            append_blocks(a, pairs, strip);
            begin = end;
        }
        strip.publish(publisher);
        buckets_.release(a);
    }

  private:
    /// Pairs that are sorted at once; sorting needs a second array of the same size.
    [[nodiscard]] std::uint64_t sort_room() const { return std::max<std::uint64_t>(memory_ / 4 / sizeof(PackedPair), 1); }

    /// Largest end so that pairs with begin <= b < end fit the room (one chunk at least).
    ChunkNumber range_end(ChunkNumber a, ChunkNumber begin, std::uint64_t room) const {
        std::vector<std::uint64_t> count(layout_.chunk_count());
        buckets_.visit(a, [&](std::span<const PackedPair> run) {
            for (const PackedPair pair : run) ++count[pair_chunk(pair)];
        });
        std::uint64_t sum = count[begin];
        ChunkNumber end = begin + 1;
        while (end < layout_.chunk_count() && sum + count[end] <= room) sum += count[end++];
        return end;
    }

    /// Sorted pairs -> one block per run of equal b, encoded in parallel, appended in order.
    void append_blocks(ChunkNumber a, std::span<const PackedPair> pairs, StripWriter& strip) const {
        std::vector<std::size_t> begin;
        for (std::size_t k = 0; k < pairs.size(); ++k)
            if (k == 0 || pair_chunk(pairs[k]) != pair_chunk(pairs[k - 1])) begin.push_back(k);
        begin.push_back(pairs.size());
        const std::size_t count = begin.size() - 1;
        std::vector<BlockFileWriter::Packed> packed(count);
        std::vector<std::uint64_t> sizes(count);
        parallel_for(count, 1, [&](std::size_t k) {
            const StripPairs block = sum_pairs(a, pairs.subspan(begin[k], begin[k + 1] - begin[k]));
            sizes[k] = block.column.size();
            packed[k] = pack_pairs(block);
        });
        for (std::size_t k = 0; k < count; ++k) strip.append(pair_chunk(pairs[begin[k]]), sizes[k], packed[k]);
    }

    [[nodiscard]] StripPairs sum_pairs(ChunkNumber a, std::span<const PackedPair> pairs) const {
        StripPairs block;
        block.rows = layout_.size(a);
        block.columns = layout_.size(pair_chunk(pairs.front()));
        block.row_begin.assign(block.rows + 1, 0);
        block.column.reserve(pairs.size());
        block.count.reserve(pairs.size());
        for (std::size_t k = 0; k < pairs.size();) {
            std::uint32_t sum = 0;
            const std::uint64_t place = pair_place(pairs[k]);
            while (k < pairs.size() && pair_place(pairs[k]) == place) add_rays(sum, pair_count(pairs[k++]), "pooling");
            ++block.row_begin[((place >> 16) & 0xffff) + 1];
            block.column.push_back(static_cast<std::uint16_t>(place & 0xffff));
            block.count.push_back(sum);
        }
        for (std::uint32_t row = 0; row < block.rows; ++row) block.row_begin[row + 1] += block.row_begin[row];
        return block;
    }

    const ChunkLayout& layout_;
    IdIndex ids_;
    Tallies tallies_;
    LevelLedger ledger_;
    std::uint64_t memory_;
    std::uint32_t largest_chunk_ = 1;
    PairBuckets buckets_;
};

}  // namespace

std::filesystem::path strip_path(const std::filesystem::path& folder, ChunkNumber a) {
    return folder / ("strip-" + std::to_string(a) + ".lxs");
}

bool pool_evidence(const ChunkLayout& layout, std::span<const PatchId> ids,
                   std::span<const EvidenceFile> evidence_files, const std::filesystem::path& strip_folder, const Key& strip_key,
                   const PoolOptions& options, const ProgressFunction& progress) {
    if (layout.chunk_count() > max_chunks)
        throw Error(ErrorCode::usage, "pooling", std::to_string(layout.chunk_count()) + " chunks, at most 65536 are possible",
                    "choose larger chunks with --chunk-patches");
    bool all_there = true;
    for (ChunkNumber a = 0; a < layout.chunk_count(); ++a)
        all_there = all_there && block_file_is_whole(strip_path(strip_folder, a), FileKind::strip, strip_version, strip_key);
    if (all_there) return false;
    Pooling pooling(layout, ids, options);
    const std::uint64_t steps = evidence_files.size() + layout.chunk_count();
    std::uint64_t done = 0;
    for (const EvidenceFile& file : evidence_files) {
        pooling.deal(file.path, file.key);
        if (progress) progress(++done, steps);
    }
    Publisher publisher;
    for (ChunkNumber first = 0; first < layout.chunk_count();) {
        const ChunkNumber end = pooling.group_end(first);
        parallel_for(end - first, 1, [&](std::size_t k) {
            const auto a = static_cast<ChunkNumber>(first + k);
            pooling.write_strip(a, strip_path(strip_folder, a), strip_key, publisher);
        });
        done += end - first;
        if (progress) progress(done, steps);
        first = end;
    }
    publisher.finish();
    return true;
}

}  // namespace luxel
