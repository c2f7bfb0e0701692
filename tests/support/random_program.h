// Random programs: valid, well-typed and ending, the same for the same seed on every machine. They
// drive the tests that hold two ways of running a program against each other, and those of the
// formatter. They use numbers and vectors, conditionals, loops with early ends, functions (with
// defaults, names and functions as arguments), arrays, swizzles, noise, blocks once per frame, and
// arithmetic that meets NaN, infinity, subnormal numbers and both zeros.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/random_expressions.h"

namespace pse::test {

class RandomProgram : RandomExpressions {
 public:
  explicit RandomProgram(std::uint64_t seed, RandomProgramOptions options = {})
      : RandomExpressions(seed, std::move(options)) {
    build();
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int indent_ = 0;
  int loops_ = 0;  // around the current statement
  bool in_function_ = false;
  int result_ = 1;  // components that the current function returns

  // ---- Statements ----

  void line(const std::string& statement) {
    text_.append(static_cast<std::size_t>(4 * indent_), ' ');
    text_ += statement;
    if (chance(4)) text_ += "  # " + fresh("remark ");
    text_ += '\n';
  }

  // Statements in a block of their own, behind `head`; what they introduce is gone behind it.
  template <class Body>
  void block(const std::string& head, Body body) {
    const bool braces = chance(25);
    line(head + (braces ? " {" : ""));
    ++indent_;
    const std::size_t known = scope_.size();
    body();
    scope_.resize(known);
    --indent_;
    if (braces) line("}");
  }

  int any_size() {
    static constexpr std::array<int, 8> sizes = {1, 1, 1, 1, 2, 3, 3, 4};
    return sizes[static_cast<std::size_t>(below(8))];
  }

  void introduce() {
    const int n = any_size();
    const std::string value_text = value(n, 3);
    const std::string name = fresh(n == 1 ? "s" : "c");
    line(name + " = " + value_text);
    scope_.push_back({name, n});
  }

  void change() {
    std::vector<const Variable*> settable;
    for (const Variable& variable : scope_)
      if (variable.settable && variable.elements == 0) settable.push_back(&variable);
    if (settable.empty()) return introduce();
    const Variable target =
        *settable[static_cast<std::size_t>(below(static_cast<int>(settable.size())))];
    static constexpr std::array<std::string_view, 6> operators = {
        " = ", " += ", " -= ", " *= ", " /= ", " = "};
    const std::string op = pick(operators);
    const int n = target.components;
    if (n > 1 && chance(25)) {
      line(target.name + "." + letters(1, n) + op + value(1, 2));
    } else if (n > 1 && chance(20)) {
      line(target.name + "[" + std::to_string(1 + below(n)) + "]" + op + value(1, 2));
    } else if (n > 2 && chance(20)) {
      line(target.name + (chance(50) ? ".yx" : ".xz") + " = " + value(2, 2));
    } else {
      line(target.name + op + (n > 1 && op != " = " && chance(40) ? value(1, 2) : value(n, 2)));
    }
  }

  void make_array() {
    const int n = chance(60) ? 1 : 3;
    const int elements = 2 + below(3);
    const std::string name = fresh("list");
    if (chance(40)) {
      const std::string i = fresh("i");
      block("for " + i + " in [1 .. " + std::to_string(elements) + "]", [&] {
        scope_.push_back({i, 1, false});
        line(name + "[" + i + "] = " + value(n, 2));
      });
    } else {
      for (int e = 1; e <= elements; ++e)
        line(name + "[" + std::to_string(e) + "] = " + value(n, 1));
    }
    scope_.push_back({name, n, false, elements});
  }

  void choice(int depth) {
    block("if " + condition(2), [&] { statements(1 + below(2), depth - 1); });
    if (chance(30))
      block((chance(50) ? "else if " : "elif ") + condition(1), [&] { statements(1, depth - 1); });
    if (chance(50)) block("else", [&] { statements(1 + below(2), depth - 1); });
  }

  void loop_body(int depth, int turns) {
    ++loops_;
    times_ *= turns;
    statements(1 + below(2), depth - 1);
    if (chance(25)) line("if " + condition(1) + " " + (chance(50) ? "break" : "continue"));
    if (chance(50)) change();
    times_ /= turns;
    --loops_;
  }

  void for_loop(int depth) {
    const std::string i = fresh("i");
    int components = 1, turns = 3;
    std::string sequence;
    switch (below(5)) {
      case 0:
        sequence = "[1 .. " + std::to_string(1 + below(4)) + "]";
        break;
      case 1:
        sequence = "[1 .. (" + condition(1) + " ? 2 : 4)]";
        break;
      case 2:
        sequence = "[0.5 .. -1 by -0.5]";
        break;
      case 3:
        sequence = literal(3, 1);
        break;
      default: {
        sequence = "[3 .. 1]";
        for (const Variable& variable : scope_)
          if (variable.elements > 0) sequence = variable.name, components = variable.components;
      }
    }
    block("for " + i + " in " + sequence, [&] {
      scope_.push_back({i, components, false});
      loop_body(depth, turns);
    });
  }

  void while_loop(int depth) {
    const std::string count = fresh("_k");
    line(count + " = 0");
    const std::string limit = count + " < " + std::to_string(1 + below(5));
    block("while " + limit + (chance(60) ? " and (" + condition(1) + ")" : ""), [&] {
      line(count + " += 1");
      scope_.push_back({count, 1, false});
      loop_body(depth, 4);
    });
  }

  void statements(int count, int depth) {
    for (int i = 0; i < count; ++i) {
      const int kind = below(100);
      if (kind < 30 || weight_ > 1500) {
        chance(50) || indent_ > 0 ? change() : introduce();
      } else if (kind < 55) {
        introduce();
      } else if (kind < 72 && depth > 0) {
        choice(depth);
      } else if (kind < 84 && depth > 0 && loops_ < 2) {
        chance(65) ? for_loop(depth) : while_loop(depth);
      } else if (kind < 88 && options_.arrays && loops_ == 0 && indent_ <= 1 && depth == 2) {
        make_array();
      } else if (kind < 92 && in_function_) {
        line("if " + condition(1) + " return " + value(result_, 2));
      } else {
        change();
      }
    }
  }

  // ---- Program ----

  void make_function() {
    Function function;
    function.name = fresh("f");
    function.result = any_size();
    function.function_components = any_size();
    const int count = 1 + below(3);
    const bool higher = chance(30);
    scope_.clear();
    std::string head = "function " + function.name + "(";
    for (int i = 1; i <= count; ++i) {
      const std::string name = "p" + std::to_string(i);
      const bool is_function = higher && i == 1;
      const bool optional = i > 1 && i == count && chance(40);
      function.parameters.push_back(is_function ? 0 : optional ? 1 : any_size());
      if (optional) function.default_from = i - 1;
      head += (i > 1 ? ", " : "") + name + (optional ? " = " + number() : "");
      // A parameter may be set; the one with a default keeps its kind.
      if (!is_function) scope_.push_back({name, function.parameters.back()});
    }
    for (const auto& [name, components] : options_.sample_inputs)
      scope_.push_back({name, components, false});

    const int outer = weight_;
    weight_ = 0;
    in_function_ = true;
    result_ = function.result;
    block(head + ")", [&] {
      if (higher) {
        const std::string name = fresh("s");
        line(name + " = p1(p1(" + value(function.function_components, 1) + "))");
        scope_.push_back({name, function.function_components});
      }
      statements(1 + below(3), 1);
      line("return " + value(function.result, 2));
    });
    in_function_ = false;
    function.weight = weight_ * 3 + 1;
    weight_ = outer;
    functions_.push_back(function);
  }

  void build() {
    line("# a random program");
    if (options_.functions)
      for (int i = below(4); i > 0; --i) make_function();
    scope_.clear();
    weight_ = 0;

    // What holds for a whole frame: knobs, and a block that is computed once.
    for (const auto& [name, components] : options_.frame_inputs)
      scope_.push_back({name, components, false});
    if (chance(40)) {
      const std::string knob = fresh("Knob");
      line(knob + " = 0.3 [[ min = 0, max = 1, label = \"a knob\" ]]");
      scope_.push_back({knob, 1, false});
    }
    if (chance(40)) {
      frame_only_ = true;
      std::vector<Variable> made;
      line("if begin_frame");
      ++indent_;
      for (int i = 1 + below(2); i > 0; --i) introduce();
      --indent_;
      frame_only_ = false;
    }
    for (const auto& [name, components] : options_.sample_inputs)
      scope_.push_back({name, components, false});
    statements(options_.statements / 2 + below(options_.statements), 2);
    introduce();
  }
};

}  // namespace pse::test
