// require() and expect(): what a program says of its own values. One ends the run where it does not
// hold, the other warns of it and goes on (ir/expectations.h).
#include <algorithm>

#include "ir/expectations.h"
#include "lower/lowering.h"

namespace pse::lower {

Typed Lowering::intrinsic_require(const std::vector<CallArgument>& arguments, const Span& span) {
  const Typed condition = to_truth(arguments[0].value, arguments[0].span);
  if (condition.is_error()) return {};
  if (arguments[1].value.kind != Kind::text) {
    error("argument-type", arguments[1].span,
          "what `require` reports is a text, this is " + describe(arguments[1].value));
    return {};
  }
  if (known(condition.parts.front()) == 0.0f) call_->unmet = arguments[1].value.text;
  add_check(condition.parts.front(), arguments[1].value.text, program_place(span));
  Typed nothing;
  nothing.kind = Kind::nothing;
  return nothing;
}

// expect(value, condition, text, hint, function): the last two may be left out.
Typed Lowering::intrinsic_expect(const std::vector<CallArgument>& arguments, const Span& span) {
  static const std::string usage = "expect(value, condition, \"text\", \"hint\", function)";
  if (arguments.size() < 3 || arguments.size() > 5) {
    error("argument-count", span,
          "`expect` takes 3 to 5 arguments, this gives " + std::to_string(arguments.size()), usage);
    return {};
  }
  const Typed value = to_number(arguments[0].value);
  if (value.is_error()) return {};
  if (!value.is_numeric()) {
    error("argument-type", arguments[0].span,
          "`expect` hands on a number or a vector, this is " + describe(value), usage);
    return {};
  }
  const Typed condition = to_truth(arguments[1].value, arguments[1].span);
  if (condition.is_error()) return {};

  // What to say, and where.
  std::string message, hint;
  Span place = program_place(span);
  for (std::size_t i = 2; i < arguments.size(); ++i) {
    const Typed& given = arguments[i].value;
    const bool is_function = i >= 3 && i + 1 == arguments.size() && given.kind == Kind::function;
    if (given.kind != Kind::text && !is_function) {
      error("argument-type", arguments[i].span,
            "what `expect` reports is a text, this is " + describe(given), usage);
      return {};
    }
    if (!is_function) {
      (i == 2 ? message : hint) = given.text;
    } else if (const lang::FunctionStmt* blamed = given.function.definition;
               blamed != nullptr && !library_texts_.contains(blamed->name_span.file)) {
      place = blamed->name_span;
      message = "`" + blamed->name + "` " + message;
    }
  }
  if (!hint.empty()) message += "\n" + hint;

  // One warning for each place and text.
  const auto same = [&](const ir::Check& check) {
    return check.span == place && check.message == message;
  };
  auto& checks = module_.checks;
  auto check = std::ranges::find_if(checks, same);
  if (check == checks.end()) check = checks.insert(checks.end(), {place, message});
  const ir::External external{
      ir::expectation_name(static_cast<std::int32_t>(check - checks.begin())),
      value.components() + 1, value.components()};
  auto& externals = module_.externals;
  auto known = std::ranges::find_if(externals, [&](const ir::External& other) {
    return other.name == external.name && other.results == external.results;
  });
  if (known == externals.end()) known = externals.insert(externals.end(), external);
  std::vector<ir::Value> operands = to_number(condition).parts;
  operands.insert(operands.end(), value.parts.begin(), value.parts.end());
  const std::vector<ir::Type> types(value.parts.size(), ir::Type::f32);
  Typed result = value;
  result.parts = builder_->emit_multi(ir::Op::external, operands, types,
                                      static_cast<std::int32_t>(known - externals.begin()));
  return result;
}

}  // namespace pse::lower
