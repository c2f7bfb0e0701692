// The module around Assimp and Embree: the only home of both, with read_mesh.cpp. Loaded by mesh.cpp,
// on demand.
#include <embree3/rtcore.h>

#include <cstring>
#include <memory>

#include "surface/mesh.h"
#include "surface/modules/read_mesh.h"

namespace pse::surface {
namespace {

// What Embree is told with rays, and what it keeps for each of them: the nearest triangle so far. A
// ray's number, 0 to 7, is its `id`.
struct Query {
  static constexpr std::size_t lanes = 8;
  RTCIntersectContext context;  // first: Embree hands its address on
  float t[lanes];
  std::uint32_t triangle[lanes];

  explicit Query(bool coherent) {
    rtcInitIntersectContext(&context);
    if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    std::fill_n(t, lanes, -1.0f);
  }
};

// Called for each triangle that is no farther than the nearest so far. Of two at the same distance
// Embree takes the later, and which that is depends on the rays beside; here it is the one with
// the lower number. Distances depend on ray and triangle alone: every kernel computes them alike.
void keep_lower_number(const RTCFilterFunctionNArguments* arguments) {
  Query& query = *reinterpret_cast<Query*>(arguments->context);
  const unsigned count = arguments->N;
  for (unsigned k = 0; k < count; ++k) {
    if (arguments->valid[k] == 0) continue;
    const unsigned id = RTCRayN_id(arguments->ray, count, k) % Query::lanes;
    const float t = RTCRayN_tfar(arguments->ray, count, k);
    const std::uint32_t triangle = RTCHitN_primID(arguments->hit, count, k);
    if (t == query.t[id] && triangle > query.triangle[id])
      arguments->valid[k] = 0;
    else
      query.t[id] = t, query.triangle[id] = triangle;
  }
}

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
      rtcSetGeometryIntersectFilterFunction(geometry, keep_lower_number);
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

  void first(std::span<const Ray> rays, std::span<TriangleHit> hits) const override {
    if (rays.size() == 1) return first_alone(rays.front(), hits.front());
    for (std::size_t begin = 0; begin < rays.size(); begin += Query::lanes) {
      const std::size_t count = std::min(Query::lanes, rays.size() - begin);
      first_of(rays.subspan(begin, count), hits.subspan(begin, count), rays.size() > 32);
    }
  }

 private:
  void first_alone(const Ray& ray, TriangleHit& hit) const {
    Query context(false);
    RTCRayHit query;
    query.ray = {static_cast<float>(ray.origin.x), static_cast<float>(ray.origin.y),
                 static_cast<float>(ray.origin.z), static_cast<float>(ray.begin),
                 static_cast<float>(ray.direction.x), static_cast<float>(ray.direction.y),
                 static_cast<float>(ray.direction.z), 0, static_cast<float>(ray.end),
                 0xffffffff, 0, 0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context.context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) hit.triangle = query.hit.primID;
  }

  // A packet of up to eight.
  void first_of(std::span<const Ray> rays, std::span<TriangleHit> hits, bool coherent) const {
    Query context(coherent);
    alignas(32) int valid[Query::lanes];
    alignas(32) RTCRayHit8 query;
    for (std::size_t k = 0; k < Query::lanes; ++k) {
      const Ray& ray = rays[std::min(k, rays.size() - 1)];
      valid[k] = k < rays.size() ? -1 : 0;
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
      query.ray.id[k] = static_cast<unsigned>(k);
      query.ray.flags[k] = 0;
      query.hit.geomID[k] = query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, scene_, &context.context, &query);
    for (std::size_t k = 0; k < rays.size(); ++k)
      if (query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID) hits[k].triangle = query.hit.primID[k];
  }

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
