/// Names of everything in a bake folder, built here and nowhere else.
///
///     atlas-<key>.lxa                     unwrap/atlas_file.h
///     evidence-<key>/chunk-<n>.lxe        formats/bake/evidence_file.md
///     strips-<key>/strip-<n>.lxs          formats/bake/strip_file.md
///     directory-<key>.lxd                 formats/bake/directory_file.md; the key is that of the strips that are not all kept
///     hot-<key>/strip-<n>.lxs             formats/bake/strip_file.md: the blocks of them that are
///     patches-<key>.lxp                   formats/bake/patches_file.md; the key is that of the strips
///     plan-<key>.lxl                      stage_files.h
///     closure-<key>.lxc                   stage_files.h
///     sky-<key>.lxy                       formats/bake/sky_view_file.md
///     solution-<key>.lxr                  stage_files.h
///     checkpoint-<key>.lxk                stage_files.h; the key is that of the solution, which takes its place
///     accuracy-<key>.lxv                  stage_files.h
///     lightmaps-<key>/page-<n>.lxp        stage_files.h
///
/// <key> is the hash of the stage's inputs and options: another input gives another name, so nothing is ever stale.
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "formats/base/hash.h"

namespace luxel {

class BakeFolder {
  public:
    /// `work` is kept, temporary files of killed runs in it are removed; when it is empty, a temporary folder beside `output` is made and removed with this object.
    BakeFolder(const std::filesystem::path& work, const std::filesystem::path& output);
    ~BakeFolder();
    BakeFolder(const BakeFolder&) = delete;
    BakeFolder& operator=(const BakeFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& root() const { return root_; }
    [[nodiscard]] std::filesystem::path atlas(const Key& key) const;
    [[nodiscard]] std::filesystem::path evidence(const Key& key) const;  ///< folder, made if missing
    [[nodiscard]] std::filesystem::path strips(const Key& key) const;    ///< folder, made if missing
    [[nodiscard]] std::filesystem::path directory(const Key& strips) const;
    [[nodiscard]] std::filesystem::path hot(const Key& strips) const;  ///< folder, made if missing
    [[nodiscard]] std::filesystem::path patches(const Key& strips) const;
    [[nodiscard]] std::filesystem::path plan(const Key& key) const;
    [[nodiscard]] std::filesystem::path closure(const Key& key) const;
    [[nodiscard]] std::filesystem::path sky_view(const Key& key) const;
    [[nodiscard]] std::filesystem::path solution(const Key& key) const;
    [[nodiscard]] std::filesystem::path checkpoint(const Key& solution) const;
    [[nodiscard]] std::filesystem::path accuracy(const Key& key) const;
    [[nodiscard]] std::filesystem::path lightmaps(const Key& key) const;  ///< folder, made if missing

    /// Of a file or folder of the root; 0: it is not there.
    [[nodiscard]] std::uint64_t bytes_of(const std::string& name) const;

    /// Key of the kept blocks of strips that are not all kept.
    static Key hot_key(const Key& strips);

    /// Removes a matrix that only served to choose rays, and what was found with it; what is not there is no error, here and
    /// below.
    void discard(const Key& strips, const Key& closure) const;
    /// Removes a solution, or what there is of it.
    void discard_solution(const Key& solution) const;
    void discard_checkpoint(const Key& solution) const;
    /// Removes the strips of a matrix, or one round of evidence.
    void discard_strips(const Key& strips) const;
    void discard_evidence(const Key& evidence) const;
    /// Removes the kept blocks, or the directory too.
    void discard_hot(const Key& strips) const;
    void discard_directory(const Key& strips) const;

    static std::filesystem::path evidence_file(const std::filesystem::path& folder, std::uint32_t chunk);
    static std::filesystem::path lightmap_file(const std::filesystem::path& folder, std::uint32_t page);

    /// The stage and key that a file or folder of the root is named after: "strips-<key>" -> {"strips", key}. Empty: not
    /// one of ours.
    struct StageName {
        std::string stage;
        Key key;
    };
    static std::optional<StageName> stage_of(const std::filesystem::path& name);

  private:
    std::filesystem::path root_;
    bool temporary_ = false;
};

}  // namespace luxel
