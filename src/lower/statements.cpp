// Statements: assignment, branches, early exits.
#include "lower/constant.h"
#include "lower/lowering.h"

namespace pse::lower {

using namespace lang;

void Lowering::lower_block(const Block& block, std::size_t first) {
  for (std::size_t i = first; i < block.size(); ++i) {
    if (!block[i]) continue;
    const Stmt& statement = *block[i];
    const Exits exits = exits_of(statement);
    const bool last = i + 1 == block.size();

    // Without early exits a block is just its statements.
    if (!exits.any()) {
      lower_statement(statement);
      continue;
    }
    if (const auto* choice = std::get_if<IfStmt>(&statement.node)) {
      // `if c return a` followed by more: the rest belongs to the one way through that does not
      // leave.
      int ways_through = choice->branches.empty() || choice->branches.back().condition ? 1 : 0;
      bool clean = true;
      for (const IfBranch& b : choice->branches) {
        if (always_exits(b.body)) continue;
        ++ways_through;
        clean = clean && !exits_of(b.body).any();
      }
      if (clean && ways_through <= 1) {
        lower_if(*choice, statement.span, 0, [&] { lower_block(block, i + 1); }, true);
        return;
      }
    }
    lower_statement(statement);
    if (std::holds_alternative<ReturnStmt>(statement.node) ||
        std::holds_alternative<BreakStmt>(statement.node) ||
        std::holds_alternative<ContinueStmt>(statement.node)) {
      if (!last && block[i + 1])
        warning("unreachable", block[i + 1]->span, "this is never reached");
      return;
    }
    if (last) return;
    lower_rest_guarded(block, i + 1, exits);
    return;
  }
}

// The rest of a block after a statement that may have left early: done only where it has not.
void Lowering::lower_rest_guarded(const Block& block, std::size_t next, const Exits& exits) {
  branch(
      not_left(exits), [&] { lower_block(block, next); }, [] {},
      block[next] ? block[next]->span : Span{});
}

void Lowering::lower_statement(const Stmt& statement) {
  builder_->set_span(statement.span);
  check_size();
  if (const auto* s = std::get_if<AssignStmt>(&statement.node))
    return lower_assign(*s, statement.span);
  if (const auto* s = std::get_if<IfStmt>(&statement.node))
    return lower_if(*s, statement.span, 0, [] {}, false);
  if (const auto* s = std::get_if<WhileStmt>(&statement.node))
    return lower_while(*s, statement.span);
  if (const auto* s = std::get_if<ForStmt>(&statement.node)) return lower_for(*s, statement.span);
  if (const auto* s = std::get_if<ReturnStmt>(&statement.node))
    return lower_return(*s, statement.span);
  if (const auto* s = std::get_if<ExprStmt>(&statement.node)) {
    const Typed value = lower(*s->value);
    // A comparison has been questioned already, as the assignment that it may be meant for.
    const auto* binary = std::get_if<BinaryExpr>(&s->value->node);
    const bool questioned = binary && binary->op == BinaryOp::equal && !s->value->parenthesised;
    if (!value.is_error() && value.kind != Kind::nothing && !questioned)
      warning("no-effect", statement.span, "the value of this expression is not used",
              "assign it to a name, or remove it");
    return;
  }
  if (std::holds_alternative<BreakStmt>(statement.node) ||
      std::holds_alternative<ContinueStmt>(statement.node)) {
    const bool breaks = std::holds_alternative<BreakStmt>(statement.node);
    if (loop_depth_ == 0)
      return error("not-in-loop", statement.span,
                   breaks ? "`break` outside a loop" : "`continue` outside a loop");
    return set_flag(breaks ? "%broke" : "%continued");
  }
  // Functions and imports were read before; the parser keeps them at the outermost level. Actions
  // describe movement; they are kept in the tree and have no effect on a picture.
}

void Lowering::lower_if(const IfStmt& statement, const Span& span, std::size_t index,
                        const std::function<void()>& rest, bool rest_in_fallthrough) {
  if (index == statement.branches.size()) return rest();
  const IfBranch& current = statement.branches[index];
  const auto body = [&] {
    lower_block(current.body);
    if (rest_in_fallthrough && !always_exits(current.body)) rest();
  };
  if (!current.condition) return body();

  // `if begin_frame` is the frame rate made visible: the frame has always begun where frame-rate
  // code runs.
  if (const auto* name = std::get_if<NameExpr>(&current.condition->node);
      name && name->name == "begin_frame" && !variables().contains(name->name)) {
    ++frame_blocks_;
    lower_block(current.body);
    --frame_blocks_;
    if (rest_in_fallthrough && !always_exits(current.body)) rest();
    return;
  }

  const Typed condition = to_truth(lower(*current.condition), current.condition->span);
  if (condition.is_error()) {
    // Lower the branches all the same, for their errors.
    const ir::Value unknown = builder_->const_bool(false);
    return branch(
        unknown, body, [&] { lower_if(statement, span, index + 1, rest, rest_in_fallthrough); },
        span);
  }
  branch(condition.parts.front(), body,
         [&] { lower_if(statement, span, index + 1, rest, rest_in_fallthrough); }, span);
}

void Lowering::set_flag(const char* flag) { variables()[flag] = truth(builder_->const_bool(true)); }

void Lowering::lower_return(const ReturnStmt& statement, const Span& span) {
  if (!call_->definition)
    return error("return-outside", span, "`return` outside a function",
                 "set a variable instead; the program's results are the names it sets");
  Typed value{.kind = Kind::nothing};
  if (statement.value) value = lower(*statement.value);
  variables()["%result"] = value;
  set_flag("%returned");
}

// ---- Assignment ---------------------------------------------------------------------------------

namespace {

BinaryOp operator_of(AssignOp op) {
  switch (op) {
    case AssignOp::subtract: return BinaryOp::subtract;
    case AssignOp::multiply: return BinaryOp::multiply;
    case AssignOp::divide: return BinaryOp::divide;
    case AssignOp::power: return BinaryOp::power;
    default: return BinaryOp::add;
  }
}

bool is_capitalised(const std::string& name) { return name.front() >= 'A' && name.front() <= 'Z'; }

}  // namespace

Typed Lowering::assigned_value(const AssignStmt& assign, const std::function<Typed()>& current,
                               const Span& span) {
  if (assign.op == AssignOp::set) return lower(*assign.value);
  const Typed old = current();
  const Typed value = lower(*assign.value);
  if (old.is_error() || value.is_error()) return {};
  return arithmetic(operator_of(assign.op), old, value, span);
}

void Lowering::lower_assign(const AssignStmt& assign, const Span& span) {
  if (const auto* name = std::get_if<NameExpr>(&assign.target->node)) {
    // A knob was declared before lowering began: its value comes from outside.
    if (call_ == &top_ && assign.op == AssignOp::set && is_capitalised(name->name)) {
      const auto knob = main_.knobs.find(name->name);
      if (knob != main_.knobs.end() && knobs_[knob->second].span == span) {
        variables()[name->name] = read_knob(knob->second);
        warn_of_constant(name->name, span);
        return;
      }
    }
    Typed value = assigned_value(
        assign, [&] { return lower_name(name->name, assign.target->span); }, span);
    // A second name for an array is a second array.
    if (value.kind == Kind::array && std::holds_alternative<NameExpr>(assign.value->node))
      value = copy_array(value, name->name);
    return assign_name(name->name, std::move(value), span);
  }
  if (const auto* index = std::get_if<IndexExpr>(&assign.target->node))
    return assign_index(assign, *index, span);
  if (const auto* member = std::get_if<MemberExpr>(&assign.target->node))
    return assign_member(assign, *member, span);
  error("bad-target", assign.target->span, "this cannot be assigned to",
        "assign to a name, `v[i]` or `v.x`");
}

void Lowering::warn_of_constant(const std::string& name, const Span& span) {
  if (named_constant(name))
    warning("hides-constant", span,
            "`" + name + "` is a constant of the language, and this hides it",
            "choose another name");
}

void Lowering::assign_name(const std::string& name, Typed value, const Span& span) {
  if (value.kind == Kind::nothing) {
    error("no-value", span, "this gives `" + name + "` no value",
          "the function called returns nothing");
    value = Typed{};
  }
  if (call_ == &top_) {
    if (stream_name(name) && stream_name(name)->rate != ir::Rate::sample && !value.is_error())
      warning("shadows-stream", span, "`" + name + "` also names something that the stream brings",
              "choose another name if the stream's value is wanted later");
    if (!set_at_top_.contains(name)) output_order_.push_back(name);
    set_at_top_[name] = span;
    warn_of_constant(name, span);
  }
  variables()[name] = std::move(value);
}

void Lowering::assign_index(const AssignStmt& assign, const IndexExpr& index, const Span& span) {
  const auto* name = std::get_if<NameExpr>(&index.base->node);
  if (!name)
    return error("bad-target", assign.target->span,
                 "only an element of a named vector or array can be set");
  Typed base;
  if (const auto found = variables().find(name->name); found != variables().end()) {
    base = found->second;
  } else if (call_ == &top_ && stream_name(name->name)) {
    base = read_stream(*stream_name(name->name));
  } else {
    base = new_array(name->name, 1024);
    variables()[name->name] = base;
  }
  if (base.is_error()) return;
  if (base.kind == Kind::array) {
    if (index.indices.size() != 1)
      return error("index-count", span, "an array takes one index");
    // What was to be put in is reported already: the array is silent from here on.
    const auto give_up = [&] {
      given_up_.insert(base.array);
      variables()[name->name] = {};
    };
    const Typed position = to_number(lower(*index.indices.front()));
    if (position.is_error()) return give_up();
    if (position.kind != Kind::number)
      return error("index-type", index.indices.front()->span,
                   "an index must be a number, this is " + describe(position));
    const ir::Value at = to_index(position);
    const Typed value =
        assigned_value(assign, [&] { return load_element(base, at, span, true); }, span);
    if (value.is_error()) return give_up();
    return store_element(base, at, value, span);
  }
  if (base.kind != Kind::vector && base.kind != Kind::matrix)
    return error("index-base", span,
                 "`" + name->name + "` is " + describe(base) + " and has no elements");

  // One component of a vector, or a row or an element of a matrix.
  std::vector<Typed> positions;
  for (const ExprPtr& e : index.indices) {
    positions.push_back(to_number(lower(*e)));
    if (positions.back().is_error()) return;
    if (positions.back().kind != Kind::number)
      return error("index-type", e->span,
                   "an index must be a number, this is " + describe(positions.back()));
  }
  const std::size_t most = base.kind == Kind::matrix ? 2 : 1;
  if (positions.size() > most)
    return error("index-count", span, describe(base) + " takes fewer indices");
  const bool row = base.kind == Kind::matrix && positions.size() == 1;
  Typed whole = base;
  if (base.kind == Kind::matrix && !row) {
    // Row-major place of [r, c].
    const ir::Value columns = constant(static_cast<float>(base.columns));
    const ir::Value r = emit(ir::Op::fsub, {positions[0].parts[0], constant(1)});
    ir::Value place = emit(ir::Op::fadd, {emit(ir::Op::fmul, {r, columns}), positions[1].parts[0]});
    if (const auto a = known(positions[0].parts[0]), b = known(positions[1].parts[0]); a && b)
      place = constant((*a - 1) * static_cast<float>(base.columns) + *b);
    positions = {number(place)};
    whole = vector(base.parts);
  }
  const int stride = row ? base.columns : 1;
  const int count = static_cast<int>(base.parts.size()) / stride;
  const Typed value = assigned_value(
      assign, [&] { return element_of(row ? base : whole, positions[0], span, name->name); }, span);
  if (value.is_error()) return;
  const Typed shaped =
      row ? promote(value, vector(std::vector<ir::Value>(static_cast<std::size_t>(stride))))
          : to_number(value);
  if (shaped.components() != stride)
    return error("element-type", span,
                 "an element of `" + name->name + "` is " +
                     (row ? "a vector of " + std::to_string(stride) : "a number") + ", this is " +
                     describe(value));
  Typed result = base;
  if (const auto fixed = known(positions[0].parts[0])) {
    const int at = static_cast<int>(*fixed) - 1;
    if (at < 0 || at >= count)
      return error("index-range", span,
                   "index " + std::to_string(at + 1) + " is outside 1.." + std::to_string(count) +
                       " of `" + name->name + "`");
    for (int c = 0; c < stride; ++c)
      result.parts[static_cast<std::size_t>(at * stride + c)] =
          shaped.parts[static_cast<std::size_t>(c)];
  } else {
    const ir::Value at = to_index(positions[0]);
    add_check(emit(ir::Op::band,
                   {emit(ir::Op::ile, {integer(0), at}), emit(ir::Op::ilt, {at, integer(count)})}),
              "index of `" + name->name + "` is outside 1.." + std::to_string(count), span);
    for (int k = 0; k < count; ++k) {
      const ir::Value here = emit(ir::Op::ieq, {at, integer(k)});
      for (int c = 0; c < stride; ++c) {
        ir::Value& part = result.parts[static_cast<std::size_t>(k * stride + c)];
        part = emit(ir::Op::select, {here, shaped.parts[static_cast<std::size_t>(c)], part});
      }
    }
  }
  assign_name(name->name, result, span);
}

void Lowering::assign_member(const AssignStmt& assign, const MemberExpr& member, const Span& span) {
  const auto* name = std::get_if<NameExpr>(&member.base->node);
  if (!name)
    return error("bad-target", assign.target->span, "only components of a named vector can be set");
  Typed base = lower_name(name->name, member.base->span);
  if (base.is_error()) return;
  if (base.kind != Kind::vector)
    return error("member-base", span,
                 "`" + name->name + "` is " + describe(base) + " and has no components");

  // Which components the letters name; none may repeat.
  std::vector<int> places;
  for (const char letter : member.name) {
    const std::string_view sets[] = {"xyzw", "rgba", "uv"};
    int place = -1;
    for (const std::string_view letters : sets)
      if (const std::size_t at = letters.find(letter); at != std::string_view::npos)
        place = static_cast<int>(at);
    if (place < 0 || place >= base.rows)
      return error(
          "unknown-component", member.name_span,
          "`" + name->name + "` is " + describe(base) + " and has no component `" + letter + "`");
    for (const int other : places)
      if (other == place)
        return error("repeated-component", member.name_span, "a component is set twice");
    places.push_back(place);
  }
  const Typed value = assigned_value(assign, [&] { return lower_member(member, span); }, span);
  if (value.is_error()) return;
  const Typed plain = to_number(value);
  if (plain.kind != Kind::number &&
      (plain.kind != Kind::vector || plain.rows != static_cast<int>(places.size())))
    return error("element-type", span,
                 "`." + member.name + "` takes " + std::to_string(places.size()) +
                     " numbers, this is " + describe(value));
  for (std::size_t i = 0; i < places.size(); ++i)
    base.parts[static_cast<std::size_t>(places[i])] =
        plain.parts[plain.kind == Kind::number ? 0 : i];
  assign_name(name->name, base, span);
}

}  // namespace pse::lower
