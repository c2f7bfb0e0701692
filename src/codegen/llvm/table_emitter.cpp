// Small constant tables, each target in its best way: whole tables in registers where the processor
// can permute by a varying index, shuffles for bytes where it can only shuffle 16, gathers for what
// is left.
#include "codegen/llvm/emitter.h"

#include <bit>

#include <llvm/IR/IntrinsicsX86.h>

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

llvm::Constant* byte_vector(llvm::LLVMContext& context, llvm::ArrayRef<std::uint8_t> bytes) {
  return llvm::ConstantDataVector::get(context, bytes);
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
  if (lanes > 1 && !parent_.target().avx512 && entries.size() <= 16) {
    if (llvm::Value* result = table_in_bytes(entries, index)) return result;
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

// A table of halves, ones and zeros, such as gradients are: half of each entry has only its top
// byte set, so one shuffle looks up bytes. Where several lookups take their indices from the bytes
// of one word, they share that shuffle.
llvm::Value* FunctionEmitter::table_in_bytes(llvm::ArrayRef<llvm::Constant*> entries,
                                             llvm::Value* index) {
  if (!entries[0]->getType()->isFloatTy()) return nullptr;
  llvm::SmallVector<std::uint8_t, 32> halves;
  for (unsigned i = 0; i < 32; ++i) {
    const float entry =
        llvm::cast<llvm::ConstantFP>(entries[i % entries.size()])->getValueAPF().convertToFloat();
    const float half = 0.5f * entry;
    const auto half_bits = std::bit_cast<std::uint32_t>(half);
    if (std::bit_cast<std::uint32_t>(half + half) != std::bit_cast<std::uint32_t>(entry) ||
        half_bits << 8 != 0)
      return nullptr;
    halves.push_back(static_cast<std::uint8_t>(half_bits >> 24));
  }
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
  llvm::Value* low_bits = b_.CreateAnd(word, constant(0x0f0f0f0fu));
  llvm::Type* all_bytes = lanes_type(b_.getInt8Ty(), 4 * lanes_of(index));
  const unsigned piece = parent_.target().avx2 && lanes_of(index) >= 8 ? 32 : 16;
  const auto shuffle_id =
      piece == 32 ? llvm::Intrinsic::x86_avx2_pshuf_b : llvm::Intrinsic::x86_ssse3_pshuf_b_128;
  llvm::Constant* row = byte_vector(context_, llvm::ArrayRef(halves).take_front(piece));
  llvm::Value* found =
      by_pieces(b_, b_.CreateBitCast(low_bits, all_bytes), piece, [&](llvm::Value* v) {
        return b_.CreateIntrinsic(shuffle_id, {}, {row, v});
      });
  llvm::Value* top = b_.CreateBitCast(found, words);
  if (byte < 3) top = b_.CreateShl(top, constant(static_cast<std::uint32_t>(24 - 8 * byte)));
  if (byte > 0) top = b_.CreateAnd(top, constant(0xff000000u));
  llvm::Value* half = b_.CreateBitCast(top, lanes_type(f32_, lanes_of(index)));
  return b_.CreateFAdd(half, half);
}

llvm::Value* FunctionEmitter::permute_512(llvm::Constant* table, llvm::Value* index) {
  return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx512_permvar_sf_512, {}, {table, index});
}

llvm::Value* FunctionEmitter::permute_256(llvm::Constant* table, llvm::Value* index) {
  return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx2_permps, {}, {table, index});
}

llvm::Value* FunctionEmitter::bytes_add(llvm::Value* x, llvm::Value* y) {
  llvm::Type* bytes = lanes_type(b_.getInt8Ty(), 4 * lanes_of(x));
  return b_.CreateBitCast(b_.CreateAdd(b_.CreateBitCast(x, bytes), b_.CreateBitCast(y, bytes)),
                          x->getType());
}

llvm::Value* FunctionEmitter::bytes_lookup(const ir::ByteTable& table, llvm::Value* index) {
  if (lanes_of(index) == 1) return bytes_lookup_scalar(table, index);
  llvm::Value* bytes = b_.CreateBitCast(index, lanes_type(b_.getInt8Ty(), 4 * lanes_of(index)));
  llvm::Value* result;
  if (parent_.target().vbmi) {
    result = by_pieces(b_, bytes, 64, [&](llvm::Value* v) { return bytes_lookup_vbmi(table, v); });
  } else {
    const unsigned piece = parent_.target().avx512 && lanes_of(bytes) >= 64 ? 64
                           : parent_.target().avx2 && lanes_of(bytes) >= 32 ? 32
                                                                            : 16;
    result = by_pieces(b_, bytes, piece,
                       [&](llvm::Value* v) { return bytes_lookup_shuffles(table, v, piece); });
  }
  return b_.CreateBitCast(result, index->getType());
}

// The table in four registers: two lookups in 128 entries each, and the top bit chooses.
llvm::Value* FunctionEmitter::bytes_lookup_vbmi(const ir::ByteTable& table, llvm::Value* bytes) {
  const auto part = [&](std::size_t i) {
    return byte_vector(context_, llvm::ArrayRef(table.entries).slice(64 * i, 64));
  };
  const auto lookup = [&](std::size_t i) {
    return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx512_vpermi2var_qi_512, {},
                              {part(i), bytes, part(i + 1)});
  };
  llvm::Value *low = lookup(0), *high = lookup(2);
  return b_.CreateSelect(b_.CreateICmpSLT(bytes, llvm::Constant::getNullValue(bytes->getType())),
                         high, low);
}

// Sixteen shuffles of 16 entries. A shuffle gives 0 where the index is negative, so with the index
// lowered by 16 at each step the steps 0..k all answer an index of row k; tables that hold the
// difference to the row before (by exclusive or) make the sum of these answers the entry.
// Saturation keeps negative indices negative, so that each half of the table answers only for its
// own half of the indices.
llvm::Value* FunctionEmitter::bytes_lookup_shuffles(const ir::ByteTable& table, llvm::Value* bytes,
                                                    unsigned piece) {
  const auto shuffle_id = piece == 64   ? llvm::Intrinsic::x86_avx512_pshuf_b_512
                          : piece == 32 ? llvm::Intrinsic::x86_avx2_pshuf_b
                                        : llvm::Intrinsic::x86_ssse3_pshuf_b_128;
  const auto splat_byte = [&](unsigned value) {
    return llvm::ConstantInt::get(bytes->getType(), value);
  };
  llvm::Value* result = nullptr;
  for (unsigned half = 0; half < 2; ++half) {
    llvm::Value* index = half == 0 ? bytes : b_.CreateXor(bytes, splat_byte(0x80));
    for (unsigned row = 0; row < 8; ++row) {
      llvm::SmallVector<std::uint8_t, 64> difference;
      for (unsigned i = 0; i < piece; ++i) {
        const unsigned entry = 128 * half + 16 * row + i % 16;
        const unsigned before = row == 0 ? 0u : table.entries[entry - 16];
        difference.push_back(static_cast<std::uint8_t>(table.entries[entry] ^ before));
      }
      llvm::Value* lowered = row == 0 ? index
                                      : b_.CreateBinaryIntrinsic(llvm::Intrinsic::ssub_sat, index,
                                                                 splat_byte(16 * row));
      llvm::Value* answer =
          b_.CreateIntrinsic(shuffle_id, {}, {byte_vector(context_, difference), lowered});
      result = result ? b_.CreateXor(result, answer) : answer;
    }
  }
  return result;
}

llvm::Value* FunctionEmitter::bytes_lookup_scalar(const ir::ByteTable& table, llvm::Value* index) {
  llvm::Value* data =
      parent_.constant_data(llvm::ConstantDataArray::get(context_, llvm::ArrayRef(table.entries)));
  llvm::Value* result = nullptr;
  for (std::uint32_t shift = 0; shift < 32; shift += 8) {
    llvm::Value* byte = b_.CreateAnd(b_.CreateLShr(index, shift), b_.getInt32(255));
    auto* load = b_.CreateLoad(
        b_.getInt8Ty(), b_.CreateInBoundsGEP(b_.getInt8Ty(), data, b_.CreateZExt(byte, i64_)));
    load->setMetadata(llvm::LLVMContext::MD_invariant_load, llvm::MDNode::get(context_, {}));
    llvm::Value* placed = b_.CreateShl(b_.CreateZExt(load, i32_), shift);
    result = result ? b_.CreateOr(result, placed) : placed;
  }
  return result;
}

}  // namespace pse
