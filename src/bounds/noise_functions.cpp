// The noises, whose IR functions are named after what they are made for: "noise.3",
// "vnoise.3.seeded", "dnoise.2.periodic" (lower/builtins_noise.cpp).
#include <string_view>

#include "bounds/functions.h"
#include "bounds/noise_bounds.h"

namespace pse::bounds {
namespace {

// What a function's name says.
struct NoiseName {
  std::string_view kind;
  std::size_t dimensions = 0;
  bool periodic = false, seeded = false;
};
NoiseName noise_name(std::string_view name) {
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos || dot + 1 >= name.size()) return {};
  const char digit = name[dot + 1];
  if (digit < '1' || digit > '4') return {};
  return {name.substr(0, dot), static_cast<std::size_t>(digit - '0'),
          name.find(".periodic") != std::string_view::npos,
          name.find(".seeded") != std::string_view::npos};
}

// The parameters: lower ends, upper ends, periods, key.
template <std::size_t N>
std::vector<IrFloat> write_bounds(bool three, bool periodic, const std::vector<IrFloat>& floats,
                                  const std::vector<IrInt>& keys) {
  std::array<Interval<IrFloat>, N> box;
  num::NoiseOptions<IrFloat, N> options;
  if (periodic) options.period.emplace();
  for (std::size_t axis = 0; axis < N; ++axis) {
    box[axis] = {floats[axis], floats[N + axis]};
    if (periodic) (*options.period)[axis] = floats[2 * N + axis];
  }
  if (!keys.empty()) options.key = keys[0];

  std::vector<IrFloat> ends;
  const auto add = [&](const auto& ranges) {
    for (const auto& range : ranges) {
      ends.push_back(range.lo);
      ends.push_back(range.hi);
    }
  };
  if (three) {
    add(bound_noise<3>(box, [&](const auto& place) {
      // Its options are those of plain numbers: lattice points have no derivative.
      return num::improved_vector_noise(place, options);
    }));
  } else {
    add(bound_noise<1>(
        box, [&](const auto& place) { return std::array{num::improved_noise(place, options)}; }));
  }
  return ends;
}

std::vector<IrFloat> write_bounds(const NoiseName& name, const std::vector<IrFloat>& floats,
                                  const std::vector<IrInt>& keys) {
  const bool three = name.kind == "vnoise";
  switch (name.dimensions) {
    case 1:
      return write_bounds<1>(three, name.periodic, floats, keys);
    case 2:
      return write_bounds<2>(three, name.periodic, floats, keys);
    case 3:
      return write_bounds<3>(three, name.periodic, floats, keys);
    default:
      return write_bounds<4>(three, name.periodic, floats, keys);
  }
}

}  // namespace

std::vector<Range> Functions::call(ir::Builder& builder, std::int32_t callee,
                                   const std::vector<Argument>& arguments,
                                   const std::vector<IrInt>& keys) {
  const ir::Function& function = module_.functions[static_cast<std::size_t>(callee)];
  if (noise_name(function.name).dimensions > 0) return noise(builder, callee, arguments, keys);
  if (function.body.yields.size() == 1 && keys.empty())
    return {bound_math(builder, module_, callee, arguments)};
  return std::vector<Range>(function.body.yields.size(), anything<IrFloat>());
}

std::vector<Range> Functions::noise(ir::Builder& builder, std::int32_t callee,
                                    const std::vector<Argument>& arguments,
                                    const std::vector<IrInt>& keys) {
  const ir::Function& called = module_.functions[static_cast<std::size_t>(callee)];
  const std::string key = called.name;
  const NoiseName name = noise_name(key);
  const std::size_t n = name.dimensions, results = called.body.yields.size();

  // Everywhere, for places that are numbers.
  const auto within = [&](float limit) {
    IrBool finite(true);
    for (std::size_t axis = 0; axis < n; ++axis)
      finite = both(finite,
                    arguments[axis].range.hi - arguments[axis].range.lo < IrFloat(num::infinity));
    return std::vector<Range>(results, provided(finite, Range{IrFloat(-limit), IrFloat(limit)}));
  };
  if (name.kind == "noise1985") return within(limit_1985(n));
  if (name.kind == "noise1989") return within(limit_1989(n));
  if (name.kind == "dnoise") return within(improved_limits[n - 1].slope);
  if (name.kind != "noise" && name.kind != "vnoise")
    return std::vector<Range>(results, anything<IrFloat>());
  for (std::size_t i = n; i < arguments.size(); ++i)
    if (!arguments[i].exact) return within(improved_limits[n - 1].value);

  // The function of this kind, once for the module.
  auto found = made_.find(key);
  if (found == made_.end()) {
    ir::Function function;
    function.name = key + "$bounds";
    ir::Builder inner(module_, function);
    std::vector<IrFloat> floats;
    std::vector<IrInt> ints;
    for (std::size_t i = 0; i < arguments.size() + n; ++i)
      floats.emplace_back(inner, inner.add_param(function.body, ir::Type::f32));
    for (std::size_t i = 0; i < keys.size(); ++i)
      ints.emplace_back(inner, inner.add_param(function.body, ir::Type::i32));
    for (const IrFloat& end : write_bounds(name, floats, ints))
      function.body.yields.push_back(place(inner, end));
    module_.functions.push_back(std::move(function));
    found = made_.emplace(key, static_cast<std::int32_t>(module_.functions.size() - 1)).first;
  }

  // Its call.
  std::vector<ir::Value> operands;
  for (std::size_t axis = 0; axis < n; ++axis)
    operands.push_back(place(builder, arguments[axis].range.lo));
  for (std::size_t axis = 0; axis < n; ++axis)
    operands.push_back(place(builder, arguments[axis].range.hi));
  for (std::size_t i = n; i < arguments.size(); ++i)
    operands.push_back(place(builder, arguments[i].range.lo));
  for (const IrInt& k : keys) operands.push_back(place(builder, k));
  const std::vector<ir::Type> types(2 * results, ir::Type::f32);
  const auto ends = builder.emit_multi(ir::Op::call, operands, types, found->second);
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < results; ++i)
    ranges.push_back({IrFloat(builder, ends[2 * i]), IrFloat(builder, ends[2 * i + 1])});
  return ranges;
}

}  // namespace pse::bounds
