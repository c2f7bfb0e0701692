// The module around Assimp and Embree: the only home of both, with read_mesh.cpp. Loaded by
// mesh.cpp, on demand.
#include <embree3/rtcore.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>

#include "surface/mesh.h"
#include "surface/modules/read_mesh.h"

namespace pse::surface {
namespace {

// What Embree is told with rays, and what it keeps for each of them: the nearest triangle so far. A
// ray's number, below `lanes`, is its `id`.
constexpr std::size_t most_lanes = 16;
struct Query {
  RTCIntersectContext context;  // first: Embree hands its address on
  std::size_t lanes;
  float t[most_lanes];
  std::uint32_t triangle[most_lanes];

  Query(std::size_t lane_count, bool coherent) : lanes(lane_count) {
    rtcInitIntersectContext(&context);
    if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    std::fill_n(t, most_lanes, -1.0f);
  }
};

// Called for each triangle that is no farther than the nearest so far. Of two at the same distance
// Embree takes the later, and which that is depends on the rays beside; here it is the one with
// the lower number. Distances depend on ray and triangle alone: every kernel computes them alike.
void keep_lower_number(const RTCFilterFunctionNArguments* arguments) {
  Query& query = *reinterpret_cast<Query*>(arguments->context);
  const unsigned count = arguments->N;
  const float* t = &RTCRayN_tfar(arguments->ray, count, 0);
  const std::uint32_t* triangle = &RTCHitN_primID(arguments->hit, count, 0);
  const auto all = [&](const auto& id_of) {
    for (unsigned k = 0; k < count; ++k) {
      float& best_t = query.t[id_of(k)];
      std::uint32_t& best = query.triangle[id_of(k)];
      const bool loses = (t[k] == best_t) & (triangle[k] > best);
      const int valid = loses ? 0 : arguments->valid[k];
      best_t = valid != 0 ? t[k] : best_t;
      best = valid != 0 ? triangle[k] : best;
      arguments->valid[k] = valid;
    }
  };
  if (count == query.lanes) return all([](unsigned k) { return k; });
  // A processor with narrower vectors is given a packet's parts.
  all([&](unsigned k) { return RTCRayN_id(arguments->ray, count, k) % most_lanes; });
}

// Embree ends the process where a ray's numbers are greater.
constexpr double reach = 1.8e18;
double largest(const Vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

// Whether all of them certainly are not: their sum is not. Two numbers at a time.
bool are_in_reach(std::span<const Ray> rays) {
  using Two [[gnu::vector_size(16)]] = double;
  using Bits [[gnu::vector_size(16)]] = std::uint64_t;
  constexpr Bits without_sign = {~std::uint64_t{0} >> 1, ~std::uint64_t{0} >> 1};
  static_assert(offsetof(Ray, direction) == 3 * sizeof(double));
  Two sums[3] = {};
  for (const Ray& ray : rays) {
    Bits numbers[3];
    std::memcpy(numbers, &ray, sizeof numbers);
    for (int k = 0; k < 3; ++k) sums[k] += std::bit_cast<Two>(numbers[k] & without_sign);
  }
  const Two sum = sums[0] + sums[1] + sums[2];
  return sum[0] + sum[1] <= reach;
}

// Packets of 8 rays and of 16.
struct Eight {
  using Rays = RTCRayHit8;
  static constexpr std::size_t lanes = 8;
  static constexpr auto intersect = rtcIntersect8;
};
struct Sixteen {
  using Rays = RTCRayHit16;
  static constexpr std::size_t lanes = 16;
  static constexpr auto intersect = rtcIntersect16;
};

class Tree : public TriangleTree {
 public:
  Tree(RTCDevice device, const Mesh& mesh) : device_(device), scene_(rtcNewScene(device)) {
    rtcRetainDevice(device_);
    // Large meshes in less memory: the tree then looks corners up instead of keeping them.
    const bool is_large = mesh.triangle_count() > 4'000'000;
    rtcSetSceneFlags(
        scene_, is_large ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    // Copies, since Embree reads 16 bytes at each vertex.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             12, mesh.vertex_count());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              12, mesh.triangle_count());
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
    // Wide packets pay where there are instructions as wide; a few rays left over go in a narrow
    // one.
    const bool coherent = rays.size() > 32;
    std::size_t begin = 0;
    if (has_wide_)
      for (; rays.size() - begin > Eight::lanes; begin += Sixteen::lanes) {
        const std::size_t count = std::min(Sixteen::lanes, rays.size() - begin);
        first_of<Sixteen>(rays.subspan(begin, count), hits.subspan(begin, count), coherent);
        if (count < Sixteen::lanes) return;
      }
    for (; begin < rays.size(); begin += Eight::lanes) {
      const std::size_t count = std::min(Eight::lanes, rays.size() - begin);
      first_of<Eight>(rays.subspan(begin, count), hits.subspan(begin, count), coherent);
    }
  }

 private:
  void first_alone(Ray ray, TriangleHit& hit) const {
    // From beyond Embree's reach nothing is met; of a direction only the direction counts.
    if (!(largest(ray.origin) <= reach)) return;
    if (const double size = largest(ray.direction); size > reach) {
      const double scale = std::exp2(-std::ilogb(size));
      ray = {ray.origin, scale * ray.direction, ray.begin / scale, ray.end / scale};
    }
    Query context(1, false);
    RTCRayHit query;
    query.ray = {static_cast<float>(ray.origin.x),
                 static_cast<float>(ray.origin.y),
                 static_cast<float>(ray.origin.z),
                 static_cast<float>(ray.begin),
                 static_cast<float>(ray.direction.x),
                 static_cast<float>(ray.direction.y),
                 static_cast<float>(ray.direction.z),
                 0,
                 static_cast<float>(ray.end),
                 0xffffffff,
                 0,
                 0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context.context, &query);
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) hit.triangle = query.hit.primID;
  }

  // Up to a packet.
  template <class Packet>
  void first_of(std::span<const Ray> rays, std::span<TriangleHit> hits, bool coherent) const {
    if (!are_in_reach(rays)) {
      for (std::size_t k = 0; k < rays.size(); ++k) first_alone(rays[k], hits[k]);
      return;
    }
    Query context(Packet::lanes, coherent);
    alignas(64) int valid[Packet::lanes];
    alignas(64) typename Packet::Rays query;
    const auto set = [&](std::size_t k, const Ray& ray) {
      query.ray.org_x[k] = static_cast<float>(ray.origin.x);
      query.ray.org_y[k] = static_cast<float>(ray.origin.y);
      query.ray.org_z[k] = static_cast<float>(ray.origin.z);
      query.ray.dir_x[k] = static_cast<float>(ray.direction.x);
      query.ray.dir_y[k] = static_cast<float>(ray.direction.y);
      query.ray.dir_z[k] = static_cast<float>(ray.direction.z);
      query.ray.tnear[k] = static_cast<float>(ray.begin);
      query.ray.tfar[k] = static_cast<float>(ray.end);
    };
    for (std::size_t k = 0; k < rays.size(); ++k) set(k, rays[k]);
    for (std::size_t k = rays.size(); k < Packet::lanes; ++k) set(k, rays.back());
    for (std::size_t k = 0; k < Packet::lanes; ++k) {
      valid[k] = k < rays.size() ? -1 : 0;
      query.ray.time[k] = 0;
      query.ray.mask[k] = 0xffffffff;
      query.ray.id[k] = static_cast<unsigned>(k);
      query.ray.flags[k] = 0;
      query.hit.geomID[k] = query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      query.hit.primID[k] = TriangleHit::no_triangle;
    }
    Packet::intersect(valid, scene_, &context.context, &query);
    for (std::size_t k = 0; k < rays.size(); ++k) hits[k].triangle = query.hit.primID[k];
  }

  RTCDevice device_;
  RTCScene scene_;
  bool has_wide_ = rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0;
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
