// The derivative of a program by the place in the picture, in forward mode: every value that
// changes from sample to sample carries its two slopes with it, rightward and downward, in the unit
// of one pixel. passes/slopes.cpp answers a program's own questions with it (`Dx`, `filterwidth`),
// antialias/derive.cpp finds the edges around a sample.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "passes/emit.h"
#include "passes/slice.h"

namespace pse::passes {

using Slopes = std::array<ir::Value, 2>;  // no_value: 0

using ir::InputSlopes;
using SlopesOfInput = std::array<InputSlopes, 2>;  // rightward and downward; none: 0

// What follows the derivation along the program's way and carries floats of its own through
// conditionals and loops.
class Watcher {
 public:
  using SlopesOf = std::function<Slopes(ir::Value)>;

  virtual ~Watcher() = default;
  // What is carried at the program's beginning.
  virtual std::vector<ir::Value> start(const Emit& emit) = 0;
  // Behind each instruction without regions that has one result.
  virtual void see(const Emit& emit, const ir::Instruction& in, const SlopesOf& slopes,
                   std::vector<ir::Value>& carried) = 0;
};

struct Derivation {
  const Slice* needed = nullptr;  // the values whose slopes are used; null: any may be
  Watcher* watcher = nullptr;
  bool yield_slopes = false;  // the main function then yields two slopes for each of its results,
                              // behind these
};

// Derives the main function in place and replaces its `slope` instructions. `inputs` holds one
// entry for each of the module's; where these have slopes, inputs "NAME$x" and "NAME$y" are added
// unless they are there. Returns what the watcher carries at the end.
std::vector<ir::Value> derive_main(ir::Module& module, const std::vector<SlopesOfInput>& inputs,
                                   const Derivation& how);

// Whether there is a `slope` instruction.
bool asks_for_slopes(const ir::Region& region);

}  // namespace pse::passes
