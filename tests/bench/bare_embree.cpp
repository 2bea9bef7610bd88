#include "tests/bench/bare_embree.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "baker/trace/embree_api.h"

namespace luxel::bench {

struct BareEmbree::State {
    RTCDevice device = nullptr;
    RTCScene tree = nullptr;
};

BareEmbree::BareEmbree(const Scene& scene) : state_(std::make_unique<State>()) {
    state_->device = rtcNewDevice("isa=avx2");
    if (!state_->device) throw std::runtime_error("Embree cannot start");
    state_->tree = rtcNewScene(state_->device);
    rtcSetSceneFlags(state_->tree, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(state_->tree, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 sizeof(Vec3f), scene.positions.size()));
    std::copy_n(reinterpret_cast<const float*>(scene.positions.data()), scene.positions.size() * 3, vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene.triangles.data(), 0,
                               sizeof(scene.triangles[0]), scene.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(state_->tree, geometry, 0);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(state_->tree);
}

BareEmbree::~BareEmbree() {
    rtcReleaseScene(state_->tree);
    rtcReleaseDevice(state_->device);
}

std::uint64_t BareEmbree::trace(std::span<const TraceRay> rays) const {
    alignas(32) int valid[8];
    std::uint64_t sum = 0;
    for (std::size_t begin = 0; begin < rays.size(); begin += 8) {
        const std::size_t count = std::min<std::size_t>(8, rays.size() - begin);
        RTCRayHit8 query;
        for (std::size_t k = 0; k < 8; ++k) {
            const TraceRay& ray = rays[begin + std::min(k, count - 1)];
            valid[k] = k < count ? -1 : 0;
            query.ray.org_x[k] = ray.origin.x, query.ray.org_y[k] = ray.origin.y, query.ray.org_z[k] = ray.origin.z;
            query.ray.dir_x[k] = ray.direction.x, query.ray.dir_y[k] = ray.direction.y;
            query.ray.dir_z[k] = ray.direction.z;
            query.ray.tnear[k] = 0, query.ray.time[k] = 0;
            query.ray.tfar[k] = std::numeric_limits<float>::infinity();
            query.ray.mask[k] = 0xffffffffu, query.ray.id[k] = 0, query.ray.flags[k] = 0;
            query.hit.geomID[k] = query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
        }
        embree_intersect8(valid, state_->tree, query);
        for (std::size_t k = 0; k < count; ++k)
            if (query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID) sum += query.hit.primID[k];
    }
    return sum;
}

}  // namespace luxel::bench
