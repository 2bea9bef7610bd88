/// From a glTF file to a lightmapped glTF file: the list of stages, and nothing else. Each stage is a function from value
/// to value; what is expensive is kept in the bake folder under a name made of its inputs, and not run again.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "baker/bake/parts.h"
#include "baker/bake/report.h"
#include "baker/core/stop.h"
#include "baker/light/interpolate.h"
#include "baker/output/layers.h"
#include "baker/output/viewer_profile.h"
#include "baker/scene/value_check.h"
#include "baker/solver/solve.h"
#include "baker/unwrap/unwrap.h"
#include "formats/gltf/gltf_packing.h"

namespace luxel {

/// How form factors are found: formfactors/ray_estimator.h, formfactors/hemicube_estimator.h.
enum class EstimatorKind { ray, hemicube };

/// What becomes of jumps of light between charts where the surface goes on: output/seam_join.h.
enum class SeamMode { join, keep };

/// Which side of a two-sided surface its texels hold the light of.
enum class TwoSidedTexels {
    front,
    lit  ///< the back where the front lies in the dark: light/lit_sides.h
};

/// How patches are grouped: chunks/room_chunks.h, chunks/spatial_tiles.h.
enum class ChunkKind { rooms, tiles };

/// What of the matrix stays on the disk; the rest is traced again when it is needed, with the same bytes as result.
enum class StoreKind {
    all,   ///< evidence and strips
    hot,   ///< the blocks that cost most time to trace for their bytes, and the directory
    no_blocks,  ///< "none": only the directory: which blocks there are
};
/// Their names on the command line and in reports.
const char* store_name(StoreKind kind);

/// The sky: what the user says, else what the scene has (EXT_lights_image_based), else none. docs/lights.md.
struct SkyChoice {
    bool none = false;                           ///< no sky, whatever the scene has
    std::optional<std::array<double, 3>> color{};  ///< nits from everywhere
    std::filesystem::path picture{};             ///< OpenEXR or Radiance HDR by longitude and latitude; empty: none
    double turn_degrees = 0;  ///< of any sky, counter-clockwise seen from above
    double scale = 1;         ///< factor of any sky, >= 0
};

struct BakedGeometry;

/// What the user may choose. Values are final here: presets are resolved by the command line.
struct BakeOptions {
    std::filesystem::path input, output;
    std::filesystem::path work;  ///< bake folder, kept; empty: a temporary one beside the output, removed at the end

    std::string scene;          ///< number or name in the file; empty: the default one
    bool skip_skinned = false;  ///< leave out nodes with a skin
    bool vertex_colors = true;  ///< COLOR_0 multiplies base colour and alpha
    std::filesystem::path settings;  ///< of nodes (docs/settings.md); empty: what the file's extras say
    bool allow_outside = false; ///< the file may refer to others outside of its folder
    BadValues bad_values = BadValues::clamp;  ///< numbers of materials and lamps that cannot be
    double lamp_radius = 0;        ///< metres, of point and spot lamps that give none
    double sun_angle_degrees = 0;  ///< apparent diameter of directional lamps that give none
    SkyChoice sky;
    bool blend_colours = false;  ///< light that alpha BLEND lets through takes the base colour (scene/see_through.h)
    TwoSidedTexels two_sided = TwoSidedTexels::front;
    UnwrapOptions unwrap;
    std::uint32_t patch_texels = 4;      ///< side of a patch in texels, 1 .. 64
    std::uint32_t chunk_patches = 2048;  ///< patches per chunk at most, 16 .. 65536; never derived from memory
    ChunkKind chunks = ChunkKind::rooms;
    EstimatorKind estimator = EstimatorKind::ray;
    std::uint32_t hemicube_resolution = 64;  ///< pixels along an edge, for EstimatorKind::hemicube
    std::uint32_t replicates = 4;        ///< independent ray sequences per patch
    std::uint64_t rays = 1024;           ///< evidence rays per patch, on average with importance, at least without
    bool importance = true;              ///< choose by a thin first round who gets the rays; false: all the same
    double error = 0;                    ///< wanted relative error of the light of patches and texels; 0: `rays` and `gather_rays` decide
    std::uint32_t closure_iterations = 16;
    SolverKind solver = SolverKind::shoot;
    double tolerance = 1e-3;          ///< of the solve: bound of the relative error
    std::uint32_t lamp_points = 4;    ///< per texel and per patch, a power of two
    /// The same where a shadow may have its edge.
    [[nodiscard]] std::uint32_t edge_lamp_points() const { return 8 * lamp_points; }
    std::uint32_t gather_rays = 256;  ///< per texel, a power of two; 0: draft, patches are interpolated
    std::uint32_t most_gather_rays = 4096;  ///< per texel, where `error` asks for more than gather_rays
    std::uint32_t share_texels = 8;   ///< radius over which gathered light may be shared, 0: not (light/share_light.h), at most 8
    Interpolation interpolation = Interpolation::linear;
    SeamMode seams = SeamMode::join;
    LightmapFormat format = LightmapFormat::png8;          ///< of the pages in the model (output/page_picture.h)
    LightmapEncoding encoding = LightmapEncoding::srgb8;   ///< of png8
    bool dither = true;                                    ///< of png8
    ViewerProfile profile = ViewerProfile::three;          ///< for whom the model's materials are made
    bool unlit = false;         ///< write a second model that any viewer shows (unlit_stage.h)
    double unlit_exposure = 0;  ///< its sample = nits * this; 0: found from the light
    std::optional<DracoBits> draco{};  ///< compress the triangles of the model by Draco
    bool meshopt = false;              ///< compress its arrays by meshopt, those that Draco does not take
    bool split_chunks = false;         ///< write the scene in parts too, for engines that load it piece by piece (split_stage.h)
    std::uint32_t split_triangles = 1000;  ///< fewest of a part
    std::vector<Layer> layers;  ///< to write beside the lightmap, in the order of all_layers
    std::uint64_t seed = 0;

    std::uint64_t memory_bytes = std::uint64_t{2} << 30;  ///< beside the scene's geometry
    StoreKind store = StoreKind::all;
    std::uint64_t store_bytes = 0;  ///< of StoreKind::hot: bytes for kept blocks; 0: a quarter of what all of them would take
    PartSet forced;       ///< done, though the scene does not need it
    bool verify = false;  ///< check the bake folder at the end; findings are in the report
    unsigned threads = 0;                                 ///< 0: all cores
    std::string software = "luxel";                       ///< name and version for metadata

    const StopRequest* stop = nullptr;  ///< asked: end early and write what is there (stopping.h); must outlive the bake
    /// Called once, when the geometry is there and has taken so many seconds: may still change rays, gather_rays, most_gather_rays,
    /// lamp_points and tolerance. None: they are final.
    std::function<void(BakeOptions&, const BakedGeometry&, double seconds)> adapt;
    double checkpoint_s = 20;  ///< time between checkpoints of a solve; 0: after every step
    double preview_s = 0;      ///< time between previews while solving (preview.h); 0: none

    /// (stage, done, total, unit): now and then, from any thread, one at a time.
    std::function<void(const std::string&, std::uint64_t, std::uint64_t, const char*)> progress;
};

/// Runs all stages. Throws Error; nothing half-written stays at the output's place. The report is complete on return. Asked to
/// stop before there is any light: Error{stopped_early}; later: outputs from what is there, and report.stopped.
BakeReport bake(const BakeOptions& options);

}  // namespace luxel
