#include "baker/output/page_layers.h"

#include <algorithm>

#include "baker/core/parallel.h"
#include "baker/output/fill_hidden.h"
#include "baker/patches/texel_surface.h"

namespace luxel {
namespace {

class PageLayers {
  public:
    explicit PageLayers(const PageLayerInput& input)
        : in_(input),
          content_(input.texels.pages[input.page]),
          size_(input.atlas.page_size),
          square_(std::size_t{size_} * size_) {
        if (in_.mask.size() != square_)
            throw Error(
                ErrorCode::internal, "layers",
                "the mask has " + std::to_string(in_.mask.size()) + " texels, the page " + std::to_string(square_));
    }

    [[nodiscard]] ExrPartValues values(Layer layer) const {
        if (layer_info(layer).is_of_light && in_.light.size() != content_.texels.size())
            throw Error(ErrorCode::internal, "layers",
                        "the light has " + std::to_string(in_.light.size()) + " texels, the page covers " +
                            std::to_string(content_.texels.size()));
        switch (layer) {
            case Layer::direct:
                return filled([&](std::size_t k) { return in_.light[k].direct; });
            case Layer::indirect:
                return filled([&](std::size_t k) { return in_.light[k].indirect; });
            case Layer::error:
                return each<float>(0, [&](std::size_t k) { return can_send(k) ? in_.light[k].error : 0.0f; });
            case Layer::sharing:
                return each<float>(0, [&](std::size_t k) { return can_send(k) ? in_.light[k].bias : 0.0f; });
            case Layer::samples:
                return each<std::uint32_t>(0, [&](std::size_t k) { return can_send(k) ? in_.light[k].rays : 0u; });
            case Layer::albedo:
                return channels(each<Rgb>(Rgb(0, 0, 0), [&](std::size_t k) { return content_.texels[k].reflectance; }));
            case Layer::normal:
                return channels(each<Vec3f>(Vec3f(0, 0, 0), [&](std::size_t k) {
                    return texel_surface(in_.scene, in_.atlas, content_, content_.texels[k]).shading_normal;
                }));
            case Layer::patch:
                return each<std::uint32_t>(no_patch,
                                           [&](std::size_t k) { return in_.patches.page_patch[in_.page][place(k)]; });
            case Layer::chart:
                return each<std::uint32_t>(none, [&](std::size_t k) { return content_.texels[k].chart; });
            case Layer::valid:
                return valid();
            case Layer::area:
                return each<float>(0, [&](std::size_t k) { return content_.texels[k].visible_m2; });
        }
        return {};
    }

  private:
    [[nodiscard]] std::size_t place(std::size_t k) const {
        return std::size_t{content_.texels[k].y} * size_ + content_.texels[k].x;
    }
    [[nodiscard]] bool can_send(std::size_t k) const { return content_.can_send(content_.texels[k]); }

    template <class Value, class Of>
    [[nodiscard]] std::vector<Value> each(Value elsewhere, const Of& of) const {
        std::vector<Value> values(square_, elsewhere);
        parallel_for(content_.texels.size(), 1024, [&](std::size_t k) { values[place(k)] = of(k); });
        return values;
    }

    static std::vector<float> channels(const std::vector<Vec3f>& values) {
        std::vector<float> interleaved;
        interleaved.reserve(values.size() * 3);
        for (const Vec3f& value : values) interleaved.insert(interleaved.end(), {value.x, value.y, value.z});
        return interleaved;
    }

    template <class Of>
    [[nodiscard]] std::vector<float> filled(const Of& of) const {
        std::vector<Rgb> values = each<Rgb>(Rgb(0, 0, 0), of);
        std::vector<std::uint8_t> mask(square_, texel_empty);
        std::vector<std::uint32_t> charts(square_, none);
        for (std::size_t k = 0; k < content_.texels.size(); ++k) {
            mask[place(k)] = can_send(k) ? texel_covered : texel_hidden;
            charts[place(k)] = content_.texels[k].chart;
        }
        fill_hidden(values, mask, charts, size_, size_);
        dilate(values, mask, size_, size_, std::max(1u, in_.atlas.padding));
        for (std::size_t at = 0; at < square_; ++at)
            if (mask[at] == texel_empty) values[at] = Rgb(0, 0, 0);
        return channels(values);
    }

    [[nodiscard]] std::vector<std::uint32_t> valid() const {
        std::vector<std::uint32_t> values(square_, valid_none);
        for (std::size_t at = 0; at < square_; ++at)
            if (in_.mask[at] == texel_filled) values[at] = valid_filled;
        for (std::size_t k = 0; k < content_.texels.size(); ++k)
            values[place(k)] = can_send(k) ? valid_covered : valid_hidden;
        return values;
    }

    const PageLayerInput& in_;
    const PageTexels& content_;
    const std::uint32_t size_;
    const std::size_t square_;
};

}  // namespace

ExrPartValues page_layer(const PageLayerInput& input, Layer layer) { return PageLayers(input).values(layer); }

Bytes layers_exr(const PageLayerInput& input, std::span<const Layer> layers, const std::string& software) {
    std::vector<ExrPart> parts;
    for (const Layer layer : layers) {
        const LayerInfo& info = layer_info(layer);
        ExrPart& part = parts.emplace_back();
        part.name = info.name;
        for (const char* channel = info.channels; *channel; ++channel) part.channels.emplace_back(1, *channel);
        part.sample = info.sample;
        part.metadata.quantity = info.quantity;
        part.metadata.unit = info.unit;
        part.metadata.encoding = "linear";
        part.metadata.software = software;
    }
    const PageLayers page(input);
    return encode_exr_parts(input.atlas.page_size, input.atlas.page_size, parts,
                            [&](std::size_t part) { return page.values(layers[part]); });
}

}  // namespace luxel
