// Rays against a surface of revolution, four at once, for the instructions that the including file
// is compiled for: revolution_any.cpp and revolution_avx2.cpp. Nothing here may be kept out of line
// but what is local, since the linker would take one such function for both.
#pragma once

#include "surface/revolution_profile.h"

namespace pse::surface::revolution {

namespace {

// One ray of several.
[[gnu::always_inline]] inline Course<double> one_of(const Course<Lanes>& c, std::size_t i) {
  return {c.ox[i],    c.oy[i],  c.oz[i], c.dx[i], c.dy[i], c.dz[i],         c.least[i],  c.most[i],
          c.begin[i], c.end[i], c.oo[i], c.od[i], c.dd[i], c.per_height[i], c.middle[i], c.off[i]};
}

// Calls meet(ray, nearest) for those of several rays that an answer holds for.
template <class Meet>
[[gnu::always_inline]] inline void one_by_one(Answers which, const Course<Lanes>& rays,
                                              Nearest<Lanes>& nearest, const Meet& meet) {
  for (std::size_t i = 0; i < lane_count; ++i) {
    if (which[i] == 0) continue;
    Nearest<double> own{nearest.t[i], nearest.v[i], nearest.part[i]};
    meet(i, one_of(rays, i), own);
    nearest.t[i] = own.t, nearest.v[i] = own.v, nearest.part[i] = own.part;
  }
}

// The only root in [0, 1] of polynomials (rising powers) with the values at_0 and at_1 at its ends:
// Newton's method, held in its bracket (roots.cpp: the same for one).
[[gnu::always_inline]] inline Lanes refine(Answers open, const Lanes (&power)[7], Lanes at_0,
                                           Lanes at_1, Answers above) {
  const Lanes zero{}, one = zero + 1;
  Lanes a = zero, b = one;
  Lanes x = choose(at_0 * at_1 < 0, at_0 / (at_0 - at_1), zero + 0.5);
  for (int step = 0; step < 60 && any(open); ++step) {
    Lanes value = power[6], slope = zero;
    for (int i = 6; i-- > 0;) slope = slope * x + value, value = value * x + power[i];
    const Answers before = (value > 0) == above;
    a = choose(before, x, a), b = choose(before, b, x);
    const Lanes newton = x - value / slope;
    const Lanes next = choose((newton > a) & (newton < b), newton, 0.5 * (a + b));
    const Answers found = value == 0;
    const Answers done = found | (size(next - x) <= 1e-12) | (next == a) | (next == b);
    x = choose(open & ~found, next, x);
    open &= ~done;
  }
  return x;
}

// With w = height - o.y and t = w / d.y: w^2 d.d + 2 w dy o.d + dy^2 (o.o - r^2) = 0.
[[gnu::always_inline]] inline void meet_piece(Answers which, const Course<Lanes>& rays,
                                              const Piece& piece, double part,
                                              Nearest<Lanes>& nearest) {
  if (piece.is_disc())
    return one_by_one(which, rays, nearest, [&](std::size_t, const auto& ray, auto& own) {
      meet_disc(ray, piece, part, own);
    });
  const Lanes yy = rays.dy * rays.dy, w2 = rays.dd, w1 = 2 * rays.dy * rays.od;
  const Lanes of_h = w1 - 2 * rays.oy * w2;
  const Lanes constant = (rays.oy * w2 - w1) * rays.oy + yy * rays.oo;
  // Count changes of sign of the Bernstein coefficients; those of 0 have the sign before them.
  Lanes bernstein[7], power[7], changes{}, before{}, first{};
  for (int i = 0; i < 7; ++i) {
    const Lanes c = w2 * piece.hh.bernstein[i] + of_h * piece.h.bernstein[i] -
                    yy * piece.rr.bernstein[i] + constant;
    bernstein[i] = c;
    changes += choose(before * c < 0, Lanes{} + 1, Lanes{});
    const Lanes sign = choose(c > 0, Lanes{} + 1, choose(c < 0, Lanes{} - 1, before));
    first = choose(first == 0, sign, first);
    before = sign;
  }
  which &= changes > 0;
  if (!any(which)) return;
  for (int i = 0; i < 7; ++i)
    power[i] = w2 * piece.hh.powers[i] + of_h * piece.h.powers[i] - yy * piece.rr.powers[i];
  power[0] += constant;
  const Answers once = which & (changes == 1);
  if (any(once)) {
    const Lanes v = refine(once, power, bernstein[0], bernstein[6], first > 0);
    rays.keep(once, (cubic(piece.height, v) - rays.oy) * rays.per_height, v, part, nearest);
  }
  const Answers many = which & (changes > 1);
  if (!any(many)) return;
  one_by_one(many, rays, nearest, [&](std::size_t k, const auto& ray, auto& own) {
    Sextic polynomial;
    for (int i = 0; i < 7; ++i)
      polynomial.powers[i] = power[i][k], polynomial.bernstein[i] = bernstein[i][k];
    meet_many(ray, piece, part, polynomial, own);
  });
}

// Rays side by side mostly meet the same piece, so each packet begins with `likely`, one that the
// packet before met; which it begins with changes nothing of what it meets first.
[[gnu::always_inline]] inline void meet_profile(const Profile& profile, const Course<Lanes>& rays,
                                                std::size_t likely, Nearest<Lanes>& nearest) {
  const auto try_piece = [&](std::size_t i) {
    const Answers which = may_come_before(rays.earliest(profile.pieces[i]), nearest);
    if (any(which)) meet_piece(which, rays, profile.pieces[i], static_cast<double>(i), nearest);
  };
  try_piece(likely);
  for (std::size_t g = 0; g < profile.group_count; ++g) {
    if (!any(may_come_before(rays.earliest(profile.groups[g]), nearest))) continue;
    const std::size_t begin = g * Profile::group, all = profile.piece_count;
    const std::size_t end = begin + Profile::group < all ? begin + Profile::group : all;
    for (std::size_t i = begin; i < end; ++i)
      if (i != likely) try_piece(i);
  }
}

[[gnu::always_inline]] inline void find(const Profile& profile, std::size_t count, const Ray* rays,
                                        Meeting* meetings) {
  std::size_t likely = 0, filled = 0;
  std::size_t which[lane_count];
  // Meets those that have been collected; where they are too few, the last one stands for more.
  const auto meet = [&] {
    for (std::size_t i = filled; i < lane_count; ++i) which[i] = which[filled - 1];
    const Ray &p = rays[which[0]], &q = rays[which[1]], &r = rays[which[2]], &s = rays[which[3]];
    Course<Lanes> course;
    course.ox = Lanes{p.origin.x, q.origin.x, r.origin.x, s.origin.x};
    course.oy = Lanes{p.origin.y, q.origin.y, r.origin.y, s.origin.y};
    course.oz = Lanes{p.origin.z, q.origin.z, r.origin.z, s.origin.z};
    course.dx = Lanes{p.direction.x, q.direction.x, r.direction.x, s.direction.x};
    course.dy = Lanes{p.direction.y, q.direction.y, r.direction.y, s.direction.y};
    course.dz = Lanes{p.direction.z, q.direction.z, r.direction.z, s.direction.z};
    course.least = Lanes{p.begin, q.begin, r.begin, s.begin};
    course.most = Lanes{p.end, q.end, r.end, s.end};
    course.prepare(profile.bounds);
    if (any(course.begin <= course.end)) {
      Nearest<Lanes> nearest{course.most, Lanes{}, Lanes{}};
      meet_profile(profile, course, likely, nearest);
      for (std::size_t i = 0; i < filled; ++i) {
        if (!(nearest.t[i] < course.most[i])) continue;
        const auto part = static_cast<std::uint32_t>(nearest.part[i]);
        meetings[which[i]] = {nearest.t[i], nearest.v[i], 0, part};
        likely = part;
      }
    }
    filled = 0;
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (is_level(rays[i])) {
      meet_level_ray(profile, rays[i], meetings[i]);
      continue;
    }
    which[filled++] = i;
    if (filled == lane_count) meet();
  }
  if (filled > 0) meet();
}

}  // namespace

}  // namespace pse::surface::revolution
