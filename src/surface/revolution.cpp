// The surface of revolution: a spline through profile points, turned about Y. Each piece of the
// spline makes a polynomial of degree 6 with a ray, in the spline's own parameter.
#include <algorithm>
#include <array>
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

using Sextic = std::array<double, 7>;

// A polynomial of degree 6 as powers and in Bernstein form.
struct Both {
  Sextic powers{}, bernstein{};
  explicit Both(const Sextic& p = {}) : powers(p) { to_bernstein(powers.data(), 6, bernstein.data()); }
};

// Where something lies: between two heights and two distances from the axis.
struct Ring {
  Span1 radii, heights;
};

struct Piece : Ring {
  Cubic radius, height;
  Both h, hh, rr;   // height, its square, and that of the radius
  int rising = 0;   // 1 where the height only grows, -1 where it only falls

  void finish() {
    radii = range(radius), heights = range(height);
    const double derivative[3] = {height[1], 2 * height[2], 3 * height[3]};
    double b[3];
    to_bernstein(derivative, 2, b);
    rising = std::min({b[0], b[1], b[2]}) > 0 ? 1 : std::max({b[0], b[1], b[2]}) < 0 ? -1 : 0;
    Sextic first{}, square{}, round{};
    for (std::size_t i = 0; i < 4; ++i) {
      first[i] = height[i];
      for (std::size_t j = 0; j < 4; ++j)
        square[i + j] += height[i] * height[j], round[i + j] += radius[i] * radius[j];
    }
    h = Both(first), hh = Both(square), rr = Both(round);
  }
};

// What all pieces ask of a ray.
struct Slanted {
  double begin, end;        // the part of it inside the bounds
  double oo, od, dd;        // o.o, o.d and d.d of what is seen from above
  double per_height;        // 1 / d.y
  double middle;            // where it is nearest to the axis

  Slanted(const Ray& ray, const Span1& span) : begin(span.begin), end(span.end) {
    const Vec3 &o = ray.origin, &d = ray.direction;
    oo = o.x * o.x + o.z * o.z, od = o.x * d.x + o.z * d.z, dd = d.x * d.x + d.z * d.z;
    per_height = 1 / d.y;
    middle = dd > 0 ? -od / dd : 0;
  }
  double squared(double t) const { return oo + t * (2 * od + t * dd); }
};

class Revolution : public Shape {
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
      made.finish();
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
      if (i % group == 0) groups_.push_back(pieces_[i]);
      const auto join = [](Span1& a, const Span1& b) {
        a = {std::min(a.begin, b.begin), std::max(a.end, b.end)};
      };
      join(groups_.back().radii, pieces_[i].radii);
      join(groups_.back().heights, pieces_[i].heights);
    }
  }
  Box bounds() const override { return bounds_; }

  // Rays side by side mostly meet the same piece, so each begins with the one before's; which it
  // begins with changes nothing of what it meets first.
  void find(std::span<const Ray> rays, std::span<Meeting> meetings) const override {
    std::size_t likely = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      meet(rays[i], likely, meetings[i]);
      if (meetings[i].found()) likely = meetings[i].part;
    }
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
    disc.radius = {from.radius, to.radius - from.radius, 0, 0};
    disc.height = {from.height, 0, 0, 0};
    disc.finish();
    pieces_.insert(front ? pieces_.begin() : pieces_.end(), disc);
  }

  // A meeting's a is the profile's parameter in its piece.
  void meet(const Ray& given, std::size_t likely, Meeting& meeting) const {
    const Ray ray = beside_axis(given);
    const Span1 span = clip(ray, bounds_);
    if (!(span.begin <= span.end)) return;
    Meeting nearest;
    nearest.t = ray.end;
    const Slanted seen(ray, span);
    if (earliest(ray, seen, pieces_[likely]) < Box::inf) meet_piece(ray, seen, likely, nearest);
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      if (!may_come_before(earliest(ray, seen, groups_[g]), nearest)) continue;
      const std::size_t end = std::min(pieces_.size(), (g + 1) * group);
      for (std::size_t i = g * group; i < end; ++i)
        if (i != likely && may_come_before(earliest(ray, seen, pieces_[i]), nearest))
          meet_piece(ray, seen, i, nearest);
    }
    if (nearest.t < ray.end) meeting = nearest;
  }

  static bool may_come_before(double earliest, const Meeting& nearest) {
    return earliest < nearest.t + 1e-9 * std::abs(nearest.t);
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

  void meet_piece(const Ray& ray, const Slanted& seen, std::size_t index, Meeting& nearest) const {
    if (pieces_[index].heights.begin == pieces_[index].heights.end)
      meet_disc(ray, index, nearest);
    else if (std::abs(ray.direction.y) < 1e-4 * length(ray.direction))
      meet_level(ray, index, nearest);
    else
      meet_slanted(ray, seen, index, nearest);
  }

  // Where the ray comes to the ring at the earliest; infinite where it does not come through it.
  static double earliest(const Ray& ray, const Slanted& seen, const Ring& ring) {
    double begin = seen.begin, end = seen.end;
    if (ray.direction.y != 0) {
      const double a = (ring.heights.begin - ray.origin.y) * seen.per_height,
                   b = (ring.heights.end - ray.origin.y) * seen.per_height;
      begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
    } else if (ray.origin.y < ring.heights.begin || ray.origin.y > ring.heights.end) {
      return Box::inf;
    }
    constexpr double slack = 1e-9;
    if (!(begin <= end + slack * std::abs(end))) return Box::inf;
    const double low = ring.radii.begin, high = std::max(-low, ring.radii.end);
    const double nearest = begin < end ? std::clamp(seen.middle, begin, end) : begin;
    const double room = slack * (seen.oo + high * high);
    if (seen.squared(nearest) > high * high + room) return Box::inf;
    const double at_begin = seen.squared(begin);
    if (low > 0 && std::max(at_begin, seen.squared(end)) < low * low - room) return Box::inf;
    if (at_begin <= high * high || !(seen.dd > 0)) return begin;
    // It enters through the outer wall.
    const double rest = high * high + room - seen.squared(seen.middle);
    const double entry = seen.middle - std::sqrt(std::max(rest, 0.0) / seen.dd);
    return std::max(begin, entry - slack * std::abs(entry));
  }

  static void keep(const Ray& ray, double t, double v, std::size_t piece, Meeting& nearest) {
    const auto part = static_cast<std::uint32_t>(piece);
    if (!(t > ray.begin)) return;
    if (t < nearest.t || (t == nearest.t && part < nearest.part)) nearest = {t, v, 0, part};
  }

  void meet_slanted(const Ray& ray, const Slanted& seen, std::size_t index,
                    Meeting& nearest) const {
    const Piece& piece = pieces_[index];
    const double oy = ray.origin.y, dy = ray.direction.y, yy = dy * dy;
    // With w = height - o.y and t = w / d.y: w^2 d.d + 2 w dy o.d + dy^2 (o.o - r^2) = 0.
    const double w2 = seen.dd, w1 = 2 * dy * seen.od;
    const double of_h = w1 - 2 * oy * w2, constant = (oy * w2 - w1) * oy + yy * seen.oo;
    Sextic bernstein, powers;
    for (std::size_t i = 0; i < 7; ++i)
      bernstein[i] = w2 * piece.hh.bernstein[i] + of_h * piece.h.bernstein[i] -
                     yy * piece.rr.bernstein[i] + constant;
    if (std::all_of(bernstein.begin(), bernstein.end(), [](double c) { return c > 0; })) return;
    for (std::size_t i = 0; i < 7; ++i)
      powers[i] = w2 * piece.hh.powers[i] + of_h * piece.h.powers[i] - yy * piece.rr.powers[i];
    powers[0] += constant;
    // A ray from outside wants the root that it comes to first.
    const bool forward = (piece.rising > 0) == (dy > 0);
    const Which which = piece.rising == 0 || !(seen.begin > ray.begin) ? Which::all
                        : forward                                     ? Which::first
                                                                      : Which::last;
    const Roots roots = roots_in_unit(powers.data(), bernstein.data(), 6, which);
    for (std::size_t i = 0; i < roots.count; ++i)
      keep(ray, (value(piece.height, roots.at[i]) - oy) * seen.per_height, roots.at[i], index,
           nearest);
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

  ShapePoint look(const Vec3& p, const Meeting& meeting, bool with_uv) const {
    const Piece& piece = pieces_[meeting.part];
    const double r = std::sqrt(p.x * p.x + p.z * p.z), c = r > 0 ? p.x / r : 1, s = r > 0 ? p.z / r : 0;
    // Outward is to the right of the profile's direction.
    const double sign = value(piece.radius, meeting.a) < 0 ? -1 : 1;
    double out = sign * slope(piece.height, meeting.a), up = -slope(piece.radius, meeting.a);
    if (out == 0 && up == 0) out = 1;
    const Vec3 normal{out * c, up, out * s};
    if (!with_uv) return {normal, normal, 0, 0};
    double u = std::atan2(-p.z, p.x) / (2 * pi);
    if (u < 0) u += 1;
    return {normal, normal, u, (double(meeting.part) + meeting.a) / double(pieces_.size())};
  }

  static constexpr std::size_t group = 4;
  std::vector<Piece> pieces_;
  std::vector<Ring> groups_;  // of so many pieces each
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
