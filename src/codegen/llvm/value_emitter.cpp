// Operators without control: what ir/ops.cpp says, in LLVM's words. No fast-math flag is ever set.
#include "codegen/llvm/emitter.h"

#include <llvm/IR/IntrinsicsX86.h>
#include <llvm/IR/PatternMatch.h>

namespace pse {

using ir::Op;

llvm::Value* FunctionEmitter::splat(llvm::Value* value) {
  return b_.CreateVectorSplat(lanes_, value);
}

llvm::Value* FunctionEmitter::get_as(ir::Value value, bool as_varying) {
  llvm::Value* v = values_[value];
  return as_varying && lanes_of(v) != lanes_ ? splat(v) : v;
}

llvm::Value* FunctionEmitter::zero(ir::Type type, bool as_varying) {
  return llvm::Constant::getNullValue(parent_.type_of(type, as_varying ? lanes_ : 1));
}

void FunctionEmitter::emit_region(const ir::Region& region) {
  for (const ir::Instruction& in : region.body) emit(in);
}

void FunctionEmitter::emit(const ir::Instruction& in) {
  switch (in.op) {
    case Op::if_:
      return emit_if(in);
    case Op::loop:
      return emit_loop(in);
    case Op::check:
      return emit_check(in);
    case Op::call:
      return emit_call(in);
    case Op::external:
      return emit_external(in);
    case Op::array_store:
      return emit_array_store(in);
    case Op::array_resize:
      return emit_array_resize(in);
    default:
      values_[in.result()] = emit_value(in);
  }
}

llvm::Value* FunctionEmitter::emit_input(const ir::Instruction& in) {
  const auto index = static_cast<std::size_t>(in.imm);
  if (ir_.inputs[index].rate != ir::Rate::sample) return inputs_[index];
  llvm::Value* address = b_.CreateInBoundsGEP(f32_, inputs_[index], base_);
  return b_.CreateAlignedLoad(parent_.type_of(ir::Type::f32, lanes_), address, llvm::Align(4));
}

// A byte times 0x01010101 is that byte in all four places: a shuffle, cheaper than the product.
llvm::Value* FunctionEmitter::multiply(llvm::Value* x, llvm::Value* y) {
  using namespace llvm::PatternMatch;
  llvm::Value* source = nullptr;
  const unsigned lanes = lanes_of(x);
  if (lanes % 4 != 0 || !match(x, m_And(m_Value(source), m_SpecificInt(255))) ||
      !match(y, m_SpecificInt(0x01010101))) {
    return b_.CreateMul(x, y);
  }
  llvm::SmallVector<int, 128> low_bytes;
  for (unsigned i = 0; i < 4 * lanes; ++i) low_bytes.push_back(static_cast<int>(i & ~3u));
  llvm::Value* bytes = b_.CreateBitCast(source, lanes_type(b_.getInt8Ty(), 4 * lanes));
  llvm::Value* word = b_.CreateBitCast(b_.CreateShuffleVector(bytes, low_bytes), x->getType());
  repeated_bytes_[word] = source;
  return word;
}

// cvttps2dq gives -2^31 where the value does not fit; LLVM's own fptosi would be undefined there.
llvm::Value* FunctionEmitter::float_to_int(llvm::Value* value) {
  using namespace llvm::Intrinsic;
  const auto call = [&](ID id, llvm::ArrayRef<llvm::Value*> args) {
    return b_.CreateIntrinsic(id, {}, args);
  };
  if (lanes_of(value) == 1) {
    llvm::Value* vector = b_.CreateInsertElement(llvm::PoisonValue::get(lanes_type(f32_, 4)), value,
                                                 std::uint64_t{0});
    return call(x86_sse_cvttss2si, {vector});
  }
  if (parent_.target().avx512 && lanes_of(value) >= 16) {
    return by_pieces(b_, value, 16, [&](llvm::Value* v) {
      llvm::Value* none = llvm::Constant::getNullValue(lanes_type(i32_, 16));
      return call(x86_avx512_mask_cvttps2dq_512, {v, none, b_.getInt16(0xffff), b_.getInt32(4)});
    });
  }
  if (parent_.target().avx2 && lanes_of(value) >= 8) {
    return by_pieces(b_, value, 8,
                     [&](llvm::Value* v) { return call(x86_avx_cvtt_ps2dq_256, {v}); });
  }
  return by_pieces(b_, value, 4, [&](llvm::Value* v) { return call(x86_sse2_cvttps2dq, {v}); });
}

// By a power of two: the product with its inverse is the same number.
llvm::Value* FunctionEmitter::divide(llvm::Value* dividend, llvm::Value* divisor) {
  const auto* constant = llvm::dyn_cast<llvm::Constant>(divisor);
  if (constant && constant->getType()->isVectorTy()) constant = constant->getSplatValue();
  const auto* number = llvm::dyn_cast_or_null<llvm::ConstantFP>(constant);
  llvm::APFloat inverse(0.0f);
  if (!number || !number->getValueAPF().getExactInverse(&inverse))
    return b_.CreateFDiv(dividend, divisor);
  return b_.CreateFMul(dividend, llvm::ConstantFP::get(dividend->getType(), inverse));
}

// LLVM's shifts are undefined past 31.
llvm::Value* FunctionEmitter::shift(Op op, llvm::Value* value, llvm::Value* by) {
  llvm::Type* t = value->getType();
  llvm::Value* limit = llvm::ConstantInt::get(t, 31);
  // By a number known to be small: the plain instruction.
  if (const auto* constant = llvm::dyn_cast<llvm::Constant>(by)) {
    const auto* number = llvm::dyn_cast_or_null<llvm::ConstantInt>(
        t->isVectorTy() ? constant->getSplatValue() : constant);
    if (number && number->getZExtValue() <= 31) {
      return op == Op::ishl   ? b_.CreateShl(value, by)
             : op == Op::ishr ? b_.CreateLShr(value, by)
                              : b_.CreateAShr(value, by);
    }
  }
  llvm::Value* inside = b_.CreateICmpULE(by, limit);
  if (op == Op::isar) return b_.CreateAShr(value, b_.CreateSelect(inside, by, limit));
  llvm::Value* safe = b_.CreateAnd(by, limit);
  llvm::Value* shifted = op == Op::ishl ? b_.CreateShl(value, safe) : b_.CreateLShr(value, safe);
  return b_.CreateSelect(inside, shifted, llvm::Constant::getNullValue(t));
}

llvm::Value* FunctionEmitter::canonical_nan(llvm::Value* value) {
  llvm::Constant* bits = llvm::ConstantInt::get(i32_, 0x7fc00000);
  llvm::Constant* nan = llvm::ConstantExpr::getBitCast(bits, f32_);
  if (lanes_of(value) > 1)
    nan = llvm::ConstantVector::getSplat(llvm::ElementCount::getFixed(lanes_of(value)), nan);
  return b_.CreateSelect(b_.CreateFCmpUNO(value, value), nan, value);
}

llvm::Value* FunctionEmitter::emit_value(const ir::Instruction& in) {
  const bool wide = varying(in.result());
  const auto arg = [&](std::size_t i) { return get_as(in.operands[i], wide); };
  const auto index = static_cast<std::size_t>(in.imm);
  // Comparisons and the like: vectors where an operand is one.
  switch (in.op) {
    case Op::const_f32:
      return llvm::ConstantFP::get(context_, llvm::APFloat(in.imm_f32()));
    case Op::slope:
      return llvm::ConstantFP::get(context_, llvm::APFloat(0.0f));
    case Op::const_i32:
      return b_.getInt32(static_cast<std::uint32_t>(in.imm));
    case Op::const_bool:
      return b_.getInt1(in.imm != 0);
    case Op::input:
      return emit_input(in);
    case Op::fsub:
      return b_.CreateFSub(arg(0), arg(1));
    case Op::fdiv:
      return divide(arg(0), arg(1));
    case Op::fadd:
    case Op::fmul:
    case Op::fma:
      return multiply_add(in, wide);
    case Op::fneg:
      return b_.CreateFNeg(arg(0));
    case Op::fabs:
      return b_.CreateUnaryIntrinsic(llvm::Intrinsic::fabs, arg(0));
    case Op::fsqrt:
      return b_.CreateUnaryIntrinsic(llvm::Intrinsic::sqrt, arg(0));
    case Op::fmin: {
      llvm::Value *x = arg(0), *y = arg(1);
      return b_.CreateSelect(b_.CreateFCmpOLT(x, y), x, y);
    }
    case Op::fmax: {
      llvm::Value *x = arg(0), *y = arg(1);
      return b_.CreateSelect(b_.CreateFCmpOGT(x, y), x, y);
    }
    case Op::ffloor:
      return b_.CreateUnaryIntrinsic(llvm::Intrinsic::floor, arg(0));
    case Op::fceil:
      return b_.CreateUnaryIntrinsic(llvm::Intrinsic::ceil, arg(0));
    case Op::ftrunc:
      return b_.CreateUnaryIntrinsic(llvm::Intrinsic::trunc, arg(0));
    case Op::fround:
      return b_.CreateUnaryIntrinsic(llvm::Intrinsic::roundeven, arg(0));
    case Op::feq:
      return b_.CreateFCmpOEQ(arg(0), arg(1));
    case Op::fne:
      return b_.CreateFCmpUNE(arg(0), arg(1));
    case Op::flt:
      return b_.CreateFCmpOLT(arg(0), arg(1));
    case Op::fle:
      return b_.CreateFCmpOLE(arg(0), arg(1));
    case Op::iadd:
      return b_.CreateAdd(arg(0), arg(1));
    case Op::isub:
      return b_.CreateSub(arg(0), arg(1));
    case Op::imul:
      return multiply(arg(0), arg(1));
    case Op::iand:
    case Op::band:
      return b_.CreateAnd(arg(0), arg(1));
    case Op::ior:
    case Op::bor:
      return b_.CreateOr(arg(0), arg(1));
    case Op::ixor:
    case Op::bxor:
      return b_.CreateXor(arg(0), arg(1));
    case Op::bnot:
      return b_.CreateNot(arg(0));
    case Op::ishl:
    case Op::ishr:
    case Op::isar:
      return shift(in.op, arg(0), arg(1));
    case Op::ieq:
      return b_.CreateICmpEQ(arg(0), arg(1));
    case Op::ine:
      return b_.CreateICmpNE(arg(0), arg(1));
    case Op::ilt:
      return b_.CreateICmpSLT(arg(0), arg(1));
    case Op::ile:
      return b_.CreateICmpSLE(arg(0), arg(1));
    case Op::select:
      return b_.CreateSelect(arg(0), arg(1), arg(2));
    case Op::f2i:
      return float_to_int(arg(0));
    case Op::i2f:
      return b_.CreateSIToFP(arg(0), parent_.type_of(ir::Type::f32, wide ? lanes_ : 1));
    case Op::f2bits:
      return b_.CreateBitCast(arg(0), parent_.type_of(ir::Type::i32, wide ? lanes_ : 1));
    case Op::bits2f:
      return b_.CreateBitCast(arg(0), parent_.type_of(ir::Type::f32, wide ? lanes_ : 1));
    case Op::table_f32: {
      llvm::SmallVector<llvm::Constant*, 64> entries;
      for (const float entry : ir_.float_tables[index].entries) {
        entries.push_back(llvm::ConstantFP::get(context_, llvm::APFloat(entry)));
      }
      return table_lookup(entries, arg(0));
    }
    case Op::table_i32: {
      llvm::SmallVector<llvm::Constant*, 64> entries;
      for (const std::int32_t entry : ir_.int_tables[index].entries) {
        entries.push_back(b_.getInt32(static_cast<std::uint32_t>(entry)));
      }
      return table_lookup(entries, arg(0));
    }
    case Op::bytes_add:
      return bytes_add(arg(0), arg(1));
    case Op::bytes_lookup:
      return bytes_lookup(ir_.byte_tables[index], arg(0), (asked_[in.result()] & 0xf0f0f0f0u) == 0);
    case Op::array_load:
      return emit_array_load(in);
    case Op::array_length:
      return load_length(in.imm);
    default:
      break;
  }
  llvm_unreachable("operator with effects");
}

}  // namespace pse
