// The shells of a kernel: its entry points, its loop over the samples, its read-only data and
// called functions.
#include <algorithm>
#include <cstddef>

#include "codegen/kernel_call.h"
#include "codegen/llvm/emitter.h"

namespace pse {
namespace {

llvm::FunctionType* entry_type(llvm::LLVMContext& context) {
  return llvm::FunctionType::get(llvm::Type::getVoidTy(context),
                                 {llvm::PointerType::get(context, 0)}, false);
}

}  // namespace

ModuleEmitter::ModuleEmitter(llvm::Module& out, const BackendRequest& request)
    : out_(out),
      ir_(request.split->module),
      split_(*request.split),
      target_(*request.target),
      width_(static_cast<unsigned>(request.width)),
      shapes_(ir_.functions.size()) {}

llvm::Type* ModuleEmitter::type_of(ir::Type type, unsigned lanes) {
  llvm::LLVMContext& context = out_.getContext();
  llvm::Type* element = type == ir::Type::f32   ? llvm::Type::getFloatTy(context)
                        : type == ir::Type::i32 ? llvm::Type::getInt32Ty(context)
                                                : llvm::Type::getInt1Ty(context);
  return lanes_type(element, lanes);
}

unsigned ModuleEmitter::byte_piece(unsigned count) const {
  if (target_.vbmi || (target_.avx512 && count >= 64)) return 64;
  return target_.avx2 && count >= 32 ? 32 : 16;
}

llvm::Value* ModuleEmitter::constant_data(llvm::Constant* contents) {
  llvm::Value*& data = data_[contents];
  if (!data) {
    auto* global = new llvm::GlobalVariable(out_, contents->getType(), true,
                                            llvm::GlobalValue::PrivateLinkage, contents, "table");
    global->setAlignment(llvm::Align(64));
    global->setUnnamedAddr(llvm::GlobalValue::UnnamedAddr::Global);
    data = global;
  }
  return data;
}

llvm::Function* ModuleEmitter::add_function(llvm::FunctionType* type, const std::string& name,
                                            bool external) {
  const auto linkage =
      external ? llvm::GlobalValue::ExternalLinkage : llvm::GlobalValue::InternalLinkage;
  llvm::Function* function = llvm::Function::Create(type, linkage, name, out_);
  function->addFnAttr(llvm::Attribute::NoUnwind);
  function->addFnAttr("target-cpu", target_.cpu);
  function->addFnAttr("target-features", target_.features);
  // The vectors that are written are the vectors that run: nothing is cut into halves to save
  // power.
  function->addFnAttr("prefer-vector-width", "512");
  function->addFnAttr("min-legal-vector-width", "512");
  if (!external) function->setCallingConv(llvm::CallingConv::Fast);
  return function;
}

// Calls of callers first, so that a function's own shape is known before its calls are looked at;
// where it grows later, they are looked at again.
void ModuleEmitter::find_shapes(const ir::Function& function, const Uniformity& uniformity) {
  std::vector<const ir::Region*> regions = {&function.body};
  while (!regions.empty()) {
    const ir::Region& region = *regions.back();
    regions.pop_back();
    for (const ir::Instruction& in : region.body) {
      for (const ir::Region& inner : in.regions) regions.push_back(&inner);
      if (in.op != ir::Op::call) continue;
      const auto varies = [&](ir::Value value) { return uniformity.varying[value]; };
      if (std::ranges::none_of(in.operands, varies)) continue;
      const auto callee = static_cast<std::uint32_t>(in.imm);
      std::vector<bool> shape = shapes_[callee];
      shape.resize(in.operands.size());
      for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = shape[i] || varies(in.operands[i]);
      if (shape == shapes_[callee]) continue;
      shapes_[callee] = shape;
      const ir::Function& called = ir_.functions[callee];
      find_shapes(called, find_uniformity(ir_, called, shape));
    }
  }
}

void ModuleEmitter::emit_samples() {
  const ir::Function& main = ir_.main();
  Uniformity uniformity = width_ == 1 ? all_uniform(main) : find_uniformity(ir_, main, {});
  find_shapes(main, uniformity);
  llvm::Function* out = add_function(entry_type(out_.getContext()), samples_symbol, true);
  FunctionEmitter(*this, main, std::move(uniformity), width_, out).emit_sample_loop(ir_.outputs);
}

void ModuleEmitter::emit_frame() {
  const ir::Function& frame = ir_.functions[split_.frame];
  llvm::Function* out = add_function(entry_type(out_.getContext()), frame_symbol, true);
  FunctionEmitter(*this, frame, all_uniform(frame), 1, out).emit_once();
}

bool ModuleEmitter::takes_mask(std::uint32_t index, unsigned lanes) const {
  const auto& body = ir_.functions[index].body.body;
  const auto depends = [](const ir::Instruction& in) {
    return !in.regions.empty() || in.op == ir::Op::call || in.op == ir::Op::external;
  };
  return lanes > 1 && std::ranges::any_of(body, depends);
}

llvm::Function* ModuleEmitter::called_function(std::uint32_t index,
                                               const std::vector<bool>& varying, unsigned lanes) {
  llvm::Function*& out = called_[{index, varying}];
  if (out) return out;
  const ir::Function& function = ir_.functions[index];
  llvm::LLVMContext& context = out_.getContext();

  std::vector<llvm::Type*> params = {llvm::PointerType::get(context, 0)};
  if (takes_mask(index, lanes)) params.push_back(lanes_type(llvm::Type::getInt1Ty(context), lanes));
  for (std::size_t i = 0; i < varying.size(); ++i) {
    params.push_back(
        type_of(function.values[function.body.params[i]].type, varying[i] ? lanes : 1));
  }
  std::vector<llvm::Type*> results;
  for (const ir::Value value : function.body.yields) {
    results.push_back(type_of(function.values[value].type, lanes));
  }
  auto* type = llvm::FunctionType::get(llvm::StructType::get(context, results), params, false);
  out = add_function(type, "call." + function.name, false);
  llvm::Function* created = out;  // emitting may add to the map
  Uniformity uniformity =
      lanes == 1 ? all_uniform(function) : find_uniformity(ir_, function, varying);
  FunctionEmitter(*this, function, std::move(uniformity), lanes, created)
      .emit_called(takes_mask(index, lanes));
  return created;
}

FunctionEmitter::FunctionEmitter(ModuleEmitter& parent, const ir::Function& function,
                                 Uniformity uniformity, unsigned lanes, llvm::Function* out)
    : parent_(parent),
      ir_(parent.ir()),
      function_(function),
      uniformity_(std::move(uniformity)),
      lanes_(lanes),
      out_(out),
      b_(out->getContext()),
      context_(out->getContext()),
      f32_(b_.getFloatTy()),
      i32_(b_.getInt32Ty()),
      i64_(b_.getInt64Ty()),
      i1_(b_.getInt1Ty()),
      ptr_(b_.getPtrTy()),
      values_(function.values.size()),
      asked_(find_asked_bits(ir_, function)),
      inputs_(ir_.inputs.size()),
      input_used_(ir_.inputs.size()),
      sample_layout_(function.arrays, static_cast<int>(lanes)),
      frame_layout_(function.arrays) {
  entry_ = llvm::BasicBlock::Create(context_, "entry", out_);
  b_.SetInsertPoint(entry_);
  call_ = out_->getArg(0);
}

// A field of the KernelCall, loaded once in the entry block.
llvm::Value* FunctionEmitter::call_field(std::size_t offset, llvm::Type* field_type) {
  llvm::Value*& field = call_fields_[offset];
  if (field) return field;
  IrBuilder::InsertPointGuard guard(b_);
  if (entry_->getTerminator()) {
    b_.SetInsertPoint(entry_->getTerminator());
  } else {
    b_.SetInsertPoint(entry_);
  }
  auto* load =
      b_.CreateLoad(field_type, b_.CreateConstInBoundsGEP1_64(b_.getInt8Ty(), call_, offset));
  load->setMetadata(llvm::LLVMContext::MD_invariant_load, llvm::MDNode::get(context_, {}));
  field = load;
  return field;
}

void FunctionEmitter::find_used_inputs(const ir::Region& region) {
  for (const ir::Instruction& in : region.body) {
    if (in.op == ir::Op::input) input_used_[static_cast<std::size_t>(in.imm)] = true;
    for (const ir::Region& inner : in.regions) find_used_inputs(inner);
  }
}

// Uniform inputs become values, the others the addresses of their arrays.
void FunctionEmitter::load_inputs() {
  find_used_inputs(function_.body);
  for (std::size_t i = 0; i < ir_.inputs.size(); ++i) {
    if (!input_used_[i]) continue;
    if (ir_.inputs[i].rate == ir::Rate::sample) {
      llvm::Value* arrays = call_field(offsetof(KernelCall, inputs), ptr_);
      inputs_[i] = b_.CreateLoad(ptr_, b_.CreateConstInBoundsGEP1_64(ptr_, arrays, i));
    } else {
      llvm::Value* uniforms = call_field(offsetof(KernelCall, uniforms), ptr_);
      inputs_[i] = b_.CreateLoad(f32_, b_.CreateConstInBoundsGEP1_64(f32_, uniforms, i));
    }
  }
}

void FunctionEmitter::emit_sample_loop(const std::vector<ir::Output>& outputs) {
  load_inputs();
  declare_arrays();
  llvm::Value* count = call_field(offsetof(KernelCall, count), i64_);
  std::vector<llvm::Value*> planes;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    llvm::Value* arrays = call_field(offsetof(KernelCall, outputs), ptr_);
    planes.push_back(b_.CreateLoad(ptr_, b_.CreateConstInBoundsGEP1_64(ptr_, arrays, i)));
  }

  // One vector of samples per turn; the caller passes whole vectors only.
  llvm::BasicBlock* turn = new_block("samples");
  b_.CreateBr(turn);
  b_.SetInsertPoint(turn);
  llvm::PHINode* base = b_.CreatePHI(i64_, 2, "base");
  base->addIncoming(b_.getInt64(0), entry_);
  base_ = base;
  clear_arrays();
  emit_region(function_.body);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    llvm::Value* value = canonical_nan(get_as(function_.body.yields[i], lanes_ > 1));
    b_.CreateAlignedStore(value, b_.CreateInBoundsGEP(f32_, planes[i], base_), llvm::Align(4));
  }
  poll();
  llvm::Value* next = b_.CreateAdd(base_, b_.getInt64(lanes_), "", true, true);
  base->addIncoming(next, b_.GetInsertBlock());
  llvm::BasicBlock* done = new_block("done");
  b_.CreateCondBr(b_.CreateICmpSLT(next, count), turn, done);
  b_.SetInsertPoint(done);
  b_.CreateRetVoid();
}

void FunctionEmitter::emit_once() {
  load_inputs();
  declare_arrays();
  emit_region(function_.body);
  if (!function_.body.yields.empty()) {
    llvm::Value* slots = b_.CreateLoad(ptr_, call_field(offsetof(KernelCall, outputs), ptr_));
    for (std::size_t i = 0; i < function_.body.yields.size(); ++i) {
      // As they are: a slot may carry an integer's bits.
      b_.CreateStore(get(function_.body.yields[i]), b_.CreateConstInBoundsGEP1_64(f32_, slots, i));
    }
  }
  b_.CreateRetVoid();
}

void FunctionEmitter::emit_called(bool takes_mask) {
  unsigned first = 1;
  if (takes_mask) mask_ = out_->getArg(first++);
  std::vector<llvm::Value*> arguments;
  for (std::size_t i = 0; i < function_.body.params.size(); ++i) {
    arguments.push_back(out_->getArg(first + static_cast<unsigned>(i)));
  }
  bind_params(function_.body.params, arguments);
  emit_region(function_.body);
  llvm::Value* result = llvm::PoisonValue::get(out_->getReturnType());
  for (std::size_t i = 0; i < function_.body.yields.size(); ++i) {
    llvm::Value* value = get_as(function_.body.yields[i], lanes_ > 1);
    result = b_.CreateInsertValue(result, value, static_cast<unsigned>(i));
  }
  b_.CreateRet(result);
}

// Leaves the function at once; a caller finds out when it polls.
void FunctionEmitter::leave() {
  llvm::Type* result = out_->getReturnType();
  if (result->isVoidTy()) {
    b_.CreateRetVoid();
  } else {
    b_.CreateRet(llvm::Constant::getNullValue(result));
  }
}

llvm::BasicBlock* FunctionEmitter::stop_block() {
  if (!stop_) {
    IrBuilder::InsertPointGuard guard(b_);
    stop_ = new_block("stop");
    b_.SetInsertPoint(stop_);
    leave();
  }
  return stop_;
}

}  // namespace pse
