// Ranges hold every result: for operators on values drawn from within the operands' ranges.
#include <gtest/gtest.h>

#include <cmath>

#include "../support/random_ir.h"
#include "ir/evaluate.h"
#include "passes/range.h"

namespace pse::passes {
namespace {

using ir::Op;
using ir::Type;

Type type_of(char letter, Type generic) {
  return letter == 'f'   ? Type::f32
         : letter == 'i' ? Type::i32
         : letter == 'b' ? Type::boolean
                         : generic;
}

ir::Bits random_bits(test::Dice& dice, Type type) {
  if (type == Type::f32) return ir::to_bits(dice.floating());
  if (type == Type::i32) return static_cast<ir::Bits>(dice.integer());
  return static_cast<ir::Bits>(dice.below(2));
}

double number(ir::Bits bits, Type type) {
  if (type == Type::f32) return double{ir::to_f32(bits)};
  return type == Type::i32 ? static_cast<double>(static_cast<std::int32_t>(bits))
                           : static_cast<double>(bits);
}

bool holds(const Range& range, ir::Bits bits, Type type) {
  const double value = number(bits, type);
  return std::isnan(value) ? range.nan : range.contains(value);
}

// The smallest range around a few values.
Range around(const std::vector<ir::Bits>& values, Type type) {
  Range range{INFINITY, -INFINITY, false};
  for (const ir::Bits bits : values) {
    const double value = number(bits, type);
    range.nan = range.nan || std::isnan(value);
    if (std::isnan(value)) continue;
    range.lo = std::min(range.lo, value);
    range.hi = std::max(range.hi, value);
  }
  return range.lo > range.hi ? full_range(type) : range;
}

TEST(Range, HoldsEveryResult) {
  test::Dice dice(7);
  for (int i = 0; i < 200'000; ++i) {
    const auto op =
        static_cast<Op>(static_cast<int>(Op::fadd) +
                        dice.below(static_cast<int>(Op::bits2f) - static_cast<int>(Op::fadd) + 1));
    const std::string_view letters = ir::info(op).operands;
    const Type generic = static_cast<Type>(dice.below(3));
    std::vector<ir::Bits> values[3];
    Range ranges[3];
    for (std::size_t k = 0; k < letters.size(); ++k) {
      const Type type = type_of(letters[k], generic);
      const int count = 1 + dice.below(3);
      for (int n = 0; n < count; ++n) values[k].push_back(random_bits(dice, type));
      ranges[k] = around(values[k], type);
    }
    const Type result = type_of(ir::info(op).results[0], generic);
    const Range range = range_of(op, ranges[0], ranges[1], ranges[2], result);
    const auto operand = [&](std::size_t k) {
      return values[k].empty() ? 0 : dice.pick(values[k]);
    };
    for (int n = 0; n < 4; ++n) {
      const ir::Bits a = operand(0), b = operand(1), c = operand(2);
      const ir::Bits answer = ir::evaluate(op, a, b, c);
      ASSERT_TRUE(holds(range, answer, result))
          << ir::info(op).name << " of " << a << " " << b << " " << c << " gives " << answer
          << ", not within " << range.lo << " .. " << range.hi;
    }
  }
}

TEST(Range, IsAsNarrowAsClampingMakesIt) {
  const Range anything = full_range(Type::f32);
  const Range positive = range_of(Op::fmax, anything, exactly(0), {}, Type::f32);
  EXPECT_EQ(positive, (Range{0, INFINITY, false}));
  EXPECT_EQ(range_of(Op::fmin, positive, exactly(1), {}, Type::f32), (Range{0, 1, false}));
  EXPECT_TRUE(range_of(Op::fmax, exactly(0), anything, {}, Type::f32).nan);
  EXPECT_EQ(range_of(Op::f2i, Range{-2.5, 3.5, false}, {}, {}, Type::i32), (Range{-2, 3, false}));
  EXPECT_EQ(range_of(Op::iadd, Range{2147483647.0, 2147483647.0, false}, exactly(1), {}, Type::i32),
            full_range(Type::i32));
}

}  // namespace
}  // namespace pse::passes
