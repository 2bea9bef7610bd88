#include "formats/gltf/gltf_draco_decoder.h"

#include <draco/compression/attributes/sequential_attribute_decoders_controller.h>
#include <draco/compression/attributes/sequential_quantization_attribute_decoder.h>
#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/varint_decoding.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "formats/gltf/gltf_json.h"

namespace luxel {
namespace {

constexpr std::uint64_t triangles_per_byte = 64, free_triangles = 1 << 22;
constexpr std::uint64_t decoded_bytes_per_byte = 1024, free_decoded_bytes = 1 << 27;

/// What one stream may claim, and the claim that was too much. Outlives the decoder.
struct Bounds {
    std::uint64_t stream_bytes = 0;
    std::string refusal;

    /// Notes the refusal. `what`: "orientations"; `whose`: what `most` follows from, "its corners".
    bool allows(std::uint64_t found, std::uint64_t most, const std::string& what, const std::string& whose) {
        if (found <= most) return true;
        refusal = "the stream claims " + std::to_string(found) + " " + what + "; expected at most " + std::to_string(most) + " for " + whose;
        return false;
    }
    bool allows_triangles(std::uint64_t found) {
        return allows(found, free_triangles + triangles_per_byte * stream_bytes, "triangles or points", its_bytes());
    }
    bool allows_attributes(std::uint64_t bytes) {
        return allows(bytes, free_decoded_bytes + decoded_bytes_per_byte * stream_bytes, "bytes of attributes", its_bytes());
    }
    [[nodiscard]] std::string its_bytes() const { return "its " + std::to_string(stream_bytes) + " bytes"; }
};

/// An integer as streams hold it: 32 bits in old versions, of variable length since. Nothing where the stream ends.
std::optional<std::uint32_t> read_count(draco::DecoderBuffer& buffer, bool is_fixed) {
    std::uint32_t count = 0;
    const bool is_read = is_fixed ? buffer.Decode(&count) : draco::DecodeVarint(&count, &buffer);
    return is_read ? std::optional(count) : std::nullopt;
}

/// How many orientations come next. Nothing where the stream ends, or the scheme has none.
std::optional<std::uint32_t> next_orientations(draco::DecoderBuffer buffer, draco::PredictionSchemeMethod method) {
    if (method == draco::MESH_PREDICTION_TEX_COORDS_PORTABLE) return read_count(buffer, true);
    if (method == draco::MESH_PREDICTION_TEX_COORDS_DEPRECATED)
        return read_count(buffer, buffer.bitstream_version() < DRACO_BITSTREAM_VERSION(2, 2));
    return std::nullopt;
}

/// A prediction scheme of Draco that does not read more orientations than there are corners.
class BoundedScheme : public draco::PredictionSchemeTypedDecoderInterface<std::int32_t> {
  public:
    using Scheme = draco::PredictionSchemeTypedDecoderInterface<std::int32_t>;
    BoundedScheme(std::unique_ptr<Scheme> scheme, std::uint64_t corners, Bounds& bounds)
        : scheme_(std::move(scheme)), corners_(corners), bounds_(bounds) {}

    bool DecodePredictionData(draco::DecoderBuffer* buffer) override {
        const std::optional<std::uint32_t> orientations = next_orientations(*buffer, GetPredictionMethod());
        if (orientations && !bounds_.allows(*orientations, corners_, "orientations of texture coordinates", "its corners")) return false;
        return scheme_->DecodePredictionData(buffer);
    }
    bool ComputeOriginalValues(const std::int32_t* corrections, std::int32_t* values, int size, int components,
                               const draco::PointIndex* points) override {
        return scheme_->ComputeOriginalValues(corrections, values, size, components, points);
    }
    [[nodiscard]] draco::PredictionSchemeMethod GetPredictionMethod() const override { return scheme_->GetPredictionMethod(); }
    [[nodiscard]] const draco::PointAttribute* GetAttribute() const override { return scheme_->GetAttribute(); }
    [[nodiscard]] bool IsInitialized() const override { return scheme_->IsInitialized(); }
    [[nodiscard]] int GetNumParentAttributes() const override { return scheme_->GetNumParentAttributes(); }
    [[nodiscard]] draco::GeometryAttribute::Type GetParentAttributeType(int i) const override { return scheme_->GetParentAttributeType(i); }
    bool SetParentAttribute(const draco::PointAttribute* attribute) override { return scheme_->SetParentAttribute(attribute); }
    bool AreCorrectionsPositive() override { return scheme_->AreCorrectionsPositive(); }
    [[nodiscard]] draco::PredictionSchemeTransformType GetTransformType() const override { return scheme_->GetTransformType(); }

  private:
    std::unique_ptr<Scheme> scheme_;
    std::uint64_t corners_;
    Bounds& bounds_;
};

/// The decoders of attributes that may be predicted from positions: Draco's, of integers and of quantised numbers.
template <class AttributeDecoder>
class BoundedAttribute : public AttributeDecoder {
  public:
    explicit BoundedAttribute(Bounds& bounds) : bounds_(bounds) {}

  protected:
    /// Predictions that are none are refused: Draco would take any negative number for one.
    bool DecodeValues(const std::vector<draco::PointIndex>& points, draco::DecoderBuffer* buffer) override {
        std::array<std::int8_t, 2> prediction{};  // method, transform
        if (!buffer->Peek(prediction.data(), prediction.size())) return false;
        const auto [method, transform] = prediction;
        const bool is_method = method >= draco::PREDICTION_NONE && method < draco::NUM_PREDICTION_SCHEMES;
        const bool is_transform = transform >= draco::PREDICTION_TRANSFORM_NONE && transform < draco::NUM_PREDICTION_SCHEME_TRANSFORM_TYPES;
        return is_method && (is_transform || method == draco::PREDICTION_NONE) && AttributeDecoder::DecodeValues(points, buffer);
    }
    std::unique_ptr<BoundedScheme::Scheme> CreateIntPredictionScheme(draco::PredictionSchemeMethod method,
                                                                     draco::PredictionSchemeTransformType transform) override {
        auto scheme = AttributeDecoder::CreateIntPredictionScheme(method, transform);
        if (!scheme) return nullptr;
        const auto& mesh = static_cast<const draco::Mesh&>(*this->decoder()->point_cloud());
        return std::make_unique<BoundedScheme>(std::move(scheme), std::uint64_t{3} * mesh.num_faces(), bounds_);
    }

  private:
    Bounds& bounds_;
};

/// The decoder of a group of attributes, which takes no more memory for them than the stream may justify.
class BoundedController : public draco::SequentialAttributeDecodersController {
  public:
    /// In the place of the one that a decoder of meshes has made, with the order of values that it has chosen.
    BoundedController(draco::SequentialAttributeDecodersController&& made, Bounds& bounds)
        : SequentialAttributeDecodersController(std::move(made)), bounds_(bounds) {}

    bool DecodeAttributesDecoderData(draco::DecoderBuffer* buffer) override {
        return SequentialAttributeDecodersController::DecodeAttributesDecoderData(buffer) && attributes_fit();
    }

  protected:
    std::unique_ptr<draco::SequentialAttributeDecoder> CreateSequentialDecoder(std::uint8_t type) override {
        if (type == draco::SEQUENTIAL_ATTRIBUTE_ENCODER_INTEGER)
            return std::make_unique<BoundedAttribute<draco::SequentialIntegerAttributeDecoder>>(bounds_);
        if (type == draco::SEQUENTIAL_ATTRIBUTE_ENCODER_QUANTIZATION)
            return std::make_unique<BoundedAttribute<draco::SequentialQuantizationAttributeDecoder>>(bounds_);
        return SequentialAttributeDecodersController::CreateSequentialDecoder(type);
    }

  private:
    /// All attributes so far, of this group and of those before it.
    bool attributes_fit() {
        const draco::PointCloud& cloud = *GetDecoder()->point_cloud();
        std::uint64_t bytes_per_point = 0;
        for (int k = 0; k < cloud.num_attributes(); ++k) {
            // Whatever the type, values are integers of 32 bits on their way.
            const draco::PointAttribute& attribute = *cloud.attribute(k);
            bytes_per_point += std::max<std::uint64_t>(static_cast<std::uint64_t>(attribute.byte_stride()), 4u * attribute.num_components());
        }
        return bounds_.allows_attributes(bytes_per_point * cloud.num_points());
    }

    Bounds& bounds_;
};

/// Triangles, once more for each attribute that has seams of its own, or points. Nothing where the stream ends.
std::optional<std::uint64_t> claimed_triangles(draco::DecoderBuffer buffer, draco::MeshEncoderMethod method) {
    const auto version = buffer.bitstream_version();
    if (method == draco::MESH_SEQUENTIAL_ENCODING) {
        const bool is_fixed = version < DRACO_BITSTREAM_VERSION(2, 2);
        const auto faces = read_count(buffer, is_fixed), points = read_count(buffer, is_fixed);
        return faces && points ? std::optional<std::uint64_t>(std::max(*faces, *points)) : std::nullopt;
    }
    const bool is_fixed = version < DRACO_BITSTREAM_VERSION(2, 0);
    if (version < DRACO_BITSTREAM_VERSION(2, 2) && !read_count(buffer, is_fixed)) return std::nullopt;  // vertices that are new
    const auto vertices = read_count(buffer, is_fixed), faces = read_count(buffer, is_fixed);
    std::uint8_t with_seams = 0;
    if (!vertices || !faces || !buffer.Decode(&with_seams)) return std::nullopt;
    return std::max<std::uint64_t>(*vertices, *faces) * (1u + with_seams);
}

/// One of Draco's two decoders of meshes.
template <class MeshDecoder, draco::MeshEncoderMethod method>
class BoundedDecoder : public MeshDecoder {
  public:
    explicit BoundedDecoder(Bounds& bounds) : bounds_(bounds) {}

  protected:
    bool DecodeConnectivity() override {
        const auto claimed = claimed_triangles(*this->buffer(), method);
        return claimed && bounds_.allows_triangles(*claimed) && MeshDecoder::DecodeConnectivity();
    }
    bool CreateAttributesDecoder(std::int32_t id) override {
        if (!MeshDecoder::CreateAttributesDecoder(id)) return false;
        // The decoder owns it and gives it out as const; it is ours to change until decoding goes on.
        auto* made = dynamic_cast<draco::SequentialAttributeDecodersController*>(
            const_cast<draco::AttributesDecoderInterface*>(this->attributes_decoder(id)));
        return made && this->SetAttributesDecoder(id, std::make_unique<BoundedController>(std::move(*made), bounds_));
    }

  private:
    Bounds& bounds_;
};

draco::Status decode(draco::DecoderBuffer& buffer, Bounds& bounds, draco::Mesh& mesh) {
    draco::DecoderBuffer ahead = buffer;
    draco::DracoHeader header;
    if (draco::Status status = draco::PointCloudDecoder::DecodeHeader(&ahead, &header); !status.ok()) return status;
    if (header.encoder_type != draco::TRIANGULAR_MESH) return {draco::Status::DRACO_ERROR, "the compressed data is no mesh"};
    const draco::DecoderOptions options;
    if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING)
        return BoundedDecoder<draco::MeshSequentialDecoder, draco::MESH_SEQUENTIAL_ENCODING>(bounds).Decode(options, &buffer, &mesh);
    if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING)
        return BoundedDecoder<draco::MeshEdgebreakerDecoder, draco::MESH_EDGEBREAKER_ENCODING>(bounds).Decode(options, &buffer, &mesh);
    return {draco::Status::UNSUPPORTED_FEATURE, "expected edgebreaker or sequential encoding, found method " + std::to_string(header.encoder_method)};
}

}  // namespace

std::unique_ptr<draco::Mesh> decode_draco_mesh(ByteView stream, const std::string& where) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
    Bounds bounds{stream.size(), {}};
    auto mesh = std::make_unique<draco::Mesh>();
    const draco::Status status = decode(buffer, bounds, *mesh);
    if (status.ok()) return mesh;
    bad_gltf(where, "Draco: " + (bounds.refusal.empty() ? status.error_msg_string() : bounds.refusal),
             "the file is damaged, or was packed by a newer tool; export it again");
}

}  // namespace luxel
