#include "taut/picture/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <limits>

#include "taut/base/error.h"

namespace taut::detail {

struct RayScene::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  ~Handles() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

namespace {

void check_device(RTCDevice device, const char* what) {
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE)
    throw InputError(
        fmt::format("ray tracing: {} failed (Embree error {}); is there enough memory?", what,
                    static_cast<int>(error)));
}

void attach(RTCDevice device, RTCScene scene, const Surface& surface, unsigned id,
            const Vec3& origin) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               surface.positions.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), surface.triangles.size()));
  if (vertices && indices) {
    for (const Vec3& p : surface.positions)
      for (int k = 0; k < 3; ++k) *vertices++ = static_cast<float>(p[k] - origin[k]);
    for (const Triangle& t : surface.triangles)
      for (const Index v : t) *indices++ = static_cast<unsigned>(v);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
  }
  rtcReleaseGeometry(geometry);
  check_device(device, "loading a mesh");
}

template <class Ray8>
void fill(const Rays& rays, Ray8& ray, int* valid) {
  for (int i = 0; i < packet_size; ++i) {
    const auto k = static_cast<std::size_t>(i);
    valid[i] = rays.active[k] ? -1 : 0;
    if (!rays.active[k]) continue;
    ray.org_x[i] = rays.origin[k].x();
    ray.org_y[i] = rays.origin[k].y();
    ray.org_z[i] = rays.origin[k].z();
    ray.dir_x[i] = rays.direction[k].x();
    ray.dir_y[i] = rays.direction[k].y();
    ray.dir_z[i] = rays.direction[k].z();
    ray.tnear[i] = rays.near;
    ray.tfar[i] = std::numeric_limits<float>::infinity();
    ray.time[i] = 0.0F;
    ray.mask[i] = ~0U;
    ray.id[i] = 0;
    ray.flags[i] = 0;
  }
}

}  // namespace

RayScene::RayScene(std::span<const Surface> surfaces, const Vec3& origin)
    : handles_(std::make_unique<Handles>()) {
  handles_->device = rtcNewDevice(nullptr);
  check_device(handles_->device, "starting");
  handles_->scene = rtcNewScene(handles_->device);
  rtcSetSceneFlags(handles_->scene, RTC_SCENE_FLAG_ROBUST);
  for (std::size_t s = 0; s < surfaces.size(); ++s)
    if (!surfaces[s].triangles.empty())
      attach(handles_->device, handles_->scene, surfaces[s], static_cast<unsigned>(s), origin);
  // The tree is built by one thread: built by several, the order inside its leaves, and so which of
  // two triangles wins on their common edge, could differ from run to run.
  tbb::task_arena one_thread(1);
  one_thread.execute([&] { rtcJoinCommitScene(handles_->scene); });
  check_device(handles_->device, "building the tree");
}

RayScene::~RayScene() = default;

void RayScene::nearest_hits(const Rays& rays, Hits& hits) const {
  alignas(32) int valid[packet_size];
  RTCRayHit8 query{};
  fill(rays, query.ray, valid);
  for (int i = 0; i < packet_size; ++i)
    query.hit.geomID[i] = query.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, handles_->scene, &context, &query);
  for (int i = 0; i < packet_size; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool hit = valid[i] && query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    hits.distance[k] = hit ? query.ray.tfar[i] : std::numeric_limits<float>::infinity();
    hits.u[k] = query.hit.u[i];
    hits.v[k] = query.hit.v[i];
    hits.surface[k] = query.hit.geomID[i];
    hits.triangle[k] = query.hit.primID[i];
  }
}

void RayScene::blocked(const Rays& rays, Packet<bool>& result) const {
  alignas(32) int valid[packet_size];
  RTCRay8 query{};
  fill(rays, query, valid);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded8(valid, handles_->scene, &context, &query);
  // Embree marks a blocked ray by tfar = -infinity.
  for (int i = 0; i < packet_size; ++i)
    result[static_cast<std::size_t>(i)] = valid[i] && query.tfar[i] < 0.0F;
}

}  // namespace taut::detail
