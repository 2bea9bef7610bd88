#include "baker/bake/store_stage.h"

#include "baker/store/traced_strips.h"

namespace luxel {
namespace {

/// Share of what all blocks would take that `hot` keeps when no size is given: with it most blocks are kept, since most are small.
constexpr double hot_share = 0.25;

std::uint64_t hot_budget(const BakeOptions& options, const StripDirectory& directory) {
    if (options.store != StoreKind::hot) return 0;
    if (options.store_bytes) return options.store_bytes;
    std::uint64_t all = 0;
    for (const DirectoryBlock& block : directory.blocks) all += block.stored_bytes;
    return static_cast<std::uint64_t>(hot_share * static_cast<double>(all));
}

std::uint64_t bytes_of(const std::filesystem::path& path) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(path, failed);
    return failed ? 0 : bytes;
}

}  // namespace

const char* store_name(StoreKind kind) {
    return kind == StoreKind::all ? "all" : kind == StoreKind::hot ? "hot" : "none";
}

bool open_traced(const BakeOptions& options, const BakeFolder& folder, const Key& strips, BakedMatrix& matrix, StageClock& clock) {
    const auto path = folder.directory(strips);
    clock.keeps(path);
    const std::uint64_t traced_before = matrix.rows->rays_traced();
    std::optional<StripDirectory> directory = load_directory(path, strips);
    const bool found = directory.has_value();
    if (!found) directory = find_directory(*matrix.rows, clock.progress("strips"));
    const std::uint64_t budget = hot_budget(options, *directory);
    // Blocks kept for another budget go before the directory says so: they are never taken for those of this one.
    if (!found || directory->hot_bytes != budget) {
        folder.discard_hot(strips);
        directory->hot_bytes = budget;
        save_directory(path, strips, *directory);
    }
    std::unique_ptr<StripStore> kept;
    if (budget) {
        const Key key = BakeFolder::hot_key(strips);
        const auto place = folder.hot(strips);
        clock.keeps(place);
        keep_blocks(*matrix.rows, *directory, blocks_to_keep(*directory, *matrix.rows, budget), place, key, clock.progress("strips"));
        kept = std::make_unique<StripStore>(place, key, matrix.rows->layout());
    }
    matrix.strips = std::make_unique<TracedStrips>(*matrix.rows, std::move(*directory), std::move(kept), bytes_of(path));
    return found && matrix.rows->rays_traced() == traced_before;
}

void remove_other_store(const BakeOptions& options, const BakeFolder& folder, const Key& strips, std::span<const Key> evidence) {
    if (options.store == StoreKind::all) return folder.discard_directory(strips);
    folder.discard_strips(strips);
    for (const Key& round : evidence) folder.discard_evidence(round);
}

}  // namespace luxel
