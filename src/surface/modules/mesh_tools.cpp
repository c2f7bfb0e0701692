// The module around Assimp and Embree: the only home of both, with read_mesh.cpp. Loaded by mesh.cpp,
// on demand.
#include <embree3/rtcore.h>

#include <cstring>
#include <memory>

#include "surface/mesh.h"
#include "surface/modules/read_mesh.h"

namespace pse::surface {
namespace {

class Tree : public TriangleTree {
 public:
  Tree(RTCDevice device, const Mesh& mesh) : device_(device), scene_(rtcNewScene(device)) {
    rtcRetainDevice(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Copies, since Embree reads 16 bytes at each vertex.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                             RTC_FORMAT_FLOAT3, 12, mesh.vertex_count());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                              RTC_FORMAT_UINT3, 12, mesh.triangle_count());
    if (vertices != nullptr && triangles != nullptr) {
      std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(float));
      std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof(std::uint32_t));
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene_, geometry);
      rtcCommitScene(scene_);
    }
    rtcReleaseGeometry(geometry);
  }
  ~Tree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  // One ray at a time: which triangle is found then depends on the ray alone.
  void first(std::span<const Ray> rays, std::span<TriangleHit> hits) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray& ray = rays[i];
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      RTCRayHit query;
      query.ray.org_x = static_cast<float>(ray.origin.x);
      query.ray.org_y = static_cast<float>(ray.origin.y);
      query.ray.org_z = static_cast<float>(ray.origin.z);
      query.ray.dir_x = static_cast<float>(ray.direction.x);
      query.ray.dir_y = static_cast<float>(ray.direction.y);
      query.ray.dir_z = static_cast<float>(ray.direction.z);
      query.ray.tnear = static_cast<float>(ray.begin);
      query.ray.tfar = static_cast<float>(ray.end);
      query.ray.time = 0;
      query.ray.mask = 0xffffffff;
      query.ray.id = 0;
      query.ray.flags = 0;
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_, &context, &query);
      if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) hits[i].triangle = query.hit.primID;
    }
  }

  // Packets of 16.
  void first_together(std::span<const Ray> rays, std::span<TriangleHit> hits) const override {
    constexpr std::size_t lanes = 16;
    for (std::size_t begin = 0; begin < rays.size(); begin += lanes) {
      const std::size_t count = std::min(lanes, rays.size() - begin);
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      alignas(64) int valid[lanes];
      alignas(64) RTCRayHit16 query;
      for (std::size_t k = 0; k < lanes; ++k) {
        const Ray& ray = rays[begin + std::min(k, count - 1)];
        valid[k] = k < count ? -1 : 0;
        query.ray.org_x[k] = static_cast<float>(ray.origin.x);
        query.ray.org_y[k] = static_cast<float>(ray.origin.y);
        query.ray.org_z[k] = static_cast<float>(ray.origin.z);
        query.ray.dir_x[k] = static_cast<float>(ray.direction.x);
        query.ray.dir_y[k] = static_cast<float>(ray.direction.y);
        query.ray.dir_z[k] = static_cast<float>(ray.direction.z);
        query.ray.tnear[k] = static_cast<float>(ray.begin);
        query.ray.tfar[k] = static_cast<float>(ray.end);
        query.ray.time[k] = 0;
        query.ray.mask[k] = 0xffffffff;
        query.ray.id[k] = 0;
        query.ray.flags[k] = 0;
        query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect16(valid, scene_, &context, &query);
      for (std::size_t k = 0; k < count; ++k)
        if (query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID)
          hits[begin + k].triangle = query.hit.primID[k];
    }
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

class Tools : public MeshTools {
 public:
  bool read(const std::string& file, Mesh& mesh, std::string& error) const override {
    return read_in_child(file, mesh, error);
  }

  TriangleTree* build(const Mesh& mesh, std::string& error) const override {
    static const RTCDevice device = rtcNewDevice(nullptr);
    if (device == nullptr) {
      error = "Embree cannot be started";
      return nullptr;
    }
    auto tree = std::make_unique<Tree>(device, mesh);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) {
      error = "there is not enough memory for the mesh";
      return nullptr;
    }
    return tree.release();
  }
};

}  // namespace
}  // namespace pse::surface

extern "C" __attribute__((visibility("default"))) pse::surface::MeshTools* pse_mesh_tools() {
  static pse::surface::Tools tools;
  return &tools;
}
