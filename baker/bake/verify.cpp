#include "baker/bake/verify.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "baker/bake/stage_files.h"
#include "baker/core/parallel.h"
#include "baker/store/pooling.h"
#include "formats/bake/sky_view_file.h"

namespace luxel {
namespace {

/// Rows are closed in double; a sum over a row in another order differs in its last bits.
constexpr double row_tolerance = 1e-9;

FileKind kind_of(const std::string& stage) {
    if (stage == "atlas") return FileKind::atlas;
    if (stage == "evidence") return FileKind::evidence;
    if (stage == "strips" || stage == "hot") return FileKind::strip;
    if (stage == "directory") return FileKind::directory;
    if (stage == "patches") return FileKind::patches;
    if (stage == "plan") return FileKind::plan;
    if (stage == "closure") return FileKind::closure;
    if (stage == "solution") return FileKind::solution;
    if (stage == "checkpoint") return FileKind::checkpoint;
    if (stage == "accuracy") return FileKind::accuracy;
    if (stage == "sky") return FileKind::sky_view;
    return FileKind::lightmap;
}

Finding finding_of(const Error& error) { return {error.where, error.what_text}; }

/// Elements of `bytes` each in block `index`, as the index says; 0 if there is no such block.
std::size_t elements(const BlockFileReader& file, std::size_t index, std::size_t bytes) {
    return index < file.blocks().size() ? file.blocks()[index].raw_bytes / bytes : 0;
}

/// What the loader of a stage demands beyond the checksums. The sizes are taken from the file itself: whether they fit
/// the bake is another question.
void load_whole(const std::string& stage, const std::filesystem::path& path, const Key& key, const BlockFileReader& file) {
    if (stage == "patches") load_patches(path, key);
    if (stage == "plan") load_plan(path, key, elements(file, 0, 1));
    if (stage == "closure") load_closure(path, key, elements(file, 0, 8));
    if (stage == "solution") load_solution(path, key, elements(file, 0, 24));
    if (stage == "checkpoint") load_checkpoint(path, key);
    if (stage == "accuracy") load_accuracy(path, key, elements(file, 0, 24));
    if (stage == "lightmaps") load_page_light(path, key, elements(file, 0, 12));
    if (stage == "directory") load_directory(path, key);
    if (stage == "sky") {
        const SkyViewReader view(path, key);
        for (std::size_t block = 0; block < view.block_count(); ++block) static_cast<void>(view.read(block));
    }
    if (stage == "strips" || stage == "hot") {
        read_tallies(file);
        read_strip_directory(file);
    }
}

class Verifier {
  public:
    Verifier(const FolderListing& listing, const VerifyOptions& options) : listing_(listing), options_(options) {}

    void check_files() {
        std::uint64_t total = 0;
        for (const StageEntry& entry : listing_.entries) total += entry.bytes;
        for (const StageEntry& entry : listing_.entries) {
            for (const auto& path : entry.foreign) add({path.string(), "is not a file of " + entry.stage});
            for (const auto& path : entry.files) {
                check_file(entry, path);
                report("files", out_.bytes, total, "bytes");
            }
        }
    }

    void check_matrix(const Key& key) {
        std::unique_ptr<StoredMatrix> matrix;
        try {
            if (!all_there(key)) return leave_out("the matrix: files are missing");
            matrix = std::make_unique<StoredMatrix>(listing_, key);
        } catch (const Error& error) {
            add(finding_of(error));
            return leave_out("the matrix: it cannot be opened");
        }
        if (!out_.findings.empty()) return leave_out("the matrix: files are damaged");
        try {
            check_opened(*matrix);
        } catch (const Error& error) {
            add(finding_of(error));
        }
    }

    Verification take() { return std::move(out_); }

  private:
    void add(Finding finding) {
        const auto same = [&](const Finding& f) { return f.where == finding.where && f.what == finding.what; };
        if (out_.findings.size() < options_.most_findings && std::none_of(out_.findings.begin(), out_.findings.end(), same))
            out_.findings.push_back(std::move(finding));
    }
    void leave_out(const std::string& what) { out_.not_checked = what; }
    void report(const char* what, std::uint64_t done, std::uint64_t total, const char* unit) const {
        if (options_.progress) options_.progress(what, done, total, unit);
    }

    void check_file(const StageEntry& entry, const std::filesystem::path& path) {
        ++out_.files;
        try {
            const BlockFileIdentity identity = identify_block_file(path);
            const BlockFileReader file(path, kind_of(entry.stage), identity.version, &entry.key);
            out_.bytes += file.file_bytes();
            out_.blocks += file.blocks().size();
            const std::size_t before = out_.findings.size();
            check_blocks(entry.stage, file);
            if (out_.findings.size() == before) load_whole(entry.stage, path, entry.key, file);
        } catch (const Error& error) {
            add(finding_of(error));
        }
    }

    void check_blocks(const std::string& stage, const BlockFileReader& file) {
        if (stage == "evidence" && identify_block_file(file.name()).version != evidence_version)
            throw Error(ErrorCode::damaged_store, file.name(), "another format version than this program reads");
        std::vector<std::optional<Finding>> found(file.blocks().size());
        parallel_for(found.size(), 1, [&](std::size_t k) {
            try {
                if (stage == "evidence")
                    read_evidence_block(file, k);
                else
                    (void)file.read(k);
            } catch (const Error& error) {
                found[k] = finding_of(error);
            }
        });
        for (auto& finding : found)
            if (finding) add(std::move(*finding));
    }

    /// Names every strip and evidence file of the bake that is not there, and those that it does not have.
    bool all_there(const Key& key) {
        const StageEntry* described = listing_.find("patches", key);
        if (!described) throw Error(ErrorCode::damaged_store, listing_.root.string(), "patches-" + key.text() + ".lxp is missing");
        const PatchesFile patches = load_patches(described->path, key);
        const std::size_t chunks = patches.first_patch.size() - 1, before = out_.findings.size();
        const auto check = [&](const std::string& stage, const Key& stage_key, auto&& name) {
            const StageEntry* entry = listing_.find(stage, stage_key);
            if (!entry) return add({(listing_.root / (stage + "-" + stage_key.text())).string(), "is missing"});
            std::set<std::filesystem::path> found(entry->files.begin(), entry->files.end());
            for (ChunkNumber c = 0; c < chunks; ++c)
                if (const auto path = name(entry->path, c); !found.erase(path)) add({path.string(), "is missing"});
            for (const auto& path : found) add({path.string(), "the bake has only " + std::to_string(chunks) + " chunks"});
        };
        const auto strip = [](const auto& folder, ChunkNumber c) { return strip_path(folder, c); };
        if (const StageEntry* directory = directory_of(listing_, key)) {
            if (load_directory(directory->path, key)->hot_bytes) check("hot", BakeFolder::hot_key(key), strip);
        } else {
            check("strips", key, strip);
            for (const Key& round : patches.evidence)
                check("evidence", round, [](const auto& folder, ChunkNumber c) { return BakeFolder::evidence_file(folder, c); });
        }
        if (!listing_.find("closure", patches.closure))
            add({(listing_.root / ("closure-" + patches.closure.text() + ".lxc")).string(), "is missing"});
        return out_.findings.size() == before;
    }

    void check_opened(const StoredMatrix& matrix) {
        const std::size_t before = out_.findings.size();
        if (matrix.strips) check_strip_blocks(matrix);
        if (out_.findings.size() != before) return leave_out("the matrix: blocks are damaged");
        if (!matrix.is_whole()) return check_directory(matrix);
        out_.row_error = inspect_matrix(listing_, matrix, 0, progress("rows", "blocks")).row_error;
        if (!(out_.row_error <= row_tolerance))
            add({listing_.find("closure", matrix.patches.closure)->path.string(),
                 "a row differs from its patch's area by a share of " + std::to_string(out_.row_error) + ", rows must be exact"});
        for (Finding& finding : recount(*matrix.strips, matrix.strip_folder, matrix.patches.ids, matrix.evidence,
                                        {options_.memory_bytes, options_.most_findings}, progress("recount", "blocks")))
            add(std::move(finding));
        out_.recounted = true;
        check_sampler(matrix);
    }

    /// Of a matrix that is not whole: the kept blocks and their tallies are those of the directory.
    void check_directory(const StoredMatrix& matrix) {
        const std::string where = directory_of(listing_, matrix.key)->path.string();
        const RayTallies& tallies = matrix.tallies();
        if (matrix.strips) {
            const RayTallies& kept = matrix.strips->tallies();
            if (kept.rays != tallies.rays || kept.self != tallies.self || kept.open != tallies.open || kept.back != tallies.back)
                add({where, "other tallies than those of the kept blocks"});
            auto at = matrix.directory->blocks.begin();
            const auto end = matrix.directory->blocks.end();
            for (const BlockInfo& block : matrix.strips->blocks()) {
                while (at != end && (at->a != block.a || at->b != block.b)) ++at;
                if (at == end || at->pair_count != block.pair_count) {
                    add({where, "block (" + std::to_string(block.a) + ", " + std::to_string(block.b) + ") is kept, but not as it is named here"});
                    break;
                }
            }
        }
        for (const DirectoryBlock& block : matrix.directory->blocks)
            if (block.b >= matrix.layout.chunk_count()) return add({where, "it names a chunk that does not exist"});
        leave_out(std::string("recount, rows and flux self-check: evidence is not stored, and ") +
                  (matrix.strips ? "only some blocks are (--store hot)" : "no blocks are (--store none)"));
    }

    void check_strip_blocks(const StoredMatrix& matrix) {
        std::vector<std::optional<Finding>> found(matrix.strips->block_count());
        parallel_for(found.size(), 1, [&](std::size_t k) {
            try {
                CountBlock block;
                matrix.strips->load(k, block);
            } catch (const Error& error) {
                found[k] = finding_of(error);
            }
        });
        for (auto& finding : found)
            if (finding) add(std::move(*finding));
    }

    void check_sampler(const StoredMatrix& matrix) {
        if (matrix.patches.estimator != "ray")
            return leave_out("the flux self-check: counts of the " + matrix.patches.estimator + " estimator do not scatter");
        out_.flux = check_flux({matrix.patches.ids, matrix.patches.area_m2, matrix.tallies().rays}, matrix.evidence,
                               options_.flux, progress("flux", "files"));
        out_.flux_checked = true;
        if (out_.flux.passed) return;
        char text[200];
        std::snprintf(text, sizeof text,
                      "out and in differ by %.2g of the flux on average, by %.1f standard errors at worst (patch %llu); a right "
                      "sampler does so with a probability of %.1g",
                      out_.flux.mean_difference, out_.flux.worst.empty() ? 0.0 : std::abs(out_.flux.worst.front().t),
                      out_.flux.worst.empty() ? 0ULL : static_cast<unsigned long long>(out_.flux.worst.front().id),
                      2 * std::min(out_.flux.probability_all, out_.flux.probability_each));
        add({"flux self-check of " + matrix.key.text(), text});
    }

    [[nodiscard]] ProgressFunction progress(const char* what, const char* unit) const {
        if (!options_.progress) return {};
        return [this, what, unit](std::uint64_t done, std::uint64_t total) { options_.progress(what, done, total, unit); };
    }

    const FolderListing& listing_;
    const VerifyOptions& options_;
    Verification out_;
};

}  // namespace

Verification verify_bake(const FolderListing& listing, const Key& strips, const VerifyOptions& options) {
    Verifier verifier(listing, options);
    verifier.check_files();
    verifier.check_matrix(strips);
    return verifier.take();
}

Verification verify_files(const FolderListing& listing, const VerifyOptions& options) {
    Verifier verifier(listing, options);
    verifier.check_files();
    return verifier.take();
}

}  // namespace luxel
