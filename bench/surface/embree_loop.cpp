// The plainest use of Embree there is.
#include "embree_loop.h"

#include <embree3/rtcore.h>

#include <cstring>

namespace pse::surface {
namespace {

void set(RTCRay16& rays, int k, const Ray& ray) {
  rays.org_x[k] = static_cast<float>(ray.origin.x);
  rays.org_y[k] = static_cast<float>(ray.origin.y);
  rays.org_z[k] = static_cast<float>(ray.origin.z);
  rays.dir_x[k] = static_cast<float>(ray.direction.x);
  rays.dir_y[k] = static_cast<float>(ray.direction.y);
  rays.dir_z[k] = static_cast<float>(ray.direction.z);
  rays.tnear[k] = 0, rays.tfar[k] = 1e30f, rays.time[k] = 0;
  rays.mask[k] = 0xffffffff, rays.flags[k] = 0;
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

std::vector<std::uint32_t> EmbreeLoop::triangles(const Lens& lens, int size, bool packets) const {
  std::vector<std::uint32_t> found(static_cast<std::size_t>(size) * size);
  const auto scene = static_cast<RTCScene>(scene_);
  alignas(64) int all[16];
  std::fill_n(all, 16, -1);
  for (int y = 0; y < size; y += 4)
    for (int x = 0; x < size; x += 4) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      alignas(64) RTCRayHit16 query;
      for (int k = 0; k < 16; ++k) {
        set(query.ray, k, lens.ray(x + k % 4 + 0.5, y + k / 4 + 0.5));
        query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        query.hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
      }
      if (packets) {
        rtcIntersect16(all, scene, &context, &query);
      } else {
        for (unsigned k = 0; k < 16; ++k) {
          RTCRayHit single;
          single.ray = rtcGetRayFromRayN(reinterpret_cast<RTCRayN*>(&query.ray), 16, k);
          single.hit.geomID = single.hit.primID = RTC_INVALID_GEOMETRY_ID;
          single.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
          rtcIntersect1(scene, &context, &single);
          query.hit.primID[k] = single.hit.primID;
        }
      }
      for (int k = 0; k < 16; ++k)
        found[static_cast<std::size_t>(y + k / 4) * size + x + k % 4] = query.hit.primID[k];
    }
  return found;
}

}  // namespace pse::surface
