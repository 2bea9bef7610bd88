#include "baker/bake/write_stage.h"

#include <algorithm>

#include "baker/bake/instance_layouts.h"
#include "baker/bake/seam_stage.h"
#include "baker/bake/split_stage.h"
#include "baker/bake/unlit_stage.h"
#include "baker/output/page_layers.h"
#include "baker/output/page_picture.h"
#include "baker/output/sidecar.h"
#include "baker/output/unlit_page.h"
#include "formats/base/file.h"
#include "formats/gltf/gltf_out.h"

namespace luxel {
namespace {

/// Removes what was written so far unless the whole set is complete.
class OutputSet {
  public:
    ~OutputSet() {
        std::error_code ignored;
        if (!complete_)
            for (const auto& path : files_) std::filesystem::remove(path, ignored);
    }
    void add(const std::filesystem::path& path) { files_.push_back(path); }
    void complete() { complete_ = true; }

  private:
    std::vector<std::filesystem::path> files_;
    bool complete_ = false;
};

class Writer {
  public:
    Writer(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light, const JoinedSeams& seams)
        : options_(options), g_(geometry), light_(light), seams_(seams) {}

    WrittenOutputs run(const ProgressFunction& progress) {
        sidecar_.generator = lightmaps_.version = options_.software;
        sidecar_.state = light_.state;
        sidecar_.model = options_.output.filename().string();
        sidecar_.texels_per_metre = static_cast<double>(g_.atlas.texels_per_metre);
        sidecar_.profile = viewer_profile_info(options_.profile).name;
        lightmaps_.meaning = meaning();
        for (std::uint32_t page = 0; page < g_.shown_pages; ++page) {
            const std::vector<std::uint8_t> mask = write_page(page);
            if (!options_.layers.empty() && light_.state != "preview") write_layers(page, mask);
            if (progress) progress(page + 1, g_.shown_pages + 1);
        }
        lightmaps_.instances = instance_layouts(g_);
        GltfPacking packing{options_.draco, options_.meshopt, g_.atlas.page_size, {}};
        std::optional<SplitPlan> plan;
        if (options_.split_chunks && light_.state != "preview") plan = plan_split(options_, g_);
        if (plan) packing.split = plan->split;
        const GltfWritten written = write_gltf(options_.output, g_.document, g_.record, lightmaps_, packing);
        for (const auto& file : written.files) written_.add(file);
        if (plan) write_chunk_index(*plan, written.parts);
        for (std::size_t page = 0; page < sidecar_.pages.size(); ++page) sidecar_.pages[page].picture.file = written.page_files[page];
        report_.warnings.insert(report_.warnings.end(), written.warnings.begin(), written.warnings.end());
        report_.outputs.push_back({options_.output.string(), "model", "", "", "", 1});
        const auto sidecar = sidecar_path(options_.output);
        write_sidecar(sidecar, sidecar_);
        report_.outputs.push_back({sidecar.string(), "sidecar", "", "", "", 1});
        written_.complete();
        return std::move(report_);
    }

  private:
    [[nodiscard]] LightmapMeaning meaning() const {
        const LightmapFormatInfo& format = lightmap_format_info(options_.format);
        const ViewerProfileInfo& profile = viewer_profile_info(options_.profile);
        LightmapMeaning meaning;
        meaning.encoding = encoding_of(options_.format, options_.encoding);
        meaning.format = format.name;
        meaning.profile = profile.name;
        if (profile.on_nodes) meaning.placement = LightmapPlacement::nodes;
        meaning.lit_scale = profile.lit_scale;
        meaning.unlit_scale = profile.unlit_scale;
        meaning.suffix = format.suffix;
        meaning.mime_type = format.mime_type;
        if (format.texture_extension) meaning.texture_extension = format.texture_extension;
        meaning.is_embedded = !format.texture_extension || embeds_foreign_pictures(options_.profile);
        return meaning;
    }

    void write_chunk_index(const SplitPlan& plan, const GltfParts& parts) {
        auto file = options_.output;
        file.replace_extension("chunks.json");
        publish_file(file, chunk_index_text(index_of_parts(options_, g_, plan, parts)));
        written_.add(file);
        report_.outputs.push_back({file.string(), "chunks", "", "", "", 1});
        for (const auto& part : parts.files()) report_.outputs.push_back({part.string(), "chunk", "", "", "", 1});
    }

    /// Returns which texels have a value.
    std::vector<std::uint8_t> write_page(std::uint32_t page) {
        const std::uint32_t size = g_.atlas.page_size;
        PageImage image = page_image(options_, g_, light_, page);
        seams_.put_into(page, size, image);
        const std::string name = "lightmap" + std::to_string(page);
        auto exr = options_.output;
        exr.replace_extension(name + ".exr");
        publish_file(exr, lightmap_exr(image.values, image.mask, size, size, options_.software));
        written_.add(exr);
        report_.outputs.push_back({exr.string(), "lightmap", "irradiance", "lux", "linear", 1});
        PagePicture picture = page_picture(image.values, image.mask, size, size, {options_.format, options_.encoding, options_.dither, options_.software});
        const std::string encoding = lightmaps_.meaning.encoding, title = name + "." + encoding;
        lightmaps_.meaning.range = picture.range;
        report_.outputs.push_back({options_.output.string() + "#" + title, "lightmap", "irradiance", "lux", encoding, picture.intensity, picture.error});
        SidecarPage entry;
        entry.width = entry.height = size;
        entry.exr = {exr.filename().string(), "", "linear", 1};
        entry.picture = {"", title, encoding, picture.intensity, lightmaps_.meaning.format, picture.range, picture.error};
        sidecar_.pages.push_back(entry);
        lightmaps_.pages.push_back({title, std::move(picture.file), picture.intensity});
        return std::move(image.mask);
    }

    void write_layers(std::uint32_t page, const std::vector<std::uint8_t>& mask) {
        const std::vector<TexelLight> light = light_.texel_light ? light_.texel_light(page) : std::vector<TexelLight>();
        std::vector<Layer> layers, unknown;
        for (const Layer layer : options_.layers)
            (layer_info(layer).is_of_light && light.empty() && !g_.texels.pages[page].texels.empty() ? unknown : layers).push_back(layer);
        if (!unknown.empty())
            report_.warnings.push_back({"layers-left-out", "page " + std::to_string(page),
                                        layer_names(unknown) + ": the parts of its light are not known, as nothing was gathered for it"});
        if (layers.empty()) return;
        auto exr = options_.output;
        exr.replace_extension("aov" + std::to_string(page) + ".exr");
        publish_file(exr, layers_exr({g_.scene, g_.atlas, g_.texels, g_.patches, page, mask, light}, layers, options_.software));
        written_.add(exr);
        for (const Layer layer : layers)
            report_.outputs.push_back({exr.string() + "#" + layer_info(layer).name, "layer", layer_info(layer).quantity, layer_info(layer).unit, "linear", 1});
        sidecar_.pages.back().layer_file = exr.filename().string();
        sidecar_.pages.back().layers = std::move(layers);
    }

    const BakeOptions& options_;
    const BakedGeometry& g_;
    const BakedLight& light_;
    const JoinedSeams& seams_;
    WrittenOutputs report_;
    GltfLightmaps lightmaps_;
    Sidecar sidecar_;
    OutputSet written_;
};

}  // namespace

std::uint64_t picture_bytes_per_texel(const BakeOptions& options) {
    return std::max(lightmap_format_info(options.format).bytes_per_texel, options.unlit ? unlit_bytes_per_texel : 0);
}

WrittenOutputs write_lightmaps(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light,
                               const JoinedSeams& seams, const ProgressFunction& progress) {
    return Writer(options, geometry, light, seams).run(progress);
}

void write_outputs(const BakeOptions& options, const BakedGeometry& geometry, const BakedLight& light, StageClock& clock,
                   BakeReport& report) {
    clock.stage("write", [&] {
        const JoinedSeams seams = options.seams == SeamMode::join ? JoinedSeams(options, geometry, light) : JoinedSeams();
        report.seams = seams.report();
        WrittenOutputs written = write_lightmaps(options, geometry, light, seams, clock.progress("files"));
        if (options.unlit) report.unlit = write_unlit(options, geometry, light, seams, written);
        report.outputs = std::move(written.outputs);
        report.warnings.insert(report.warnings.end(), written.warnings.begin(), written.warnings.end());
        return false;
    });
}

}  // namespace luxel
