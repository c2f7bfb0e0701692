// The profile of a surface of revolution, cut into the pieces that rays are met with
// (revolution.cpp makes it), and what all its pieces ask of a ray. For one ray or for several side
// by side: revolution_packet.h is compiled for more than one kind of processor, so that nothing
// here may be kept out of line but what revolution.cpp defines.
#pragma once

#include "surface/lanes.h"
#include "surface/revolution.h"

namespace pse::surface::revolution {

// A polynomial of degree 6, rising powers, and the same in Bernstein form on [0, 1].
struct Sextic {
  double powers[7], bernstein[7];
};

// Where something lies: between two heights and two distances from the axis.
struct Ring {
  Span1 radii, heights;
};

// A piece of the spline: cubics of its parameter v in [0, 1], rising powers.
struct Piece : Ring {
  double radius[4] = {}, height[4] = {};
  Sextic h{}, hh{}, rr{};  // height, its square, and that of the radius
  int rising = 0;          // 1 where the height only grows, -1 where it only falls

  bool is_disc() const { return heights.begin == heights.end; }
};

// Views of what a Revolution owns.
struct Profile {
  static constexpr std::size_t group = 4;  // pieces in a group, but for the last
  const Piece* pieces;
  std::size_t piece_count;
  const Ring* groups;  // around the pieces of each
  std::size_t group_count;
  Box bounds;
};

template <class V>
[[gnu::always_inline]] inline V cubic(const double (&c)[4], V v) {
  return ((c[3] * v + c[2]) * v + c[1]) * v + c[0];
}

constexpr double slack = 1e-9;  // of rounding, where something is ruled out

// What is met first so far: a meeting's a is the profile's parameter v in its piece.
template <class V>
struct Nearest {
  V t, v, part;
};

// Rays that are not level, or one ray, and the part of them inside the bounds.
template <class V>
struct Course {
  V ox, oy, oz, dx, dy, dz;
  V least, most;  // the rays' own ends
  V begin, end;   // inside the bounds; begin > end where they miss them
  V oo, od, dd;   // o.o, o.d and d.d of what is seen from above
  V per_height;   // 1 / d.y
  V middle, off;  // where it is nearest to the axis, and the square of how near

  // Computes what follows from the first two lines, which are set.
  [[gnu::always_inline]] void prepare(const Box& bounds) {
    seen_from_above();
    beside_axis();
    per_height = 1 / dy;
    begin = least, end = most;
    clip(bounds.lower.x, bounds.upper.x, ox, dx);
    clip(bounds.lower.y, bounds.upper.y, oy, dy);
    clip(bounds.lower.z, bounds.upper.z, oz, dz);
    const AnswersOf<V> outside = begin > end;
    begin = choose(outside, V{} + 1, begin), end = choose(outside, V{}, end);
  }

  [[gnu::always_inline]] V squared(V t) const { return oo + t * (2 * od + t * dd); }

  // Where the rays come to a ring at the earliest; infinite where they do not come through it.
  [[gnu::always_inline]] V earliest(const Ring& ring) const {
    V from = begin, to = end;
    narrow((ring.heights.begin - oy) * per_height, (ring.heights.end - oy) * per_height, from, to);
    AnswersOf<V> misses = from > to + slack * size(to);
    const double low = ring.radii.begin, high = -low > ring.radii.end ? -low : ring.radii.end;
    const double outer = high * high;
    const V nearest = choose(from < to, larger(from, smaller(middle, to)), from);
    const V room = slack * (oo + outer);
    misses = misses | (squared(nearest) > outer + room);
    const V at_begin = squared(from);
    if (low > 0) misses = misses | (larger(at_begin, squared(to)) < low * low - room);
    const V nothing = V{} + Box::inf;
    const V sure = choose(misses, nothing, from);
    const AnswersOf<V> enters = (at_begin > outer) & (dd > 0) & (sure < nothing);
    if (!any(enters)) return sure;
    // It enters through the outer wall.
    const V entry = middle - square_root(larger(outer + room - off, V{}) / dd);
    return choose(enters, larger(from, entry - slack * size(entry)), sure);
  }

  [[gnu::always_inline]] void keep(AnswersOf<V> which, V t, V v, double part,
                                   Nearest<V>& nearest) const {
    which =
        which & (t > least) & ((t < nearest.t) | ((t == nearest.t) & (V{} + part < nearest.part)));
    nearest.t = choose(which, t, nearest.t), nearest.v = choose(which, v, nearest.v);
    nearest.part = choose(which, V{} + part, nearest.part);
  }

 private:
  [[gnu::always_inline]] void seen_from_above() {
    oo = ox * ox + oz * oz, od = ox * dx + oz * dz, dd = dx * dx + dz * dz;
    middle = choose(dd > 0, -od / dd, V{});
    const V x = ox + middle * dx, z = oz + middle * dz;
    off = x * x + z * z;
  }

  // A ray through the axis meets the poles in a double root; one a millionth beside it does not.
  [[gnu::always_inline]] void beside_axis() {
    const AnswersOf<V> through = off <= 1e-12;
    if (!any(through)) return;
    const V step = 1e-6 / square_root(dd);
    ox = choose(through, ox + choose(dd > 0, -dz * step, V{} + 1e-6), ox);
    oz = choose(through, oz + choose(dd > 0, dx * step, V{}), oz);
    seen_from_above();
  }

  // 0 times infinity, along a face, narrows nothing.
  [[gnu::always_inline]] static void narrow(V a, V b, V& from, V& to) {
    const AnswersOf<V> known = (a == a) & (b == b);
    from = choose(known, larger(from, smaller(a, b)), from);
    to = choose(known, smaller(to, larger(a, b)), to);
  }
  [[gnu::always_inline]] void clip(double lower, double upper, V o, V d) {
    narrow((lower - o) / d, (upper - o) / d, begin, end);
  }
};

template <class V>
[[gnu::always_inline]] inline AnswersOf<V> may_come_before(V earliest, const Nearest<V>& nearest) {
  return earliest < nearest.t + slack * size(nearest.t);
}

// One ray and one piece, in revolution.cpp. Level ones go through other code than all others.
[[gnu::always_inline]] inline bool is_level(const Ray& ray) {
  const Vec3& d = ray.direction;
  return d.y * d.y < 1e-8 * (d.x * d.x + d.y * d.y + d.z * d.z);
}
void meet_level_ray(const Profile& profile, const Ray& ray, Meeting& meeting);
void meet_disc(const Course<double>& ray, const Piece& piece, double part,
               Nearest<double>& nearest);
// Where the polynomial may have several roots; of all, or of the first only that the ray comes to.
void meet_many(const Course<double>& ray, const Piece& piece, double part, const Sextic& polynomial,
               Nearest<double>& nearest);

}  // namespace pse::surface::revolution
