// The surface of revolution: a spline through profile points, turned about Y. Each piece of the
// spline makes a polynomial of degree 6 with a ray, in the spline's own parameter.
#include <numbers>

#include "surface/roots.h"
#include "surface/shapes.h"

namespace pse::surface {
namespace {

constexpr double pi = std::numbers::pi;
using Cubic = std::array<double, 4>;  // rising powers

double value(const Cubic& c, double v) { return ((c[3] * v + c[2]) * v + c[1]) * v + c[0]; }
double slope(const Cubic& c, double v) { return (3 * c[3] * v + 2 * c[2]) * v + c[1]; }

// Catmull-Rom from b to c.
Cubic piece(double a, double b, double c, double d) {
  return {b, (c - a) / 2, a - 2.5 * b + 2 * c - d / 2, (d - a) / 2 + 1.5 * (b - c)};
}

// The least and greatest value on [0, 1].
Span1 range(const Cubic& c) {
  Span1 r{std::min(c[0], value(c, 1)), std::max(c[0], value(c, 1))};
  const double derivative[3] = {c[1], 2 * c[2], 3 * c[3]};
  const Roots roots = roots_in_unit(derivative, 2, false);
  for (std::size_t i = 0; i < roots.count; ++i) {
    const double here = value(c, roots.at[i]);
    r.begin = std::min(r.begin, here), r.end = std::max(r.end, here);
  }
  return r;
}

struct Piece {
  Cubic radius, height;
  Span1 radii, heights;
};

class Revolution : public SingleShape {
 public:
  Revolution(const std::vector<ProfilePoint>& profile, bool caps) {
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
      made.radius = piece(p[i].radius, p[i + 1].radius, p[i + 2].radius, p[i + 3].radius);
      made.height = piece(p[i].height, p[i + 1].height, p[i + 2].height, p[i + 3].height);
      made.radii = range(made.radius), made.heights = range(made.height);
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
  }
  Box bounds() const override { return bounds_; }

 private:
  struct Meeting {
    double t = Box::inf, v = 0;
    std::size_t piece = 0;
  };

  void add_disc(const ProfilePoint& from, const ProfilePoint& to, bool front) {
    if (std::max(from.radius, to.radius) < 1e-9) return;
    Piece disc;
    disc.radius = {from.radius, to.radius - from.radius, 0, 0};
    disc.height = {from.height, 0, 0, 0};
    disc.radii = range(disc.radius), disc.heights = range(disc.height);
    pieces_.insert(front ? pieces_.begin() : pieces_.end(), disc);
  }

  void meet(const Ray& given, ShapeHit& hit) const override {
    const Ray ray = beside_axis(given);
    const Span1 span = clip(ray, bounds_);
    if (!(span.begin <= span.end)) return;
    Meeting nearest;
    nearest.t = ray.end;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!may_meet(ray, span, pieces_[i])) continue;
      if (pieces_[i].heights.begin == pieces_[i].heights.end)
        meet_disc(ray, i, nearest);
      else if (std::abs(ray.direction.y) < 1e-4 * length(ray.direction))
        meet_level(ray, i, nearest);
      else
        meet_slanted(ray, i, nearest);
    }
    if (nearest.t < ray.end) fill(ray, nearest, hit);
  }

  // A ray through the axis meets the poles in a double root; one a millionth beside it does not.
  static Ray beside_axis(Ray ray) {
    const double dx = ray.direction.x, dz = ray.direction.z, k = dx * dx + dz * dz;
    const double t = k > 0 ? -(ray.origin.x * dx + ray.origin.z * dz) / k : 0;
    const double x = ray.origin.x + t * dx, z = ray.origin.z + t * dz;
    if (x * x + z * z > 1e-12) return ray;
    if (k > 0)
      ray.origin = ray.origin + (1e-6 / std::sqrt(k)) * Vec3{-dz, 0, dx};
    else
      ray.origin.x += 1e-6;
    return ray;
  }

  // Whether the ray comes through the ring that the piece lies in.
  static bool may_meet(const Ray& ray, const Span1& span, const Piece& piece) {
    const double dy = ray.direction.y;
    double begin = span.begin, end = span.end;
    if (dy != 0) {
      const double a = (piece.heights.begin - ray.origin.y) / dy,
                   b = (piece.heights.end - ray.origin.y) / dy;
      begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
    } else if (ray.origin.y < piece.heights.begin || ray.origin.y > piece.heights.end) {
      return false;
    }
    if (!(begin <= end)) return false;
    const double ox = ray.origin.x, oz = ray.origin.z, dx = ray.direction.x, dz = ray.direction.z;
    const double k = dx * dx + dz * dz;
    const auto squared = [&](double t) {
      const double x = ox + t * dx, z = oz + t * dz;
      return x * x + z * z;
    };
    const double low = piece.radii.begin, high = std::max(-low, piece.radii.end);
    const double t = k > 0 ? std::clamp(-(ox * dx + oz * dz) / k, begin, end) : begin;
    constexpr double slack = 1e-9;
    if (squared(t) > high * high * (1 + slack)) return false;
    return low <= 0 || std::max(squared(begin), squared(end)) >= low * low * (1 - slack);
  }

  static void keep(const Ray& ray, double t, double v, std::size_t piece, Meeting& nearest) {
    if (t > ray.begin && t < nearest.t) nearest = {t, v, piece};
  }

  void meet_slanted(const Ray& ray, std::size_t index, Meeting& nearest) const {
    const Piece& piece = pieces_[index];
    const Vec3 &o = ray.origin, &d = ray.direction;
    // With w = height - o.y and t = w / d.y: w^2 (dx^2 + dz^2) + 2 w dy (ox dx + oz dz) + dy^2 (ox^2 +
    // oz^2 - r^2) = 0.
    Cubic w = piece.height;
    w[0] -= o.y;
    const double ww = d.x * d.x + d.z * d.z, w1 = 2 * d.y * (o.x * d.x + o.z * d.z),
                 yy = d.y * d.y, w0 = yy * (o.x * o.x + o.z * o.z);
    double c[7] = {w0, 0, 0, 0, 0, 0, 0};
    for (std::size_t i = 0; i < 4; ++i) {
      c[i] += w1 * w[i];
      for (std::size_t j = 0; j < 4; ++j)
        c[i + j] += ww * w[i] * w[j] - yy * piece.radius[i] * piece.radius[j];
    }
    const Roots roots = roots_in_unit(c, 6, false);
    for (std::size_t i = 0; i < roots.count; ++i)
      keep(ray, value(w, roots.at[i]) / d.y, roots.at[i], index, nearest);
  }

  // Nearly level rays: the circle at the ray's height, then Newton's method in t and v.
  void meet_level(const Ray& ray, std::size_t index, Meeting& nearest) const {
    const Piece& piece = pieces_[index];
    const Vec3 &o = ray.origin, &d = ray.direction;
    const double k = d.x * d.x + d.z * d.z, middle = -(o.x * d.x + o.z * d.z) / k;
    const double height = o.y + middle * d.y;
    const double cx = o.x + middle * d.x, cz = o.z + middle * d.z, off = cx * cx + cz * cz;
    Cubic w = piece.height;
    w[0] -= height;
    const Roots roots = roots_in_unit(w.data(), 3, false);
    for (std::size_t i = 0; i < roots.count; ++i) {
      const double r = value(piece.radius, roots.at[i]), rest = r * r - off;
      if (!(rest >= 0)) continue;
      for (const double side : {-1.0, 1.0}) {
        double t = side * std::sqrt(rest / k), v = roots.at[i];  // t from the middle
        for (int step = 0; step < 4; ++step) {
          const double radius = value(piece.radius, v);
          const double f = off + k * t * t - radius * radius, g = value(w, v) - t * d.y;
          const double ft = 2 * k * t, fv = -2 * radius * slope(piece.radius, v), gt = -d.y,
                       gv = slope(piece.height, v);
          const double determinant = ft * gv - fv * gt;
          if (determinant == 0) break;
          t -= (f * gv - fv * g) / determinant;
          v -= (ft * g - f * gt) / determinant;
        }
        if (v >= 0 && v <= 1) keep(ray, middle + t, v, index, nearest);
      }
    }
  }

  void meet_disc(const Ray& ray, std::size_t index, Meeting& nearest) const {
    const Piece& piece = pieces_[index];
    const double t = (piece.heights.begin - ray.origin.y) / ray.direction.y;
    if (!std::isfinite(t)) return;
    const double r = std::hypot(ray.origin.x + t * ray.direction.x,
                                ray.origin.z + t * ray.direction.z);
    const double v = (r - piece.radius[0]) / piece.radius[1];
    if (v >= 0 && v <= 1) keep(ray, t, v, index, nearest);
  }

  void fill(const Ray& ray, const Meeting& meeting, ShapeHit& hit) const {
    const Piece& piece = pieces_[meeting.piece];
    const Vec3 p = ray.origin + meeting.t * ray.direction;
    const double r = std::hypot(p.x, p.z), c = r > 0 ? p.x / r : 1, s = r > 0 ? p.z / r : 0;
    // Outward is to the right of the profile's direction.
    const double sign = value(piece.radius, meeting.v) < 0 ? -1 : 1;
    double out = sign * slope(piece.height, meeting.v), up = -slope(piece.radius, meeting.v);
    if (out == 0 && up == 0) out = 1;
    hit.t = meeting.t;
    hit.normal = hit.flat = {out * c, up, out * s};
    hit.u = std::atan2(-p.z, p.x) / (2 * pi);
    if (hit.u < 0) hit.u += 1;
    hit.v = (double(meeting.piece) + meeting.v) / double(pieces_.size());
  }

  std::vector<Piece> pieces_;
  Box bounds_;
};

}  // namespace

std::shared_ptr<const Shape> make_revolution(const std::vector<ProfilePoint>& profile, bool caps) {
  return std::make_shared<Revolution>(profile, caps);
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
