// Appending instructions and giving their results types.
#include "ir/builder.h"

#include <bit>

namespace pse::ir {
namespace {

Type type_of_letter(char letter) {
  return letter == 'f' ? Type::f32 : letter == 'i' ? Type::i32 : Type::boolean;
}

}  // namespace

Value Builder::append(Instruction instruction, std::span<const Type> types) {
  instruction.span = span_;
  for (const Type type : types) instruction.results.push_back(function_->add_value(type));
  const Value first = instruction.results.empty() ? no_value : instruction.results.front();
  regions_.back()->body.push_back(std::move(instruction));
  ++emitted_;
  return first;
}

Value Builder::const_f32(float value) {
  const Type type = Type::f32;
  return append({.op = Op::const_f32, .imm = std::bit_cast<std::int32_t>(value)}, {&type, 1});
}

Value Builder::const_i32(std::int32_t value) {
  const Type type = Type::i32;
  return append({.op = Op::const_i32, .imm = value}, {&type, 1});
}

Value Builder::const_bool(bool value) {
  const Type type = Type::boolean;
  return append({.op = Op::const_bool, .imm = value ? 1 : 0}, {&type, 1});
}

Value Builder::emit(Op op, std::initializer_list<Value> operands, std::int32_t imm,
                    std::int32_t component) {
  // `T` in the operator table stands for the type of the last operand.
  const char letter = info(op).results.front();
  const Type result = letter == 'T' ? type(*(operands.end() - 1)) : type_of_letter(letter);
  return append({.op = op, .operands = operands, .imm = imm, .component = component}, {&result, 1});
}

void Builder::emit_void(Op op, std::initializer_list<Value> operands, std::int32_t imm,
                        std::int32_t component) {
  append({.op = op, .operands = operands, .imm = imm, .component = component}, {});
}

std::vector<Value> Builder::emit_multi(Op op, std::span<const Value> operands,
                                       std::span<const Type> result_types, std::int32_t imm) {
  append({.op = op, .operands = {operands.begin(), operands.end()}, .imm = imm}, result_types);
  return regions_.back()->body.back().results;
}

std::vector<Value> Builder::emit_like(const Instruction& original, std::span<const Value> operands,
                                      std::span<const Type> result_types) {
  append({.op = original.op,
          .operands = {operands.begin(), operands.end()},
          .imm = original.imm,
          .component = original.component},
         result_types);
  return regions_.back()->body.back().results;
}

Value Builder::add_param(Region& region, Type type) {
  region.params.push_back(function_->add_value(type));
  return region.params.back();
}

std::vector<Value> Builder::emit_if(Value condition, Region then_region, Region else_region) {
  std::vector<Type> types;
  for (const Value value : then_region.yields) types.push_back(type(value));
  Instruction instruction{.op = Op::if_, .operands = {condition}};
  instruction.regions.push_back(std::move(then_region));
  instruction.regions.push_back(std::move(else_region));
  append(std::move(instruction), types);
  return regions_.back()->body.back().results;
}

std::vector<Value> Builder::emit_loop(std::span<const Value> initial, Region head, Region body) {
  std::vector<Type> types;
  for (const Value value : initial) types.push_back(type(value));
  Instruction instruction{.op = Op::loop, .operands = {initial.begin(), initial.end()}};
  instruction.regions.push_back(std::move(head));
  instruction.regions.push_back(std::move(body));
  append(std::move(instruction), types);
  return regions_.back()->body.back().results;
}

}  // namespace pse::ir
