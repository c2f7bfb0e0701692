// From a kernel's lanes to rays and back.
#include "surface/trace_call.h"

namespace pse::surface {
namespace {

Vec3 vector_at(const float* const* arguments, std::size_t first, std::int64_t i) {
  return {arguments[first][i], arguments[first + 1][i], arguments[first + 2][i]};
}

void write_hits(const Scene& scene, std::span<const Ray> rays, std::span<const Hit> hits,
                float* const* results) {
  std::vector<Ray> seen_rays;
  std::vector<Hit> seen;
  for (std::size_t i = 0; i < hits.size(); ++i)
    if (hits[i].found()) seen_rays.push_back(rays[i]), seen.push_back(hits[i]);
  std::vector<Spot> spots(seen.size());
  scene.describe(seen_rays, seen, true, spots);
  std::size_t next = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Spot s = hits[i].found() ? spots[next++] : Spot{};
    const double distance =
        hits[i].found() ? hits[i].t() * length(rays[i].direction) : hits[i].t();
    const std::array<double, hit_components> values = {
        distance,   s.place.x,  s.place.y,  s.place.z, s.point.x, s.point.y, s.point.z,
        s.normal.x, s.normal.y, s.normal.z, s.u,       s.v,       hits[i].object + 1.0,
        s.back ? 1.0 : 0};
    for (std::size_t c = 0; c < values.size(); ++c) results[c][i] = static_cast<float>(values[c]);
  }
}

}  // namespace

std::optional<TraceCall::What> TraceCall::of(std::string_view external) {
  if (external == "trace") return What::trace;
  if (external == "radiance") return What::radiance;
  if (external == "visible") return What::visible;
  return {};
}

void TraceCall::run(void* self, std::int64_t count, const float* const* arguments,
                    float* const* results) {
  const auto& call = *static_cast<const TraceCall*>(self);
  const Scene* scene = call.shader->scene();
  const auto n = static_cast<std::size_t>(count);
  std::vector<Ray> rays(n);
  for (std::int64_t i = 0; i < count; ++i) {
    Ray& ray = rays[static_cast<std::size_t>(i)];
    ray.origin = vector_at(arguments, 0, i);
    ray.direction = vector_at(arguments, 3, i);
    ray.begin = scene->tiny();
    if (call.what == What::visible) {
      // From a to b, short of both ends.
      ray.direction = ray.direction - ray.origin;
      const double way = length(ray.direction);
      ray.begin = scene->tiny() / way, ray.end = 1 - ray.begin;
    } else {
      ray.begin = scene->tiny() / length(ray.direction);
    }
  }
  if (call.what == What::radiance) return call.shader->radiance(rays, 0, results);
  std::vector<Hit> hits(n);
  scene->trace(rays, hits);
  if (call.what == What::trace) return write_hits(*scene, rays, hits, results);
  for (std::size_t i = 0; i < n; ++i) results[0][i] = hits[i].found() ? 0.0f : 1.0f;
}

}  // namespace pse::surface
