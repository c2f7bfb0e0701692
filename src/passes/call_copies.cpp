// Finding, describing and moving copies. A copy's shape lists its operators and where their
// operands come from: the number of a value defined inside, or -1 for what comes from outside.
#include "passes/call_copies.h"

#include <algorithm>

#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

}  // namespace

// Collects what CallCopy says of its instructions.
struct CallBody::Describer {
  const CallBody& body;
  CallCopy& copy;
  bool movable = true;

  void use(const std::vector<Value>& values) {
    copy.shape.push_back(static_cast<std::int32_t>(values.size()));
    for (const Value value : values) {
      Inside& inside = body.inside_[value];
      if (inside.number >= 0 && body.leaves_[value] == nullptr) {
        ++inside.uses;
        copy.shape.push_back(inside.number);
      } else {
        copy.shape.push_back(-1);
        copy.shape.push_back(static_cast<std::int32_t>(body.type(value)));
        copy.outside.push_back(value);
      }
    }
  }
  void define(const std::vector<Value>& values) {
    for (const Value value : values) {
      body.inside_[value] = {static_cast<std::int32_t>(copy.defined.size()), 0};
      copy.defined.push_back(value);
      copy.shape.push_back(static_cast<std::int32_t>(body.type(value)));
    }
  }
  void walk(const Instruction& in) {
    if (is_leaf(in)) return;
    if (reads_array(in.op) || writes_array(in.op) || is_effect(in)) movable = false;
    ++copy.size;
    copy.shape.insert(copy.shape.end(), {static_cast<std::int32_t>(in.op), in.imm, in.component});
    use(in.operands);
    for (const Region& region : in.regions) {
      define(region.params);
      for (const Instruction& inner : region.body) walk(inner);
      copy.shape.push_back(-2);
      use(region.yields);
    }
    define(in.results);
  }
};

bool is_leaf(const Instruction& in) { return is_constant(in.op) || in.op == Op::input; }

CallBody::CallBody(ir::Function& function)
    : function_(function),
      places_(function.values.size()),
      leaves_(function.values.size()),
      uses_(function.values.size()),
      inside_(function.values.size()) {
  walk(function.body, 0);
}

void CallBody::walk(Region& region, int depth) {
  for (const Value value : region.params) places_[value] = {};
  for (std::size_t i = 0; i < region.body.size(); ++i) {
    Instruction& in = region.body[i];
    for (const Value value : in.operands) ++uses_[value];
    for (Region& inner : in.regions) walk(inner, depth + 1);
    for (const Value value : in.results) places_[value] = {&region, i, depth};
    if (is_leaf(in)) leaves_[in.result()] = &in;
  }
  for (const Value value : region.yields) ++uses_[value];
}

const Instruction* CallBody::leaf(Value value) const {
  return value < leaves_.size() ? leaves_[value] : nullptr;
}

std::optional<CallCopy> CallBody::find(const ir::CallRange& call) const {
  // The outermost region that the call's values are defined in, and where.
  Place outermost{nullptr, 0, 1 << 20};
  for (Value value = call.first; value < call.end && value < places_.size(); ++value) {
    if (places_[value].region && places_[value].depth < outermost.depth) outermost = places_[value];
  }
  if (!outermost.region) return std::nullopt;
  CallCopy copy{.values = call, .region = outermost.region, .from = outermost.position};
  for (Value value = call.first; value < call.end && value < places_.size(); ++value) {
    const Place& place = places_[value];
    if (place.depth != outermost.depth || !place.region) continue;
    if (place.region != outermost.region) return std::nullopt;
    copy.from = std::min(copy.from, place.position);
    copy.to = std::max(copy.to, place.position + 1);
  }
  // Nothing of anybody else's between.
  for (std::size_t i = copy.from; i < copy.to; ++i) {
    for (const Value value : copy.region->body[i].results)
      if (value < call.first || value >= call.end) return std::nullopt;
  }
  if (!describe(copy)) return std::nullopt;
  return copy;
}

bool CallBody::describe(CallCopy& copy) const {
  Describer describer{*this, copy};
  for (std::size_t i = copy.from; i < copy.to; ++i) describer.walk(copy.region->body[i]);
  for (std::size_t i = 0; i < copy.defined.size(); ++i) {
    Inside& inside = inside_[copy.defined[i]];
    if (uses_[copy.defined[i]] > inside.uses) copy.live.push_back(i);
    inside = {};
  }
  return describer.movable && copy.size > 0;
}

void CopyWriter::write(const CallCopy& copy) {
  next_outside_ = 0;
  for (std::size_t i = copy.from; i < copy.to; ++i) {
    const Instruction& in = copy.region->body[i];
    if (!is_leaf(in)) to_.body.body.push_back(clone(in));
  }
}

std::optional<ir::CallRange> CopyWriter::range_of(const CallCopy& inner) const {
  ir::CallRange range{inner.values.callee, ir::no_value, 0};
  for (const Value value : inner.defined) {
    const auto found = fresh_.find(value);
    if (found == fresh_.end()) return std::nullopt;
    range.first = std::min(range.first, found->second);
    range.end = std::max(range.end, found->second + 1);
  }
  return range;
}

Instruction CopyWriter::clone(const Instruction& in) {
  Instruction made{.op = in.op,
                   .operands = used(in.operands),
                   .imm = in.imm,
                   .component = in.component,
                   .span = in.span};
  for (const Region& region : in.regions) {
    Region inner{.params = define(region.params)};
    for (const Instruction& nested : region.body)
      if (!is_leaf(nested)) inner.body.push_back(clone(nested));
    inner.yields = used(region.yields);
    made.regions.push_back(std::move(inner));
  }
  made.results = define(in.results);
  return made;
}

std::vector<Value> CopyWriter::used(const std::vector<Value>& values) {
  std::vector<Value> made;
  for (const Value value : values) {
    const auto found = fresh_.find(value);
    made.push_back(found != fresh_.end() ? found->second : outside[next_outside_++]);
  }
  return made;
}

std::vector<Value> CopyWriter::define(const std::vector<Value>& values) {
  std::vector<Value> made;
  for (const Value value : values) {
    made.push_back(to_.add_value(from_.values[value].type));
    fresh_[value] = made.back();
  }
  return made;
}

}  // namespace pse::passes
