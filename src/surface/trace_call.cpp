// From a kernel's lanes to rays and back.
#include "surface/trace_call.h"

namespace pse::surface {
namespace {

Vec3 vector_at(const float* const* arguments, std::size_t first, std::int64_t i) {
  return {arguments[first][i], arguments[first + 1][i], arguments[first + 2][i]};
}

void write_hits(std::span<const Ray> rays, std::span<const Hit> hits, float* const* results) {
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Hit& h = hits[i];
    const bool seen = h.found();
    const Vec3 zero;
    const Vec3 &place = seen ? h.place : zero, &point = seen ? h.point : zero,
               &normal = seen ? h.normal : zero;
    const double distance = seen ? h.t * length(rays[i].direction)
                                 : std::numeric_limits<double>::infinity();
    const std::array<double, hit_components> values = {
        distance,  place.x,  place.y,         place.z, point.x, point.y, point.z,
        normal.x,  normal.y, normal.z,        h.u,     h.v,     seen ? h.object + 1.0 : 0,
        h.back ? 1.0 : 0};
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
  if (call.what == What::trace) return write_hits(rays, hits, results);
  for (std::size_t i = 0; i < n; ++i) results[0][i] = hits[i].found() ? 0.0f : 1.0f;
}

}  // namespace pse::surface
