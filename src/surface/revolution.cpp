// The surface of revolution: a spline through profile points, turned about Y. Each piece of the
// spline makes a polynomial of degree 6 with a ray, in the spline's own parameter.
#include <algorithm>
#include <numbers>

#include "surface/revolution_profile.h"
#include "surface/roots.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace revolution {
namespace {


double slope(const double (&c)[4], double v) { return (3 * c[3] * v + 2 * c[2]) * v + c[1]; }

// Catmull-Rom from b to c.
void set_cubic(double (&cubic)[4], double a, double b, double c, double d) {
  cubic[0] = b, cubic[1] = (c - a) / 2;
  cubic[2] = a - 2.5 * b + 2 * c - d / 2, cubic[3] = (d - a) / 2 + 1.5 * (b - c);
}

// The least and greatest value on [0, 1].
Span1 range(const double (&c)[4]) {
  Span1 r{std::min(c[0], cubic(c, 1.0)), std::max(c[0], cubic(c, 1.0))};
  const double derivative[3] = {c[1], 2 * c[2], 3 * c[3]};
  const Roots roots = roots_in_unit(derivative, 2, false);
  for (std::size_t i = 0; i < roots.count; ++i) {
    const double here = cubic(c, roots.at[i]);
    r.begin = std::min(r.begin, here), r.end = std::max(r.end, here);
  }
  return r;
}

// Computes what follows from radius and height.
void finish(Piece& piece) {
  piece.radii = range(piece.radius), piece.heights = range(piece.height);
  const double derivative[3] = {piece.height[1], 2 * piece.height[2], 3 * piece.height[3]};
  double b[3];
  to_bernstein(derivative, 2, b);
  piece.rising = std::min({b[0], b[1], b[2]}) > 0 ? 1 : std::max({b[0], b[1], b[2]}) < 0 ? -1 : 0;
  for (std::size_t i = 0; i < 4; ++i) {
    piece.h.powers[i] = piece.height[i];
    for (std::size_t j = 0; j < 4; ++j) {
      piece.hh.powers[i + j] += piece.height[i] * piece.height[j];
      piece.rr.powers[i + j] += piece.radius[i] * piece.radius[j];
    }
  }
  for (Sextic* each : {&piece.h, &piece.hh, &piece.rr})
    to_bernstein(each->powers, 6, each->bernstein);
}

// Nearly level rays: the circle at the ray's height, then Newton's method in t and v.
void meet_level(const Course<double>& ray, const Piece& piece, double part,
                Nearest<double>& nearest) {
  const double k = ray.dd, off = ray.off, height = ray.oy + ray.middle * ray.dy;
  double w[4] = {piece.height[0] - height, piece.height[1], piece.height[2], piece.height[3]};
  const Roots roots = roots_in_unit(w, 3, false);
  for (std::size_t i = 0; i < roots.count; ++i) {
    const double r = cubic(piece.radius, roots.at[i]), rest = r * r - off;
    if (!(rest >= 0)) continue;
    for (const double side : {-1.0, 1.0}) {
      double t = side * std::sqrt(rest / k), v = roots.at[i];  // t from the middle
      for (int step = 0; step < 4; ++step) {
        const double radius = cubic(piece.radius, v);
        const double f = off + k * t * t - radius * radius, g = cubic(w, v) - t * ray.dy;
        const double ft = 2 * k * t, fv = -2 * radius * slope(piece.radius, v), gt = -ray.dy,
                     gv = slope(piece.height, v);
        const double determinant = ft * gv - fv * gt;
        if (determinant == 0) break;
        t -= (f * gv - fv * g) / determinant;
        v -= (ft * g - f * gt) / determinant;
      }
      // A ray at the height of a profile's point meets a piece at its very end.
      if (v >= -slack && v <= 1 + slack)
        ray.keep(true, ray.middle + t, std::clamp(v, 0.0, 1.0), part, nearest);
    }
  }
}

// What the processor can do.
FindFunction find_function() {
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx2") != 0) return find_for_avx2();
#endif
  return find_for_any();
}

}  // namespace

void meet_level_ray(const Profile& profile, const Ray& ray, Meeting& meeting) {
  const Vec3 &o = ray.origin, &d = ray.direction;
  Course<double> course{.ox = o.x, .oy = o.y, .oz = o.z, .dx = d.x, .dy = d.y, .dz = d.z,
                        .least = ray.begin, .most = ray.end};
  course.prepare(profile.bounds);
  if (!(course.begin <= course.end)) return;
  Nearest<double> nearest{ray.end, 0, 0};
  for (std::size_t i = 0; i < profile.piece_count; ++i) {
    const Piece& piece = profile.pieces[i];
    if (!may_come_before(course.earliest(piece), nearest)) continue;
    const auto part = static_cast<double>(i);
    piece.is_disc() ? meet_disc(course, piece, part, nearest)
                    : meet_level(course, piece, part, nearest);
  }
  if (nearest.t < ray.end)
    meeting = {nearest.t, nearest.v, 0, static_cast<std::uint32_t>(nearest.part)};
}

void meet_disc(const Course<double>& ray, const Piece& piece, double part,
               Nearest<double>& nearest) {
  const double t = (piece.heights.begin - ray.oy) / ray.dy;
  if (!std::isfinite(t)) return;
  const double r = std::hypot(ray.ox + t * ray.dx, ray.oz + t * ray.dz);
  const double v = (r - piece.radius[0]) / piece.radius[1];
  if (v >= 0 && v <= 1) ray.keep(true, t, v, part, nearest);
}

void meet_many(const Course<double>& ray, const Piece& piece, double part,
               const Sextic& polynomial, Nearest<double>& nearest) {
  // A ray from outside wants the root that it comes to first.
  const bool forward = (piece.rising > 0) == (ray.dy > 0);
  const Which which = piece.rising == 0 || !(ray.begin > ray.least) ? Which::all
                      : forward                                     ? Which::first
                                                                    : Which::last;
  const Roots roots = roots_in_unit(polynomial.powers, polynomial.bernstein, 6, which);
  for (std::size_t i = 0; i < roots.count; ++i) {
    const double v = roots.at[i];
    ray.keep(true, (cubic(piece.height, v) - ray.oy) * ray.per_height, v, part, nearest);
  }
}

namespace {

class Revolution : public Shape {
 public:
  Revolution(const std::vector<ProfilePoint>& profile, bool caps, FindFunction function)
      : find_(function) {
    // Ends on the axis go on as their own mirror image, so that they are round.
    const auto beyond = [](const ProfilePoint& end, const ProfilePoint& next) {
      if (end.radius < 1e-9) return ProfilePoint{-next.radius, next.height};
      return ProfilePoint{2 * end.radius - next.radius, 2 * end.height - next.height};
    };
    const std::size_t n = profile.size();
    std::vector<ProfilePoint> p;
    p.push_back(beyond(profile[0], profile[1]));
    p.insert(p.end(), profile.begin(), profile.end());
    p.push_back(beyond(profile[n - 1], profile[n - 2]));
    for (std::size_t i = 0; i + 1 < n; ++i) {
      Piece made;
      set_cubic(made.radius, p[i].radius, p[i + 1].radius, p[i + 2].radius, p[i + 3].radius);
      set_cubic(made.height, p[i].height, p[i + 1].height, p[i + 2].height, p[i + 3].height);
      finish(made);
      pieces_.push_back(made);
    }
    if (caps) {
      add_disc({0, profile.front().height}, profile.front(), true);
      add_disc(profile.back(), {0, profile.back().height}, false);
    }
    for (const Piece& each : pieces_) {
      const double r = std::max(std::abs(each.radii.begin), std::abs(each.radii.end));
      bounds_.add(Vec3{-r, each.heights.begin, -r}), bounds_.add(Vec3{r, each.heights.end, r});
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (i % Profile::group == 0) groups_.push_back(pieces_[i]);
      const auto join = [](Span1& a, const Span1& b) {
        a = {std::min(a.begin, b.begin), std::max(a.end, b.end)};
      };
      join(groups_.back().radii, pieces_[i].radii);
      join(groups_.back().heights, pieces_[i].heights);
    }
  }
  Box bounds() const override { return bounds_; }

  // A piece lies within its control points: each of them turned about Y, in a ring of 16 corners.
  std::vector<Hull> hulls() const override {
    constexpr int corners = 16;
    std::vector<Hull> all;
    for (const Piece& piece : pieces_) {
      double radius[4], height[4];
      to_bernstein(piece.radius, 3, radius), to_bernstein(piece.height, 3, height);
      Hull& hull = all.emplace_back();
      for (std::size_t i = 0; i < 4; ++i)
        for (int corner = 0; corner < corners; ++corner) {
          const double angle = 2 * std::numbers::pi * corner / corners;
          const double r = radius[i] / std::cos(std::numbers::pi / corners);
          hull.push_back({r * std::cos(angle), height[i], r * std::sin(angle)});
        }
    }
    return all;
  }

  void find(std::span<const Ray> rays, std::span<Meeting> meetings) const override {
    const Profile profile{pieces_.data(), pieces_.size(), groups_.data(), groups_.size(), bounds_};
    find_(profile, rays.size(), rays.data(), meetings.data());
  }
  void describe(std::span<const Ray> rays, std::span<const Meeting> meetings, bool with_uv,
                std::span<ShapePoint> points) const override {
    for (std::size_t i = 0; i < rays.size(); ++i)
      points[i] = look(rays[i].origin + meetings[i].t * rays[i].direction, meetings[i], with_uv);
  }

 private:
  void add_disc(const ProfilePoint& from, const ProfilePoint& to, bool front) {
    if (std::max(from.radius, to.radius) < 1e-9) return;
    Piece disc;
    disc.radius[0] = from.radius, disc.radius[1] = to.radius - from.radius;
    disc.height[0] = from.height;
    finish(disc);
    pieces_.insert(front ? pieces_.begin() : pieces_.end(), disc);
  }

  ShapePoint look(const Vec3& p, const Meeting& meeting, bool with_uv) const {
    const Piece& piece = pieces_[meeting.part];
    const double r = std::sqrt(p.x * p.x + p.z * p.z), c = r > 0 ? p.x / r : 1,
                 s = r > 0 ? p.z / r : 0;
    // Outward is to the right of the profile's direction.
    const double sign = cubic(piece.radius, meeting.a) < 0 ? -1 : 1;
    double out = sign * slope(piece.height, meeting.a), up = -slope(piece.radius, meeting.a);
    if (out == 0 && up == 0) out = 1;
    const Vec3 normal{out * c, up, out * s};
    if (!with_uv) return {normal, normal, 0, 0};
    double u = std::atan2(-p.z, p.x) / (2 * std::numbers::pi);
    if (u < 0) u += 1;
    return {normal, normal, u, (double(meeting.part) + meeting.a) / double(pieces_.size())};
  }

  std::vector<Piece> pieces_;
  std::vector<Ring> groups_;
  Box bounds_;
  FindFunction find_;
};

}  // namespace

std::shared_ptr<const Shape> make_for(const std::vector<ProfilePoint>& points, bool caps,
                                      FindFunction find) {
  return std::make_shared<Revolution>(points, caps, find);
}

}  // namespace revolution

std::shared_ptr<const Shape> make_revolution(const std::vector<ProfilePoint>& profile, bool caps) {
  return revolution::make_for(profile, caps, revolution::find_function());
}

const std::vector<ProfilePoint>& vase_profile() {
  static const std::vector<ProfilePoint> points = {
      {0, -1},        {0.34, -1},     {0.40, -0.96},  {0.32, -0.88},  {0.27, -0.78},
      {0.42, -0.55},  {0.62, -0.22},  {0.68, 0.08},   {0.60, 0.36},   {0.40, 0.58},
      {0.265, 0.74},  {0.25, 0.84},   {0.31, 0.94},   {0.40, 1.0},    {0.405, 1.02},
      {0.385, 1.025}, {0.29, 0.955},  {0.215, 0.84},  {0.23, 0.74},   {0.35, 0.58},
      {0.55, 0.34},   {0.62, 0.06},   {0.56, -0.22},  {0.36, -0.55},  {0.2, -0.7},
      {0, -0.72}};
  return points;
}

}  // namespace pse::surface
