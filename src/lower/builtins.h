// The functions that programs call and that are written in C++: arithmetic, the math library,
// noise, vector intrinsics. One table says their names, parameters, ranges and errors; the lowering
// emits from it and `pse doc` prints it. The bodies are the templates of noise/, instantiated with
// IrFloat (lower/ir_value.h).
#pragma once

#include <expected>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ir/builder.h"

namespace pse {

// The components of one argument or result, all of type f32. A number is one component.
using Components = std::vector<ir::Value>;

// How a builtin's result is shaped.
enum class ResultShape : std::uint8_t {
  number,       // one component
  elementwise,  // as many components as the longest argument; arguments of one component are
                // repeated
  like_first,   // as many components as the first argument (for coordinates: as there are
                // coordinates)
  vector3,      // three components
};

// One entry of the table.
struct Builtin {
  std::string_view name;
  std::string_view group;       // "math", "noise", "vector", "choice"
  std::string_view parameters;  // as printed: "p, period = 256, seed = 0"; a name before `...`
                                // takes any number of arguments
  ResultShape result = ResultShape::number;
  std::string_view doc;      // what it is, with its range and greatest error
  std::string_view same_as;  // the entry this is another name of; empty: none
};

// All entries, in the order of the manual.
std::span<const Builtin> builtins();
// The entry of this name; nothing when there is none.
const Builtin* find_builtin(std::string_view name);

// The names of an entry's parameters, in order.
std::vector<std::string> parameter_names(const Builtin& builtin);

// One call as the lowering sees it: arguments in order, then those given by name.
struct BuiltinCall {
  std::string_view name;
  std::vector<Components> arguments;
  std::vector<std::pair<std::string, Components>> named;
};

// Emits calls of builtins into functions of one module. Large bodies are emitted once, as functions
// of the module that Op::call calls; small ones stand where they are used. A Builder keeps a
// reference into module.functions, so the host reserves room for `room_for_builtins` more before it
// makes one.
class BuiltinEmitter {
 public:
  static constexpr std::size_t room_for_builtins = 1024;
  explicit BuiltinEmitter(ir::Module& module) : module_(&module) {}

  // The components of the result, or what is wrong with the call, as one sentence without its full
  // stop.
  std::expected<Components, std::string> emit(ir::Builder& builder, const BuiltinCall& call);

 private:
  friend class BuiltinScope;
  ir::Module* module_;
  std::map<std::string, std::int32_t, std::less<>>
      functions_;  // by key: index into module_->functions
};

}  // namespace pse
