// The plainest use of Embree there is.
#include "embree_loop.h"

#include <embree3/rtcore.h>

#include <cstring>

namespace pse::surface {
namespace {

RTCRay ray_of(const Ray& ray) {
  return {static_cast<float>(ray.origin.x), static_cast<float>(ray.origin.y),
          static_cast<float>(ray.origin.z), 0,
          static_cast<float>(ray.direction.x), static_cast<float>(ray.direction.y),
          static_cast<float>(ray.direction.z), 0, 1e30f, 0xffffffff, 0, 0};
}

// One block of pixels, in a packet of as many lanes.
template <class Packet, int lanes, class Intersect>
void block(const Lens& lens, int x, int y, int size, const Intersect& intersect,
           std::vector<std::uint32_t>& found) {
  alignas(64) int all[lanes];
  alignas(64) Packet query;
  for (int k = 0; k < lanes; ++k) {
    const RTCRay ray = ray_of(lens.ray(x + k % 4 + 0.5, y + k / 4 + 0.5));
    auto& r = query.ray;
    r.org_x[k] = ray.org_x, r.org_y[k] = ray.org_y, r.org_z[k] = ray.org_z;
    r.dir_x[k] = ray.dir_x, r.dir_y[k] = ray.dir_y, r.dir_z[k] = ray.dir_z;
    r.tnear[k] = 0, r.tfar[k] = ray.tfar, r.time[k] = 0;
    r.mask[k] = ray.mask, r.id[k] = 0, r.flags[k] = 0;
    query.hit.geomID[k] = query.hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    all[k] = -1;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  intersect(all, &context, &query);
  for (int k = 0; k < lanes; ++k)
    found[static_cast<std::size_t>(y + k / 4) * size + x + k % 4] = query.hit.primID[k];
}

}  // namespace

EmbreeLoop::EmbreeLoop(const Mesh& mesh) {
  const RTCDevice device = rtcNewDevice("threads=1");
  const RTCScene scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                      mesh.vertex_count()),
              mesh.positions.data(), mesh.positions.size() * sizeof(float));
  std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                      mesh.triangle_count()),
              mesh.triangles.data(), mesh.triangles.size() * sizeof(std::uint32_t));
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  device_ = device, scene_ = scene;
}

EmbreeLoop::~EmbreeLoop() {
  rtcReleaseScene(static_cast<RTCScene>(scene_));
  rtcReleaseDevice(static_cast<RTCDevice>(device_));
}

std::vector<std::uint32_t> EmbreeLoop::triangles(const Lens& lens, int size, int packet) const {
  std::vector<std::uint32_t> found(static_cast<std::size_t>(size) * size);
  const auto scene = static_cast<RTCScene>(scene_);
  const auto alone = [&](int x, int y) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query;
    query.ray = ray_of(lens.ray(x + 0.5, y + 0.5));
    query.hit.geomID = query.hit.primID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    found[static_cast<std::size_t>(y) * size + x] = query.hit.primID;
  };
  for (int y = 0; y < size; y += packet == 1 ? 1 : packet / 4)
    for (int x = 0; x < size; x += packet == 1 ? 1 : 4) {
      if (packet == 1)
        alone(x, y);
      else if (packet == 8)
        block<RTCRayHit8, 8>(lens, x, y, size, [&](int* valid, auto* context, auto* query) {
          rtcIntersect8(valid, scene, context, query);
        }, found);
      else
        block<RTCRayHit16, 16>(lens, x, y, size, [&](int* valid, auto* context, auto* query) {
          rtcIntersect16(valid, scene, context, query);
        }, found);
    }
  return found;
}

}  // namespace pse::surface
