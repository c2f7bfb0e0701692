// `while` and `for`: both become the IR's one loop.
#include "lower/lowering.h"

namespace pse::lower {

using namespace lang;

namespace {

// The flags that a loop's body may set travel with the loop.
void add_flags(std::set<std::string>& assigned, const Exits& exits) {
  if (exits.returns) {
    assigned.insert("%returned");
    assigned.insert("%result");
  }
  if (exits.breaks) assigned.insert("%broke");
}

}  // namespace

void Lowering::lower_while(const WhileStmt& statement, const Span& span) {
  if (!statement.condition) return;  // the parser has reported it
  std::set<std::string> assigned;
  collect_assigned(statement.body, assigned);
  Exits exits = exits_of(statement.body);
  add_flags(assigned, exits);
  const bool continues = std::exchange(exits.continues, false);

  const Variables outer = variables();
  const auto set_false = [&](const char* flag) {
    variables()[flag] = truth(builder_->const_bool(false));
  };
  if (exits.breaks) set_false("%broke");
  if (exits.returns && !variables().contains("%returned")) set_false("%returned");

  ++loop_depth_;
  loop(
      assigned, statement.body,
      [&]() -> ir::Value {
        const auto test = [&] {
          return to_truth(lower(*statement.condition), statement.condition->span);
        };
        if (!exits.any()) {
          const Typed condition = test();
          return condition.is_error() ? builder_->const_bool(false) : condition.parts.front();
        }
        const Typed condition = branch_value(
            not_left(exits), test, [&] { return truth(builder_->const_bool(false)); }, span);
        return condition.is_error() ? builder_->const_bool(false) : condition.parts.front();
      },
      [&] {
        if (continues) set_false("%continued");
        lower_block(statement.body);
        variables().erase("%continued");
      },
      span);
  --loop_depth_;
  // The flags of an enclosing loop come back.
  for (const char* flag : {"%broke", "%continued"}) {
    variables().erase(flag);
    if (const auto found = outer.find(flag); found != outer.end())
      variables()[flag] = found->second;
  }
}

void Lowering::counted_loop(const ForStmt& statement, ir::Value count,
                            const std::function<Typed(ir::Value)>& element, const Span& span) {
  std::set<std::string> assigned;
  collect_assigned(statement.body, assigned);
  assigned.erase(statement.variable);
  assigned.insert("%counter");
  Exits exits = exits_of(statement.body);
  add_flags(assigned, exits);
  const bool continues = std::exchange(exits.continues, false);

  const Variables outer = variables();
  const auto set_false = [&](const char* flag) {
    variables()[flag] = truth(builder_->const_bool(false));
  };
  if (exits.breaks) set_false("%broke");
  if (exits.returns && !variables().contains("%returned")) set_false("%returned");
  variables()["%counter"] =
      Typed{.kind = Kind::number, .parts = {integer(0)}, .text = {}, .function = {}};
  variables().erase(statement.variable);

  ++loop_depth_;
  loop(
      assigned, statement.body,
      [&] {
        const ir::Value more = emit(ir::Op::ilt, {variables()["%counter"].parts.front(), count});
        return exits.any() ? emit(ir::Op::band, {more, not_left(exits)}) : more;
      },
      [&] {
        const ir::Value counter = variables()["%counter"].parts.front();
        variables()[statement.variable] = element(counter);
        if (continues) set_false("%continued");
        lower_block(statement.body);
        variables().erase("%continued");
        variables().erase(statement.variable);
        variables()["%counter"].parts.front() = emit(ir::Op::iadd, {counter, integer(1)});
      },
      span);
  --loop_depth_;
  variables().erase("%counter");
  for (const std::string& name : {std::string("%counter"), std::string("%broke"),
                                  std::string("%continued"), statement.variable}) {
    variables().erase(name);
    if (const auto found = outer.find(name); found != outer.end())
      variables()[name] = found->second;
  }
}

void Lowering::lower_for(const ForStmt& statement, const Span& span) {
  if (!statement.sequence) return;  // the parser has reported it
  // A range: count its steps before the loop, so that it ends whatever the body does.
  if (const auto* range = std::get_if<RangeExpr>(&statement.sequence->node)) {
    const auto bound = [&](const ExprPtr& expr) -> Typed {
      const Typed value = to_number(lower(*expr));
      if (value.is_error() || value.kind == Kind::number) return value;
      error("range-type", expr->span, "a range runs between numbers, this is " + describe(value));
      return {};
    };
    const Typed first = bound(range->first), last = bound(range->last);
    const Typed step = range->step ? bound(range->step) : number(1.0f);
    if (first.is_error() || last.is_error() || step.is_error()) {
      variables()[statement.variable] = Typed{};
      return;
    }
    const ir::Value a = first.parts.front(), b = last.parts.front(), s = step.parts.front();
    ir::Value steps = emit(ir::Op::fsub, {b, a});
    if (range->step) {
      steps = emit(ir::Op::fdiv, {steps, s});
      if (const auto fixed = known(s); fixed && *fixed == 0)
        return error("range-step", range->step->span,
                     "the step of a range is 0, so it would never end");
    }
    // The most steps that a float and a 32-bit integer both hold; NaN gives none.
    const ir::Value whole =
        emit(ir::Op::ffloor, {emit(ir::Op::fmin, {steps, constant(2147483392.0f)})});
    const ir::Value count = emit(ir::Op::f2i, {emit(ir::Op::fadd, {whole, constant(1)})});
    counted_loop(
        statement, count,
        [&](ir::Value counter) {
          const ir::Value k = emit(ir::Op::i2f, {counter});
          return number(emit(ir::Op::fadd, {a, range->step ? emit(ir::Op::fmul, {k, s}) : k}));
        },
        span);
    return;
  }

  const Typed sequence = lower(*statement.sequence);
  if (sequence.is_error()) {
    variables()[statement.variable] = Typed{};
    return;
  }
  if (sequence.kind == Kind::array) {
    const ir::Value count = emit(ir::Op::f2i, {array_length(sequence).parts.front()});
    counted_loop(
        statement, count,
        [&](ir::Value counter) { return load_element(sequence, counter, span, false); }, span);
    return;
  }
  if (sequence.kind == Kind::vector || sequence.kind == Kind::matrix) {
    counted_loop(
        statement, integer(sequence.rows),
        [&](ir::Value counter) {
          const ir::Value place = emit(ir::Op::fadd, {emit(ir::Op::i2f, {counter}), constant(1)});
          return element_of(sequence, number(place), span, "");
        },
        span);
    return;
  }
  error("not-a-sequence", statement.sequence->span,
        "`for` runs over a range, an array or a vector; this is " + describe(sequence),
        "write `[1 .. n]` to count to n");
}

}  // namespace pse::lower
