// Rays against a surface of revolution, four at once, for the instructions that the including file
// is compiled for: revolution_any.cpp and revolution_avx2.cpp. Nothing here may be kept out of line
// but what is local, since the linker would take one such function for both.
#pragma once

#include "surface/revolution_profile.h"
#include "surface/sextic_lanes.h"

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
  Lanes bernstein[7], power[7];
  for (int i = 0; i < 7; ++i)
    bernstein[i] = w2 * piece.hh.bernstein[i] + of_h * piece.h.bernstein[i] -
                   yy * piece.rr.bernstein[i] + constant;
  const Signs whole = signs(bernstein);
  which &= whole.changes > 0;
  if (!any(which)) return;
  for (int i = 0; i < 7; ++i)
    power[i] = w2 * piece.hh.powers[i] + of_h * piece.h.powers[i] - yy * piece.rr.powers[i];
  power[0] += constant;

  // Of several roots the one that the ray comes to first, where it comes from outside to a piece
  // that only rises or falls.
  const Lanes zero{};
  Bracket bracket{choose(bernstein[6] == 0, zero + 1, zero), zero + 1, bernstein[0], bernstein[6],
                  whole.first > 0};
  Answers once = which & (whole.changes == 1);
  Answers alone = which & (whole.changes > 1);
  if (const Answers in_order = alone & (rays.begin > rays.least);
      piece.rising != 0 && any(in_order)) {
    const Answers last = piece.rising > 0 ? rays.dy < 0 : rays.dy > 0;
    Answers sure = in_order;
    once |= isolate(in_order, bernstein, last, bracket, sure);
    alone &= ~sure;
  }
  if (any(once)) {
    const Lanes v = refine(once, power, bracket);
    rays.keep(once, (cubic(piece.height, v) - rays.oy) * rays.per_height, v, part, nearest);
  }
  if (!any(alone)) return;
  one_by_one(alone, rays, nearest, [&](std::size_t k, const auto& ray, auto& own) {
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
