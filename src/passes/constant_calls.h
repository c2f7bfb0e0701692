// Runs calls whose operands are all constants while compiling.
#pragma once

#include <optional>
#include <vector>

#include "ir/interpreter.h"
#include "ir/module.h"

namespace pse::passes {

class ConstantCalls {
 public:
  explicit ConstantCalls(const ir::Module& module);
  // The results of a function; nothing where it asks an external, turns for long, or the work done
  // so far is enough.
  std::optional<std::vector<ir::Bits>> run(std::uint32_t function,
                                           const std::vector<ir::Bits>& arguments);

 private:
  struct Size {
    bool known = false;
    bool has_external = false;
    double instructions = 0;  // with those of the functions it calls
  };
  const Size& measure(std::uint32_t function);
  void measure(const ir::Region& region, Size& size);

  const ir::Module& module_;
  ir::Interpreter interpreter_;
  std::vector<Size> sizes_;
  double work_left_ = 3e6;  // instructions, all calls together: some hundredths of a second
};

}  // namespace pse::passes
