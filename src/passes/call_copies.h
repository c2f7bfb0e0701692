// The copies of called functions within a function: where each stands, what it takes and gives, and
// whether two are alike. For outline.cpp.
#pragma once

#include <optional>
#include <unordered_map>
#include <vector>

#include "ir/call_range.h"

namespace pse::passes {

// Constants and inputs: where they stand says nothing, so comparing and moving leaves them out.
bool is_leaf(const ir::Instruction& in);

// One call as it was written into its caller: instructions [from, to) of a region.
struct CallCopy {
  ir::CallRange values;
  ir::Region* region = nullptr;
  std::size_t from = 0, to = 0;
  std::size_t size = 0;             // instructions that are no leaves
  std::vector<std::int32_t> shape;  // equal for copies that are alike
  std::vector<ir::Value> outside;   // operands from outside, and leaves, as they occur
  std::vector<ir::Value> defined;   // what the instructions define, in order
  std::vector<std::size_t> live;    // of `defined`: used behind the copy
};

// A function's values: which are leaves, where they are defined, how often used.
class CallBody {
 public:
  explicit CallBody(ir::Function& function);
  // Nothing where the call's instructions do not stand together, or may not move: what touches
  // arrays or can fail must stay.
  std::optional<CallCopy> find(const ir::CallRange& call) const;
  // The instruction that defines `value` where that is a leaf, else null.
  const ir::Instruction* leaf(ir::Value value) const;
  ir::Type type(ir::Value value) const { return function_.values[value].type; }

 private:
  struct Place {
    ir::Region* region = nullptr;
    std::size_t position = 0;
    int depth = 0;
  };

  struct Inside {
    std::int32_t number = -1;  // among the values that the copy defines; -1: it does not
    std::uint32_t uses = 0;
  };
  struct Describer;

  void walk(ir::Region& region, int depth);
  bool describe(CallCopy& copy) const;

  ir::Function& function_;
  std::vector<Place> places_;
  std::vector<const ir::Instruction*> leaves_;  // per value: what defines it, if that is a leaf
  std::vector<std::uint32_t> uses_;
  mutable std::vector<Inside> inside_;  // of the copy that is being described
};

// Writes a copy into a function of its own.
class CopyWriter {
 public:
  CopyWriter(const ir::Function& from, ir::Function& to) : from_(from), to_(to) {}

  std::vector<ir::Value> outside;  // per CallCopy::outside: the value in the new function
  void write(const CallCopy& copy);
  ir::Value fresh(ir::Value value) const { return fresh_.at(value); }
  // The call range that a copy inside the one written has now.
  std::optional<ir::CallRange> range_of(const CallCopy& inner) const;

 private:
  ir::Instruction clone(const ir::Instruction& in);
  std::vector<ir::Value> used(const std::vector<ir::Value>& values);
  std::vector<ir::Value> define(const std::vector<ir::Value>& values);

  const ir::Function& from_;
  ir::Function& to_;
  std::unordered_map<ir::Value, ir::Value> fresh_;
  std::size_t next_outside_ = 0;
};

}  // namespace pse::passes
