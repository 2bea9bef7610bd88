/// Copies a part of a model into a new one with everything that it refers to, and nothing else: a collector that copies.
/// Private to the gltf_out files.
///
/// Numbers  of the new model in the order of first use. An object is copied once however often it is named.
/// Arrays   get a view of their own with just their elements (equal ones share it); sparse ones are written out.
/// Left out extensions that are unknown here and hold whole numbers, which might be references: with a warning.
/// Errors   none: arrays that cannot be read, which nothing that was read uses, become zeros, with a warning.
/// Threads  pure; the same calls give the same model.
#pragma once
#include <map>
#include <set>
#include <string>
#include <utility>

#include "formats/gltf/gltf_out_arrays.h"
#include "formats/gltf/gltf_out_model.h"
#include "formats/gltf/gltf_references.h"

namespace luxel {

class GltfSubset {
  public:
    /// `source` must outlive `target`, which borrows its bytes; `target` is empty.
    GltfSubset(const OutputModel& source, OutputModel& target) : source_(source), target_(target), arrays_(target) {}

    /// The new number of an object, which is copied with what it names at its first call. Nodes are a matter of add_node.
    std::uint64_t copy(GltfKind kind, std::uint64_t number, ArrayUse use = ArrayUse::other);

    /// Says which nodes will be there, in this order: their numbers are known from now on. To be called first.
    void name_nodes(const std::vector<std::uint64_t>& numbers);
    /// Appends the next of them. Its members name objects of the source, which are copied, and nodes that were named above.
    void add_node(nlohmann::json node);
    /// The new number of a node, if it was named.
    [[nodiscard]] const std::uint64_t* find_node(std::uint64_t number) const { return find(GltfKind::node, number); }

    /// Copies those channels of an animation whose targets are here, with their samplers; nothing if there are none.
    /// Returns if all of them were.
    bool add_animation(const nlohmann::json& animation);

    /// Numbers of the source's images that were copied, ascending.
    [[nodiscard]] std::set<std::uint64_t> images() const;

    /// asset, scenes and lists of extensions: what is left to do when all nodes are there. `roots` are new numbers.
    void finish(const std::vector<std::uint64_t>& roots, const nlohmann::json& scene);

  private:
    [[nodiscard]] const std::uint64_t* find(GltfKind kind, std::uint64_t number) const;
    void translate(GltfKind kind, nlohmann::json& object);
    bool translate_target(nlohmann::json& target) const;
    void add_sky(nlohmann::json& scene);
    std::uint64_t copy_array(std::uint64_t number, ArrayUse use);
    std::uint64_t copy_view(std::uint64_t number);
    void drop_unknown(nlohmann::json& object);
    void copy_extension_lists();

    const OutputModel& source_;
    OutputModel& target_;
    ArrayStore arrays_;
    std::map<std::pair<GltfKind, std::uint64_t>, std::uint64_t> known_;
    std::map<std::pair<std::uint64_t, ArrayUse>, std::uint64_t> known_arrays_;
    std::set<std::string> dropped_;  ///< names of extensions
};

}  // namespace luxel
