// The noise family as builtins: one entry for each function, one IR function for each number of
// dimensions and options.
#include <fmt/format.h>
#include <algorithm>

#include "lower/builtin_table.h"
#include "noise/book_noise.h"
#include "noise/improved.h"
#include "noise/noise1985.h"
#include "noise/noise1989.h"
#include "noise/seed.h"

namespace pse {
namespace {

using Result = std::expected<Components, std::string>;
using Numbers = std::span<const IrFloat>;

// What a noise call gives: its value, its gradient, or three values.
enum class Form { value, gradient, vector };

// Runs `body` with the number of dimensions as a constant.
template <class Body>
auto with_dimensions(std::size_t dimensions, const Body& body) {
  switch (dimensions) {
    case 1:
      return body(std::integral_constant<std::size_t, 1>());
    case 2:
      return body(std::integral_constant<std::size_t, 2>());
    case 3:
      return body(std::integral_constant<std::size_t, 3>());
    default:
      return body(std::integral_constant<std::size_t, 4>());
  }
}

// The 2002 noise.
struct Improved {
  static constexpr std::string_view name = "noise";
  template <class F, std::size_t N>
  static F value(const std::array<F, N>& p, const num::NoiseOptions<num::BaseOf<F>, N>& options) {
    return num::improved_noise(p, options);
  }
  template <class F, std::size_t N>
  static std::array<F, 3> vector(const std::array<F, N>& p,
                                 const num::NoiseOptions<F, N>& options) {
    return num::improved_vector_noise(p, options);
  }
};

// The noise of 1985.
struct Linear {
  static constexpr std::string_view name = "noise1985";
  template <class F, std::size_t N>
  static F value(const std::array<F, N>& p, const num::NoiseOptions<num::BaseOf<F>, N>& options) {
    return num::noise_1985(p, options);
  }
};

// The noise of 1989.
struct Knots {
  static constexpr std::string_view name = "noise1989";
  template <class F, std::size_t N>
  static F value(const std::array<F, N>& p, const num::NoiseOptions<num::BaseOf<F>, N>& options) {
    return num::noise_1989(p, options);
  }
};

// The noise of the chapter's listing; of three coordinates only.
struct Book {
  static constexpr std::string_view name = "book_noise";
  template <class F, std::size_t N>
  static F value(const std::array<F, N>& p, const num::NoiseOptions<num::BaseOf<F>, N>&) {
    std::array<F, 3> three;
    std::copy_n(p.begin(), std::min<std::size_t>(N, 3), three.begin());
    return num::book_noise(three);
  }
};

// The body of one IR function: coordinates, then periods, then the key.
template <class Kind, std::size_t N>
std::vector<IrFloat> body(Form form, bool periodic, Numbers floats, std::span<const IrInt> ints) {
  std::array<IrFloat, N> point;
  num::NoiseOptions<IrFloat, N> options;
  if (periodic) options.period.emplace();
  for (std::size_t axis = 0; axis < N; ++axis) {
    point[axis] = floats[axis];
    if (periodic) (*options.period)[axis] = floats[N + axis];
  }
  if (!ints.empty()) options.key = ints[0];
  if (form == Form::gradient) {
    const auto slopes = num::gradient(Kind::value(num::variables(point), options));
    return {slopes.begin(), slopes.end()};
  }
  if constexpr (requires { Kind::vector(point, options); }) {
    if (form == Form::vector) {
      const auto three = Kind::vector(point, options);
      return {three.begin(), three.end()};
    }
  }
  return {Kind::value(point, options)};
}

// A call's position, checked.
std::expected<std::vector<IrFloat>, std::string> position(const BuiltinScope& scope,
                                                          const BoundCall& call) {
  if (call.arguments[0].size() > 4) {
    return std::unexpected(
        fmt::format("`{}` takes a position of 1 to 4 coordinates, and this has {}", call.name,
                    call.arguments[0].size()));
  }
  return scope.numbers(call.arguments[0]);
}

// Calls the IR function for this kind, form, and these options. An absent period or seed is empty.
template <class Kind>
std::expected<std::vector<IrFloat>, std::string> call_noise(const BuiltinScope& scope,
                                                            const BoundCall& call, Form form,
                                                            const Components& period,
                                                            const Components& seed) {
  auto floats = position(scope, call);
  if (!floats) return floats;
  const std::size_t dimensions = floats->size();
  if (!period.empty() && period.size() != 1 && period.size() != dimensions) {
    return std::unexpected(
        fmt::format("the period of `{}` is one number or one for each of the {} coordinates",
                    call.name, dimensions));
  }
  for (std::size_t axis = 0; axis < dimensions && !period.empty(); ++axis) {
    floats->push_back(scope.number(period[period.size() == 1 ? 0 : axis]));
  }
  std::vector<IrInt> ints;
  if (seed.size() > 1)
    return std::unexpected(fmt::format("the seed of `{}` is one number", call.name));
  if (!seed.empty()) ints.push_back(num::key_of_seed(scope.number(seed[0])));

  // The function's name tells all that it is made for.
  constexpr std::string_view forms[] = {"", "d", "v"};
  const std::string key =
      fmt::format("{}{}.{}{}{}", forms[static_cast<int>(form)], Kind::name, dimensions,
                  period.empty() ? "" : ".periodic", seed.empty() ? "" : ".seeded");
  return scope.call(key, *floats, ints, [&](Numbers parameters, std::span<const IrInt> keys) {
    return with_dimensions(dimensions, [&](auto n) {
      return body<Kind, n()>(form, !period.empty(), parameters, keys);
    });
  });
}

// Entries with the parameters "p..., period, seed".
template <class Kind, Form form>
Result emit(const BuiltinScope& scope, const BoundCall& call) {
  const auto result = call_noise<Kind>(scope, call, form, call.arguments[1], call.arguments[2]);
  if (!result) return std::unexpected(result.error());
  return scope.values(*result);
}

// Entries with the parameter "p...", of three coordinates.
template <class Kind, Form form>
Result emit_three(const BuiltinScope& scope, const BoundCall& call) {
  if (call.arguments[0].size() != 3) {
    return std::unexpected(fmt::format("`{}` takes a position of 3 coordinates, and this has {}",
                                       call.name, call.arguments[0].size()));
  }
  const auto result = call_noise<Kind>(scope, call, form, {}, {});
  if (!result) return std::unexpected(result.error());
  return scope.values(*result);
}

// From [-1, 1] to [0, 1]. Values a little beyond are cut.
Result emit_unsigned(const BuiltinScope& scope, const BoundCall& call) {
  const auto result =
      call_noise<Improved>(scope, call, Form::value, call.arguments[1], call.arguments[2]);
  if (!result) return std::unexpected(result.error());
  return scope.values(std::array{min(max(fma(result->front(), 0.5f, 0.5f), 0.0f), 1.0f)});
}

constexpr std::string_view plain = "p..., period = 0, seed = 0";
constexpr std::string_view periodic = "p..., period, seed = 0";

constexpr BuiltinEntry entry(std::string_view name, std::string_view parameters, ResultShape shape,
                             EmitCall call, std::string_view doc) {
  return {.builtin = {name, "noise", parameters, shape, doc, ""}, .call = call};
}
constexpr BuiltinEntry alias(std::string_view name, std::string_view of) {
  return {.builtin = {name, "noise", "", ResultShape::number, "", of}};
}

constexpr BuiltinEntry noise_list[] = {
    entry("Noise", plain, ResultShape::number, emit<Improved, Form::value>,
          "the signed noise of 2002 at a position of 1 to 4 coordinates: in [-1.1, 1.1] (3-D: at "
          "most 1.0364), mostly "
          "within [-0.6, 0.6], 0 at whole coordinates; repeats after the period, a whole number "
          "from 1 to 256 or one for "
          "each coordinate (0: 256); another seed is another noise"),
    alias("noise", "Noise"),
    alias("snoise", "Noise"),
    entry("unoise", plain, ResultShape::number, emit_unsigned,
          "Noise moved to [0, 1] and cut to it; 0.5 in the middle"),
    entry("Dnoise", plain, ResultShape::like_first, emit<Improved, Form::gradient>,
          "the gradient of Noise, exact"),
    alias("dnoise", "Dnoise"),
    entry("vnoise", plain, ResultShape::vector3, emit<Improved, Form::vector>,
          "three noises that have nothing to do with each other; the first is Noise"),
    entry("pnoise", periodic, ResultShape::number, emit<Improved, Form::value>,
          "Noise that repeats after the period"),
    entry("Dpnoise", periodic, ResultShape::like_first, emit<Improved, Form::gradient>,
          "the gradient of pnoise, exact"),
    entry("vpnoise", periodic, ResultShape::vector3, emit<Improved, Form::vector>,
          "vnoise that repeats after the period"),
    entry("noise1985", plain, ResultShape::number, emit<Linear, Form::value>,
          "the noise of 1985 at a position of 1 to 4 coordinates: in [-1.6, 1.6], mostly within "
          "[-0.8, 0.8], not 0 at "
          "whole coordinates; repeats only after a period up to 2^20, where one is given"),
    entry("Dnoise1985", plain, ResultShape::like_first, emit<Linear, Form::gradient>,
          "the gradient of noise1985, exact"),
    entry("noise1989", plain, ResultShape::number, emit<Knots, Form::value>,
          "the noise of 1989 at a position of 1 to 4 coordinates: in [-0.8, 0.8], mostly within "
          "[-0.4, 0.4], 0 at whole "
          "coordinates; period as for Noise"),
    entry("Dnoise1989", plain, ResultShape::like_first, emit<Knots, Form::gradient>,
          "the gradient of noise1989, exact"),
    entry("book_noise", "p...", ResultShape::number, emit_three<Book, Form::value>,
          "the noise of the chapter's listing in 3-D, bit for bit, defects included: in [-1.1, "
          "1.1], positions rounded "
          "to 1/1024, wrong below -10000"),
    entry("Dbook_noise", "p...", ResultShape::like_first, emit_three<Book, Form::gradient>,
          "the gradient of book_noise between its rounded positions"),
};

}  // namespace

std::span<const BuiltinEntry> noise_builtins() { return noise_list; }

}  // namespace pse
