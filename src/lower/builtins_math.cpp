// Builtins from numbers to a number; on vectors they work component by component. Bodies: noise/number.h, noise/math.h.
#include "lower/builtin_table.h"

namespace pse {
namespace {

using Numbers = std::span<const IrFloat>;

IrFloat sign(const IrFloat& a) { return select(a > 0.0f, 1.0f, select(a < 0.0f, -1.0f, a)); }

// A small elementwise entry.
constexpr BuiltinEntry small(std::string_view name, std::string_view parameters, EmitNumber emit, std::string_view doc) {
  return {.builtin = {name, "math", parameters, ResultShape::elementwise, doc, ""}, .number = emit};
}

constexpr BuiltinEntry list[] = {
    small("abs", "a", [](Numbers a) { return abs(a[0]); }, "a without its sign"),
    small("sign", "a", [](Numbers a) { return sign(a[0]); }, "1, -1, or a itself where a is 0 or NaN"),
    small("floor", "a", [](Numbers a) { return floor(a[0]); }, "the largest whole number not above a"),
    small("ceil", "a", [](Numbers a) { return ceil(a[0]); }, "the smallest whole number not below a"),
    small("trunc", "a", [](Numbers a) { return trunc(a[0]); }, "a without its fraction"),
    small("round", "a", [](Numbers a) { return round(a[0]); }, "the nearest whole number, halves to even"),
    small("fract", "a", [](Numbers a) { return a[0] - floor(a[0]); }, "a - floor(a): in [0, 1]"),
    small("min", "a, b", [](Numbers a) { return min(a[0], a[1]); }, "a where a < b, else b"),
    small("max", "a, b", [](Numbers a) { return max(a[0], a[1]); }, "a where a > b, else b"),
    small("fma", "a, b, c", [](Numbers a) { return fma(a[0], a[1], a[2]); }, "a * b + c with one rounding"),
    small("sqrt", "a", [](Numbers a) { return sqrt(a[0]); }, "the square root, correctly rounded; NaN below 0"),
};

}  // namespace

std::span<const BuiltinEntry> math_builtins() { return list; }

}  // namespace pse
