// The bounds of a call of a builtin function, by its name: of the math library and of the noises.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bounds/interval.h"
#include "ir/builder.h"
#include "lower/ir_value.h"

namespace pse::bounds {

using Range = Interval<IrFloat>;

// One operand of a call.
struct Argument {
  Range range;
  bool exact = false;  // both ends are the value itself
};

// Writes calls into a program. Functions that bound noises are added to the module at first use.
class Functions {
 public:
  explicit Functions(ir::Module& module) : module_(module) {}

  // What function `callee` can give, each of its results. `keys` are its integer operands. What is
  // not known is anything.
  std::vector<Range> call(ir::Builder& builder, std::int32_t callee,
                          const std::vector<Argument>& arguments, const std::vector<IrInt>& keys);

 private:
  std::vector<Range> noise(ir::Builder& builder, std::int32_t callee,
                           const std::vector<Argument>& arguments, const std::vector<IrInt>& keys);

  ir::Module& module_;
  std::map<std::string, std::int32_t> made_;
};

// By the name of a function of the math library.
Range bound_math(ir::Builder& builder, const ir::Module& module, std::int32_t callee,
                 const std::vector<Argument>& arguments);

}  // namespace pse::bounds
