// Points, directions and affine maps in double: the arithmetic of rays. Right-handed, metres.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace pse::surface {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  double operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
inline Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
inline Vec3 operator*(const Vec3& a, double s) { return s * a; }
inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }
// Zero stays zero.
inline Vec3 normalized(const Vec3& a) {
  const double size = length(a);
  return size > 0 ? (1 / size) * a : a;
}
inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
inline Vec3 least(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
inline Vec3 greatest(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

// An axis-aligned box; empty until something is added.
struct Box {
  static constexpr double inf = std::numeric_limits<double>::infinity();
  Vec3 lower{inf, inf, inf}, upper{-inf, -inf, -inf};

  bool empty() const { return !(lower.x <= upper.x); }
  bool bounded() const { return !empty() && is_finite(lower) && is_finite(upper); }
  void add(const Vec3& p) { lower = least(lower, p), upper = greatest(upper, p); }
  void add(const Box& box) { lower = least(lower, box.lower), upper = greatest(upper, box.upper); }
  std::vector<Vec3> corners() const {
    std::vector<Vec3> all;
    for (int k = 0; k < 8; ++k)
      all.push_back({(k & 1) != 0 ? upper.x : lower.x, (k & 2) != 0 ? upper.y : lower.y,
                     (k & 4) != 0 ? upper.z : lower.z});
    return all;
  }
  Vec3 centre() const { return 0.5 * (lower + upper); }
  double radius() const { return 0.5 * length(upper - lower); }  // of the sphere around it
};

// The part [t0, t1] of a ray that lies in a box or sphere.
struct Span1 {
  double begin = 0, end = 0;
};

// p -> columns * p + offset.
struct Affine {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  // where the axes go
  Vec3 offset;

  Vec3 vector(const Vec3& v) const { return v.x * x + v.y * y + v.z * z; }
  Vec3 point(const Vec3& p) const { return vector(p) + offset; }
  double determinant() const { return dot(x, cross(y, z)); }
  // a after b.
  friend Affine operator*(const Affine& a, const Affine& b) {
    return {a.vector(b.x), a.vector(b.y), a.vector(b.z), a.point(b.offset)};
  }
  // Only where determinant() is not 0.
  Affine inverse() const {
    const double s = 1 / determinant();
    const Vec3 r0 = s * cross(y, z), r1 = s * cross(z, x), r2 = s * cross(x, y);
    Affine out{{r0.x, r1.x, r2.x}, {r0.y, r1.y, r2.y}, {r0.z, r1.z, r2.z}, {}};
    out.offset = -out.vector(offset);
    return out;
  }
  // The transposed linear part applied to v: with the inverse map, how normals turn.
  Vec3 transposed(const Vec3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Box box(const Box& b) const {
    Box out;
    for (const Vec3& corner : b.corners()) out.add(point(corner));
    return out;
  }
};

// From the world to where an object was made.
struct Frame {
  Affine to_object;
  bool identity = false;  // it stands where it was made
};

}  // namespace pse::surface
