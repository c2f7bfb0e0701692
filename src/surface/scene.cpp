// Rays against the objects, one object after the other: each is given the rays that enter its box
// before what they have met so far.
#include "surface/scene.h"

namespace pse::surface {

Vec3 light_value(const Light& light, LightPart part, const Vec3& place) {
  constexpr double far = 1e4;  // where a light without a place is said to be
  switch (part) {
    case LightPart::direction:
      return normalized(light.is_lamp ? light.position - place : light.position);
    case LightPart::color: {
      if (!light.is_lamp) return light.color;
      const Vec3 way = light.position - place;
      return (1 / std::max(dot(way, way), 1e-12)) * light.color;
    }
    case LightPart::position:
      return light.is_lamp ? light.position : place + far * normalized(light.position);
    case LightPart::radius:
      return {light.radius * (light.is_lamp ? 1 : far), 0, 0};
  }
  return {};
}

Scene::Scene(std::vector<Object> objects, std::vector<Light> lights) : lights_(std::move(lights)) {
  for (Object& object : objects) {
    Placed placed;
    const Box own = object.shape->bounds();
    placed.to_object = object.to_world.inverse();
    const Affine& m = object.to_world;
    placed.identity = m.x == Vec3{1, 0, 0} && m.y == Vec3{0, 1, 0} && m.z == Vec3{0, 0, 1} &&
                      m.offset == Vec3{};
    constexpr double inf = Box::inf;
    placed.bounds = own.bounded() ? m.box(own) : Box{{-inf, -inf, -inf}, {inf, inf, inf}};
    if (placed.identity) placed.bounds = own;
    if (placed.bounds.bounded()) bounds_.add(placed.bounds);
    placed.object = std::move(object);
    placed_.push_back(std::move(placed));
  }
  if (bounds_.bounded()) tiny_ = std::max(1e-4 * bounds_.radius(), 1e-12);
}

namespace {

bool is_usable(const Ray& ray) {
  const double size = dot(ray.direction, ray.direction);
  return size > 0 && std::isfinite(size) && is_finite(ray.origin);
}

}  // namespace

void Scene::trace(std::span<const Ray> rays, std::span<Hit> hits) const {
  thread_local std::vector<ShapeHit> best;
  best.assign(rays.size(), {});
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i].object = -1;
  // One object that stands where it was made takes the rays as they are.
  const bool direct = placed_.size() == 1 && placed_.front().identity &&
                      std::all_of(rays.begin(), rays.end(), is_usable);
  if (direct) {
    placed_.front().object.shape->intersect(rays, best);
    for (std::size_t i = 0; i < rays.size(); ++i)
      if (best[i].found()) hits[i].object = 0;
  } else {
    trace_each(rays, hits, best);
  }
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (hits[i].found())
      finish(rays[i], placed_[static_cast<std::size_t>(hits[i].object)], best[i], hits[i]);
    else
      hits[i] = {};
}

void Scene::trace_each(std::span<const Ray> rays, std::span<Hit> hits,
                       std::span<ShapeHit> best) const {
  std::vector<std::uint32_t> which;
  std::vector<Ray> local;
  std::vector<ShapeHit> found;
  which.reserve(rays.size()), local.reserve(rays.size());
  for (std::size_t k = 0; k < placed_.size(); ++k) {
    const Placed& placed = placed_[k];
    which.clear(), local.clear();
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Ray& ray = rays[i];
      if (!is_usable(ray)) continue;
      Ray clipped = ray;
      clipped.end = std::min(ray.end, best[i].t);
      const Span1 span = clip(clipped, placed.bounds);
      if (!(span.begin <= span.end)) continue;
      which.push_back(static_cast<std::uint32_t>(i));
      if (!placed.identity)
        clipped.origin = placed.to_object.point(ray.origin),
        clipped.direction = placed.to_object.vector(ray.direction);
      local.push_back(clipped);
    }
    if (local.empty()) continue;
    found.assign(local.size(), {});
    placed.object.shape->intersect(local, found);
    for (std::size_t j = 0; j < which.size(); ++j)
      if (found[j].t < best[which[j]].t)
        best[which[j]] = found[j], hits[which[j]].object = static_cast<int>(k);
  }
}

void Scene::finish(const Ray& ray, const Placed& placed, const ShapeHit& found, Hit& hit) const {
  hit.t = found.t;
  hit.place = ray.origin + found.t * ray.direction;
  hit.point = placed.identity ? hit.place : placed.to_object.point(hit.place);
  hit.u = found.u, hit.v = found.v;
  hit.normal = normalized(placed.identity ? found.normal : placed.to_object.transposed(found.normal));
  hit.flat = normalized(placed.identity ? found.flat : placed.to_object.transposed(found.flat));
  hit.back = dot(hit.flat, ray.direction) > 0;
  if (hit.back) hit.normal = -hit.normal, hit.flat = -hit.flat;
}

std::vector<std::string> Scene::around(const Vec3& point) const {
  std::vector<std::string> names;
  for (const Placed& placed : placed_) {
    if (!placed.bounds.bounded()) continue;
    const Box& b = placed.bounds;
    if (least(point, b.lower) != b.lower || greatest(point, b.upper) != b.upper) continue;
    const Ray ray{placed.to_object.point(point), placed.to_object.vector({0.31, 0.87, 0.38}), 0};
    ShapeHit hit;
    placed.object.shape->intersect(std::span(&ray, 1), std::span(&hit, 1));
    if (hit.found() && dot(hit.flat, ray.direction) > 0) names.push_back(placed.object.name);
  }
  return names;
}

}  // namespace pse::surface
