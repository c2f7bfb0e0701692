// What leaves the function: failed checks, calls of the program's own functions, calls of the
// host's.
#include <cstddef>

#include "codegen/kernel_call.h"
#include "codegen/llvm/emitter.h"

namespace pse {

llvm::AllocaInst* FunctionEmitter::stack_slot(llvm::Type* type) {
  IrBuilder::InsertPointGuard guard(b_);
  b_.SetInsertPoint(entry_, entry_->begin());
  llvm::AllocaInst* slot = b_.CreateAlloca(type);
  slot->setAlignment(llvm::Align(64));
  return slot;
}

// The first active sample that fails is noted in the KernelCall, and the code returns.
void FunctionEmitter::emit_check(const ir::Instruction& in) {
  llvm::Value* failed;
  llvm::Value* lane = b_.getInt64(0);
  llvm::Value* condition = get(in.operands[0]);
  if (lanes_of(condition) == 1 && !(mask_ && lanes_ > 1)) {
    failed = b_.CreateNot(condition);
  } else {
    llvm::Value* failing = and_masks(mask_, b_.CreateNot(get_as(in.operands[0], true)));
    failed = any(failing);
    llvm::Value* bits = b_.CreateBitCast(failing, b_.getIntNTy(lanes_));
    bits = b_.CreateZExt(bits, i64_);
    lane = b_.CreateBinaryIntrinsic(llvm::Intrinsic::cttz, bits, b_.getFalse());
  }
  llvm::BasicBlock *fail = new_block("fail"), *go_on = new_block("checked");
  b_.CreateCondBr(failed, fail, go_on, llvm::MDBuilder(context_).createBranchWeights(1, 1u << 20));
  b_.SetInsertPoint(fail);
  const auto note = [&](std::size_t offset, llvm::Value* value) {
    b_.CreateStore(value, b_.CreateConstInBoundsGEP1_64(b_.getInt8Ty(), call_, offset));
  };
  note(offsetof(KernelCall, failed_check), b_.getInt32(static_cast<std::uint32_t>(in.imm)));
  note(offsetof(KernelCall, failed_sample), base_ ? b_.CreateAdd(base_, lane) : lane);
  leave();
  b_.SetInsertPoint(go_on);
}

void FunctionEmitter::emit_call(const ir::Instruction& in) {
  std::vector<bool> shape;
  bool wide = false;
  for (const ir::Value value : in.operands) {
    shape.push_back(varying(value));
    wide = wide || varying(value);
  }
  const auto index = static_cast<std::uint32_t>(in.imm);
  const unsigned lanes = wide ? lanes_ : 1;
  if (wide) shape = parent_.shape_of(index);
  llvm::Function* callee = parent_.called_function(index, shape, lanes);
  std::vector<llvm::Value*> arguments = {call_};
  if (parent_.takes_mask(index, lanes)) arguments.push_back(mask_ ? mask_ : all_lanes());
  for (std::size_t i = 0; i < in.operands.size(); ++i)
    arguments.push_back(get_as(in.operands[i], shape[i]));
  llvm::CallInst* result = b_.CreateCall(callee, arguments);
  result->setCallingConv(callee->getCallingConv());
  for (std::size_t i = 0; i < in.results.size(); ++i) {
    values_[in.results[i]] = b_.CreateExtractValue(result, static_cast<unsigned>(i));
  }
}

// Lanes go through arrays on the stack; where only some may be active, the host picks those out.
void FunctionEmitter::emit_external(const ir::Instruction& in) {
  bool wide = false;
  for (const ir::Value value : in.operands) wide = wide || varying(value);
  const unsigned lanes = wide ? lanes_ : 1;
  const auto pointer_table = [&](std::size_t count) {
    return stack_slot(llvm::ArrayType::get(ptr_, std::max<std::size_t>(count, 1)));
  };
  llvm::Value* argument_table = pointer_table(in.operands.size());
  llvm::Value* result_table = pointer_table(in.results.size());
  for (std::size_t i = 0; i < in.operands.size(); ++i) {
    llvm::Value* slot = stack_slot(lanes_type(f32_, lanes));
    b_.CreateStore(get_as(in.operands[i], wide), slot);
    b_.CreateStore(slot, b_.CreateConstInBoundsGEP1_64(ptr_, argument_table, i));
  }
  std::vector<llvm::Value*> results;
  for (std::size_t i = 0; i < in.results.size(); ++i) {
    results.push_back(stack_slot(lanes_type(f32_, lanes)));
    b_.CreateStore(results[i], b_.CreateConstInBoundsGEP1_64(ptr_, result_table, i));
  }

  llvm::Value* functions = call_field(offsetof(KernelCall, externals), ptr_);
  const auto place = 2 * static_cast<std::uint64_t>(in.imm);
  llvm::Value* function =
      b_.CreateLoad(ptr_, b_.CreateConstInBoundsGEP1_64(ptr_, functions, place));
  llvm::Value* user =
      b_.CreateLoad(ptr_, b_.CreateConstInBoundsGEP1_64(ptr_, functions, place + 1));
  if (wide && mask_ && lanes > 1) {
    llvm::Value* active = b_.CreateZExt(b_.CreateBitCast(mask_, b_.getIntNTy(lanes)), i64_);
    llvm::Value* call_active = call_field(offsetof(KernelCall, call_active), ptr_);
    auto* signature = llvm::FunctionType::get(
        b_.getVoidTy(), {ptr_, ptr_, i64_, i64_, i64_, ptr_, i64_, ptr_}, false);
    b_.CreateCall(signature, call_active,
                  {function, user, active, b_.getInt64(lanes), b_.getInt64(in.operands.size()),
                   argument_table, b_.getInt64(in.results.size()), result_table});
  } else {
    auto* signature = llvm::FunctionType::get(b_.getVoidTy(), {ptr_, i64_, ptr_, ptr_}, false);
    b_.CreateCall(signature, function, {user, b_.getInt64(lanes), argument_table, result_table});
  }
  for (std::size_t i = 0; i < in.results.size(); ++i) {
    values_[in.results[i]] = b_.CreateLoad(lanes_type(f32_, lanes), results[i]);
  }
}

}  // namespace pse
