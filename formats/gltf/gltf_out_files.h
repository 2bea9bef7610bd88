/// Lays the model out as files: GLB with everything inside, or .gltf with one .bin and pictures beside it.
/// Private to the gltf_out files.
///
/// All bytes are written to temporaries first and renamed together, the model last. When something fails, the files
/// that this call has already renamed are removed.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "formats/gltf/gltf_out.h"
#include "formats/gltf/gltf_out_model.h"
#include "formats/gltf/scene_record.h"

namespace luxel {

class ModelFiles {
  public:
    ModelFiles(std::filesystem::path path, OutputModel& model);

    /// Adds the picture of a page; its bytes must outlive write(). Returns its image index.
    std::uint64_t add_page(std::size_t page, const LightmapPicture& picture, const LightmapMeaning& meaning);
    /// Name of the file that an image of add_page() goes to; empty: inside the model.
    [[nodiscard]] std::string file_of(std::uint64_t image) const;
    /// Takes pictures outside the file along: into a GLB, or beside a .gltf in another folder. Those which cannot be
    /// read keep their URI; a warning says so.
    void take_pictures_along(const SceneRecord& record);
    /// Puts pictures that are data URIs into a GLB; its other pictures stay where they are.
    void take_data_pictures_inside();
    /// "<stem><suffix>" of the output, or a longer one where that is a file of the input: it must survive.
    [[nodiscard]] std::string free_name(const std::string& suffix) const;
    /// Sets offsets and buffers, and publishes; returns the files, the model first.
    std::vector<std::filesystem::path> write();

  private:
    struct File {
        std::filesystem::path path;
        std::vector<ByteView> parts;
    };
    /// The bytes of an image outside the file; nothing, with a warning, if they cannot be read. Sets an empty type to what the URI says.
    std::optional<ByteView> read_picture(const nlohmann::json& image, const std::string& where, std::string& mime_type);
    void take_picture(nlohmann::json& image, std::size_t index, ByteView bytes, const std::string& mime_type);
    void lay_out_views();
    void add_buffers(std::uint64_t unpacked_bytes);
    ByteView view_bytes(std::size_t index, const std::string& where);
    void add_body(std::vector<File>& files);
    void publish(const std::vector<File>& files) const;

    std::filesystem::path path_;
    OutputModel& model_;
    bool is_text_;
    std::set<std::filesystem::path> input_files_;
    std::vector<File> pictures_;
    std::map<std::uint64_t, std::string> page_files_;  ///< by image
    std::vector<ByteView> body_;  ///< views and padding, in order
    std::uint64_t body_bytes_ = 0;
    std::vector<Bytes> kept_;  ///< bytes that nobody else owns
    std::string text_;
};

}  // namespace luxel
