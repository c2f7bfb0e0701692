// Small constant tables, each target in its best way: whole tables in registers where the processor
// can permute by a varying index, shuffles for bytes where it can only shuffle 16, gathers for what
// is left.
#include "codegen/llvm/emitter.h"

#include <bit>
#include <utility>

#include <llvm/IR/IntrinsicsX86.h>
#include <llvm/IR/PatternMatch.h>

namespace pse {
namespace {

// `entries` repeated to `size`, which makes the processor's own "index mod size" right for smaller
// tables.
llvm::Constant* repeated(llvm::ArrayRef<llvm::Constant*> entries, std::size_t first,
                         std::size_t size) {
  llvm::SmallVector<llvm::Constant*, 64> all;
  for (std::size_t i = 0; i < size; ++i) all.push_back(entries[(first + i) % entries.size()]);
  return llvm::ConstantVector::get(all);
}

// Whether a value is below 2^127, so that it can be doubled: a place in a cell, from its low or its
// high corner.
bool is_place_in_cell(llvm::Value* value) {
  using namespace llvm::PatternMatch;
  llvm::Value* from_low = nullptr;
  if (match(value, m_FSub(m_Value(from_low), m_SpecificFP(1.0)))) value = from_low;
  llvm::Value* point = nullptr;
  return match(value,
               m_FSub(m_Value(point), m_Intrinsic<llvm::Intrinsic::floor>(m_Deferred(point))));
}

}  // namespace

llvm::Value* FunctionEmitter::table_lookup(llvm::ArrayRef<llvm::Constant*> entries,
                                           llvm::Value* index) {
  llvm::Type* element = entries[0]->getType();
  if (entries.size() == 1) {
    return lanes_of(index) == 1 ? entries[0]
                                : llvm::ConstantVector::getSplat(
                                      llvm::ElementCount::getFixed(lanes_of(index)), entries[0]);
  }
  const unsigned lanes = lanes_of(index);
  if (lanes > 1 && parent_.target().avx512 && entries.size() <= 32)
    return table_in_registers(entries, index);
  if (lanes > 1 && !parent_.target().avx512) {
    if (const auto bytes = top_bytes(entries))
      return table_in_bytes(*bytes, entries.size() > 16, index);
  }
  if (lanes > 1 && parent_.target().avx2 && entries.size() <= 16)
    return table_in_registers(entries, index);

  llvm::Constant* contents =
      llvm::ConstantArray::get(llvm::ArrayType::get(element, entries.size()), entries);
  llvm::Value* data = parent_.constant_data(contents);
  index = b_.CreateAnd(index, llvm::ConstantInt::get(index->getType(), entries.size() - 1));
  if (lanes == 1) {
    auto* load =
        b_.CreateLoad(element, b_.CreateInBoundsGEP(element, data, b_.CreateZExt(index, i64_)));
    load->setMetadata(llvm::LLVMContext::MD_invariant_load, llvm::MDNode::get(context_, {}));
    return load;
  }
  return b_.CreateMaskedGather(lanes_type(element, lanes),
                               b_.CreateInBoundsGEP(element, data, index), llvm::Align(4));
}

// A permutation of floats moves the bits of integers as well.
llvm::Value* FunctionEmitter::table_in_registers(llvm::ArrayRef<llvm::Constant*> entries,
                                                 llvm::Value* index) {
  llvm::SmallVector<llvm::Constant*, 64> floats;
  for (llvm::Constant* entry : entries)
    floats.push_back(llvm::ConstantExpr::getBitCast(entry, f32_));
  llvm::Value* result;
  if (parent_.target().avx512) {
    result = by_pieces(b_, index, 16, [&](llvm::Value* i) -> llvm::Value* {
      if (floats.size() <= 16) return permute_512(repeated(floats, 0, 16), i);
      return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx512_vpermi2var_ps_512, {},
                                {repeated(floats, 0, 16), i, repeated(floats, 16, 16)});
    });
  } else {
    result = by_pieces(b_, index, 8, [&](llvm::Value* i) {
      llvm::Value* low = permute_256(repeated(floats, 0, 8), i);
      if (floats.size() <= 8) return low;
      llvm::Value* high = permute_256(repeated(floats, 8, 8), i);
      llvm::Value* bit3_on_top = b_.CreateShl(i, llvm::ConstantInt::get(i->getType(), 28));
      return b_.CreateSelect(
          b_.CreateICmpSLT(bit3_on_top, llvm::Constant::getNullValue(i->getType())), high, low);
    });
  }
  return b_.CreateBitCast(result, lanes_type(entries[0]->getType(), lanes_of(index)));
}

// The top bytes of the halves of a table's entries, where a half has nothing else: gradients are
// such tables. Repeated to fill two rows of 16.
std::optional<std::array<std::uint8_t, 32>> FunctionEmitter::top_bytes(
    llvm::ArrayRef<llvm::Constant*> entries) {
  if (!entries[0]->getType()->isFloatTy() || entries.size() > 32) return std::nullopt;
  std::array<std::uint8_t, 32> bytes{};
  for (unsigned i = 0; i < 32; ++i) {
    const float entry =
        llvm::cast<llvm::ConstantFP>(entries[i % entries.size()])->getValueAPF().convertToFloat();
    const float half = 0.5f * entry;
    const auto half_bits = std::bit_cast<std::uint32_t>(half);
    if (std::bit_cast<std::uint32_t>(half + half) != std::bit_cast<std::uint32_t>(entry) ||
        half_bits << 8 != 0)
      return std::nullopt;
    bytes[i] = static_cast<std::uint8_t>(half_bits >> 24);
  }
  return bytes;
}

// One shuffle looks up such bytes for all four bytes of a word of indices, so that lookups whose
// indices are the bytes of one word share it. The result is remembered to be twice a half: products
// use that (times_table).
llvm::Value* FunctionEmitter::table_in_bytes(const std::array<std::uint8_t, 32>& bytes,
                                             bool two_rows, llvm::Value* index) {
  // Which byte of which word the index is.
  llvm::Value* word = index;
  std::uint64_t byte = 0;
  if (auto* shift = llvm::dyn_cast<llvm::BinaryOperator>(index);
      shift && shift->getOpcode() == llvm::Instruction::LShr) {
    const auto* by = llvm::dyn_cast<llvm::Constant>(shift->getOperand(1));
    const auto* number =
        by ? llvm::dyn_cast_or_null<llvm::ConstantInt>(by->getSplatValue()) : nullptr;
    if (number && number->getZExtValue() % 8 == 0 && number->getZExtValue() < 32) {
      word = shift->getOperand(0);
      byte = number->getZExtValue() / 8;
    }
  }

  llvm::Type* words = index->getType();
  const auto constant = [&](std::uint32_t value) { return llvm::ConstantInt::get(words, value); };
  llvm::Value*& found = found_bytes_[{b_.GetInsertBlock(), word, bytes}];
  if (!found) {
    llvm::Type* all_bytes = lanes_type(b_.getInt8Ty(), 4 * lanes_of(index));
    llvm::Value* low = b_.CreateBitCast(b_.CreateAnd(word, constant(0x0f0f0f0fu)), all_bytes);
    const auto row = [&](std::size_t first) {
      return shuffle_bytes(llvm::ArrayRef(bytes).slice(first, 16), low);
    };
    found = row(0);
    if (two_rows) {
      llvm::Value* bit4_on_top = b_.CreateBitCast(b_.CreateShl(word, constant(3)), all_bytes);
      found = choose_bytes(bit4_on_top, row(16), found);
    }
  }
  llvm::Value* top = b_.CreateBitCast(found, words);
  if (byte < 3) top = b_.CreateShl(top, constant(static_cast<std::uint32_t>(24 - 8 * byte)));
  if (byte > 0) top = b_.CreateAnd(top, constant(0xff000000u));
  llvm::Value* half = b_.CreateBitCast(top, lanes_type(f32_, lanes_of(index)));
  llvm::Value* entry = b_.CreateFAdd(half, half);
  halves_[entry] = half;
  return entry;
}

// fadd, fmul and fma. Where a factor is an entry that was looked up as its half, that half times
// twice the other factor is the same number, and twice a place in a cell serves all its corners; an
// entry is twice its half by a product that costs nothing beside the sum.
llvm::Value* FunctionEmitter::multiply_add(const ir::Instruction& in, bool wide) {
  const auto arg = [&](std::size_t i) { return get_as(in.operands[i], wide); };
  llvm::Value *a = arg(0), *b = arg(1), *c = in.op == ir::Op::fma ? arg(2) : nullptr;
  const auto half_of = [&](llvm::Value* entry) -> llvm::Value* {
    const auto found = halves_.find(entry);
    return found == halves_.end() ? nullptr : found->second;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    llvm::Value *half = half_of(i == 0 ? a : b), *other = i == 0 ? b : a;
    if (!half) continue;
    if (in.op == ir::Op::fadd) {
      c = other;
      b = llvm::ConstantFP::get(half->getType(), 2.0);
    } else if (is_place_in_cell(get(in.operands[1 - i]))) {
      llvm::Value*& twice = doubled_[{b_.GetInsertBlock(), other}];
      if (!twice) twice = b_.CreateFAdd(other, other);
      b = twice;
    } else {
      continue;
    }
    a = half;
    break;
  }
  if (c) return b_.CreateIntrinsic(llvm::Intrinsic::fma, {a->getType()}, {a, b, c});
  return in.op == ir::Op::fadd ? b_.CreateFAdd(a, b) : b_.CreateFMul(a, b);
}

llvm::Value* FunctionEmitter::permute_512(llvm::Constant* table, llvm::Value* index) {
  return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx512_permvar_sf_512, {}, {table, index});
}

llvm::Value* FunctionEmitter::permute_256(llvm::Constant* table, llvm::Value* index) {
  return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx2_permps, {}, {table, index});
}

}  // namespace pse
