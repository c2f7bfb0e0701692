// Names of surfaces for four samples at once, for the instructions that the including file is
// compiled for: names_any.cpp and names_avx2.cpp. Nothing here may be kept out of line but what is
// local, since the linker would take one such function for both.
#pragma once

#include "surface/name_values.h"
#include "surface/spot_lanes.h"

namespace pse::surface {

namespace {

using Floats [[gnu::vector_size(4 * lane_count)]] = float;

// The computed names of four samples, component by component.
struct Computed {
  Lanes at[computed_count][3];

  [[gnu::always_inline]] void set(What what, const Vec<Lanes>& v) {
    Lanes* to = at[static_cast<std::size_t>(what)];
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
  }
  [[gnu::always_inline]] void set(What what, Lanes v) { at[static_cast<std::size_t>(what)][0] = v; }
};

// The samples of a packet: four in a row, or fewer, the last of which stands for the rest.
struct Company {
  std::size_t index[lane_count], filled;
};

[[gnu::always_inline]] inline void compute(const NameValues& values, const Company& company,
                                           Computed& out) {
  const auto load = [&](const auto& of) [[gnu::always_inline]] {
    return Lanes{of(company.index[0]), of(company.index[1]), of(company.index[2]),
                 of(company.index[3])};
  };
  const auto load3 = [&](const auto& of) [[gnu::always_inline]] {
    const Vec3 &a = of(company.index[0]), &b = of(company.index[1]), &c = of(company.index[2]),
               &d = of(company.index[3]);
    return Vec<Lanes>{{a.x, b.x, c.x, d.x}, {a.y, b.y, c.y, d.y}, {a.z, b.z, c.z, d.z}};
  };
  const Vec<Lanes> origin =
      load3([&](std::size_t k) -> const Vec3& { return values.rays[k].origin; });
  const Vec<Lanes> direction =
      load3([&](std::size_t k) -> const Vec3& { return values.rays[k].direction; });
  const Lanes width = load([&](std::size_t k) { return values.sightings[k].width; });
  out.set(What::origin, origin);
  out.set(What::direction, direction);
  out.set(What::view, -direction);
  out.set(What::depth, load([&](std::size_t k) { return values.sightings[k].depth; }));

  // Where it is and how it faces; the background is nowhere.
  Seen<Lanes> seen{};
  Vec<Lanes> uv{};
  if (values.points != nullptr) {
    const Lanes t = load([&](std::size_t k) { return values.hits[k].meeting.t; });
    seen = see(values.frame, origin, direction, t,
               load3([&](std::size_t k) -> const Vec3& { return values.points[k].normal; }),
               load3([&](std::size_t k) -> const Vec3& { return values.points[k].flat; }));
    uv.x = load([&](std::size_t k) { return values.points[k].u; });
    uv.y = load([&](std::size_t k) { return values.points[k].v; });
  }
  out.set(What::place, seen.place);
  out.set(What::point, seen.point);
  out.set(What::normal, seen.normal);
  out.set(What::flat_normal, seen.flat);
  out.set(What::uv, uv);
  const Lanes zero{};
  out.set(What::backface, choose(seen.back, zero + 1, zero));

  // How it moves from pixel to pixel, and the side of a square as large as the pixel's image on the
  // surface.
  if (!values.wants_shifts) return;
  Vec<Lanes> dx{}, dy{}, own_dx{}, own_dy{};
  Lanes side = width;
  if (!values.is_background) {
    dx = shift(spread<Lanes>(values.right), direction, seen.flat, width);
    dy = shift(spread<Lanes>(values.up), direction, seen.flat, width);
    own_dx = vector_in(values.frame, dx), own_dy = vector_in(values.frame, dy);
    const Vec<Lanes> area = cross(own_dx, own_dy);
    side = square_root(square_root(dot(area, area)));
  }
  out.set(What::place_dx, dx);
  out.set(What::place_dy, values.is_background ? dy : -dy);
  out.set(What::dpdx, own_dx);
  out.set(What::dpdy, -own_dy);
  out.set(What::pixelsize, side);
  const Lanes rounded = __builtin_convertvector(__builtin_convertvector(side, Floats), Lanes);
  out.set(What::pixel_freq, 0.5 / rounded);
}

[[gnu::always_inline]] inline void write_names(const NameValues& values) {
  Computed computed;
  for (std::size_t first = 0; first < values.count; first += lane_count) {
    Company company{};
    const std::size_t left = values.count - first;
    company.filled = left < lane_count ? left : lane_count;
    std::uint32_t sample[lane_count];
    for (std::size_t i = 0; i < lane_count; ++i) {
      company.index[i] = first + (i < company.filled ? i : company.filled - 1);
      sample[i] = values.sightings[company.index[i]].sample;
    }
    compute(values, company, computed);

    // Four neighbours in a row are stored at once.
    const bool is_row = company.filled == lane_count && sample[1] == sample[0] + 1 &&
                        sample[2] == sample[0] + 2 && sample[3] == sample[0] + 3;
    for (std::size_t s = 0; s < values.store_count; ++s) {
      const NameStore& store = values.stores[s];
      const auto what = static_cast<std::size_t>(store.what);
      const Floats value = what < computed_count
                               ? __builtin_convertvector(computed.at[what][store.component], Floats)
                               : Floats{store.number, store.number, store.number, store.number};
      if (is_row) {
        __builtin_memcpy(store.out + sample[0], &value, sizeof value);
        continue;
      }
      for (std::size_t i = 0; i < company.filled; ++i) store.out[sample[i]] = value[i];
    }
    if (values.places[0] == nullptr) continue;
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < company.filled; ++i)
        values.places[c][first + i] =
            static_cast<float>(computed.at[static_cast<std::size_t>(What::place)][c][i]);
  }
}

}  // namespace

}  // namespace pse::surface
