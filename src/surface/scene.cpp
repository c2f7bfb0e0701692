// Rays against the objects: each object is given the rays that enter its box before what they have
// met so far.
#include "surface/scene.h"

#include "surface/spot_lanes.h"

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
    placed.frame.to_object = object.to_world.inverse();
    const Affine& m = object.to_world;
    placed.frame.identity = m.x == Vec3{1, 0, 0} && m.y == Vec3{0, 1, 0} &&
                            m.z == Vec3{0, 0, 1} && m.offset == Vec3{};
    constexpr double inf = Box::inf;
    placed.bounds = own.bounded() ? m.box(own) : Box{{-inf, -inf, -inf}, {inf, inf, inf}};
    if (placed.frame.identity) placed.bounds = own;
    if (placed.bounds.bounded()) bounds_.add(placed.bounds);
    placed.object = std::move(object);
    const auto index = static_cast<std::uint32_t>(placed_.size());
    (placed.bounds.bounded() ? bounded_ : endless_).push_back(index);
    placed_.push_back(std::move(placed));
  }
  std::vector<Box> boxes;
  for (const std::uint32_t k : bounded_) boxes.push_back(placed_[k].bounds);
  tree_ = BoxTree(boxes);
  if (bounds_.bounded()) tiny_ = std::max(1e-4 * bounds_.radius(), 1e-12);
}

namespace {

bool is_usable(const Ray& ray) {
  const double size = dot(ray.direction, ray.direction);
  return size > 0 && std::isfinite(size) && is_finite(ray.origin);
}

// Without a branch for each: 0 times what is not finite is not 0.
bool all_usable(std::span<const Ray> rays) {
  bool all = true;
  for (const Ray& ray : rays) {
    const double size = dot(ray.direction, ray.direction);
    const Vec3& o = ray.origin;
    all &= (size > 0) & (0 * size + 0 * o.x + 0 * o.y + 0 * o.z == 0);
  }
  return all;
}

}  // namespace

Ray Scene::local(const Placed& placed, const Ray& ray) {
  const auto& [to_object, identity] = placed.frame;
  if (identity) return ray;
  return {to_object.point(ray.origin), to_object.vector(ray.direction), ray.begin, ray.end};
}

void Scene::trace(std::span<const Ray> rays, std::span<Hit> hits) const {
  // One object that stands where it was made takes the rays as they are.
  const bool direct = placed_.size() == 1 && placed_.front().frame.identity && all_usable(rays);
  if (!direct) return trace_many(rays, hits);
  thread_local std::vector<Meeting> meetings;
  meetings.assign(rays.size(), {});
  placed_.front().object.shape->find(rays, meetings);
  for (std::size_t i = 0; i < rays.size(); ++i)
    hits[i] = {meetings[i], meetings[i].found() ? 0 : -1};
}

// Each object is given the rays as they came, not cut off at what they have met so far, so that a
// meeting's last bits do not depend on the other objects.
void Scene::trace_many(std::span<const Ray> rays, std::span<Hit> hits) const {
  std::vector<std::uint32_t> usable;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits[i] = {};
    if (is_usable(rays[i])) usable.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<double> nearest(rays.size(), Box::inf);
  std::vector<Ray> own;
  std::vector<Meeting> found;
  const auto try_object = [&](std::uint32_t k, std::span<const std::uint32_t> which) {
    own.clear();
    for (const std::uint32_t i : which) own.push_back(local(placed_[k], rays[i]));
    found.assign(which.size(), {});
    placed_[k].object.shape->find(own, found);
    for (std::size_t j = 0; j < which.size(); ++j) {
      const std::uint32_t i = which[j];
      const bool first = found[j].t < nearest[i] ||
                         (found[j].found() && found[j].t == nearest[i] &&
                          static_cast<int>(k) < hits[i].object);
      if (first) nearest[i] = found[j].t, hits[i] = {found[j], static_cast<int>(k)};
    }
  };
  for (const std::uint32_t k : endless_) try_object(k, usable);
  tree_.visit(rays, std::move(usable), nearest,
              [&](std::uint32_t box, std::span<const std::uint32_t> which) {
                try_object(bounded_[box], which);
              });
}

void Scene::describe(std::span<const Ray> rays, std::span<const Hit> hits, bool with_uv,
                     std::span<Spot> spots) const {
  thread_local std::vector<ShapePoint> points;
  points.resize(hits.size());
  // Runs of hits on the same object.
  for (std::size_t begin = 0, end = 0; begin < hits.size(); begin = end) {
    const int object = hits[begin].object;
    for (end = begin + 1; end < hits.size() && hits[end].object == object;) ++end;
    const auto run = [&](const auto& all) { return all.subspan(begin, end - begin); };
    describe_own(run(rays), run(hits), with_uv, run(std::span(points)));
    for (std::size_t i = begin; i < end; ++i)
      place(placed_[static_cast<std::size_t>(object)].frame, rays[i], hits[i].t(), points[i],
            spots[i]);
  }
}

void Scene::describe_own(std::span<const Ray> rays, std::span<const Hit> hits, bool with_uv,
                         std::span<ShapePoint> points) const {
  thread_local std::vector<Ray> own;
  thread_local std::vector<Meeting> meetings;
  const Placed& placed = placed_[static_cast<std::size_t>(hits.front().object)];
  own.clear(), meetings.clear();
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!placed.frame.identity) own.push_back(local(placed, rays[i]));
    meetings.push_back(hits[i].meeting);
  }
  placed.object.shape->describe(placed.frame.identity ? rays : own, meetings, with_uv, points);
}

void Scene::place(const Frame& frame, const Ray& ray, double t, const ShapePoint& shown,
                  Spot& spot) {
  const auto in = [](const Vec3& v) { return Vec<double>{v.x, v.y, v.z}; };
  const auto out = [](const Vec<double>& v) { return Vec3{v.x, v.y, v.z}; };
  const Seen<double> seen =
      see(frame, in(ray.origin), in(ray.direction), t, in(shown.normal), in(shown.flat));
  spot = {out(seen.place), out(seen.point), out(seen.normal), out(seen.flat),
          shown.u,         shown.v,         seen.back};
}

std::vector<std::string> Scene::around(const Vec3& point) const {
  std::vector<std::string> names;
  for (const Placed& placed : placed_) {
    if (!placed.bounds.bounded()) continue;
    const Box& b = placed.bounds;
    if (least(point, b.lower) != b.lower || greatest(point, b.upper) != b.upper) continue;
    const Ray ray = local(placed, {point, {0.31, 0.87, 0.38}});
    Meeting meeting;
    placed.object.shape->find(std::span(&ray, 1), std::span(&meeting, 1));
    if (!meeting.found()) continue;
    ShapePoint seen;
    placed.object.shape->describe({&ray, 1}, {&meeting, 1}, false, {&seen, 1});
    if (dot(seen.flat, ray.direction) > 0) names.push_back(placed.object.name);
  }
  return names;
}

}  // namespace pse::surface
