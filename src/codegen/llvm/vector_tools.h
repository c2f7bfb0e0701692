// Small helpers over LLVM vectors: lanes, pieces of a machine register's size, whole-register
// intrinsics. Used by all parts of the emitter.
#pragma once

#include <functional>

#include <llvm/IR/IRBuilder.h>

namespace pse {

using IrBuilder = llvm::IRBuilder<>;

// Number of lanes; 1 for a scalar.
unsigned lanes_of(const llvm::Value* value);
// `type` itself for one lane.
llvm::Type* lanes_type(llvm::Type* type, unsigned lanes);
// The lanes [first, first + count); lanes past the end are poison.
llvm::Value* lanes_slice(IrBuilder& b, llvm::Value* value, unsigned first, unsigned count);
llvm::Value* lanes_concat(IrBuilder& b, llvm::Value* low, llvm::Value* high);

// Applies `f`, which takes and gives vectors of `piece` lanes, to a vector of any power-of-two
// number of lanes.
llvm::Value* by_pieces(IrBuilder& b, llvm::Value* value, unsigned piece,
                       const std::function<llvm::Value*(llvm::Value*)>& f);

}  // namespace pse
