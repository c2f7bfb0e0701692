// Recognising and dropping expectations.
#include "ir/expectations.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <unordered_map>

namespace pse::ir {
namespace {

constexpr std::string_view prefix = "expect ";

// Values that take the place of others, in the order of definition.
using Places = std::unordered_map<Value, Value>;

void put(const Places& places, std::vector<Value>& values) {
  for (Value& value : values)
    if (const auto found = places.find(value); found != places.end()) value = found->second;
}

void drop(const Module& module, Region& region, bool effects, Places& places) {
  std::size_t next = 0;
  for (Instruction& in : region.body) {
    put(places, in.operands);
    for (Region& inner : in.regions) drop(module, inner, effects, places);
    if ((effects || !in.results.empty()) && is_expectation(module, in)) {
      for (std::size_t i = 0; i < in.results.size(); ++i)
        places[in.results[i]] = in.operands[i + 1];
      continue;
    }
    Instruction& place = region.body[next++];
    if (&place != &in) place = std::move(in);
  }
  region.body.resize(next);
  put(places, region.yields);
}

void renumber(Region& region, const std::vector<std::int32_t>& numbers) {
  for (Instruction& in : region.body) {
    if (in.op == Op::external) in.imm = numbers[static_cast<std::size_t>(in.imm)];
    for (Region& inner : in.regions) renumber(inner, numbers);
  }
}

void drop(Module& module, bool effects) {
  if (!has_expectations(module)) return;
  for (Function& function : module.functions) {
    Places places;
    drop(module, function.body, effects, places);
  }
  // Nor does the host hear of their externals.
  std::vector<External> kept;
  std::vector<std::int32_t> numbers;
  for (External& external : module.externals) {
    numbers.push_back(static_cast<std::int32_t>(kept.size()));
    if (!expectation_of(external) || (!effects && external.results == 0))
      kept.push_back(std::move(external));
  }
  module.externals = std::move(kept);
  for (Function& function : module.functions) renumber(function.body, numbers);
}

}  // namespace

std::string expectation_name(std::int32_t check) {
  return std::string(prefix) + std::to_string(check);
}

std::optional<std::int32_t> expectation_of(const External& external) {
  const std::string_view name = external.name;
  const std::int32_t wanted = external.results == 0 ? 2 : external.results + 1;
  if (!name.starts_with(prefix) || external.arguments != wanted) return {};
  std::int32_t check = 0;
  const char* const end = name.data() + name.size();
  const auto [last, problem] = std::from_chars(name.data() + prefix.size(), end, check);
  if (problem != std::errc() || last != end || check < 0) return {};
  return check;
}

bool is_expectation(const Module& module, const Instruction& in) {
  return in.op == Op::external &&
         expectation_of(module.externals[static_cast<std::size_t>(in.imm)]).has_value();
}

bool has_expectations(const Module& module) {
  return std::ranges::any_of(module.externals, [](const External& external) {
    return expectation_of(external).has_value();
  });
}

void release_expected_values(Module& module) { drop(module, false); }
void drop_expectations(Module& module) { drop(module, true); }

}  // namespace pse::ir
