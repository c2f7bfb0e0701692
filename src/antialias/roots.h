// Comparisons seen through a root: sqrt(a) > 0 and cbrt(a) > b part the picture where a > 0 and
// a > b^3 do, but the root's own slope says nothing of how far that is: it is infinite there, and
// beyond it there may be no number.
#pragma once

#include <string>
#include <unordered_map>

#include "ir/module.h"
#include "passes/emit.h"

namespace pse::antialias {

class Roots {
 public:
  // Of the main function, as it is now.
  explicit Roots(const ir::Module& module);

  struct Sides {
    ir::Value a, b;
  };
  // What the sides of a comparison stand for: these themselves, or what one of them is a root of
  // and the other's power.
  Sides under(const passes::Emit& emit, Sides sides) const;

 private:
  enum class Kind : std::uint8_t { square, cube };
  struct Root {
    Kind kind;
    ir::Value of;
  };
  void find(const ir::Module& module, const ir::Region& region);
  bool opens(const passes::Emit& emit, ir::Value root, ir::Value other) const;

  std::unordered_map<ir::Value, Root> roots_;
  std::unordered_map<ir::Value, float> constants_;
};

}  // namespace pse::antialias
