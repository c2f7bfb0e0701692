// Edges followed and shares taken for many pixels at once (steps.h), for the instructions that the
// including file is compiled for. As in neighbours.h nothing here may be kept out of line but what
// is local.
#pragma once

#include "antialias/lanes.h"
#include "antialias/steps.h"

namespace pse::antialias {

namespace {

// How far along the edge, and beyond it, it is looked at again; in reaches of the kernel.
constexpr float along = 0.7f, beyond_edge = 0.1f;
// Edges that turn by more than this from one to the other look are not followed.
constexpr float most_turn = 0.5f;

// How far beyond the edge it is looked at again.
template <class V>
[[gnu::always_inline]] inline V offset_beyond(V distance, float reach) {
  const float beyond = beyond_edge * reach;
  return distance < 0 ? V{} + beyond : V{} - beyond;
}

// The distances x of pixels from an edge, from what two places said of it: f / |f'| is `first` at
// the pixel, and `second` at `out` along the normal and s along the edge, a circle. Along the
// normal f is x + b x^2, so f / |f'| is (x + b x^2) / (1 + 2 b x), for the distance to a circle's
// centre (b = 0) and for its square. Of both places the farther tells b and the nearer where the
// edge is; a bend measured off the edge is made that of the edge.
template <class V>
[[gnu::always_inline]] inline V true_distance(V first, V second, V out, V& bend, float s) {
  constexpr float least = 0.003f, most_b = 1, unseen = 0.001f;
  const V measured = bend;
  // The way to the centre of the circle, from the place and from where the normal is nearest to it,
  // in parts of the latter.
  const V slant = square_root(1 + measured * measured * (s * s));
  const V between = out + measured * (s * s) / (1 + slant);
  const AnswersOf<V> by_first = size(first) < size(second);
  const V near = choose(by_first, first, second), far = choose(by_first, second, first);
  const V to_far = choose(by_first, between, -between);
  V at = near;
  for (int round = 0; round < 4; ++round) {
    const V there = at + to_far, per_b = there * (2 * far - there);
    const V b = choose(size(per_b) < least, V{}, clamped((there - far) / per_b, -most_b, most_b));
    at = (near - b * at * at) / larger(1 - 2 * b * near, V{} + 0.25f);
  }
  const V x = choose(by_first, at, at - between), beside = x + between;
  bend = measured / larger(slant - measured * beside, V{} + 0.25f);
  // Both say the same of a straight edge.
  const AnswersOf<V> is_straight =
      (size(measured) < unseen) & (size(second - out - first) < unseen);
  bend = choose(is_straight, measured, bend);
  return choose(is_straight, first, x);
}

// Whether some output jumps towards a neighbour that neither line parts from the pixel: from both
// it lies on the pixel's side, by more than they may bend.
template <class V>
[[gnu::always_inline]] inline AnswersOf<V> is_unexplained(AnswersOf<V> jumps,
                                                          const float* const* lines,
                                                          std::size_t i) {
  constexpr float most_bend = 0.3f;
  AnswersOf<V> found{};
  if (!any(jumps)) return found;
  for (std::size_t k = 0; k < std::size(Pixel::around); ++k) {
    const auto dx = static_cast<float>(Pixel::around[k][0]),
               dy = static_cast<float>(Pixel::around[k][1]);
    AnswersOf<V> beside = (jumps & (1 << k)) != 0;
    for (std::size_t line = 0; line < edge_outputs; line += 3) {
      const V distance = load<V>(lines[line] + i);
      const V step = dx * load<V>(lines[line + 1] + i) + dy * load<V>(lines[line + 2] + i);
      beside &= size(distance) + choose(distance < 0, -step, step) > most_bend;
    }
    found |= beside;
  }
  return found;
}

// Of a power of a distance f / |f'| is but a part of the distance: what an edge that hardly turns
// must be multiplied by, where it comes nearer by `nearer` on a way of `out` towards it.
template <class V>
[[gnu::always_inline]] inline V power_of(V nearer, V out, V turn) {
  constexpr float straight = 0.15f, alike = 0.15f;
  V power = V{} + 1;
  for (const float odd : {3.0f, 5.0f})
    power = choose(size(nearer * odd - out) < alike * size(out), V{} + odd, power);
  return choose(size(turn) < straight, power, V{} + 1);
}

template <std::size_t lanes>
void see_nearness(const CrossingLists& c, const float* const* lines, float reach, float farthest,
                  Nearness* nearness) {
  using V = typename LanesOf<lanes>::Floats;
  // Where no program ran there is no normal, and no line.
  const auto distance_of = [&](std::size_t line, std::size_t i) {
    const V nx = load<V>(lines[line + 1] + i), ny = load<V>(lines[line + 2] + i);
    return choose((nx == 0) & (ny == 0), V{} + no_edge, size(load<V>(lines[line] + i)));
  };
  constexpr auto one = static_cast<std::int32_t>(Nearness::one_edge);
  constexpr auto unclear = static_cast<std::int32_t>(Nearness::unclear);
  for (std::size_t i = 0; i < c.count; i += lanes) {
    const V nearest = distance_of(0, i), second = distance_of(3, i);
    const AnswersOf<V> is_near = nearest < reach * 1.2f;
    const AnswersOf<V> jumps = ~is_near & load<AnswersOf<V>>(c.jumps + i);
    const AnswersOf<V> is_unclear =
        ~(nearest <= farthest) | (second < reach) | is_unexplained<V>(jumps, lines, i);
    store(nearness + i, (is_unclear & unclear) | (~is_unclear & is_near & one));
  }
}

template <std::size_t lanes>
void find_fates(const CrossingLists& c, const float* const* lines, const Nearness* nearness,
                const Reaches& reaches, std::int32_t* fates) {
  using V = typename LanesOf<lanes>::Floats;
  using Answers = AnswersOf<V>;
  constexpr auto out = static_cast<std::int32_t>(Nearness::out_of_reach);
  constexpr auto unclear = static_cast<std::int32_t>(Nearness::unclear);
  const Answers may_bend = Answers{} - (reaches.bent > 0 ? 1 : 0);
  for (std::size_t i = 0; i < c.count; i += lanes) {
    const V nearest = size(load<V>(lines[0] + i)), second = size(load<V>(lines[3] + i));
    const Answers seen = load<Answers>(nearness + i);
    const Answers is_hidden = load<Answers>(c.hidden + i) != 0, is_near = nearest < reaches.kernel;
    const Answers is_second_near = second < reaches.second;
    const Answers may_turn = (seen == unclear) & may_bend & ~(second < reaches.kernel);
    const Answers is_plain = ~(is_hidden | (seen == unclear));

    // On opposite sides of the pixel. Where no program ran there is no normal, and no line.
    V distance[2], nx[2], ny[2];
    for (std::size_t k = 0; k < 2; ++k) {
      nx[k] = load<V>(lines[3 * k + 1] + i), ny[k] = load<V>(lines[3 * k + 2] + i);
      const Answers is_none = (nx[k] == 0) & (ny[k] == 0);
      distance[k] = choose(is_none, V{} + no_edge, load<V>(lines[3 * k] + i));
      nx[k] = choose(is_none, V{} + 1, nx[k]);
    }
    const V product = distance[0] * distance[1] * (nx[0] * nx[1] + ny[0] * ny[1]);
    const Answers is_between = is_plain & (nearest >= reaches.kernel) & is_second_near &
                               (load<Answers>(c.unseen + i) == 0) & (product < 0);

    const Answers may_be_bent = may_bend & (seen == out);
    const Answers reaches_pixel =
        (may_be_bent & (nearest < reaches.bent)) | (~may_be_bent & (seen != out));
    // The other edge may be seen from beyond the crease only.
    const Answers is_followed =
        (is_hidden & is_near & ~is_second_near) | (is_plain & ~is_between & reaches_pixel);
    const Answers is_sampled =
        (is_hidden & is_near & is_second_near) | (~is_hidden & (seen == unclear) & ~may_turn);
    // What is enclosed and no circle stays out of reach.
    const Answers is_enclosed =
        is_plain & may_be_bent & ~is_between & ~is_followed & (load<Answers>(c.enclosed + i) != 0);
    const Answers is_fitted = (~is_hidden & may_turn) | is_enclosed;
    store(fates + i, (is_followed & to_follow) | (is_sampled & to_sample) | (is_fitted & to_fit) |
                         (is_between & to_smooth));
  }
}

// A loop over two lists of places, each number by itself.
inline void find_second_looks(const CrossingLists& c, float reach, double* to_x, double* to_y) {
  const float s = along * reach;
  for (std::size_t i = 0; i < c.count; ++i) {
    const float out = offset_beyond(c.distance[i], reach) - c.distance[i];
    to_x[i] = c.x[i] + 0.5 + double(out * c.nx[i] - s * c.ny[i]);
    to_y[i] = c.y[i] + 0.5 + double(out * c.ny[i] + s * c.nx[i]);
  }
}

inline void find_sides(const CrossingLists& c, double* to_x, double* to_y) {
  for (std::size_t i = 0; i < c.count; ++i) {
    const double x = c.x[i] + 0.5, y = c.y[i] + 0.5;
    to_x[i] = x + double(c.towards[i] * c.nx[i]), to_y[i] = y + double(c.towards[i] * c.ny[i]);
    to_x[c.count + i] = x + double(c.away[i] * c.nx[i]);
    to_y[c.count + i] = y + double(c.away[i] * c.ny[i]);
  }
}

template <std::size_t lanes>
void look_again(const CrossingLists& c, const float* const* lines, float reach) {
  using V = typename LanesOf<lanes>::Floats;
  const float s = along * reach;
  for (std::size_t i = 0; i < c.count; i += lanes) {
    const V nx = load<V>(c.nx + i), ny = load<V>(c.ny + i);
    const V seen = load<V>(c.distance + i);
    const V out = offset_beyond(seen, reach) - seen;
    const V x = load<V>(lines[1] + i), y = load<V>(lines[2] + i);
    const V cosine = x * nx + y * ny, turned = choose(cosine < 0, V{} - 1, V{} + 1);
    const V turn = (y * nx - x * ny) / cosine;
    const V seen_beside = load<V>(lines[0] + i) * turned;
    const V power = power_of(seen_beside - seen, out, turn);
    const V first = seen * power, beside = seen_beside * power;
    // The other line's distance from the pixel.
    const V dx = s * ny - out * nx, dy = -(s * nx) - out * ny;
    const V other = load<V>(lines[3] + i) + load<V>(lines[4] + i) * dx + load<V>(lines[5] + i) * dy;
    const AnswersOf<V> one =
        (size(turn) < most_turn) & (size(seen_beside) < reach) & ~(size(other) < reach);
    V bend = turn / s;
    store(c.distance + i, true_distance(first, beside, out, bend, s));
    store(c.bend + i, bend);
    store(c.other + i, other);
    store(c.is_one + i, one);
  }
}

template <std::size_t lanes>
void bend_shares(const CrossingLists& c) {
  using V = typename LanesOf<lanes>::Floats;
  for (std::size_t i = 0; i < c.count; i += lanes) {
    const V straight = load<V>(c.share + i), moment = load<V>(c.towards + i);
    const V bend = load<V>(c.bend + i), distance = load<V>(c.distance + i);
    // A circle for the line, to third order in its bend but for the tenth part of that order.
    const V turn = bend * distance;
    const V share =
        straight + bend / 2 * load<V>(c.turning + i) * (1 - 0.75f * turn + 0.6f * turn * turn);
    // An edge that is out of reach parts nothing.
    const AnswersOf<V> is_whole = (straight <= 0) | (straight >= 1);
    store(c.share + i, choose(is_whole, straight, share));
    store(c.towards + i, moment / straight);
    store(c.away + i, -moment / (1 - straight));
  }
}

}  // namespace
}  // namespace pse::antialias
