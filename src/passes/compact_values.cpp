// Numbers values anew in the order of their definition, so that frames and tables hold only what is
// there.
#include <utility>

#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

class Compactor {
 public:
  explicit Compactor(ir::Function& function)
      : function_(function), renaming_(function.values.size()) {}

  void run() {
    renumber(function_.body);
    function_.values = std::move(values_);
  }

 private:
  void define(std::vector<ir::Value>& values) {
    for (ir::Value& value : values) {
      values_.push_back(function_.values[value]);
      const auto number = static_cast<ir::Value>(values_.size() - 1);
      renaming_.set(value, number);
      value = number;
    }
  }

  void renumber(ir::Region& region) {
    define(region.params);
    for (ir::Instruction& in : region.body) {
      renaming_.apply(in.operands);
      for (ir::Region& inner : in.regions) renumber(inner);
      define(in.results);
    }
    renaming_.apply(region.yields);
  }

  ir::Function& function_;
  Renaming renaming_;
  std::vector<ir::ValueInfo> values_;
};

}  // namespace

void compact_values(ir::Module& module) {
  for (ir::Function& function : module.functions) Compactor(function).run();
}

}  // namespace pse::passes
