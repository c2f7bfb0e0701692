// Arrays, calls of the host, outputs: what reaches beyond the frame.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "codegen/first/function_code.h"
#include "codegen/kernel_call.h"
#include "ir/evaluate.h"

namespace pse::first {
namespace {

using Row = std::array<std::int32_t, lanes>;

bool active(const Row* mask, std::size_t lane) { return mask == nullptr || (*mask)[lane] != 0; }

// Sets one component of one element for each active lane whose index is inside. `cells`: of element
// 0; elements are `stride` floats apart.
void store_elements(float* cells, const Row* index, const float* values, const Row* mask,
                    std::int32_t capacity, std::int32_t stride) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const std::int32_t element = (*index)[lane];
    if (!active(mask, lane) || element < 0 || element >= capacity) continue;
    cells[std::ptrdiff_t{element} * stride + static_cast<std::ptrdiff_t>(lane)] = values[lane];
  }
}

// Sets the lengths of active lanes; elements that come into being are 0.
void resize_array(float* elements, Row* lengths, const Row* wanted, const Row* mask,
                  std::int32_t capacity, std::int32_t components) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if (!active(mask, lane)) continue;
    const std::int32_t length = std::clamp((*wanted)[lane], 0, capacity);
    float* cell = elements + static_cast<std::ptrdiff_t>(lane);
    for (std::int32_t i = (*lengths)[lane] * components; i < length * components; ++i)
      cell[std::ptrdiff_t{i} * lanes] = 0;
    (*lengths)[lane] = length;
  }
}

// `block`: rows of arguments, then rows for the results.
void call_external(const KernelCall* call, std::int64_t external, const Row* mask, float* block,
                   std::int64_t arguments, std::int64_t results) {
  std::uint64_t bits = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane)
    bits |= std::uint64_t{active(mask, lane)} << lane;
  std::vector<const float*> in;
  std::vector<float*> out;
  for (std::int64_t i = 0; i < arguments; ++i) in.push_back(block + lanes * i);
  for (std::int64_t i = 0; i < results; ++i) out.push_back(block + lanes * (arguments + i));
  const ExternalFunction& function = call->externals[external];
  call->call_active(function.call, function.user, bits, lanes, arguments, in.data(), results,
                    out.data());
}

}  // namespace

// At places that are reached from several others, and behind calls.
void FunctionCode::forget_registers() {
  places_.forget_registers();
  in_common_index_ = ir::no_value;
}

// What a C++ function overwrites is in no register afterwards.
template <class F>
void FunctionCode::call_host(F* function) {
  code_.zero_upper();
  code_.set64(Gpr::rax, std::bit_cast<std::uint64_t>(function));
  code_.call(Gpr::rax);
}

void FunctionCode::mask_address(Gpr to) {
  if (mask_) {
    code_.address(to, *mask_);
  } else {
    code_.set32(to, 0);
  }
}

// Where a component of element 0 stands, lane 0.
void FunctionCode::array_address(Gpr to, const ir::Instruction& in, std::int32_t component) {
  const std::int64_t cell =
      kernel_.sample_arrays.offset[static_cast<std::size_t>(in.imm)] + component * lanes;
  code_.load(to, {call_base, offsetof(KernelCall, scratch)});
  code_.add(to, static_cast<std::int32_t>(4 * cell));
}

// Values into the first rows of the block; nothing is in a register afterwards.
void FunctionCode::to_block(std::span<const ir::Value> values) {
  std::int32_t row = kernel_.call_block;
  for (const ir::Value value : values) {
    code_.store({Places::frame, row}, places_.in_register(value));
    places_.unpin();
    row += row_size;
  }
  places_.release_operands();
  places_.store_all();
  forget_registers();
}

void FunctionCode::from_rows(std::span<const ir::Value> values, std::int32_t row) {
  for (const ir::Value value : values) {
    code_.load(places_.define(value), {Places::frame, row});
    places_.unpin();
    row += row_size;
  }
}

// ---- Arrays ----

bool FunctionCode::is_sample_array(const ir::Instruction& in) const {
  return array_of(in).rate == ir::Rate::sample;
}

// Each sample starts with its arrays as declared.
void FunctionCode::begin_arrays() {
  for (std::size_t i = 0; i < function_.arrays.size(); ++i) {
    const ir::Array& array = function_.arrays[i];
    if (array.rate != ir::Rate::sample) continue;
    const Ymm length = places_.temporary();
    code_.load(length, all(static_cast<std::uint32_t>(array.initial_length)));
    code_.store({Places::frame, kernel_.lengths[i]}, length);
    places_.unpin();
    if (array.initial_length == 0) continue;
    code_.load(Gpr::rdi, {call_base, offsetof(KernelCall, scratch)});
    code_.add(Gpr::rdi, static_cast<std::int32_t>(4 * kernel_.sample_arrays.offset[i]));
    code_.set32(Gpr::rcx, array.initial_length * array.components * lanes);
    code_.set32(Gpr::rax, 0);
    code_.fill_dwords();
  }
}

// Puts the index that all active lanes have into a general register, unless it is there already.
void FunctionCode::find_common_index(ir::Value index) {
  if (std::exchange(in_common_index_, index) == index) return;
  code_.store({Places::frame, kernel_.call_block}, places_.in_register(index));
  if (!mask_) return code_.load32(common_index, {Places::frame, kernel_.call_block});
  const Ymm active = places_.temporary();
  code_.load(active, *mask_);
  code_.mask_bits(Gpr::rax, active);
  code_.lowest_bit(Gpr::rax, Gpr::rax);
  code_.load32(common_index, {Places::frame, kernel_.call_block, static_cast<int>(Gpr::rax)});
}

// One element of an array of the frame, for all lanes.
void FunctionCode::array_load_common(const ir::Instruction& in) {
  find_common_index(in.operands[0]);
  const Ymm to = places_.define(in.result());
  Label outside;
  code_.vector(op::xor_ps, to, to, to);
  code_.load(Gpr::rax, {call_base, offsetof(KernelCall, frame_lengths)});
  code_.compare32(common_index, {Gpr::rax, 4 * in.imm});
  code_.jump(Assembler::When::not_below, outside);
  code_.load(Gpr::rax, {call_base, offsetof(KernelCall, frame_arrays)});
  const std::int64_t plane =
      kernel_.frame_arrays.plane(function_.arrays, static_cast<std::size_t>(in.imm), in.component);
  code_.vector(
      op::broadcast, to, 0,
      Memory{Gpr::rax, static_cast<std::int32_t>(4 * plane), static_cast<int>(common_index)});
  code_.bind(outside);
}

// A gather of the lanes whose index is inside; 0 elsewhere.
void FunctionCode::array_load(const ir::Instruction& in) {
  if (!is_sample_array(in) && uniformity_ && !uniformity_->varying[in.operands[0]])
    return array_load_common(in);
  const auto index = static_cast<std::size_t>(in.imm);
  const Ymm element = places_.in_register(in.operands[0]);
  const Ymm inside = places_.temporary(), cell = places_.temporary();
  Memory from{Gpr::rax, 0, cell};
  if (is_sample_array(in)) {
    code_.load(inside, {Places::frame, kernel_.lengths[index]});
  } else {
    code_.load(Gpr::rax, {call_base, offsetof(KernelCall, frame_lengths)});
    code_.vector(op::broadcast, inside, 0, Memory{Gpr::rax, 4 * in.imm});
  }
  code_.vector(op::greater_d, inside, inside, element);
  code_.vector(op::greater_d, cell, element, all(0xffffffffu));
  code_.vector(op::and_ps, inside, inside, cell);
  if (is_sample_array(in)) {
    const auto stride = static_cast<std::uint32_t>(array_of(in).components * lanes);
    code_.vector(op::mul_d, cell, element, all(stride));
    code_.vector(op::add_d, cell, cell, kernel_.constants.lane_numbers());
    array_address(Gpr::rax, in, in.component);
  } else {
    code_.move(cell, element);
    code_.load(Gpr::rax, {call_base, offsetof(KernelCall, frame_arrays)});
    from.disp = static_cast<std::int32_t>(
        4 * kernel_.frame_arrays.plane(function_.arrays, index, in.component));
  }
  const Ymm to = places_.define(in.result());
  code_.vector(op::xor_ps, to, to, to);
  code_.gather(to, from, inside);
}

void FunctionCode::array_length(const ir::Instruction& in) {
  const Ymm to = places_.define(in.result());
  if (is_sample_array(in))
    return code_.load(to, {Places::frame, kernel_.lengths[static_cast<std::size_t>(in.imm)]});
  code_.load(Gpr::rax, {call_base, offsetof(KernelCall, frame_lengths)});
  code_.vector(op::broadcast, to, 0, Memory{Gpr::rax, 4 * in.imm});
}

void FunctionCode::array_store(const ir::Instruction& in) {
  if (!is_sample_array(in)) {
    kernel_.refused = "an array of the frame that samples write";
    return;
  }
  if (const auto row = places_.constant_row(in.operands[0]); row >= 0)
    return array_store_at(in, static_cast<std::int32_t>(kernel_.constants.first_of(row)));
  to_block(in.operands);
  array_address(Gpr::rdi, in, in.component);
  code_.address(Gpr::rsi, {Places::frame, kernel_.call_block});
  code_.address(Gpr::rdx, {Places::frame, kernel_.call_block + row_size});
  mask_address(Gpr::rcx);
  code_.set32(Gpr::r8, array_of(in).capacity);
  code_.set32(Gpr::r9, array_of(in).components * lanes);
  call_host(&store_elements);
}

// All lanes store to the same element: a row.
void FunctionCode::array_store_at(const ir::Instruction& in, std::int32_t element) {
  if (element < 0 || element >= array_of(in).capacity) return;
  const Ymm value = places_.in_register(in.operands[1]);
  array_address(Gpr::rax, in, element * array_of(in).components + in.component);
  const Memory cells{Gpr::rax};
  if (!mask_) return code_.store(cells, value);
  const Ymm chosen = places_.temporary(), kept = places_.temporary();
  code_.load(chosen, *mask_);
  code_.load(kept, cells);
  code_.blend(kept, kept, value, chosen);
  code_.store(cells, kept);
}

void FunctionCode::array_resize(const ir::Instruction& in) {
  if (!is_sample_array(in)) {
    kernel_.refused = "an array of the frame that samples write";
    return;
  }
  to_block(in.operands);
  array_address(Gpr::rdi, in, 0);
  code_.address(Gpr::rsi, {Places::frame, kernel_.lengths[static_cast<std::size_t>(in.imm)]});
  code_.address(Gpr::rdx, {Places::frame, kernel_.call_block});
  mask_address(Gpr::rcx);
  code_.set32(Gpr::r8, array_of(in).capacity);
  code_.set32(Gpr::r9, array_of(in).components);
  call_host(&resize_array);
}

// ---- The host ----

void FunctionCode::external(const ir::Instruction& in) {
  to_block(in.operands);
  code_.move(Gpr::rdi, call_base);
  code_.set32(Gpr::rsi, in.imm);
  mask_address(Gpr::rdx);
  code_.address(Gpr::rcx, {Places::frame, kernel_.call_block});
  code_.set32(Gpr::r8, static_cast<std::int32_t>(in.operands.size()));
  code_.set32(Gpr::r9, static_cast<std::int32_t>(in.results.size()));
  call_host(&call_external);
  from_rows(in.results,
            kernel_.call_block + row_size * static_cast<std::int32_t>(in.operands.size()));
}

// Outputs have one NaN.
void FunctionCode::outputs() {
  constexpr int unordered = 3;
  code_.load(Gpr::rcx, {call_base, offsetof(KernelCall, outputs)});
  std::int32_t output = 0;
  for (const ir::Value value : function_.body.yields) {
    const Ymm from = places_.in_register(value);
    const Ymm is_nan = places_.temporary(), to = places_.temporary();
    code_.vector(op::compare_ps, is_nan, from, from, unordered);
    code_.blend(to, from, all(ir::nan_bits), is_nan);
    code_.load(Gpr::rax, {Gpr::rcx, 8 * output++});
    code_.store({Gpr::rax, 0, static_cast<int>(sample_index)}, to);
    places_.unpin();
  }
  places_.end_step();
}

// ---- Whole functions ----

void FunctionCode::write_samples() {
  const auto of_frame = [](const ir::Array& array) { return array.rate != ir::Rate::sample; };
  if (std::ranges::any_of(function_.arrays, of_frame))
    uniformity_ = find_uniformity(kernel_.split.module, function_, {});
  begin_arrays();
  region(function_.body);
  outputs();
  kernel_.frame_size = places_.frame_end();
}

void FunctionCode::write_called(Callee& callee) {
  // The stack as the host's functions want it.
  code_.bind(callee.entry);
  code_.add(Gpr::rsp, -8);
  mask_ = Memory{Places::frame, callee.mask};
  std::int32_t row = callee.params;
  for (const ir::Value param : function_.body.params) {
    places_.set_row(param, {Places::frame, row}, false);
    row += row_size;
  }
  region(function_.body);
  row = callee.results;
  for (const ir::Value value : function_.body.yields) {
    code_.store({Places::frame, row}, places_.in_register(value));
    places_.unpin();
    row += row_size;
  }
  places_.end_step();
  code_.add(Gpr::rsp, 8);
  code_.ret();
  kernel_.frame_size = places_.frame_end();
}

}  // namespace pse::first
