// if and loop. Uniform conditions branch. Varying ones run both sides under masks, each side only
// if a sample needs it; a loop turns while any sample is active, and samples that have finished
// keep their values.
#include <cstddef>

#include "codegen/kernel_call.h"
#include "codegen/llvm/emitter.h"

namespace pse {

llvm::BasicBlock* FunctionEmitter::new_block(const char* name) {
  return llvm::BasicBlock::Create(context_, name, out_);
}

llvm::Value* FunctionEmitter::all_lanes() {
  return llvm::Constant::getAllOnesValue(lanes_type(i1_, lanes_));
}

llvm::Value* FunctionEmitter::and_masks(llvm::Value* a, llvm::Value* b) {
  if (!a || !b) return a ? a : b;
  return b_.CreateAnd(a, b);
}

llvm::Value* FunctionEmitter::any(llvm::Value* mask) {
  llvm::Value* bits = b_.CreateBitCast(mask, b_.getIntNTy(lanes_));
  return b_.CreateICmpNE(bits, llvm::Constant::getNullValue(bits->getType()));
}

llvm::Value* FunctionEmitter::to_stored(llvm::Value* value) {
  if (parent_.target().avx512 || lanes_of(value) == 1 || !value->getType()->isIntOrIntVectorTy(1))
    return value;
  return b_.CreateSExt(value, lanes_type(i32_, lanes_of(value)));
}

llvm::Value* FunctionEmitter::from_stored(llvm::Value* value, ir::Type type) {
  if (type != ir::Type::boolean || value->getType()->isIntOrIntVectorTy(1)) return value;
  return b_.CreateICmpSLT(value, llvm::Constant::getNullValue(value->getType()));
}

void FunctionEmitter::bind_params(const std::vector<ir::Value>& params,
                                  const std::vector<llvm::Value*>& values) {
  for (std::size_t i = 0; i < params.size(); ++i) values_[params[i]] = values[i];
}

// At every back-edge: one relaxed byte load, and out if somebody asks for it.
void FunctionEmitter::poll() {
  llvm::Value* flag = call_field(offsetof(KernelCall, cancel), ptr_);
  llvm::LoadInst* load = b_.CreateAlignedLoad(b_.getInt8Ty(), flag, llvm::Align(1));
  load->setAtomic(llvm::AtomicOrdering::Monotonic);
  llvm::BasicBlock* go_on = new_block("go_on");
  llvm::MDNode* unlikely = llvm::MDBuilder(context_).createBranchWeights(1, 1u << 20);
  b_.CreateCondBr(b_.CreateICmpNE(load, b_.getInt8(0)), stop_block(), go_on, unlikely);
  b_.SetInsertPoint(go_on);
}

void FunctionEmitter::emit_if(const ir::Instruction& in) {
  if (varying(in.operands[0])) {
    emit_varying_if(in);
  } else {
    emit_uniform_if(in);
  }
}

void FunctionEmitter::emit_uniform_if(const ir::Instruction& in) {
  llvm::Value* condition = get(in.operands[0]);
  llvm::BasicBlock *sides[2] = {new_block("then"), new_block("else")},
                   *after = new_block("after_if");
  b_.CreateCondBr(condition, sides[0], sides[1]);
  std::vector<llvm::Value*> yields[2];
  llvm::BasicBlock* ends[2];
  for (std::size_t s = 0; s < 2; ++s) {
    b_.SetInsertPoint(sides[s]);
    emit_region(in.regions[s]);
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      yields[s].push_back(to_stored(get_as(in.regions[s].yields[i], varying(in.results[i]))));
    }
    ends[s] = b_.GetInsertBlock();
    b_.CreateBr(after);
  }
  b_.SetInsertPoint(after);
  std::vector<llvm::PHINode*> phis;
  for (std::size_t i = 0; i < in.results.size(); ++i) {
    phis.push_back(b_.CreatePHI(yields[0][i]->getType(), 2));
    for (std::size_t s = 0; s < 2; ++s) phis[i]->addIncoming(yields[s][i], ends[s]);
  }
  for (std::size_t i = 0; i < in.results.size(); ++i) {
    values_[in.results[i]] = from_stored(phis[i], type(in.results[i]));
  }
}

void FunctionEmitter::emit_varying_if(const ir::Instruction& in) {
  llvm::Value* condition = get(in.operands[0]);
  llvm::Value* outer = mask_;
  llvm::Value* masks[2] = {and_masks(outer, condition), and_masks(outer, b_.CreateNot(condition))};
  std::vector<llvm::Value*> yields[2];
  for (std::size_t s = 0; s < 2; ++s) {
    const ir::Region& region = in.regions[s];
    // A side without instructions only hands values on.
    if (region.body.empty()) {
      for (std::size_t i = 0; i < in.results.size(); ++i) {
        yields[s].push_back(get_as(region.yields[i], varying(in.results[i])));
      }
      continue;
    }
    llvm::BasicBlock *before = b_.GetInsertBlock(), *side = new_block(s == 0 ? "then" : "else");
    llvm::BasicBlock* after = new_block("after_side");
    b_.CreateCondBr(any(masks[s]), side, after);
    b_.SetInsertPoint(side);
    mask_ = masks[s];
    emit_region(region);
    mask_ = outer;
    std::vector<llvm::Value*> inside;
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      inside.push_back(to_stored(get_as(region.yields[i], varying(in.results[i]))));
    }
    llvm::BasicBlock* end = b_.GetInsertBlock();
    b_.CreateBr(after);
    b_.SetInsertPoint(after);
    std::vector<llvm::PHINode*> phis;
    for (llvm::Value* value : inside) {
      phis.push_back(b_.CreatePHI(value->getType(), 2));
      phis.back()->addIncoming(value, end);
      phis.back()->addIncoming(llvm::Constant::getNullValue(value->getType()), before);
    }
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      yields[s].push_back(from_stored(phis[i], type(in.results[i])));
    }
  }
  for (std::size_t i = 0; i < in.results.size(); ++i) {
    // Uniform only where both sides hand on the same value from outside.
    const bool wide = varying(in.results[i]);
    values_[in.results[i]] = wide ? b_.CreateSelect(condition, yields[0][i], yields[1][i])
                                  : get(in.regions[0].yields[i]);
  }
}

void FunctionEmitter::emit_loop(const ir::Instruction& in) {
  if (varying(in.regions[0].yields[0])) {
    emit_varying_loop(in);
  } else {
    emit_uniform_loop(in);
  }
}

void FunctionEmitter::emit_uniform_loop(const ir::Instruction& in) {
  const ir::Region &head = in.regions[0], &body = in.regions[1];
  const std::size_t count = head.params.size();
  std::vector<llvm::Value*> initial;
  for (std::size_t i = 0; i < count; ++i)
    initial.push_back(to_stored(get_as(in.operands[i], varying(head.params[i]))));
  llvm::BasicBlock *before = b_.GetInsertBlock(), *turn = new_block("loop"),
                   *inside = new_block("loop_body");
  llvm::BasicBlock* after = new_block("after_loop");
  b_.CreateBr(turn);

  b_.SetInsertPoint(turn);
  std::vector<llvm::PHINode*> phis;
  for (llvm::Value* value : initial) {
    phis.push_back(b_.CreatePHI(value->getType(), 2));
    phis.back()->addIncoming(value, before);
  }
  std::vector<llvm::Value*> params;
  for (std::size_t i = 0; i < count; ++i)
    params.push_back(from_stored(phis[i], type(head.params[i])));
  bind_params(head.params, params);
  bind_params(body.params, params);
  emit_region(head);
  b_.CreateCondBr(get(head.yields[0]), inside, after);

  b_.SetInsertPoint(inside);
  emit_region(body);
  std::vector<llvm::Value*> next;
  for (std::size_t i = 0; i < count; ++i)
    next.push_back(to_stored(get_as(body.yields[i], varying(head.params[i]))));
  poll();
  for (std::size_t i = 0; i < count; ++i) phis[i]->addIncoming(next[i], b_.GetInsertBlock());
  b_.CreateBr(turn);

  b_.SetInsertPoint(after);
  for (std::size_t i = 0; i < count; ++i) {
    values_[in.results[i]] = get_as(head.params[i], varying(in.results[i]));
  }
}

void FunctionEmitter::emit_varying_loop(const ir::Instruction& in) {
  const ir::Region &head = in.regions[0], &body = in.regions[1];
  const std::size_t count = head.params.size();
  llvm::Value* outer = mask_;
  std::vector<llvm::Value*> initial;
  for (std::size_t i = 0; i < count; ++i)
    initial.push_back(to_stored(get_as(in.operands[i], varying(head.params[i]))));
  llvm::Value* initial_mask = to_stored(outer ? outer : all_lanes());
  llvm::BasicBlock *before = b_.GetInsertBlock(), *turn = new_block("loop"),
                   *inside = new_block("loop_body");
  llvm::BasicBlock* after = new_block("after_loop");
  b_.CreateBr(turn);

  // Which samples are still active, and the parameters; those that are uniform here need a varying
  // twin that keeps the value each sample left with.
  b_.SetInsertPoint(turn);
  llvm::PHINode* active_phi = b_.CreatePHI(initial_mask->getType(), 2, "active");
  active_phi->addIncoming(initial_mask, before);
  std::vector<llvm::PHINode*> phis, twins;
  for (std::size_t i = 0; i < count; ++i) {
    phis.push_back(b_.CreatePHI(initial[i]->getType(), 2));
    phis.back()->addIncoming(initial[i], before);
    llvm::PHINode* twin = nullptr;
    if (!varying(head.params[i])) {
      twin = b_.CreatePHI(to_stored(zero(type(head.params[i]), true))->getType(), 2);
      twin->addIncoming(llvm::Constant::getNullValue(twin->getType()), before);
    }
    twins.push_back(twin);
  }
  llvm::Value* active = from_stored(active_phi, ir::Type::boolean);
  std::vector<llvm::Value*> params, left_with(count);
  for (std::size_t i = 0; i < count; ++i)
    params.push_back(from_stored(phis[i], type(head.params[i])));
  bind_params(head.params, params);
  bind_params(body.params, params);
  for (std::size_t i = 0; i < count; ++i) {
    if (!twins[i]) continue;
    left_with[i] =
        b_.CreateSelect(active, splat(params[i]), from_stored(twins[i], type(head.params[i])));
  }
  mask_ = active;
  emit_region(head);
  llvm::Value* still = b_.CreateAnd(active, get_as(head.yields[0], true));
  b_.CreateCondBr(any(still), inside, after);

  b_.SetInsertPoint(inside);
  llvm::Value* still_stored = to_stored(still);
  mask_ = still;
  emit_region(body);
  mask_ = outer;
  std::vector<llvm::Value*> next, twins_next;
  for (std::size_t i = 0; i < count; ++i) {
    llvm::Value* value = get_as(body.yields[i], varying(head.params[i]));
    if (varying(head.params[i])) value = b_.CreateSelect(still, value, params[i]);
    next.push_back(to_stored(value));
    twins_next.push_back(twins[i] ? to_stored(left_with[i]) : nullptr);
  }
  poll();
  llvm::BasicBlock* end = b_.GetInsertBlock();
  active_phi->addIncoming(still_stored, end);
  for (std::size_t i = 0; i < count; ++i) {
    phis[i]->addIncoming(next[i], end);
    if (twins[i]) twins[i]->addIncoming(twins_next[i], end);
  }
  b_.CreateBr(turn);

  b_.SetInsertPoint(after);
  for (std::size_t i = 0; i < count; ++i) {
    values_[in.results[i]] = twins[i] ? left_with[i] : params[i];
  }
}

}  // namespace pse
