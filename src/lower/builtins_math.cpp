// Builtins from numbers to a number; on vectors they work component by component. Bodies:
// noise/number.h, noise/math.h.
#include "lower/builtin_table.h"
#include "noise/math.h"

namespace pse {
namespace {

using Numbers = std::span<const IrFloat>;

IrFloat sign(const IrFloat& a) { return select(a > 0.0f, 1.0f, select(a < 0.0f, -1.0f, a)); }

// A small elementwise entry.
constexpr BuiltinEntry small(std::string_view name, std::string_view parameters, EmitNumber emit,
                             std::string_view doc) {
  return {.builtin = {name, "math", parameters, ResultShape::elementwise, doc, ""}, .number = emit};
}

// An elementwise entry whose body becomes a function of the module.
constexpr BuiltinEntry large(std::string_view name, std::string_view parameters, EmitNumber emit,
                             std::string_view doc) {
  BuiltinEntry entry = small(name, parameters, emit, doc);
  entry.large = true;
  return entry;
}

constexpr BuiltinEntry math_list[] = {
    small(
        "abs", "a", [](Numbers a) { return abs(a[0]); }, "a without its sign"),
    small(
        "sign", "a", [](Numbers a) { return sign(a[0]); },
        "1, -1, or a itself where a is 0 or NaN"),
    small(
        "floor", "a", [](Numbers a) { return floor(a[0]); },
        "the largest whole number not above a"),
    small(
        "ceil", "a", [](Numbers a) { return ceil(a[0]); }, "the smallest whole number not below a"),
    small(
        "trunc", "a", [](Numbers a) { return trunc(a[0]); }, "a without its fraction"),
    small(
        "round", "a", [](Numbers a) { return round(a[0]); },
        "the nearest whole number, halves to even"),
    small(
        "fract", "a", [](Numbers a) { return a[0] - floor(a[0]); }, "a - floor(a): in [0, 1]"),
    small(
        "min", "a, b", [](Numbers a) { return min(a[0], a[1]); }, "a where a < b, else b"),
    small(
        "max", "a, b", [](Numbers a) { return max(a[0], a[1]); }, "a where a > b, else b"),
    small(
        "fma", "a, b, c", [](Numbers a) { return fma(a[0], a[1], a[2]); },
        "a * b + c with one rounding"),
    small(
        "sqrt", "a", [](Numbers a) { return sqrt(a[0]); },
        "the square root, correctly rounded; NaN below 0"),
    large(
        "sin", "a", [](Numbers a) { return num::sin(a[0]); },
        "the sine of an angle in radians; error below 1.7 ulp, NaN for infinities"),
    large(
        "cos", "a", [](Numbers a) { return num::cos(a[0]); },
        "the cosine of an angle in radians; error below 1.7 ulp, NaN for infinities"),
    large(
        "tan", "a", [](Numbers a) { return num::tan(a[0]); },
        "the tangent of an angle in radians; error below 1.1 ulp, NaN for infinities"),
    large(
        "asin", "a", [](Numbers a) { return num::asin(a[0]); },
        "the angle in [-PI/2, PI/2] with this sine; error below 1.8 ulp, NaN outside [-1, 1]"),
    large(
        "acos", "a", [](Numbers a) { return num::acos(a[0]); },
        "the angle in [0, PI] with this cosine; error below 1.3 ulp, NaN outside [-1, 1]"),
    large(
        "atan", "a", [](Numbers a) { return num::atan(a[0]); },
        "the angle in [-PI/2, PI/2] with this tangent; error below 1.5 ulp"),
    large(
        "atan2", "y, x", [](Numbers a) { return num::atan2(a[0], a[1]); },
        "the angle of the point (x, y) in [-PI, PI]; error below 1.7 ulp"),
    large(
        "sinh", "a", [](Numbers a) { return num::sinh(a[0]); },
        "the hyperbolic sine; error below 1.7 ulp"),
    large(
        "cosh", "a", [](Numbers a) { return num::cosh(a[0]); },
        "the hyperbolic cosine; error below 1.6 ulp"),
    large(
        "tanh", "a", [](Numbers a) { return num::tanh(a[0]); },
        "the hyperbolic tangent, in [-1, 1]; error below 1.5 ulp"),
    large(
        "exp", "a", [](Numbers a) { return num::exp(a[0]); },
        "E to the power a; error below 1.1 ulp"),
    large(
        "exp2", "a", [](Numbers a) { return num::exp2(a[0]); },
        "2 to the power a; error below 1 ulp, exact for whole a"),
    large(
        "expm1", "a", [](Numbers a) { return num::expm1(a[0]); },
        "E to the power a, less 1, precise near 0; error below 1.5 ulp"),
    large(
        "log", "a", [](Numbers a) { return num::log(a[0]); },
        "the natural logarithm; error below 1 ulp, NaN below 0"),
    large(
        "log2", "a", [](Numbers a) { return num::log2(a[0]); },
        "the logarithm to base 2; error below 1.2 ulp, exact for powers of 2, NaN below 0"),
    large(
        "log10", "a", [](Numbers a) { return num::log10(a[0]); },
        "the logarithm to base 10; error below 1.2 ulp, NaN below 0"),
    large(
        "log1p", "a", [](Numbers a) { return num::log1p(a[0]); },
        "the natural logarithm of 1 + a, precise near 0; error below 1.5 ulp, NaN below -1"),
    large(
        "pow", "a, b", [](Numbers a) { return num::pow(a[0], a[1]); },
        "a to the power b; error below 1 ulp near 1 and 8 at the ends of the range, NaN where a < "
        "0 "
        "and b is not whole"),
    large(
        "cbrt", "a", [](Numbers a) { return num::cbrt(a[0]); },
        "the cube root, of negative numbers too; error below 0.8 ulp"),
    large(
        "hypot", "a, b", [](Numbers a) { return num::hypot(a[0], a[1]); },
        "sqrt(a * a + b * b) without overflow on the way; error below 1.3 ulp"),
    small(
        "mod", "a, b", [](Numbers a) { return num::mod(a[0], a[1]); },
        "a - b * floor(a / b), with the sign of b: in [0, b] for b > 0; NaN for b = 0 and for "
        "infinities"),
};

}  // namespace

std::span<const BuiltinEntry> math_builtins() { return math_list; }

}  // namespace pse
