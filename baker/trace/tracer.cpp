#include "baker/trace/tracer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <utility>

#include "baker/trace/coincident.h"
#include "baker/trace/embree_api.h"
#include "baker/trace/see_through_rays.h"

namespace luxel {
namespace {

// One instruction set on every machine; one building thread, since the tree's order decides ties at shared edges.
constexpr const char* device_settings = "isa=avx2,threads=1,start_threads=0,set_affinity=0";
// The same, but for all threads: see BuildOnOneThread.
constexpr const char* all_threads_settings = "isa=avx2,start_threads=0,set_affinity=0";

[[noreturn]] void fail(RTCDevice device, const char* step) {
    const RTCError code = rtcGetDeviceError(device);
    throw Error(ErrorCode::internal, "Embree", std::string(step) + ": error " + std::to_string(static_cast<int>(code)),
                code == RTC_ERROR_OUT_OF_MEMORY ? "the scene's triangles do not fit in memory" : "");
}

/// While it lives, Embree builds on one thread; afterwards the process has all of them again.
///
/// Embree limits oneTBB in the whole process to the most threads that any of its devices asks for. Those that hold trees ask for one.
/// So one device that asks for all, and does nothing else, is there whenever no tree is being built: without it every
/// loop of the process would run on a single thread, with it a tree's order would depend on the machine.
class BuildOnOneThread {
  public:
    BuildOnOneThread() : lock_(mutex()) {
        if (all_threads()) rtcReleaseDevice(std::exchange(all_threads(), nullptr));
    }
    // A failure costs speed alone.
    ~BuildOnOneThread() { all_threads() = rtcNewDevice(all_threads_settings); }
    BuildOnOneThread(const BuildOnOneThread&) = delete;
    BuildOnOneThread& operator=(const BuildOnOneThread&) = delete;

  private:
    // What they guard is Embree's own state of the process.
    static std::mutex& mutex() {
        static std::mutex one;
        return one;
    }
    static RTCDevice& all_threads() {
        static RTCDevice device = nullptr;
        return device;
    }
    std::lock_guard<std::mutex> lock_;
};

RTCRayHit make_ray(const TraceRay& ray, float near) {
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x, query.ray.org_y = ray.origin.y, query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x, query.ray.dir_y = ray.direction.y, query.ray.dir_z = ray.direction.z;
    query.ray.tnear = near;
    query.ray.tfar = std::numeric_limits<float>::infinity();
    query.ray.mask = 0xffffffffu;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.primID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

/// Rays [first, first + count) as one packet. Idle lanes repeat the first ray, so that every lane holds defined numbers.
void fill_packet(const RayColumns& rays, std::size_t first, std::size_t count, int* valid, RTCRayHit8& query) {
    const auto copy = [&](const std::array<float, RayColumns::capacity>& from, float* to) {
        if (count == 8)
            std::memcpy(to, from.data() + first, 8 * sizeof(float));
        else
            for (std::size_t k = 0; k < 8; ++k) to[k] = from[first + (k < count ? k : 0)];
    };
    copy(rays.origin_x, query.ray.org_x), copy(rays.origin_y, query.ray.org_y), copy(rays.origin_z, query.ray.org_z);
    copy(rays.direction_x, query.ray.dir_x), copy(rays.direction_y, query.ray.dir_y), copy(rays.direction_z, query.ray.dir_z);
    for (std::size_t k = 0; k < 8; ++k) valid[k] = k < count ? -1 : 0;
    for (std::size_t k = 0; k < 8; ++k) query.ray.tnear[k] = 0, query.ray.time[k] = 0;
    for (std::size_t k = 0; k < 8; ++k) query.ray.tfar[k] = std::numeric_limits<float>::infinity();
    for (std::size_t k = 0; k < 8; ++k)
        query.ray.mask[k] = 0xffffffffu, query.ray.id[k] = static_cast<unsigned>(k), query.ray.flags[k] = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        query.hit.Ng_x[k] = query.hit.Ng_y[k] = query.hit.Ng_z[k] = 0;
        query.hit.geomID[k] = query.hit.primID[k] = query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
}

}  // namespace

struct Tracer::State {
    State(const Scene& s, PassageTest test) : scene(s), coincident(s) { part_by_passage(test); }
    ~State() {
        if (tree) rtcReleaseScene(tree);
        if (device) rtcReleaseDevice(device);
    }
    /// Only surfaces that can be seen through pay for the filter: they are a geometry of their own. What casts no shadow is in none.
    void part_by_passage(PassageTest test) {
        const auto casts = [&](std::uint32_t t) { return scene.object_of(t).casts; };
        const auto can = [&](std::uint32_t t) { return casts(t) && (test == PassageTest::everywhere || scene.material_of(t).is_see_through()); };
        const auto any = [&](const auto& is) {
            std::uint32_t t = 0;
            while (t < scene.triangle_count() && !is(t)) ++t;
            return t < scene.triangle_count();
        };
        is_see_through = any(can);
        is_parted = is_see_through || any([&](std::uint32_t t) { return !casts(t); });
        if (!is_parted) return;
        for (std::uint32_t t = 0; t < scene.triangle_count(); ++t)
            if (casts(t)) triangles[can(t)].push_back(t);
        filtered.triangle_of = triangles[1].data();
    }
    [[nodiscard]] std::uint32_t triangle(unsigned geometry, unsigned primitive) const {
        return is_parted ? triangles[geometry][primitive] : primitive;
    }
    void attach(unsigned number);

    const Scene& scene;
    CoincidentTriangles coincident;
    bool is_see_through = false, is_parted = false;
    /// Of geometry 0, which is opaque, and 1, which is not; empty when all are opaque and cast: then primitives are triangles.
    std::array<std::vector<std::uint32_t>, 2> triangles;
    SeeThroughGeometry filtered;
    RTCDevice device = nullptr;
    RTCScene tree = nullptr;
    std::int64_t bytes = 0;
};

void Tracer::State::attach(unsigned number) {
    if (is_parted ? triangles[number].empty() : scene.triangles.empty() || number > 0) return;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Embree reads 16 bytes from the last vertex: a copy with one spare float keeps it inside an allocation.
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(Vec3f), scene.positions.size()));
    if (!vertices) fail(device, "vertices");
    std::copy_n(reinterpret_cast<const float*>(scene.positions.data()), scene.positions.size() * 3, vertices);
    constexpr std::size_t stride = sizeof(scene.triangles[0]);
    if (is_parted) {
        auto* corners = static_cast<std::array<std::uint32_t, 3>*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, stride, triangles[number].size()));
        if (!corners) fail(device, "triangles");
        for (const std::uint32_t t : triangles[number]) *corners++ = scene.triangles[t];
    } else {
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene.triangles.data(), 0, stride,
                                   scene.triangles.size());
    }
    if (number == 1) {
        rtcSetGeometryUserData(geometry, &filtered);
        rtcSetGeometryIntersectFilterFunction(geometry, see_through_filter);
        rtcSetGeometryOccludedFilterFunction(geometry, see_through_filter);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tree, geometry, number);
    rtcReleaseGeometry(geometry);
}

Tracer::Tracer(const Scene& scene, PassageTest test) : state_(std::make_unique<State>(scene, test)) {
    State& s = *state_;
    const BuildOnOneThread one_thread;
    s.device = rtcNewDevice(device_settings);
    if (!s.device) fail(nullptr, "cannot start");
    rtcSetDeviceMemoryMonitorFunction(
        s.device,
        [](void* state, ssize_t bytes, bool) {
            static_cast<State*>(state)->bytes += bytes;
            return true;
        },
        state_.get());
    s.tree = rtcNewScene(s.device);
    rtcSetSceneFlags(s.tree, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(s.tree, RTC_BUILD_QUALITY_HIGH);
    for (const unsigned number : {0u, 1u}) s.attach(number);
    rtcCommitScene(s.tree);
    if (rtcGetDeviceError(s.device) != RTC_ERROR_NONE) fail(s.device, "cannot build the tree");
}

Tracer::~Tracer() = default;

std::uint64_t Tracer::resident_bytes() const {
    const std::size_t numbers = state_->triangles[0].size() + state_->triangles[1].size();
    return static_cast<std::uint64_t>(std::max<std::int64_t>(state_->bytes, 0)) + numbers * sizeof(std::uint32_t);
}

bool Tracer::is_see_through() const { return state_->is_see_through; }

TraceHit Tracer::finish(const TraceRay& ray, std::uint32_t triangle, float b1, float b2, float distance,
                        bool front, SeeThroughQuery* query, std::size_t lane) const {
    TraceHit hit{triangle, b1, b2, distance, front};
    if (state_->coincident.empty()) return hit;
    const auto group = state_->coincident.group(triangle);
    if (group.empty()) return hit;
    const Scene& scene = state_->scene;
    std::uint32_t chosen = none;
    int chosen_rank = -1;
    Vec2f chosen_b(0, 0);
    for (const std::uint32_t candidate : group) {
        if (candidate == ray.from_triangle) continue;
        const Vec2f b = transfer_barycentrics(scene, triangle, candidate, {b1, b2});
        const bool is_pane = query && scene.material_of(candidate).is_see_through();
        if (is_pane && !query->stops(lane, ray.origin, ray.direction, candidate, b, distance)) continue;
        // Fronts first; of those what can be seen through, which would be nowhere to see behind what cannot.
        const int rank = 2 * (scene.area_vector(candidate).dot(to_double(ray.direction)) < 0) + is_pane;
        if (rank > chosen_rank) chosen = candidate, chosen_rank = rank, chosen_b = b;
    }
    if (chosen == none) return hit;  // rounding between copies: the tree has asked at another place
    return {chosen, chosen_b.x, chosen_b.y, distance, chosen_rank >= 2};
}

TraceHit Tracer::first_hit(const TraceRay& ray) const {
    if (!state_->is_see_through) return first_hit(ray, nullptr);
    SeeThroughQuery query(state_->scene, SeeThroughQuery::Wants::first_hit);
    query.set_from(0, ray.from_triangle);
    TraceHit hit = first_hit(ray, &query);
    hit.tint = query.passed(0, hit.triangle == none ? std::numeric_limits<float>::infinity() : hit.distance_m);
    return hit;
}

TraceHit Tracer::first_hit(const TraceRay& ray, SeeThroughQuery* see_through) const {
    // A ray that starts exactly on its own triangle meets it at 0, and the next float is flushed to 0 again: so the near
    // end begins at a length that is nothing in any scene. It grows faster each time, so that the loop ends.
    constexpr float smallest_m = 0x1p-60f;
    float near = 0, step = std::numeric_limits<float>::epsilon();
    for (;;) {
        RTCRayHit query = make_ray(ray, near);
        if (see_through) embree_intersect1(state_->tree, query, *see_through);
        else embree_intersect1(state_->tree, query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
        const std::uint32_t triangle = state_->triangle(query.hit.geomID, query.hit.primID);
        // A copy in the same place is another triangle: finish() chooses among the copies.
        if (triangle == ray.from_triangle && state_->coincident.group(ray.from_triangle).empty()) {
            near = std::max({near, query.ray.tfar, smallest_m}) * (1 + step);
            step *= 2;
            continue;
        }
        const bool outside = query.hit.Ng_x * ray.direction.x + query.hit.Ng_y * ray.direction.y +
                                 query.hit.Ng_z * ray.direction.z < 0;
        return finish(ray, triangle, query.hit.u, query.hit.v, query.ray.tfar, outside != state_->scene.is_turned(triangle), see_through, 0);
    }
}

void Tracer::first_hits(std::span<const TraceRay> rays, std::span<TraceHit> hits) const {
    RayColumns columns;
    for (std::size_t begin = 0; begin < rays.size(); begin += RayColumns::capacity) {
        const std::size_t count = std::min(RayColumns::capacity, rays.size() - begin);
        for (std::size_t k = 0; k < count; ++k) columns.set(k, rays[begin + k]);
        first_hits(columns, 0, hits.subspan(begin, count));
    }
}

void Tracer::first_hits(const RayColumns& rays, std::size_t begin, std::span<TraceHit> hits, RayCoherence coherence) const {
    if (state_->is_see_through) return first_hits_through(rays, begin, hits, coherence);
    for (std::size_t done = 0; done < hits.size(); done += 8) {
        const std::size_t first = begin + done, count = std::min<std::size_t>(8, hits.size() - done);
        alignas(32) int valid[8];
        RTCRayHit8 query;
        fill_packet(rays, first, count, valid, query);
        embree_intersect8(valid, state_->tree, query, coherence == RayCoherence::together);
        std::array<bool, 8> outside;
        for (std::size_t k = 0; k < 8; ++k)
            outside[k] = query.hit.Ng_x[k] * query.ray.dir_x[k] + query.hit.Ng_y[k] * query.ray.dir_y[k] +
                           query.hit.Ng_z[k] * query.ray.dir_z[k] < 0;
        for (std::size_t k = 0; k < count; ++k) {
            TraceHit& hit = hits[done + k];
            if (query.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) {
                hit = {};
                continue;
            }
            const std::uint32_t triangle = state_->triangle(query.hit.geomID[k], query.hit.primID[k]);
            const bool front = outside[k] != state_->scene.is_turned(triangle);
            if (triangle == rays.from_triangle[first + k]) {
                hit = first_hit(rays.at(first + k));
            } else if (state_->coincident.empty()) {
                hit = {triangle, query.hit.u[k], query.hit.v[k], query.ray.tfar[k], front};
            } else {
                hit = finish(rays.at(first + k), triangle, query.hit.u[k], query.hit.v[k], query.ray.tfar[k], front,
                             nullptr, k);
            }
        }
    }
}

void Tracer::first_hits_through(const RayColumns& rays, std::size_t begin, std::span<TraceHit> hits,
                                RayCoherence coherence) const {
    for (std::size_t done = 0; done < hits.size(); done += 8) {
        const std::size_t first = begin + done, count = std::min<std::size_t>(8, hits.size() - done);
        alignas(32) int valid[8];
        RTCRayHit8 query;
        fill_packet(rays, first, count, valid, query);
        SeeThroughQuery see_through(state_->scene, SeeThroughQuery::Wants::first_hit);
        for (std::size_t k = 0; k < count; ++k) see_through.set_from(k, rays.from_triangle[first + k]);
        embree_intersect8(valid, state_->tree, query, coherence == RayCoherence::together, see_through);
        for (std::size_t k = 0; k < count; ++k) {
            TraceHit& hit = hits[done + k];
            hit = {};
            float reach = std::numeric_limits<float>::infinity();
            if (query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID) {
                const TraceRay ray = rays.at(first + k);
                const std::uint32_t triangle = state_->triangle(query.hit.geomID[k], query.hit.primID[k]);
                if (triangle == ray.from_triangle) {
                    hit = first_hit(ray);
                    continue;
                }
                const Vec3f normal(query.hit.Ng_x[k], query.hit.Ng_y[k], query.hit.Ng_z[k]);
                reach = query.ray.tfar[k];
                hit = finish(ray, triangle, query.hit.u[k], query.hit.v[k], reach,
                             (normal.dot(ray.direction) < 0) != state_->scene.is_turned(triangle), &see_through, k);
            }
            hit.tint = see_through.passed(k, reach);
        }
    }
}

namespace {

/// From the origin to a far end that lies on a surface: stop short of it by the rounding of the distance.
RTCRay make_shadow_ray(const TraceRay& ray, float distance_m) {
    RTCRay shadow = make_ray(ray, 0).ray;
    shadow.tfar = distance_m * (1 - 64 * std::numeric_limits<float>::epsilon());
    return shadow;
}

}  // namespace

bool Tracer::occluded(const TraceRay& ray, float distance_m) const {
    RTCRay shadow = make_shadow_ray(ray, distance_m);
    if (state_->is_see_through) {
        SeeThroughQuery query(state_->scene, SeeThroughQuery::Wants::anything);
        query.set_from(0, ray.from_triangle);
        embree_occluded1(state_->tree, shadow, query);
    } else {
        embree_occluded1(state_->tree, shadow);
    }
    return shadow.tfar < 0;
}

Rgb Tracer::transmittance(const TraceRay& ray, float distance_m) const {
    if (!state_->is_see_through) return occluded(ray, distance_m) ? Rgb(0, 0, 0) : Rgb(1, 1, 1);
    RTCRay shadow = make_shadow_ray(ray, distance_m);
    const float end = shadow.tfar;
    SeeThroughQuery query(state_->scene, SeeThroughQuery::Wants::transmittance);
    query.set_from(0, ray.from_triangle);
    embree_occluded1(state_->tree, shadow, query);
    return shadow.tfar < 0 ? Rgb(0, 0, 0) : query.passed(0, end);
}

const char* tracer_identity() {
    static const std::string identity = "embree-" + std::to_string(RTC_VERSION_MAJOR) + "." +
                                        std::to_string(RTC_VERSION_MINOR) + " avx2 robust high 8";
    return identity.c_str();
}

}  // namespace luxel
