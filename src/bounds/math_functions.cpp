// The math library. Its functions err by less than 3 ulps, so what they give at the ends is
// widened; between the ends they are monotonic up to that.
#include <algorithm>
#include <array>
#include <numbers>
#include <string_view>

#include "bounds/functions.h"

namespace pse::bounds {
namespace {

constexpr std::array<std::string_view, 13> monotonic = {"exp",   "exp2",  "expm1", "log",  "log2",
                                                        "log10", "log1p", "cbrt",  "asin", "acos",
                                                        "atan",  "sinh",  "tanh"};

class Math {
 public:
  Math(ir::Builder& builder, std::int32_t callee) : builder_(builder), callee_(callee) {}

  IrFloat at(const IrFloat& a) const { return call({place(builder_, a)}); }
  IrFloat at(const IrFloat& a, const IrFloat& b) const {
    return call({place(builder_, a), place(builder_, b)});
  }
  Range at_ends(const Range& a) const { return widened(around(at(a.lo), at(a.hi))); }
  Range at_corners(const Range& a, const Range& b) const {
    return widened(around(at(a.lo, b.lo), at(a.lo, b.hi), at(a.hi, b.lo), at(a.hi, b.hi)));
  }

  // sin and cos move no faster than their argument.
  Range wave(const Range& a) const {
    const IrFloat middle = fma(a.lo, IrFloat(0.5f), a.hi * 0.5f);
    const IrFloat reach = fma(max(abs(a.lo), abs(a.hi)), IrFloat(0x1p-22f),
                              max(a.hi - middle, middle - a.lo) * (1.0f + 0x1p-20f) + 1e-6f);
    const IrFloat value = at(middle);
    const IrFloat low = max(value - reach, IrFloat(-1.0f)),
                  high = min(value + reach, IrFloat(1.0f));
    return provided(reach < IrFloat(num::infinity), Range{low, high});
  }

  // a^b with an exponent that is known.
  Range power(const Range& a, const IrFloat& b) const {
    const Range ends = at_ends_with(a, b);
    const IrBool crosses = both(a.lo <= 0.0f, a.hi >= 0.0f);
    const IrBool negative = a.lo < 0.0f;
    const IrBool whole = trunc(b) == b;
    const IrBool even = both(whole, trunc(b * 0.5f) * 2.0f == b);
    // An even power of both signs has its least at 0; a power that is not whole has no negative
    // base, and one below 0 has no limit at 0.
    const IrFloat low = select(both(crosses, even), min(ends.lo, IrFloat(0.0f)), ends.lo);
    const IrBool good = either(negate(crosses), both(b >= 0.0f, either(negate(negative), whole)));
    return provided(good, Range{low, ends.hi});
  }
  Range power(const Range& a, const Range& b) const {
    const IrBool good = either(a.lo > 0.0f, both(a.lo >= 0.0f, b.lo >= 0.0f));
    return provided(good, at_corners(a, b));
  }

  Range hypotenuse(const Range& a, const Range& b) const {
    const Range p = abs(a), q = abs(b);
    const IrBool known = negate(either(may_be_nan(a), may_be_nan(b)));
    return provided(known, widened(around(at(p.lo, q.lo), at(p.hi, q.hi))));
  }

  // Between its corners, unless the box touches the half line where the angle jumps.
  Range angle(const Range& y, const Range& x) const {
    const float pi = std::nextafter(std::numbers::pi_v<float>, 4.0f);
    const IrBool apart = either(x.lo > 0.0f, either(y.lo > 0.0f, y.hi < 0.0f));
    const Range corners = at_corners(y, x);
    const IrBool known = negate(either(may_be_nan(y), may_be_nan(x)));
    return provided(known, Range{select(apart, corners.lo, IrFloat(-pi)),
                                 select(apart, corners.hi, IrFloat(pi))});
  }

  // Within one period in a line, else the whole period.
  Range remainder(const Range& a, const IrFloat& b) const {
    const IrBool same = floor(a.lo / b) == floor(a.hi / b);
    const Range ends = at_ends_with(a, b);
    const IrFloat slack = max(abs(a.lo), abs(a.hi)) * 0x1p-21f;
    const IrBool good =
        both(b > 0.0f, both(slack < IrFloat(num::infinity), b < IrFloat(num::infinity)));
    return provided(good, Range{select(same, max(ends.lo - slack, IrFloat(0.0f)), IrFloat(0.0f)),
                                select(same, min(ends.hi + slack, b), b)});
  }

 private:
  Range at_ends_with(const Range& a, const IrFloat& b) const {
    return widened(around(at(a.lo, b), at(a.hi, b)));
  }
  IrFloat call(const std::vector<ir::Value>& operands) const {
    const std::array types = {ir::Type::f32};
    return {builder_, builder_.emit_multi(ir::Op::call, operands, types, callee_).front()};
  }

  ir::Builder& builder_;
  std::int32_t callee_;
};

}  // namespace

Range bound_math(ir::Builder& builder, const ir::Module& module, std::int32_t callee,
                 const std::vector<Argument>& arguments) {
  const std::string_view name = module.functions[static_cast<std::size_t>(callee)].name;
  const Math math(builder, callee);
  if (arguments.size() == 1) {
    const Range& a = arguments[0].range;
    if (std::ranges::find(monotonic, name) != monotonic.end()) return math.at_ends(a);
    if (name == "sin" || name == "cos") return math.wave(a);
  }
  if (arguments.size() == 2) {
    const Range &a = arguments[0].range, &b = arguments[1].range;
    if (name == "pow") return arguments[1].exact ? math.power(a, b.lo) : math.power(a, b);
    if (name == "hypot") return math.hypotenuse(a, b);
    if (name == "atan2") return math.angle(a, b);
    if (name == "mod" && arguments[1].exact) return math.remainder(a, b.lo);
  }
  return anything<IrFloat>();
}

}  // namespace pse::bounds
