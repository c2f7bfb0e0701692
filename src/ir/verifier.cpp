// The rules of module.h and ops.h, checked one instruction at a time. See the header.
#include "ir/verifier.h"

#include <bit>
#include <span>
#include <utility>

namespace pse::ir {
namespace {

constexpr std::size_t max_complaints = 100;

std::string_view name_of(Type type) {
  return type == Type::f32 ? "f" : type == Type::i32 ? "i" : "b";
}

bool matches(char letter, Type type) { return name_of(type).front() == letter; }

class Verifier {
 public:
  explicit Verifier(const Module& module) : module_(module) {}

  std::vector<std::string> run() {
    if (module_.entry >= module_.functions.size()) {
      complain("the module has no entry function");
      return std::move(complaints_);
    }
    check_tables();
    called_.resize(module_.functions.size());
    for (const Function& function : module_.functions) find_called(function.body);
    for (std::size_t i = 0; i < module_.functions.size(); ++i) check_function(i);
    check_entry();
    check_calls_end();
    return std::move(complaints_);
  }

 private:
  void complain(std::string sentence) {
    if (complaints_.size() < max_complaints) complaints_.push_back(where_ + std::move(sentence));
  }
  void complain(const Instruction& in, const std::string& sentence) {
    const std::string result =
        in.results.empty() ? "" : "%" + std::to_string(in.results.front()) + " = ";
    complain(result + std::string(info(in.op).name) + ": " + sentence);
  }

  void check_tables() {
    for (const FloatTable& table : module_.float_tables)
      check_size(table.name, table.entries.size());
    for (const IntTable& table : module_.int_tables) check_size(table.name, table.entries.size());
    for (const ByteTable& table : module_.byte_tables) {
      if (table.entries.size() != 256)
        complain("byte table '" + table.name + "' must have 256 entries");
    }
  }

  void check_size(const std::string& name, std::size_t size) {
    if (!std::has_single_bit(size))
      complain("the size of table '" + name + "' must be a power of two");
  }

  void find_called(const Region& region) {
    for (const Instruction& in : region.body) {
      const auto callee = static_cast<std::size_t>(in.imm);
      if (in.op == Op::call && callee < called_.size()) called_[callee] = true;
      for (const Region& inner : in.regions) find_called(inner);
    }
  }

  void check_function(std::size_t index) {
    function_ = &module_.functions[index];
    is_called_ = called_[index];
    where_ = function_->name + ": ";
    defined_.assign(function_->values.size(), false);
    visible_.assign(function_->values.size(), false);
    if (is_called_ && !function_->arrays.empty()) complain("a called function has no arrays");
    for (const Array& array : function_->arrays) {
      if (array.components < 1 || array.capacity < 0)
        complain("array '" + array.name + "' has no size");
      if (array.initial_length < 0 || array.initial_length > array.capacity) {
        complain("the initial length of array '" + array.name + "' is not within its capacity");
      }
    }
    check_region(function_->body);
    where_.clear();
  }

  // What a region defines is visible from there to the region's end.
  void check_region(const Region& region) {
    std::vector<Value> local;
    for (const Value param : region.params) define(param, local);
    for (const Instruction& in : region.body) {
      check_instruction(in);
      for (const Value result : in.results) define(result, local);
    }
    for (const Value value : region.yields) use(value, "a yield");
    for (const Value value : local) visible_[value] = false;
  }

  void define(Value value, std::vector<Value>& local) {
    if (value >= defined_.size())
      return complain("%" + std::to_string(value) + " is not among the function's values");
    if (defined_[value]) return complain("%" + std::to_string(value) + " is defined twice");
    defined_[value] = true;
    visible_[value] = true;
    local.push_back(value);
  }

  bool use(Value value, const std::string& user) {
    if (value < visible_.size() && visible_[value]) return true;
    complain(user + " uses " + (value == no_value ? "no value" : "%" + std::to_string(value)) +
             ", which is not visible there");
    return false;
  }

  // The type of a value that may be out of range; f then, since the range has been complained of.
  Type type(Value value) const {
    return value < function_->values.size() ? function_->values[value].type : Type::f32;
  }

  void check_instruction(const Instruction& in) {
    const OpInfo& op = info(in.op);
    bool sound = true;
    for (const Value operand : in.operands) sound = use(operand, std::string(op.name)) && sound;
    if (sound) {
      check_letters(in, op);
      check_index(in);
    }
    const std::size_t regions = in.op == Op::if_ || in.op == Op::loop ? 2 : 0;
    if (in.regions.size() != regions) return complain(in, "wrong number of regions");
    if (in.op == Op::if_) check_if(in);
    if (in.op == Op::loop) check_loop(in);
  }

  // Operands and results against the letters of the operator table.
  void check_letters(const Instruction& in, const OpInfo& op) {
    if (op.operands != "*") {
      if (in.operands.size() != op.operands.size()) return complain(in, "wrong number of operands");
      for (std::size_t i = 0; i < in.operands.size(); ++i) {
        const Type actual = type(in.operands[i]);
        const bool generic = op.operands[i] == 'T';
        const bool right =
            generic ? actual == type(in.operands.back()) : matches(op.operands[i], actual);
        if (!right) complain(in, "operand " + std::to_string(i + 1) + " has the wrong type");
      }
    }
    if (op.results == "*") return;
    if (in.results.size() != op.results.size()) return complain(in, "wrong number of results");
    for (std::size_t i = 0; i < in.results.size(); ++i) {
      const Type actual = type(in.results[i]);
      const bool generic = op.results[i] == 'T';
      const bool right =
          generic ? actual == type(in.operands.back()) : matches(op.results[i], actual);
      if (!right) complain(in, "the result has the wrong type");
    }
  }

  void check_range(const Instruction& in, std::size_t size, const char* what) {
    if (in.imm < 0 || static_cast<std::size_t>(in.imm) >= size)
      complain(in, std::string("there is no such ") + what);
  }

  void check_index(const Instruction& in) {
    switch (in.op) {
      case Op::input:
        if (is_called_) complain(in, "a called function has no inputs");
        return check_range(in, module_.inputs.size(), "input");
      case Op::slope:
        if (is_called_) complain(in, "a called function has no place in the picture");
        return check_range(in, 2, "direction");
      case Op::table_f32:
        return check_range(in, module_.float_tables.size(), "float table");
      case Op::table_i32:
        return check_range(in, module_.int_tables.size(), "integer table");
      case Op::bytes_lookup:
        return check_range(in, module_.byte_tables.size(), "byte table");
      case Op::array_load:
      case Op::array_store:
      case Op::array_length:
      case Op::array_resize:
        return check_array(in);
      case Op::check:
        if (is_called_) complain(in, "a called function is pure");
        return check_range(in, module_.checks.size(), "check");
      case Op::call:
        return check_call(in);
      case Op::external:
        return check_external(in);
      default:
        return;
    }
  }

  void check_array(const Instruction& in) {
    if (is_called_) complain(in, "a called function is pure");
    const auto index = static_cast<std::size_t>(in.imm);
    if (in.imm < 0 || index >= function_->arrays.size())
      return complain(in, "there is no such array");
    const bool has_component = in.op == Op::array_load || in.op == Op::array_store;
    if (has_component &&
        (in.component < 0 || in.component >= function_->arrays[index].components)) {
      complain(in, "the array has no such component");
    }
  }

  void check_call(const Instruction& in) {
    const auto index = static_cast<std::size_t>(in.imm);
    if (in.imm < 0 || index >= module_.functions.size())
      return complain(in, "there is no such function");
    const Function& callee = module_.functions[index];
    check_types(in, in.operands, callee.body.params, &callee, "operands");
    check_types(in, in.results, callee.body.yields, &callee, "results");
  }

  // `given` in this function against `wanted` in `owner`.
  void check_types(const Instruction& in, std::span<const Value> given,
                   std::span<const Value> wanted, const Function* owner, const std::string& what) {
    if (given.size() != wanted.size()) return complain(in, "wrong number of " + what);
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (wanted[i] >= owner->values.size() || type(given[i]) != owner->values[wanted[i]].type) {
        complain(in, what + " have the wrong types");
        return;
      }
    }
  }

  void check_external(const Instruction& in) {
    const auto index = static_cast<std::size_t>(in.imm);
    if (in.imm < 0 || index >= module_.externals.size())
      return complain(in, "there is no such external");
    const External& external = module_.externals[index];
    if (std::cmp_not_equal(in.operands.size(), external.arguments))
      complain(in, "wrong number of operands");
    if (std::cmp_not_equal(in.results.size(), external.results))
      complain(in, "wrong number of results");
    for (const Value value : in.operands) {
      if (type(value) != Type::f32) complain(in, "an external takes floats");
    }
    for (const Value value : in.results) {
      if (type(value) != Type::f32) complain(in, "an external gives floats");
    }
  }

  void check_if(const Instruction& in) {
    for (const Region& region : in.regions) {
      if (!region.params.empty()) complain(in, "its regions have no parameters");
      check_region(region);
      check_types(in, in.results, region.yields, function_, "yields");
    }
  }

  void check_loop(const Instruction& in) {
    const Region& head = in.regions[0];
    const Region& body = in.regions[1];
    check_types(in, in.operands, head.params, function_, "parameters of the head");
    check_types(in, in.operands, body.params, function_, "parameters of the body");
    check_types(in, in.operands, body.yields, function_, "yields of the body");
    check_types(in, in.operands, in.results, function_, "results");
    if (head.yields.size() != 1 || type(head.yields[0]) != Type::boolean) {
      complain(in, "its head yields one boolean");
    }
    check_region(head);
    check_region(body);
  }

  void check_entry() {
    const Function& entry = module_.main();
    if (!entry.body.params.empty()) complain("the entry function has no parameters");
    if (called_[module_.entry]) complain("the entry function is never called");
    if (entry.body.yields.size() != module_.outputs.size())
      complain("the entry function yields one value per output");
    for (const Value value : entry.body.yields) {
      if (value < entry.values.size() && entry.values[value].type != Type::f32) {
        complain("outputs are floats");
        return;
      }
    }
  }

  // Calls must come to an end: no function calls itself, directly or through others.
  void check_calls_end() {
    state_.assign(module_.functions.size(), State::unseen);
    for (std::size_t i = 0; i < module_.functions.size(); ++i) {
      if (!ends(i)) return complain("function '" + module_.functions[i].name + "' calls itself");
    }
  }

  bool ends(std::size_t function) {
    if (state_[function] == State::done) return true;
    if (state_[function] == State::open) return false;
    state_[function] = State::open;
    const bool all_end = region_ends(module_.functions[function].body);
    state_[function] = State::done;
    return all_end;
  }

  bool region_ends(const Region& region) {
    for (const Instruction& in : region.body) {
      const auto callee = static_cast<std::size_t>(in.imm);
      if (in.op == Op::call && callee < module_.functions.size() && !ends(callee)) return false;
      for (const Region& inner : in.regions) {
        if (!region_ends(inner)) return false;
      }
    }
    return true;
  }

  enum class State : std::uint8_t { unseen, open, done };

  const Module& module_;
  const Function* function_ = nullptr;
  bool is_called_ = false;
  std::string where_;
  std::vector<bool> called_;
  std::vector<bool> defined_;
  std::vector<bool> visible_;
  std::vector<State> state_;
  std::vector<std::string> complaints_;
};

}  // namespace

std::vector<std::string> verify(const Module& module) { return Verifier(module).run(); }

}  // namespace pse::ir
