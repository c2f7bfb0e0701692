// The shapes with a formula, as functions that make them. All are centred on the origin with Y up.
// Coordinates u and v run from 0 to 1: round Y counter-clockwise seen from above, and upward.
#pragma once

#include <functional>

#include "surface/shape.h"

namespace pse::surface {

std::shared_ptr<const Shape> make_sphere(double radius);
// A cuboid of these edge lengths.
std::shared_ptr<const Shape> make_box(const Vec3& size);
// y = 0, `size` wide and deep or without end (infinity). u and v are x and z in metres.
std::shared_ptr<const Shape> make_plane(double size);
// A ring round Y: `major` from the centre to the middle of the tube, whose radius is `minor`.
std::shared_ptr<const Shape> make_torus(double major, double minor);
// (|x/a|^(2/e) + |z/c|^(2/e))^(e/n) + |y/b|^(2/n) = 1 with half-axes a b c: `north` n shapes the
// outline, `east` e the cross-section. 1 1 is an ellipsoid, near 0 a box, 2 2 an octahedron.
std::shared_ptr<const Shape> make_superquadric(const Vec3& half_axes, double north, double east);

struct ProfilePoint {
  double radius = 0, height = 0;
};
// A smooth curve through the points, turned about Y. An end on the axis is round there; `caps`
// closes the other ends with discs. At least two points.
std::shared_ptr<const Shape> make_revolution(const std::vector<ProfilePoint>& profile, bool caps);
// The profile of the vase in the paper's picture: foot, belly, neck, lip and the inside.
const std::vector<ProfilePoint>& vase_profile();

// f at count points; called from several threads at once, a value depends on its point alone.
using Field = std::function<void(std::int64_t count, const float* x, const float* y,
                                 const float* z, float* values)>;
// Where f = level inside `box`; f is greater inside the body. Walls thinner than `step` may be
// missed.
std::shared_ptr<const Shape> make_isosurface(Field f, double level, const Box& box, double step);

}  // namespace pse::surface
