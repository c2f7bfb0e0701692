// d = f / |f'| (2002 chapter, "The High-Contrast Filter"), and the nearest two of these.
#include "antialias/edge_state.h"

#include "antialias/derive.h"

namespace pse::antialias {

using ir::Op;
using ir::Value;

namespace {

// Two lines are one when they differ by less: in sine of their angle, and in pixels.
constexpr float same_angle = 0.08f;
constexpr float same_place = 0.04f;

}  // namespace

EdgeState start_edges(const Emit& e) {
  const Value far = e.number(no_edge), one = e.number(1), zero = e.number(0);
  return {far, one, zero, far, one, zero};
}

EdgeState see_edge(const Emit& e, const EdgeState& before, Value f, Value gx, Value gy) {
  const auto& [distance, nx, ny, second, second_x, second_y] = before;
  const auto size = [&](Value v) { return e(Op::fabs, {v}); };
  const Value slope = e(Op::fsqrt, {e(Op::fma, {gx, gx, e.mul(gy, gy)})});
  const Value per_slope = e.div(e.number(1), slope);
  const Value d = e.mul(f, per_slope), x = e.mul(gx, per_slope), y = e.mul(gy, per_slope);

  const Value sine = size(e.sub(e.mul(x, ny), e.mul(y, nx)));
  const Value cosine = e(Op::fma, {x, nx, e.mul(y, ny)});
  const Value turned = e.choose(e.less(cosine, e.number(0)), e(Op::fneg, {d}), d);
  const Value is_same = e(Op::band, {e.less(sine, e.number(same_angle)),
                                     e.less(size(e.sub(turned, distance)), e.number(same_place))});
  // Infinity and NaN are never nearer.
  const Value is_nearer = e.less(size(d), size(distance));
  const Value is_second = e.less(size(d), size(second));
  // What becomes second: the old first where this is nearer, else the nearer of this and the old
  // second; where this is the first once more, nothing changes.
  const auto next_second = [&](Value of_this, Value first, Value of_second) {
    const Value other = e.choose(is_nearer, first, e.choose(is_second, of_this, of_second));
    return e.choose(is_same, of_second, other);
  };
  return {e.choose(is_nearer, d, distance), e.choose(is_nearer, x, nx),
          e.choose(is_nearer, y, ny),       next_second(d, distance, second),
          next_second(x, nx, second_x),     next_second(y, ny, second_y)};
}

}  // namespace pse::antialias
