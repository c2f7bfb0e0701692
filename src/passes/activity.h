// Which values of a function change with the place in the picture, so that they have a derivative
// to carry along.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "ir/module.h"

namespace pse::passes {

// Floats only: integers and truth values are steps, which have no slope.
struct Active {
  std::vector<bool> values;   // per value of the function
  std::vector<bool> arrays;   // per array: whether any element does
  std::vector<bool> results;  // per yield of the function
};

class Activity {
 public:
  // `inputs`: which of the module's are active.
  Activity(const ir::Module& module, std::vector<bool> inputs)
      : module_(module), inputs_(std::move(inputs)) {}

  // For these parameters being active. The answer stays where it is.
  const Active& of(std::uint32_t function, const std::vector<bool>& parameters);

 private:
  bool walk(const ir::Function& function, const ir::Region& region, Active& active);
  bool visit(const ir::Function& function, const ir::Instruction& in, Active& active);

  const ir::Module& module_;
  std::vector<bool> inputs_;
  std::map<std::pair<std::uint32_t, std::vector<bool>>, Active> known_;
};

}  // namespace pse::passes
