// Slicing and joining vectors.
#include "codegen/llvm/vector_tools.h"

namespace pse {

unsigned lanes_of(const llvm::Value* value) {
  const auto* vector = llvm::dyn_cast<llvm::FixedVectorType>(value->getType());
  return vector ? vector->getNumElements() : 1;
}

llvm::Type* lanes_type(llvm::Type* type, unsigned lanes) {
  return lanes == 1 ? type : llvm::FixedVectorType::get(type, lanes);
}

llvm::Value* lanes_slice(IrBuilder& b, llvm::Value* value, unsigned first, unsigned count) {
  llvm::SmallVector<int, 64> mask;
  for (unsigned i = 0; i < count; ++i) {
    mask.push_back(first + i < lanes_of(value) ? static_cast<int>(first + i) : -1);
  }
  return b.CreateShuffleVector(value, mask);
}

llvm::Value* lanes_concat(IrBuilder& b, llvm::Value* low, llvm::Value* high) {
  llvm::SmallVector<int, 64> mask;
  for (unsigned i = 0; i < 2 * lanes_of(low); ++i) mask.push_back(static_cast<int>(i));
  return b.CreateShuffleVector(low, high, mask);
}

llvm::Value* by_pieces(IrBuilder& b, llvm::Value* value, unsigned piece,
                       const std::function<llvm::Value*(llvm::Value*)>& f) {
  const unsigned lanes = lanes_of(value);
  if (lanes == piece) return f(value);
  if (lanes < piece) return lanes_slice(b, f(lanes_slice(b, value, 0, piece)), 0, lanes);
  llvm::Value* low = by_pieces(b, lanes_slice(b, value, 0, lanes / 2), piece, f);
  llvm::Value* high = by_pieces(b, lanes_slice(b, value, lanes / 2, lanes / 2), piece, f);
  return lanes_concat(b, low, high);
}

}  // namespace pse
