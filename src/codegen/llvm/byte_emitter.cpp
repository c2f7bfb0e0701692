// Byte tables: the permutations that hash a lattice. Whole tables in registers where the processor
// can permute 128 bytes by a varying index, shuffles of 16 where it cannot.
#include "codegen/llvm/emitter.h"

#include <array>

#include <llvm/IR/IntrinsicsX86.h>

namespace pse {

llvm::Value* FunctionEmitter::bytes_add(llvm::Value* x, llvm::Value* y) {
  llvm::Type* bytes = lanes_type(b_.getInt8Ty(), 4 * lanes_of(x));
  llvm::Value* sum = b_.CreateBitCast(
      b_.CreateAdd(b_.CreateBitCast(x, bytes), b_.CreateBitCast(y, bytes)), x->getType());
  // A repeated byte with a constant added to each place: known by that byte alone.
  const auto byte = repeated_bytes_.find(x);
  auto* constant = llvm::dyn_cast<llvm::Constant>(y);
  if (constant) constant = constant->getSplatValue();
  if (const auto* added = llvm::dyn_cast_or_null<llvm::ConstantInt>(constant);
      added && byte != repeated_bytes_.end()) {
    spread_bytes_[sum] = {byte->second, static_cast<std::uint32_t>(added->getZExtValue())};
  }
  return sum;
}

// Each byte is the index of one of 16; where its top bit is set the result is 0.
llvm::Value* FunctionEmitter::shuffle_bytes(llvm::ArrayRef<std::uint8_t> row, llvm::Value* bytes) {
  const unsigned piece = parent_.byte_piece(lanes_of(bytes));
  const auto id = piece == 64   ? llvm::Intrinsic::x86_avx512_pshuf_b_512
                  : piece == 32 ? llvm::Intrinsic::x86_avx2_pshuf_b
                                : llvm::Intrinsic::x86_ssse3_pshuf_b_128;
  llvm::SmallVector<std::uint8_t, 64> rows;
  for (unsigned i = 0; i < piece; ++i) rows.push_back(row[i % 16]);
  llvm::Constant* table = llvm::ConstantDataVector::get(context_, rows);
  return by_pieces(b_, bytes, piece, [&](llvm::Value* v) {
    return b_.CreateIntrinsic(id, {}, {table, v});
  });
}

// `yes` where a byte's top bit in `mask` is set.
llvm::Value* FunctionEmitter::choose_bytes(llvm::Value* mask, llvm::Value* yes, llvm::Value* no) {
  const unsigned lanes = lanes_of(mask);
  if (lanes == 16 || (lanes == 32 && parent_.target().avx2)) {
    const auto id =
        lanes == 32 ? llvm::Intrinsic::x86_avx2_pblendvb : llvm::Intrinsic::x86_sse41_pblendvb;
    return b_.CreateIntrinsic(id, {}, {no, yes, mask});
  }
  llvm::Value* zero = llvm::Constant::getNullValue(mask->getType());
  return b_.CreateSelect(b_.CreateICmpSLT(mask, zero), yes, no);
}

llvm::Value* FunctionEmitter::bytes_lookup(const ir::ByteTable& table, llvm::Value* index,
                                           bool low_half) {
  if (lanes_of(index) == 1) return bytes_lookup_scalar(table, index);
  if (const auto spread = spread_bytes_.find(index);
      spread != spread_bytes_.end() && parent_.target().avx2 && !parent_.target().avx512) {
    return spread_byte_lookup(table, spread->second.first, spread->second.second);
  }
  llvm::Value* bytes = b_.CreateBitCast(index, lanes_type(b_.getInt8Ty(), 4 * lanes_of(index)));
  const unsigned piece = parent_.byte_piece(lanes_of(bytes));
  const auto lookup = [&](llvm::Value* v) {
    if (parent_.target().vbmi) return bytes_lookup_vbmi(table, v);
    if (piece == 64 || !parent_.target().avx2) return bytes_lookup_shuffles(table, v);
    return low_half ? low_half_lookup(table, v) : bytes_lookup_blends(table, v);
  };
  return b_.CreateBitCast(by_pieces(b_, bytes, piece, lookup), index->getType());
}

// What the four sums of one byte with the bytes of `added` find: one entry of a table of words.
llvm::Value* FunctionEmitter::spread_byte_lookup(const ir::ByteTable& table, llvm::Value* byte,
                                                 std::uint32_t added) {
  llvm::SmallVector<llvm::Constant*, 256> words;
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t word = 0;
    for (unsigned shift = 0; shift < 32; shift += 8)
      word |= std::uint32_t{table.entries[(i + (added >> shift)) & 255]} << shift;
    words.push_back(b_.getInt32(word));
  }
  return table_lookup(words, byte);
}

// The table in four registers: two lookups in 128 entries each, and the top bit chooses.
llvm::Value* FunctionEmitter::bytes_lookup_vbmi(const ir::ByteTable& table, llvm::Value* bytes) {
  const auto part = [&](std::size_t i) {
    return llvm::ConstantDataVector::get(context_, llvm::ArrayRef(table.entries).slice(64 * i, 64));
  };
  const auto lookup = [&](std::size_t i) {
    return b_.CreateIntrinsic(llvm::Intrinsic::x86_avx512_vpermi2var_qi_512, {},
                              {part(i), bytes, part(i + 1)});
  };
  return choose_bytes(bytes, lookup(2), lookup(0));
}

// Bit `bit` of each byte on top; the bits below are others'.
llvm::Value* FunctionEmitter::bit_on_top(llvm::Value* bytes, unsigned bit) {
  if (bit == 7) return bytes;
  llvm::Type* words = lanes_type(i32_, lanes_of(bytes) / 4);
  llvm::Value* shifted =
      b_.CreateShl(b_.CreateBitCast(bytes, words), llvm::ConstantInt::get(words, 7 - bit));
  return b_.CreateBitCast(shifted, bytes->getType());
}

// The entries of 16-byte rows [first, first + count), count a power of two: the bits of an index
// from `bit` on say which row, `on_top` holds them. 0 where the top bit of `low` is set.
llvm::Value* FunctionEmitter::choose_row(llvm::ArrayRef<std::uint8_t> rows, std::size_t first,
                                         std::size_t count, llvm::Value* low,
                                         llvm::ArrayRef<llvm::Value*> on_top) {
  if (count == 1) return shuffle_bytes(rows.slice(16 * first, 16), low);
  llvm::Value* no = choose_row(rows, first, count / 2, low, on_top.drop_back());
  llvm::Value* yes = choose_row(rows, first + count / 2, count / 2, low, on_top.drop_back());
  return choose_bytes(on_top.back(), yes, no);
}

// Sixteen shuffles of 16 entries, chosen among by bits 4 to 6; of the two halves of the table, the
// one that a shuffle is told to skip gives 0.
llvm::Value* FunctionEmitter::bytes_lookup_blends(const ir::ByteTable& table, llvm::Value* bytes) {
  llvm::Value* on_top[] = {bit_on_top(bytes, 4), bit_on_top(bytes, 5), bit_on_top(bytes, 6)};
  llvm::Value* other = b_.CreateXor(bytes, llvm::ConstantInt::get(bytes->getType(), 0x80));
  llvm::Value* below = choose_row(table.entries, 0, 8, bytes, on_top);
  return b_.CreateOr(below, choose_row(table.entries, 8, 8, other, on_top));
}

// The same where nobody looks at the upper half of a byte: two rows share one, and half as many
// shuffles do.
llvm::Value* FunctionEmitter::low_half_lookup(const ir::ByteTable& table, llvm::Value* bytes) {
  llvm::SmallVector<std::uint8_t, 128> shared;
  for (std::size_t i = 0; i < 128; ++i) {
    const std::size_t entry = i / 16 * 32 + i % 16;
    shared.push_back(
        static_cast<std::uint8_t>((table.entries[entry] & 15) | (table.entries[entry + 16] << 4)));
  }
  llvm::Value* on_top[] = {bit_on_top(bytes, 5), bit_on_top(bytes, 6)};
  llvm::Value* other = b_.CreateXor(bytes, llvm::ConstantInt::get(bytes->getType(), 0x80));
  llvm::Value* below = choose_row(shared, 0, 4, bytes, on_top);
  llvm::Value* even = b_.CreateOr(below, choose_row(shared, 4, 4, other, on_top));
  llvm::Type* words = lanes_type(i32_, lanes_of(bytes) / 4);
  llvm::Value* odd = b_.CreateLShr(b_.CreateBitCast(even, words), llvm::ConstantInt::get(words, 4));
  return choose_bytes(bit_on_top(bytes, 4), b_.CreateBitCast(odd, bytes->getType()), even);
}

// Sixteen shuffles of 16 entries. A shuffle gives 0 where the index is negative, so with the index
// lowered by 16 at each step the steps 0..k all answer an index of row k; tables that hold the
// difference to the row before (by exclusive or) make the sum of these answers the entry.
// Saturation keeps negative indices negative, so that each half of the table answers only for its
// own half of the indices.
llvm::Value* FunctionEmitter::bytes_lookup_shuffles(const ir::ByteTable& table,
                                                    llvm::Value* bytes) {
  const auto splat_byte = [&](unsigned value) {
    return llvm::ConstantInt::get(bytes->getType(), value);
  };
  llvm::Value* result = nullptr;
  for (unsigned half = 0; half < 2; ++half) {
    llvm::Value* index = half == 0 ? bytes : b_.CreateXor(bytes, splat_byte(0x80));
    for (unsigned row = 0; row < 8; ++row) {
      std::array<std::uint8_t, 16> difference{};
      for (unsigned i = 0; i < 16; ++i) {
        const unsigned entry = 128 * half + 16 * row + i;
        const unsigned before = row == 0 ? 0u : table.entries[entry - 16];
        difference[i] = static_cast<std::uint8_t>(table.entries[entry] ^ before);
      }
      llvm::Value* lowered = row == 0 ? index
                                      : b_.CreateBinaryIntrinsic(llvm::Intrinsic::ssub_sat, index,
                                                                 splat_byte(16 * row));
      llvm::Value* answer = shuffle_bytes(difference, lowered);
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
