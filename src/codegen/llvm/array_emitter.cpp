// Arrays: those of rate sample live in scratch memory lane by lane, those of rate frame are shared
// planes. Indices count from 0 here. A load outside [0, length) gives 0, a store outside [0,
// capacity) does nothing.
#include <cstddef>

#include "codegen/kernel_call.h"
#include "codegen/llvm/emitter.h"

namespace pse {

bool FunctionEmitter::is_sample_array(std::int32_t array) const {
  return function_.arrays[static_cast<std::size_t>(array)].rate == ir::Rate::sample;
}

// Lanes of the array's length.
unsigned FunctionEmitter::row_lanes(std::int32_t array) const {
  return uniformity_.varying_length[static_cast<std::size_t>(array)] ? lanes_ : 1;
}

void FunctionEmitter::declare_arrays() {
  for (std::size_t i = 0; i < function_.arrays.size(); ++i) {
    ArrayState state;
    const auto index = static_cast<std::int32_t>(i);
    if (is_sample_array(index)) state.length = stack_slot(lanes_type(i32_, row_lanes(index)));
    arrays_.push_back(state);
  }
}

// Each sample starts with its arrays as declared.
void FunctionEmitter::clear_arrays() {
  for (std::size_t i = 0; i < function_.arrays.size(); ++i) {
    const auto index = static_cast<std::int32_t>(i);
    if (!is_sample_array(index)) continue;
    llvm::Constant* length =
        b_.getInt32(static_cast<std::uint32_t>(function_.arrays[i].initial_length));
    const unsigned lanes = row_lanes(index);
    if (lanes > 1)
      length = llvm::ConstantVector::getSplat(llvm::ElementCount::getFixed(lanes), length);
    b_.CreateStore(length, arrays_[i].length);
    if (function_.arrays[i].initial_length > 0) {
      clear_elements(index, b_.getInt32(0),
                     b_.getInt32(static_cast<std::uint32_t>(function_.arrays[i].initial_length)),
                     nullptr, nullptr);
    }
  }
}

llvm::Value* FunctionEmitter::load_length(std::int32_t array) {
  const auto index = static_cast<std::size_t>(array);
  if (is_sample_array(array))
    return b_.CreateLoad(lanes_type(i32_, row_lanes(array)), arrays_[index].length);
  llvm::Value* lengths = call_field(offsetof(KernelCall, frame_lengths), ptr_);
  return b_.CreateLoad(i32_, b_.CreateConstInBoundsGEP1_64(i32_, lengths, index));
}

void FunctionEmitter::store_length(std::int32_t array, llvm::Value* length) {
  const auto index = static_cast<std::size_t>(array);
  if (is_sample_array(array)) {
    b_.CreateStore(length, arrays_[index].length);
    return;
  }
  llvm::Value* lengths = call_field(offsetof(KernelCall, frame_lengths), ptr_);
  b_.CreateStore(length, b_.CreateConstInBoundsGEP1_64(i32_, lengths, index));
}

// The lanes of one element: `element` is a scalar in [0, capacity].
llvm::Value* FunctionEmitter::sample_row(std::int32_t array, llvm::Value* element,
                                         std::int32_t component) {
  const auto index = static_cast<std::size_t>(array);
  const std::int64_t components = function_.arrays[index].components;
  llvm::Value* row = b_.CreateMul(b_.CreateZExt(element, i64_),
                                  b_.getInt64(static_cast<std::uint64_t>(components * lanes_)));
  const std::int64_t start = sample_layout_.offset[index] + std::int64_t{component} * lanes_;
  row = b_.CreateAdd(row, b_.getInt64(static_cast<std::uint64_t>(start)));
  return b_.CreateInBoundsGEP(f32_, call_field(offsetof(KernelCall, scratch), ptr_), row);
}

// One cell for each lane: `elements` is a vector with values in [0, capacity].
llvm::Value* FunctionEmitter::sample_cells(std::int32_t array, llvm::Value* elements,
                                           std::int32_t component) {
  const auto index = static_cast<std::size_t>(array);
  const std::int64_t components = function_.arrays[index].components;
  llvm::SmallVector<llvm::Constant*, 16> lane_numbers;
  for (unsigned i = 0; i < lanes_; ++i) lane_numbers.push_back(b_.getInt32(i));
  llvm::Value* cell =
      b_.CreateMul(elements, splat(b_.getInt32(static_cast<std::uint32_t>(components * lanes_))));
  cell = b_.CreateAdd(cell, llvm::ConstantVector::get(lane_numbers));
  const std::int64_t start = sample_layout_.offset[index] + std::int64_t{component} * lanes_;
  llvm::Value* scratch = call_field(offsetof(KernelCall, scratch), ptr_);
  return b_.CreateInBoundsGEP(
      f32_, b_.CreateConstInBoundsGEP1_64(f32_, scratch, static_cast<std::uint64_t>(start)), cell);
}

llvm::Value* FunctionEmitter::frame_cells(std::int32_t array, llvm::Value* element,
                                          std::int32_t component) {
  const std::int64_t plane =
      frame_layout_.plane(function_.arrays, static_cast<std::size_t>(array), component);
  llvm::Value* arrays = call_field(offsetof(KernelCall, frame_arrays), ptr_);
  llvm::Value* start =
      b_.CreateConstInBoundsGEP1_64(f32_, arrays, static_cast<std::uint64_t>(plane));
  return b_.CreateInBoundsGEP(f32_, start, element);
}

llvm::Value* FunctionEmitter::emit_array_load(const ir::Instruction& in) {
  const bool sample = is_sample_array(in.imm), wide = varying(in.result());
  llvm::Value* index = get(in.operands[0]);
  llvm::Value* length = load_length(in.imm);
  const unsigned index_lanes = std::max(lanes_of(index), lanes_of(length));
  llvm::Value* inside = index_lanes > 1
                            ? b_.CreateICmpULT(get_as(in.operands[0], true),
                                               lanes_of(length) > 1 ? length : splat(length))
                            : b_.CreateICmpULT(index, length);

  llvm::Value* value;
  if (lanes_of(index) > 1) {
    llvm::Value* safe =
        b_.CreateSelect(inside, index, llvm::Constant::getNullValue(index->getType()));
    llvm::Value* cells =
        sample ? sample_cells(in.imm, safe, in.component) : frame_cells(in.imm, safe, in.component);
    value = b_.CreateMaskedGather(lanes_type(f32_, lanes_), cells, llvm::Align(4), inside,
                                  llvm::Constant::getNullValue(lanes_type(f32_, lanes_)));
    return value;
  }
  // The same element for all lanes: one row, or one number.
  const auto capacity =
      static_cast<std::uint32_t>(function_.arrays[static_cast<std::size_t>(in.imm)].capacity);
  if (sample) {
    llvm::Value* exists = b_.CreateICmpULT(index, b_.getInt32(capacity));
    llvm::Value* row =
        sample_row(in.imm, b_.CreateSelect(exists, index, b_.getInt32(capacity)), in.component);
    value = b_.CreateAlignedLoad(lanes_type(f32_, lanes_), row, llvm::Align(4));
    return b_.CreateSelect(inside, value, llvm::Constant::getNullValue(value->getType()));
  }
  // A frame array may be empty: no address is read that is not inside.
  llvm::BasicBlock *before = b_.GetInsertBlock(), *read = new_block("read"),
                   *after = new_block("after_read");
  b_.CreateCondBr(inside, read, after);
  b_.SetInsertPoint(read);
  value = b_.CreateLoad(f32_, frame_cells(in.imm, b_.CreateZExt(index, i64_), in.component));
  b_.CreateBr(after);
  b_.SetInsertPoint(after);
  llvm::PHINode* result = b_.CreatePHI(f32_, 2);
  result->addIncoming(value, read);
  result->addIncoming(llvm::ConstantFP::get(f32_, 0), before);
  return wide && lanes_ > 1 ? splat(result) : result;
}

void FunctionEmitter::emit_array_store(const ir::Instruction& in) {
  const auto capacity =
      static_cast<std::uint32_t>(function_.arrays[static_cast<std::size_t>(in.imm)].capacity);
  llvm::Value* index = get(in.operands[0]);
  if (!is_sample_array(in.imm)) {
    // Only the frame function does this, one value at a time.
    llvm::BasicBlock *write = new_block("write"), *after = new_block("after_write");
    b_.CreateCondBr(b_.CreateICmpULT(index, b_.getInt32(capacity)), write, after);
    b_.SetInsertPoint(write);
    b_.CreateStore(get(in.operands[1]),
                   frame_cells(in.imm, b_.CreateZExt(index, i64_), in.component));
    b_.CreateBr(after);
    b_.SetInsertPoint(after);
    return;
  }
  llvm::Value* value = get_as(in.operands[1], lanes_ > 1);
  if (lanes_of(index) > 1) {
    llvm::Value* mask = b_.CreateICmpULT(index, splat(b_.getInt32(capacity)));
    b_.CreateMaskedScatter(value, sample_cells(in.imm, index, in.component), llvm::Align(4),
                           and_masks(mask_, mask));
    return;
  }
  // One row; outside the array it is the spare row at the end.
  llvm::Value* inside = b_.CreateICmpULT(index, b_.getInt32(capacity));
  llvm::Value* row =
      sample_row(in.imm, b_.CreateSelect(inside, index, b_.getInt32(capacity)), in.component);
  if (mask_)
    value =
        b_.CreateSelect(mask_, value, b_.CreateAlignedLoad(value->getType(), row, llvm::Align(4)));
  b_.CreateAlignedStore(value, row, llvm::Align(4));
}

void FunctionEmitter::emit_array_resize(const ir::Instruction& in) {
  const auto capacity =
      static_cast<std::uint32_t>(function_.arrays[static_cast<std::size_t>(in.imm)].capacity);
  const bool wide = row_lanes(in.imm) > 1;
  llvm::Value* wanted = get_as(in.operands[0], wide);
  llvm::Value* limit = llvm::ConstantInt::get(wanted->getType(), capacity);
  llvm::Value* none = llvm::Constant::getNullValue(wanted->getType());
  llvm::Value* length = b_.CreateBinaryIntrinsic(
      llvm::Intrinsic::smax, none, b_.CreateBinaryIntrinsic(llvm::Intrinsic::smin, wanted, limit));
  llvm::Value* old_length = load_length(in.imm);
  if (!wide) {
    clear_elements(in.imm, old_length, length, nullptr, nullptr);
  } else {
    if (mask_) length = b_.CreateSelect(mask_, length, old_length);
    clear_elements(in.imm, b_.CreateIntMinReduce(old_length, true),
                   b_.CreateIntMaxReduce(length, true), old_length, length);
  }
  store_length(in.imm, length);
}

// Sets the elements [from, to) to 0; with lengths given, of each lane only those in [old_length,
// new_length).
void FunctionEmitter::clear_elements(std::int32_t array, llvm::Value* from, llvm::Value* to,
                                     llvm::Value* old_length, llvm::Value* new_length) {
  const std::int32_t components = function_.arrays[static_cast<std::size_t>(array)].components;
  llvm::BasicBlock *before = b_.GetInsertBlock(), *turn = new_block("clear"),
                   *after = new_block("cleared");
  b_.CreateCondBr(b_.CreateICmpSLT(from, to), turn, after);
  b_.SetInsertPoint(turn);
  llvm::PHINode* element = b_.CreatePHI(i32_, 2);
  element->addIncoming(from, before);
  for (std::int32_t c = 0; c < components; ++c) {
    if (!is_sample_array(array)) {
      b_.CreateStore(llvm::ConstantFP::get(f32_, 0),
                     frame_cells(array, b_.CreateZExt(element, i64_), c));
      continue;
    }
    llvm::Value* row = sample_row(array, element, c);
    llvm::Value* value = llvm::Constant::getNullValue(lanes_type(f32_, lanes_));
    if (old_length) {
      llvm::Value* here = splat(element);
      llvm::Value* grows =
          b_.CreateAnd(b_.CreateICmpSLE(old_length, here), b_.CreateICmpSLT(here, new_length));
      value = b_.CreateSelect(grows, value,
                              b_.CreateAlignedLoad(value->getType(), row, llvm::Align(4)));
    }
    b_.CreateAlignedStore(value, row, llvm::Align(4));
  }
  llvm::Value* next = b_.CreateAdd(element, b_.getInt32(1));
  element->addIncoming(next, b_.GetInsertBlock());
  b_.CreateCondBr(b_.CreateICmpSLT(next, to), turn, after);
  b_.SetInsertPoint(after);
}

}  // namespace pse
