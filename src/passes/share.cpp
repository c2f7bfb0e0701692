// Common subexpressions: an instruction that computes what one that dominates it has computed is
// replaced by it. Loads are shared too as long as no write can lie between.
#include <unordered_map>
#include <utility>

#include "passes/passes.h"
#include "passes/rewrite.h"

namespace pse::passes {
namespace {

using ir::Function;
using ir::Instruction;
using ir::Op;
using ir::Region;
using ir::Value;

// What an instruction computes; two with equal keys give equal results.
struct Key {
  Op op;
  std::int32_t imm;
  std::int32_t component;
  std::uint64_t memory;  // loads: which state of the array is read
  std::vector<Value> operands;
  friend bool operator==(const Key&, const Key&) = default;
};

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t hash =
        static_cast<std::uint64_t>(key.op) << 32 ^ static_cast<std::uint32_t>(key.imm);
    const auto mix = [&](std::uint64_t part) {
      hash = (hash ^ part) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 29;
    };
    mix(static_cast<std::uint32_t>(key.component));
    mix(key.memory);
    for (const Value operand : key.operands) mix(operand);
    return static_cast<std::size_t>(hash);
  }
};

bool commutes(Op op) {
  switch (op) {
    case Op::fadd:
    case Op::fmul:
    case Op::fma:  // its first two
    case Op::feq:
    case Op::fne:
    case Op::iadd:
    case Op::imul:
    case Op::iand:
    case Op::ior:
    case Op::ixor:
    case Op::ieq:
    case Op::ine:
    case Op::band:
    case Op::bor:
    case Op::bxor:
    case Op::bytes_add:
      return true;
    default:
      return false;
  }
}

class Sharing {
 public:
  explicit Sharing(Function& function)
      : function_(function),
        renaming_(function.values.size()),
        array_state_(function.arrays.size(), 0) {}

  void run() { walk(function_.body); }

 private:
  using Table = std::unordered_map<Key, std::vector<Value>, KeyHash>;

  void walk(Region& region) {
    const std::size_t before = entered_.size();
    std::size_t next = 0;
    for (Instruction& in : region.body) {
      renaming_.apply(in.operands);
      if (has_regions(in.op)) {
        walk_regions(in);
      } else if (writes_array(in.op)) {
        array_state_[static_cast<std::size_t>(in.imm)] = ++state_;
      } else if (!is_effect(in) && is_shared(in)) {
        continue;
      }
      Instruction& place = region.body[next++];
      if (&place != &in) place = std::move(in);
    }
    region.body.resize(next);
    renaming_.apply(region.yields);
    // What was computed in this region is not visible behind it.
    while (entered_.size() > before) {
      table_.erase(table_.find(*entered_.back()));
      entered_.pop_back();
    }
  }

  // Regions that write make the memory before and after them differ; a loop's also that of its
  // turns.
  void walk_regions(Instruction& in) {
    for (Region& inner : in.regions) {
      if (in.op == Op::loop) memory_ = ++state_;
      const std::uint64_t written = state_;
      walk(inner);
      if (state_ != written) memory_ = ++state_;
    }
    if (in.op == Op::loop) memory_ = ++state_;
  }

  bool is_shared(const Instruction& in) {
    Key key{in.op, in.imm, in.component, 0, in.operands};
    if (commutes(in.op) && key.operands[0] > key.operands[1])
      std::swap(key.operands[0], key.operands[1]);
    if (reads_array(in.op))
      key.memory = std::max(memory_, array_state_[static_cast<std::size_t>(in.imm)]);
    const auto [place, is_new] = table_.try_emplace(std::move(key), in.results);
    if (is_new) {
      entered_.push_back(&place->first);
      return false;
    }
    for (std::size_t i = 0; i < in.results.size(); ++i)
      renaming_.set(in.results[i], place->second[i]);
    return true;
  }

  Function& function_;
  Renaming renaming_;
  Table table_;
  std::vector<const Key*> entered_;         // in order, to leave regions by
  std::vector<std::uint64_t> array_state_;  // the number of the last write to each array
  std::uint64_t memory_ = 0;  // the number of the last write that may have been to any array
  std::uint64_t state_ = 0;
};

}  // namespace

void share(ir::Module& module) {
  for (Function& function : module.functions) Sharing(function).run();
}

}  // namespace pse::passes
