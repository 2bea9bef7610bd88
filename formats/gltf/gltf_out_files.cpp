#include "formats/gltf/gltf_out_files.h"

#include <array>
#include <deque>
#include <memory>
#include <string_view>

#include "formats/base/file.h"
#include "formats/gltf/gltf_json.h"
#include "formats/gltf/gltf_out_uri.h"
#include "formats/gltf/gltf_uri.h"

namespace luxel {

using nlohmann::json;

namespace {

constexpr const char* meshopt = "EXT_meshopt_compression";
constexpr std::array<std::uint8_t, 4> zeros{};
constexpr std::array<std::uint8_t, 4> spaces{' ', ' ', ' ', ' '};
constexpr std::uint64_t glb_limit_bytes = 0xffffffffu;  ///< its lengths have 32 bits

std::uint64_t padding_of(std::uint64_t size) { return (4 - size % 4) % 4; }

struct PictureKind {
    std::string_view magic;
    std::size_t at;
    const char* mime_type;
    const char* suffix;
};

/// Kinds of pictures that glTF and its extensions name, by their first bytes.
const PictureKind* picture_kind(ByteView bytes) {
    static constexpr std::array<PictureKind, 6> kinds{{{"\x89PNG\r\n\x1a\n", 0, "image/png", ".png"},
                                                       {"\xff\xd8\xff", 0, "image/jpeg", ".jpg"},
                                                       {"WEBP", 8, "image/webp", ".webp"},
                                                       {"\xabKTX 20\xbb\r\n\x1a\n", 0, "image/ktx2", ".ktx2"},
                                                       {"DDS ", 0, "image/vnd-ms.dds", ".dds"},
                                                       {"#?RADIANCE", 0, "image/vnd.radiance", ".hdr"}}};
    for (const PictureKind& kind : kinds)
        if (bytes.size() >= kind.at + kind.magic.size() &&
            std::memcmp(bytes.data() + kind.at, kind.magic.data(), kind.magic.size()) == 0)
            return &kind;
    return nullptr;
}

/// The same text for the same place, whether it exists or not.
std::filesystem::path real_path(const std::filesystem::path& path) {
    std::error_code unknown;
    const auto found = std::filesystem::weakly_canonical(path.empty() ? std::filesystem::path(".") : path, unknown);
    return unknown ? path : found;
}

Bytes glb_header(std::uint64_t text_bytes, std::uint64_t body_bytes) {
    constexpr std::uint32_t glb_magic = 0x46546c67, glb_version = 2, chunk_json = 0x4e4f534a;
    ByteWriter writer;
    writer.put(glb_magic);
    writer.put(glb_version);
    writer.put(static_cast<std::uint32_t>(12 + 8 + text_bytes + (body_bytes ? 8 + body_bytes : 0)));
    writer.put(static_cast<std::uint32_t>(text_bytes));
    writer.put(chunk_json);
    return writer.take();
}

Bytes glb_body_header(std::uint64_t body_bytes) {
    constexpr std::uint32_t chunk_bin = 0x004e4942;
    ByteWriter writer;
    writer.put(static_cast<std::uint32_t>(body_bytes));
    writer.put(chunk_bin);
    return writer.take();
}

}  // namespace

ModelFiles::ModelFiles(std::filesystem::path path, OutputModel& model)
    : path_(std::move(path)), model_(model), is_text_(path_.extension() == ".gltf") {
    input_files_.insert(real_path(model_.document.folder / model_.document.name));
    for (const char* array : {"buffers", "images"})
        for (const json& item : json_array(model_.root, array, model_.document.name)) {
            const std::string uri = json_text(item, "uri", "", model_.document.name);
            if (uri.empty() || uri.starts_with("data:")) continue;
            if (const auto file = decode_percent(uri)) input_files_.insert(real_path(model_.document.folder / *file));
        }
}

std::string ModelFiles::free_name(const std::string& suffix) const {
    std::string stem = path_.stem().string();
    while (input_files_.contains(real_path(path_.parent_path() / (stem + suffix)))) stem += ".baked";
    return stem + suffix;
}

std::uint64_t ModelFiles::add_page(std::size_t page, const LightmapPicture& picture, const LightmapMeaning& meaning) {
    json image = {{"name", picture.name}};
    std::string file;
    if (is_text_ || !meaning.is_embedded) {
        file = free_name(".lightmap" + std::to_string(page) + meaning.suffix);
        image["uri"] = encode_percent(file);
        pictures_.push_back({path_.parent_path() / file, {picture.file}});
    } else {
        image["mimeType"] = meaning.mime_type;
        image["bufferView"] = model_.append_view({-1, picture.file, {}});
    }
    if (!meaning.texture_extension.empty()) image["extensions"][meaning.texture_extension] = json::object();
    const std::uint64_t index = model_.append("images", std::move(image));
    page_files_[index] = file;
    return index;
}

std::string ModelFiles::file_of(std::uint64_t image) const { return page_files_.at(image); }

void ModelFiles::take_pictures_along(const SceneRecord& record) {
    const bool stays = is_text_ && real_path(path_.parent_path()) == real_path(model_.document.folder);
    for (std::size_t index = 0; index < gltf_count(model_.root, "images"); ++index) {
        json& image = model_.root["images"][index];
        const std::string where =
            model_.document.name + ": " + gltf_name(image, "image", static_cast<std::int64_t>(index));
        if (!image.contains("uri")) continue;
        const std::string uri = json_text(image, "uri", "", where);
        if (stays || (is_text_ && uri.starts_with("data:"))) continue;
        ByteView bytes;
        std::string mime_type = json_text(image, "mimeType", "", where);
        if (index < record.images.size() && !record.images[index].bytes.empty()) {
            bytes = record.images[index].bytes;
            if (mime_type.empty()) mime_type = record.images[index].mime_type;
        } else {
            const auto found = read_picture(image, where, mime_type);
            if (!found) continue;
            bytes = *found;
        }
        take_picture(image, index, bytes, mime_type);
    }
}

void ModelFiles::take_data_pictures_inside() {
    for (std::size_t index = 0; index < gltf_count(model_.root, "images"); ++index) {
        json& image = model_.root["images"][index];
        const std::string where = model_.document.name + ": " + gltf_name(image, "image", static_cast<std::int64_t>(index));
        if (!json_text(image, "uri", "", where).starts_with("data:")) continue;
        std::string mime_type = json_text(image, "mimeType", "", where);
        if (const auto bytes = read_picture(image, where, mime_type)) take_picture(image, index, *bytes, mime_type);
    }
}

std::optional<ByteView> ModelFiles::read_picture(const json& image, const std::string& where, std::string& mime_type) {
    try {
        kept_.push_back(read_uri(model_.document, image["uri"].get<std::string>(), where, mime_type.empty() ? &mime_type : nullptr));
        return kept_.back();
    } catch (const Error& error) {
        model_.warnings.push_back({"picture-left-behind", where, error.what_text + "; its URI is kept"});
        return std::nullopt;
    }
}

void ModelFiles::take_picture(json& image, std::size_t index, ByteView bytes, const std::string& mime_type) {
    const PictureKind* kind = picture_kind(bytes);
    const std::string uri = image["uri"].get<std::string>();
    if (is_text_) {
        const std::string suffix = kind ? kind->suffix : std::filesystem::path(uri).extension().string();
        const std::string file = free_name(".image" + std::to_string(index) + suffix);
        image["uri"] = encode_percent(file);
        pictures_.push_back({path_.parent_path() / file, {bytes}});
        return;
    }
    if (!kind && mime_type.empty()) {
        model_.warnings.push_back({"picture-left-behind", model_.document.name + ": image " + std::to_string(index),
                                   "of an unknown kind; its URI is kept"});
        return;
    }
    if (!image.contains("name") && !uri.starts_with("data:"))
        image["name"] = std::filesystem::path(uri).stem().string();
    image.erase("uri");
    image["mimeType"] = kind ? std::string(kind->mime_type) : mime_type;
    image["bufferView"] = model_.append_view({-1, bytes, {}});
}

ByteView ModelFiles::view_bytes(std::size_t index, const std::string& where) {
    try {
        return model_.view_bytes(index, where);
    } catch (const Error& error) {
        // Nothing that was read uses it, else reading had failed: the model must not be lost for its sake.
        model_.warnings.push_back({"damaged-view", error.where, error.what_text + "; written as one zero byte"});
        return ByteView(zeros).first(1);
    }
}

/// One buffer, views in order, each at a multiple of 4. Packed views have their place in a second one without data,
/// which stands for what a decoder makes of them.
void ModelFiles::lay_out_views() {
    std::uint64_t unpacked_bytes = 0;
    const auto append = [&](ByteView bytes) {
        body_.push_back(bytes);
        body_.push_back(ByteView(zeros).first(padding_of(bytes.size())));
        const std::uint64_t offset = body_bytes_;
        body_bytes_ += bytes.size() + padding_of(bytes.size());
        return offset;
    };
    for (std::size_t index = 0; index < model_.views.size(); ++index) {
        json& item = model_.root["bufferViews"][index];
        const ByteView bytes = view_bytes(index, model_.document.name);
        if (bytes.data() == zeros.data()) item.erase("byteStride");
        erase_extension(item, meshopt);  // of the input: written decoded
        erase_extension(item, "KHR_meshopt_compression");
        item["byteLength"] = bytes.size();
        if (const auto& packed = model_.views[index].packed) {
            item["extensions"][meshopt] = {{"buffer", 0},
                                           {"byteOffset", append(packed->bytes)},
                                           {"byteLength", packed->bytes.size()},
                                           {"byteStride", packed->stride},
                                           {"count", packed->count},
                                           {"mode", packed->mode}};
            item["buffer"] = 1;
            item["byteOffset"] = unpacked_bytes;
            unpacked_bytes += bytes.size() + padding_of(bytes.size());
        } else {
            item["buffer"] = 0;
            item["byteOffset"] = append(bytes);
        }
    }
    add_buffers(unpacked_bytes);
    for (const char* name : {meshopt, "KHR_meshopt_compression", "KHR_draco_mesh_compression"})
        if (!has_extension(model_.root, name)) drop_extension(model_.root, name);
}

void ModelFiles::add_buffers(std::uint64_t unpacked_bytes) {
    json buffer = gltf_count(model_.root, "buffers") ? model_.root["buffers"][0] : json::object();
    buffer.erase("uri");
    erase_extension(buffer, meshopt);
    erase_extension(buffer, "KHR_meshopt_compression");
    buffer["byteLength"] = body_bytes_;
    model_.root.erase("buffers");
    if (body_bytes_) model_.root["buffers"] = json::array({std::move(buffer)});
    if (unpacked_bytes)
        model_.append("buffers", {{"byteLength", unpacked_bytes}, {"extensions", {{meshopt, {{"fallback", true}}}}}});
}

void ModelFiles::add_body(std::vector<File>& files) {
    const auto dump = [&](int indent) { return model_.root.dump(indent, ' ', false, json::error_handler_t::replace); };
    files.insert(files.end(), pictures_.begin(), pictures_.end());
    if (is_text_) {
        if (body_bytes_) {
            const std::string file = free_name(".bin");
            model_.root["buffers"][0]["uri"] = encode_percent(file);
            files.push_back({path_.parent_path() / file, body_});
        }
        text_ = dump(2) + "\n";
    } else {
        text_ = dump(-1);
    }
    const ByteView text(reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size());
    if (is_text_) {
        files[0].parts = {text};
        return;
    }
    const std::uint64_t text_bytes = text.size() + padding_of(text.size());
    if (text_bytes + body_bytes_ + 28 > glb_limit_bytes)
        throw Error(ErrorCode::cannot_write, path_.string(),
                    "needs " + std::to_string(text_bytes + body_bytes_ + 28) + " bytes, a GLB holds at most 4 GiB",
                    "choose an output name that ends in .gltf");
    kept_.push_back(glb_header(text_bytes, body_bytes_));
    files[0].parts = {kept_.back(), text, ByteView(spaces).first(padding_of(text.size()))};
    if (!body_bytes_) return;
    kept_.push_back(glb_body_header(body_bytes_));
    files[0].parts.emplace_back(kept_.back());
    files[0].parts.insert(files[0].parts.end(), body_.begin(), body_.end());
}

void ModelFiles::publish(const std::vector<File>& files) const {
    std::deque<PublishedFile> written;
    for (const File& file : files) {
        PublishedFile& out = written.emplace_back(file.path);
        for (const ByteView part : file.parts) out.append(part);
    }
    // The model last: whoever sees it finds everything that it names.
    std::size_t published = files.size();
    try {
        for (; published > 0; --published) written[published - 1].publish();
    } catch (...) {
        std::error_code ignored;
        for (std::size_t index = published; index < files.size(); ++index)
            std::filesystem::remove(files[index].path, ignored);
        throw;
    }
}

std::vector<std::filesystem::path> ModelFiles::write() {
    lay_out_views();
    std::vector<File> files{{path_, {}}};
    add_body(files);
    publish(files);
    std::vector<std::filesystem::path> paths;
    for (const File& file : files) paths.push_back(file.path);
    return paths;
}

}  // namespace luxel
