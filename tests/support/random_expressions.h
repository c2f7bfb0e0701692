// Random expressions: the half of random_program.h that makes values of given kinds from what is in
// scope. Valid and well-typed; literals are those at which arithmetic meets NaN, infinity,
// subnormal numbers and both zeros.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pse::test {

struct RandomProgramOptions {
  // Names that the stream brings, with their components; those once per frame.
  std::vector<std::pair<std::string, int>> sample_inputs = {
      {"x", 1}, {"y", 1}, {"u", 1}, {"v", 1}, {"point", 3}};
  std::vector<std::pair<std::string, int>> frame_inputs = {{"frame", 1}, {"time", 1}};
  bool library = true;  // call functions of library/ too
  bool arrays = true;
  bool functions = true;
  int statements = 8;  // at top level, about
};

// Expressions over `scope_` and `functions_`, which who derives from it fills.
class RandomExpressions {
 protected:
  RandomExpressions(std::uint64_t seed, RandomProgramOptions options)
      : options_(std::move(options)), state_(seed * 2 + 1) {}

  struct Variable {
    std::string name;
    int components = 1;  // of it, or of an array's elements
    bool settable = true;
    int elements = 0;  // of an array; 0: no array
  };
  struct Function {
    std::string name;
    std::vector<int> parameters;  // components; 0 stands for a function of one argument
    int default_from = 0;         // parameters from here on have defaults
    int function_components = 1;  // of that function's argument and result
    int result = 1;
    int weight = 1;
  };

  RandomProgramOptions options_;
  std::uint64_t state_;  // of the chance, after the last number drawn
  std::vector<Variable> scope_;
  std::vector<Function> functions_;
  int names_ = 0;
  int weight_ = 0;  // of the function being made, or of the program
  int times_ = 1;   // how often the current statement runs at most
  bool frame_only_ = false;

  // ---- Chance ----

  // SplitMix64, by S. Vigna.
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }
  bool chance(int percent) { return below(100) < percent; }
  template <std::size_t n>
  std::string pick(const std::array<std::string_view, n>& list) {
    return std::string(list[static_cast<std::size_t>(below(static_cast<int>(n)))]);
  }
  std::string fresh(const char* stem) { return stem + std::to_string(++names_); }

  // ---- Expressions ----

  std::string number() {
    static constexpr std::array<std::string_view, 32> numbers = {
        "0",   "1",    "2",    "3",     "0.5",   "0.25", ".1",    "7.5",   "1.",       "10",  "100",
        "1e3", "1e-3", "3e38", "1e-38", "1e-44", "1e20", "0.333", "12.25", "16777217", "0.1", "0.7",
        "4",   "5",    "1.5",  "2.5",   "0.9",   "0.99", "6",     "PI",    "TAU",      "E"};
    if (chance(3)) return chance(50) ? "INF" : "NAN";
    if (chance(10)) return "(-" + pick(numbers) + ")";
    return pick(numbers);
  }

  std::string variable(int components) {
    std::vector<std::string> names;
    for (const Variable& variable : scope_)
      if (variable.components == components && variable.elements == 0)
        names.push_back(variable.name);
    if (names.empty()) return components == 1 ? number() : literal(components, 0);
    // The latest ones are read more often.
    const int count = static_cast<int>(names.size());
    return names[static_cast<std::size_t>(std::max(below(count), below(count)))];
  }

  std::string literal(int components, int depth) {
    const bool commas = chance(40);
    std::string out = "[";
    for (int i = 0; i < components; ++i) {
      if (i > 0) out += commas ? ", " : " ";
      out += commas ? value(1, depth) : factor(1, depth);
    }
    return out + "]";
  }

  std::string letters(int count, int of) {
    static constexpr std::array<std::string_view, 2> sets = {"xyzw", "rgba"};
    const std::string set = pick(sets);
    std::string out;
    for (int i = 0; i < count; ++i) out += set[static_cast<std::size_t>(below(of))];
    return out;
  }

  // A value that stands anywhere without parentheses of its own.
  std::string factor(int components, int depth) {
    ++weight_;
    if (depth <= 0 || weight_ > 1500)
      return chance(components == 1 ? 35 : 15) ? constant(components) : variable(components);
    switch (below(12)) {
      case 0:
      case 1:
        return variable(components);
      case 2:
        return constant(components);
      case 3:
      case 4:
        return call(components, depth - 1);
      case 5:
        return components == 1 ? component(depth - 1) : literal(components, depth - 1);
      case 6:
        return noise(components, depth - 1);
      case 7:
        return own_function(components, depth - 1);
      case 8:
        return swizzle(components, depth - 1);
      case 9:
        return element(components);
      default:
        return "(" + value(components, depth - 1, chance(30)) + ")";
    }
  }

  std::string constant(int components) {
    return components == 1 ? number() : literal(components, 0);
  }

  std::string value(int components, int depth, bool compact = false) {
    if (depth <= 0) return factor(components, 0);
    const auto side = [&](int other) {
      return other == 0 || components == 1 ? factor(components, depth - 1) : factor(1, depth - 1);
    };
    static constexpr std::array<std::string_view, 10> operators = {"+", "-", "*", "*", "+",
                                                                   "-", "/", "/", "%", "^"};
    switch (below(8)) {
      case 0:
        return factor(components, depth);
      case 1:
        return "-" + factor(components, depth - 1);
      case 2: {
        const std::string test = condition(depth - 1);
        const std::string one = value(components, depth - 1);
        return "(" + test + " ? " + one + " : " + value(components, depth - 1) + ")";
      }
      case 3:
        if (components == 1) return "(" + condition(depth - 1) + ") * " + factor(1, depth - 1);
        [[fallthrough]];
      default: {
        const int scalar_side = below(3);  // 1: left, 2: right
        const std::string left = side(scalar_side == 1);
        const std::string op = pick(operators);
        const std::string right = side(scalar_side == 2);
        return compact ? left + op + right : left + " " + op + " " + right;
      }
    }
  }

  std::string condition(int depth) {
    static constexpr std::array<std::string_view, 8> comparisons = {
        " < ", " <= ", " > ", " >= ", " == ", " != ", " < ", " > "};
    if (depth > 0) {
      switch (below(8)) {
        case 0:
          return "(" + condition(depth - 1) + ") and " + condition(depth - 1);
        case 1:
          return condition(depth - 1) + " or (" + condition(depth - 1) + ")";
        case 2:
          return "not (" + condition(depth - 1) + ")";
        case 3:
          return "isnan(" + value(1, depth - 1) + ")";
        default:
          break;
      }
    }
    const std::string left = factor(1, depth);
    const std::string op = pick(comparisons);
    return left + op + factor(1, depth);
  }

  // A built-in function, or one of the library.
  std::string call(int components, int depth) {
    static constexpr std::array<std::string_view, 30> of_one = {
        "abs",  "sign",  "floor", "ceil", "round", "trunc", "fract", "sqrt", "cbrt",  "exp",
        "exp2", "expm1", "log",   "log2", "log10", "log1p", "sin",   "cos",  "tan",   "asin",
        "acos", "atan",  "sinh",  "cosh", "tanh",  "sin",   "cos",   "abs",  "floor", "sqrt"};
    static constexpr std::array<std::string_view, 5> of_two = {"min", "max", "pow", "atan2", "min"};
    const std::string a = value(components, depth);
    switch (below(10)) {
      case 0:
      case 1:
      case 2:
        return pick(of_one) + "(" + a + ")";
      case 3:
      case 4:
        return pick(of_two) + "(" + a + ", " + value(components, depth) + ")";
      case 5:
        return "select(" + condition(depth) + ", " + a + ", " + value(components, depth) + ")";
      case 6:
        if (!options_.library) return "abs(" + a + ")";
        return "clamp(" + a + ", " + number() + ", " + number() + ")";
      case 7:
        if (!options_.library) return "fract(" + a + ")";
        return "lerp(" + factor(1, depth) + ", " + a + ", " + value(components, depth) + ")";
      case 8:
        if (components != 1)
          return "fma(" + a + ", " + value(components, depth) + ", " + value(components, depth) +
                 ")";
        return reduction(depth);
      default:
        if (components != 1) return "floor(" + a + ")";
        return reduction(depth);
    }
  }

  // A number out of vectors.
  std::string reduction(int depth) {
    static constexpr std::array<std::string_view, 5> of_one = {"norm", "sum", "product", "min",
                                                               "max"};
    const int n = 2 + below(3);
    if (chance(35)) return "dot(" + value(n, depth) + ", " + value(n, depth) + ")";
    return pick(of_one) + "(" + value(n, depth) + ")";
  }

  std::string noise(int components, int depth) {
    static constexpr std::array<std::string_view, 6> of_number = {"Noise",  "snoise", "unoise",
                                                                  "unoise", "hash",   "Noise"};
    const int n = 1 + below(3);
    const std::string argument = value(n, depth > 1 ? 1 : depth);
    if (components == 3 && chance(60)) {
      if (n == 3 && chance(50)) return "Dnoise(" + argument + ")";
      return "vnoise(" + (n == 3 ? argument : value(3, 1)) + ")";
    }
    const std::string one = pick(of_number) + "(" + argument + ")";
    if (components == 1) return one;
    return "(" + one + " * " + factor(components, 0) + ")";
  }

  std::string component(int depth) {
    const int n = 2 + below(3);
    if (chance(50)) return variable(n) + "." + letters(1, n);
    return "(" + value(n, depth) + ")[" + std::to_string(1 + below(n)) + "]";
  }

  std::string swizzle(int components, int depth) {
    const int n = 2 + below(3);
    const std::string base = chance(70) ? variable(n) : "(" + value(n, depth) + ")";
    return base + "." + letters(components, n);
  }

  // An element of an array, at an index that is inside whatever the numbers are.
  std::string element(int components) {
    for (const Variable& variable : scope_) {
      if (variable.elements == 0 || variable.components != components || chance(50)) continue;
      const std::string n = std::to_string(variable.elements);
      if (chance(60))
        return variable.name + "[" + std::to_string(1 + below(variable.elements)) + "]";
      return variable.name + "[" + condition(0) + " ? " + n + " : 1]";
    }
    return variable(components);
  }

  std::string own_function(int components, int depth) {
    std::vector<const Function*> fitting;
    for (const Function& function : functions_)
      if (function.result == components && weight_ + function.weight * times_ < 1500)
        fitting.push_back(&function);
    if (fitting.empty() || frame_only_) return call(components, depth);
    const Function& function =
        *fitting[static_cast<std::size_t>(below(static_cast<int>(fitting.size())))];
    weight_ += function.weight;
    std::string out = function.name + "(";
    for (std::size_t i = 0; i < function.parameters.size(); ++i) {
      const bool optional =
          function.default_from > 0 && static_cast<int>(i) >= function.default_from;
      if (optional && chance(50)) break;
      if (i > 0) out += ", ";
      if (function.parameters[i] == 0)
        out += mapping(function.function_components);
      else
        out += (optional && chance(50) ? "p" + std::to_string(i + 1) + " = " : "") +
               value(function.parameters[i], depth > 1 ? 1 : depth);
    }
    return out + ")";
  }

  // The name of a function from `components` to as many.
  std::string mapping(int components) {
    static constexpr std::array<std::string_view, 6> of_any = {"sin",   "cos",  "abs",
                                                               "floor", "sqrt", "exp"};
    for (const Function& function : functions_)
      if (function.parameters.size() == 1 && function.parameters[0] == components &&
          function.result == components && chance(60))
        return function.name;
    return pick(of_any);
  }
};

}  // namespace pse::test
