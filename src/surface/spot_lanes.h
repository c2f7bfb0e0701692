// Where a ray has met an object and how it faces there, and how that place moves from pixel to
// pixel: of one ray or of several side by side, the same operations in the same order. Compiled for
// more than one kind of processor, so that nothing here may be kept out of line.
#pragma once

#include "surface/lanes.h"
#include "surface/shape.h"

namespace pse::surface {

// Vectors whose components are numbers or lanes.
template <class V>
struct Vec {
  V x, y, z;
};
template <class V>
[[gnu::always_inline]] inline Vec<V> operator+(const Vec<V>& a, const Vec<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
[[gnu::always_inline]] inline Vec<V> operator-(const Vec<V>& a, const Vec<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V>
[[gnu::always_inline]] inline Vec<V> operator-(const Vec<V>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class V>
[[gnu::always_inline]] inline Vec<V> operator*(V s, const Vec<V>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class V>
[[gnu::always_inline]] inline V dot(const Vec<V>& a, const Vec<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class V>
[[gnu::always_inline]] inline Vec<V> cross(const Vec<V>& a, const Vec<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
[[gnu::always_inline]] inline Vec<V> choose(AnswersOf<V> which, const Vec<V>& yes,
                                            const Vec<V>& no) {
  return {choose(which, yes.x, no.x), choose(which, yes.y, no.y), choose(which, yes.z, no.z)};
}
// Zero stays zero.
template <class V>
[[gnu::always_inline]] inline Vec<V> normalized(const Vec<V>& a) {
  const V size = square_root(dot(a, a));
  return choose(size > 0, 1 / size, V{} + 1) * a;
}
// The same vector in every lane.
template <class V>
[[gnu::always_inline]] inline Vec<V> spread(const Vec3& a) {
  return {V{} + a.x, V{} + a.y, V{} + a.z};
}

// From the world to an object's own frame.
template <class V>
[[gnu::always_inline]] inline Vec<V> vector_in(const Frame& frame, const Vec<V>& v) {
  if (frame.identity) return v;
  const Affine& m = frame.to_object;
  return {v.x * m.x.x + v.y * m.y.x + v.z * m.z.x, v.x * m.x.y + v.y * m.y.y + v.z * m.z.y,
          v.x * m.x.z + v.y * m.y.z + v.z * m.z.z};
}
template <class V>
[[gnu::always_inline]] inline Vec<V> point_in(const Frame& frame, const Vec<V>& p) {
  if (frame.identity) return p;
  return vector_in(frame, p) + spread<V>(frame.to_object.offset);
}
// From there to the world, made of length 1.
template <class V>
[[gnu::always_inline]] inline Vec<V> normal_from(const Frame& frame, const Vec<V>& v) {
  if (frame.identity) return normalized(v);
  const Affine& m = frame.to_object;
  return normalized(Vec<V>{dot(spread<V>(m.x), v), dot(spread<V>(m.y), v), dot(spread<V>(m.z), v)});
}

// What is to be seen where a ray has met an object (Spot in scene.h, less u and v).
template <class V>
struct Seen {
  Vec<V> place, point, normal, flat;
  AnswersOf<V> back;
};

// `normal` and `flat` are the shape's own (ShapePoint).
template <class V>
[[gnu::always_inline]] inline Seen<V> see(const Frame& frame, const Vec<V>& origin,
                                          const Vec<V>& direction, V t, const Vec<V>& normal,
                                          const Vec<V>& flat) {
  Seen<V> seen;
  seen.place = origin + t * direction;
  seen.point = point_in(frame, seen.place);
  seen.normal = seen.flat = normal_from(frame, normal);
  const AnswersOf<V> differs = (flat.x != normal.x) | (flat.y != normal.y) | (flat.z != normal.z);
  if (any(differs)) seen.flat = choose(differs, normal_from(frame, flat), seen.flat);
  seen.back = dot(seen.flat, direction) > 0;
  if (!any(seen.back)) return seen;
  seen.normal = choose(seen.back, -seen.normal, seen.normal);
  seen.flat = choose(seen.back, -seen.flat, seen.flat);
  return seen;
}

// How the place on the surface moves when the place in the picture moves by one pixel along `axis`:
// the step across the ray, carried along the ray onto the tangent plane.
template <class V>
[[gnu::always_inline]] inline Vec<V> shift(const Vec<V>& axis, const Vec<V>& direction,
                                           const Vec<V>& flat, V width) {
  const Vec<V> step = width * normalized(axis - dot(axis, direction) * direction);
  const V slope = dot(flat, direction), facing = choose(slope < -0.001, slope, V{} - 0.001);
  return step - (dot(flat, step) / facing) * direction;
}

}  // namespace pse::surface
