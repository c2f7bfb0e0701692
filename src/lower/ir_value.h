// Values that write IR: the number types that make the templates of noise/ emit instructions
// instead of computing. An operation appends one instruction of the operator table; one on
// constants alone is computed at once, by the same definitions (noise/number.h), and appends
// nothing. Numbers made from plain constants need no builder of their own.
#pragma once

#include <array>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "ir/builder.h"
#include "noise/number.h"

namespace pse {

// What the three kinds share: either a value in a function, or a constant not yet placed in one.
template <class Constant>
struct IrOperand {
  ir::Builder* builder = nullptr;
  ir::Value value = ir::no_value;
  Constant constant{};

  IrOperand() = default;
  IrOperand(Constant c) : constant(c) {}
  IrOperand(ir::Builder& b, ir::Value v) : builder(&b), value(v) {}
  bool is_constant() const { return builder == nullptr; }
};

inline ir::Value place(ir::Builder& builder, float constant) { return builder.const_f32(constant); }
inline ir::Value place(ir::Builder& builder, num::Int constant) {
  return builder.const_i32(constant.value);
}
inline ir::Value place(ir::Builder& builder, bool constant) { return builder.const_bool(constant); }

// The value of an operand in `builder`'s function.
template <class Constant>
ir::Value place(ir::Builder& builder, const IrOperand<Constant>& operand) {
  return operand.is_constant() ? place(builder, operand.constant) : operand.value;
}

// The first builder that is one; there must be one.
inline ir::Builder& first_builder(std::initializer_list<ir::Builder*> builders) {
  for (ir::Builder* builder : builders) {
    if (builder) return *builder;
  }
  std::unreachable();
}

// One instruction with these operands, in the builder of the first that has one.
template <class Result, class... Operands>
Result ir_emit(ir::Op op, std::int32_t imm, const Operands&... operands) {
  ir::Builder& builder = first_builder({operands.builder...});
  return Result(builder, builder.emit(op, {place(builder, operands)...}, imm));
}

// The result of `compute` on the constants where all operands are constants, else the instruction.
template <class Result, class Compute, class... Operands>
Result ir_apply(ir::Op op, const Compute& compute, const Operands&... operands) {
  if ((operands.is_constant() && ...)) return Result(compute(operands.constant...));
  return ir_emit<Result>(op, 0, operands...);
}

struct IrBool : IrOperand<bool> {
  using IrOperand::IrOperand;
  friend IrBool both(const IrBool& a, const IrBool& b) {
    return ir_apply<IrBool>(
        ir::Op::band, [](bool p, bool q) { return p && q; }, a, b);
  }
  friend IrBool either(const IrBool& a, const IrBool& b) {
    return ir_apply<IrBool>(
        ir::Op::bor, [](bool p, bool q) { return p || q; }, a, b);
  }
  friend IrBool negate(const IrBool& a) {
    return ir_apply<IrBool>(
        ir::Op::bnot, [](bool p) { return !p; }, a);
  }
};

struct IrInt : IrOperand<num::Int> {
  using IrOperand::IrOperand;
  IrInt(std::int32_t c) : IrOperand(num::Int(c)) {}

  friend IrInt operator+(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::iadd, [](num::Int p, num::Int q) { return p + q; }, a, b);
  }
  friend IrInt operator-(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::isub, [](num::Int p, num::Int q) { return p - q; }, a, b);
  }
  friend IrInt operator*(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::imul, [](num::Int p, num::Int q) { return p * q; }, a, b);
  }
  friend IrInt operator&(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::iand, [](num::Int p, num::Int q) { return p & q; }, a, b);
  }
  friend IrInt operator|(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::ior, [](num::Int p, num::Int q) { return p | q; }, a, b);
  }
  friend IrInt operator^(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::ixor, [](num::Int p, num::Int q) { return p ^ q; }, a, b);
  }
  friend IrInt operator<<(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::ishl, [](num::Int p, num::Int q) { return p << q; }, a, b);
  }
  friend IrInt operator>>(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::ishr, [](num::Int p, num::Int q) { return p >> q; }, a, b);
  }
  friend IrInt sar(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::isar, [](num::Int p, num::Int q) { return sar(p, q); }, a, b);
  }
  friend IrBool operator==(const IrInt& a, const IrInt& b) {
    return ir_apply<IrBool>(
        ir::Op::ieq, [](num::Int p, num::Int q) { return p == q; }, a, b);
  }
  friend IrBool operator!=(const IrInt& a, const IrInt& b) {
    return ir_apply<IrBool>(
        ir::Op::ine, [](num::Int p, num::Int q) { return p != q; }, a, b);
  }
  friend IrBool operator<(const IrInt& a, const IrInt& b) {
    return ir_apply<IrBool>(
        ir::Op::ilt, [](num::Int p, num::Int q) { return p < q; }, a, b);
  }
  friend IrInt bytes_add(const IrInt& a, const IrInt& b) {
    return ir_apply<IrInt>(
        ir::Op::bytes_add, [](num::Int p, num::Int q) { return num::bytes_add(p, q); }, a, b);
  }
  friend IrInt select(const IrBool& condition, const IrInt& yes, const IrInt& no) {
    return ir_apply<IrInt>(
        ir::Op::select, [](bool c, num::Int p, num::Int q) { return c ? p : q; }, condition, yes,
        no);
  }
};

struct IrFloat : IrOperand<float> {
  using IrOperand::IrOperand;
  // Whether this is the constant 1, by which nothing is ever multiplied: the product would be the
  // same number.
  bool is_one() const { return is_constant() && constant == 1.0f; }

  friend IrFloat operator+(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrFloat>(
        ir::Op::fadd, [](float p, float q) { return p + q; }, a, b);
  }
  friend IrFloat operator-(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrFloat>(
        ir::Op::fsub, [](float p, float q) { return p - q; }, a, b);
  }
  friend IrFloat operator*(const IrFloat& a, const IrFloat& b) {
    if (a.is_one()) return b;
    if (b.is_one()) return a;
    return ir_apply<IrFloat>(
        ir::Op::fmul, [](float p, float q) { return p * q; }, a, b);
  }
  friend IrFloat operator/(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrFloat>(
        ir::Op::fdiv, [](float p, float q) { return p / q; }, a, b);
  }
  friend IrFloat fma(const IrFloat& a, const IrFloat& b, const IrFloat& c) {
    if (a.is_one()) return b + c;
    if (b.is_one()) return a + c;
    return ir_apply<IrFloat>(
        ir::Op::fma, [](float p, float q, float r) { return num::fma(p, q, r); }, a, b, c);
  }
  friend IrFloat operator-(const IrFloat& a) {
    return ir_apply<IrFloat>(
        ir::Op::fneg, [](float p) { return -p; }, a);
  }
  friend IrFloat abs(const IrFloat& a) {
    return ir_apply<IrFloat>(
        ir::Op::fabs, [](float p) { return num::abs(p); }, a);
  }
  friend IrFloat sqrt(const IrFloat& a) {
    return ir_apply<IrFloat>(
        ir::Op::fsqrt, [](float p) { return num::sqrt(p); }, a);
  }
  friend IrFloat min(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrFloat>(
        ir::Op::fmin, [](float p, float q) { return num::min(p, q); }, a, b);
  }
  friend IrFloat max(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrFloat>(
        ir::Op::fmax, [](float p, float q) { return num::max(p, q); }, a, b);
  }
  friend IrFloat floor(const IrFloat& a) {
    return ir_apply<IrFloat>(
        ir::Op::ffloor, [](float p) { return num::floor(p); }, a);
  }
  friend IrFloat ceil(const IrFloat& a) {
    return ir_apply<IrFloat>(
        ir::Op::fceil, [](float p) { return num::ceil(p); }, a);
  }
  friend IrFloat trunc(const IrFloat& a) {
    return ir_apply<IrFloat>(
        ir::Op::ftrunc, [](float p) { return num::trunc(p); }, a);
  }
  friend IrFloat round(const IrFloat& a) {
    return ir_apply<IrFloat>(
        ir::Op::fround, [](float p) { return num::round(p); }, a);
  }

  friend IrBool operator==(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrBool>(
        ir::Op::feq, [](float p, float q) { return p == q; }, a, b);
  }
  friend IrBool operator!=(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrBool>(
        ir::Op::fne, [](float p, float q) { return p != q; }, a, b);
  }
  friend IrBool operator<(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrBool>(
        ir::Op::flt, [](float p, float q) { return p < q; }, a, b);
  }
  friend IrBool operator<=(const IrFloat& a, const IrFloat& b) {
    return ir_apply<IrBool>(
        ir::Op::fle, [](float p, float q) { return p <= q; }, a, b);
  }
  friend IrBool operator>(const IrFloat& a, const IrFloat& b) { return b < a; }
  friend IrBool operator>=(const IrFloat& a, const IrFloat& b) { return b <= a; }

  friend IrFloat select(const IrBool& condition, const IrFloat& yes, const IrFloat& no) {
    return ir_apply<IrFloat>(
        ir::Op::select, [](bool c, float p, float q) { return c ? p : q; }, condition, yes, no);
  }
  friend IrInt to_int(const IrFloat& a) {
    return ir_apply<IrInt>(
        ir::Op::f2i, [](float p) { return num::to_int(p); }, a);
  }
  friend IrFloat to_float(const IrInt& a) {
    return ir_apply<IrFloat>(
        ir::Op::i2f, [](num::Int p) { return num::to_float(p); }, a);
  }
  friend IrInt bits(const IrFloat& a) {
    return ir_apply<IrInt>(
        ir::Op::f2bits, [](float p) { return num::bits(p); }, a);
  }
  friend IrFloat from_bits(const IrInt& a) {
    return ir_apply<IrFloat>(
        ir::Op::bits2f, [](num::Int p) { return num::from_bits(p); }, a);
  }
};

// to_float and from_bits take an IrInt only, so that lookup by argument finds them from there.
inline IrFloat to_float(const IrInt& a);
inline IrFloat from_bits(const IrInt& a);

// The index of a module's table of this name, added on first use.
template <class Tables, class Table>
std::int32_t table_index(Tables& tables, const Table& table) {
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (tables[i].name == table.name) return static_cast<std::int32_t>(i);
  }
  tables.push_back({std::string(table.name), {table.entries.begin(), table.entries.end()}});
  return static_cast<std::int32_t>(tables.size() - 1);
}

inline IrFloat lookup(const num::FloatTable& table, const IrInt& index) {
  if (index.is_constant()) return num::lookup(table, index.constant);
  return ir_emit<IrFloat>(ir::Op::table_f32,
                          table_index(index.builder->module().float_tables, table), index);
}
inline IrInt lookup(const num::IntTable& table, const IrInt& index) {
  if (index.is_constant()) return num::lookup(table, index.constant);
  return ir_emit<IrInt>(ir::Op::table_i32, table_index(index.builder->module().int_tables, table),
                        index);
}
inline IrInt lookup(const num::ByteTable& table, const IrInt& a) {
  if (a.is_constant()) return num::lookup(table, a.constant);
  return ir_emit<IrInt>(ir::Op::bytes_lookup, table_index(a.builder->module().byte_tables, table),
                        a);
}

// A conditional with both sides as regions. See num::choose.
template <std::size_t Count, class Then, class Else>
std::array<IrFloat, Count> choose(const IrBool& condition, const Then& then_side,
                                  const Else& else_side) {
  if (condition.is_constant()) return condition.constant ? then_side() : else_side();
  ir::Builder& builder = *condition.builder;
  // Fill one region with what a side writes.
  const auto fill = [&builder](const auto& side) {
    ir::Region region;
    builder.begin_region(region);
    for (const IrFloat& result : std::array<IrFloat, Count>(side())) {
      region.yields.push_back(place(builder, result));
    }
    builder.end_region();
    return region;
  };
  ir::Region then_region = fill(then_side);
  ir::Region else_region = fill(else_side);
  const std::vector<ir::Value> results =
      builder.emit_if(condition.value, std::move(then_region), std::move(else_region));
  return [&]<std::size_t... I>(std::index_sequence<I...>) {
    return std::array<IrFloat, Count>{IrFloat(builder, results[I])...};
  }
  (std::make_index_sequence<Count>());
}

namespace num {
template <>
struct Kinds<IrFloat> {
  using Integer = IrInt;
  using Truth = IrBool;
  using Base = IrFloat;
};
}  // namespace num
}  // namespace pse
