// What structured control does to variables: branches merge them, loops carry them. This is where
// the tree's mutable variables become the IR's single assignments.
#include <algorithm>
#include <utility>

#include "lower/lowering.h"

namespace pse::lower {

namespace {

// Names bound in either map to something that differs.
std::set<std::string> changed_names(const Variables& before, const Variables& a,
                                    const Variables& b) {
  std::set<std::string> names;
  const auto differs = [&](const Variables& after) {
    for (const auto& [name, value] : after) {
      const auto old = before.find(name);
      if (old == before.end() || !same_shape(old->second, value) ||
          old->second.parts != value.parts)
        names.insert(name);
    }
  };
  differs(a);
  differs(b);
  return names;
}

constexpr const char *in_one = " in one branch and ", *in_other = " in the other";

// What a message calls it.
std::string spoken(const std::string& name) {
  if (name == "%result") return "the returned value";
  if (name == "%value") return "the value of `? :`";
  return "`" + name + "`";
}

bool is_internal(const std::string& name) { return name.front() == '%'; }

// Whether each run of the block sets the name, whatever its branches and loops do.
bool always_sets(const lang::Block& block, const std::string& name) {
  for (const lang::StmtPtr& statement : block) {
    if (!statement || exits_of(*statement).any()) return false;
    const auto* assign = std::get_if<lang::AssignStmt>(&statement->node);
    const auto* target = assign ? std::get_if<lang::NameExpr>(&assign->target->node) : nullptr;
    if (target && target->name == name) return true;
  }
  return false;
}

}  // namespace

void Lowering::branch(ir::Value condition, const std::function<void()>& if_true,
                      const std::function<void()>& if_false, const Span& span) {
  // An `else` of an `else` is a region in a region, and all that walk through them recurse.
  constexpr int deepest = 500;
  if (branch_depth_ == deepest) {
    error("too-deep", span, "more than 500 branches lie within each other here",
          "a table is an array, or a texture");
    throw TooLarge{};
  }
  ++branch_depth_;

  // Lower both sides, each from the same variables.
  const Variables before = variables();
  ir::Region then_region, else_region;
  builder_->begin_region(then_region);
  if_true();
  builder_->end_region();
  Variables after_then = std::exchange(variables(), before);
  builder_->begin_region(else_region);
  if_false();
  builder_->end_region();
  Variables after_else = std::exchange(variables(), before);
  --branch_depth_;

  // Bring each changed variable to one shape on both sides.
  struct Merge {
    std::string name;
    Typed shape;
  };
  std::vector<Merge> merges;
  const auto side = [&](Variables& after, ir::Region& region, const std::string& name,
                        const Typed* other) -> Typed {
    if (const auto found = after.find(name); found != after.end()) return found->second;
    builder_->begin_region(region);
    Typed value;
    if (const StreamName* stream =
            is_internal(name) || call_ != &top_ ? nullptr : stream_name(name))
      value = read_stream(*stream);
    else if (other->kind == Kind::array || other->kind == Kind::function ||
             other->kind == Kind::text)
      value = *other;
    else
      value = zero_of(*other);
    builder_->end_region();
    return value;
  };
  for (const std::string& name : changed_names(before, after_then, after_else)) {
    const auto in_then = after_then.find(name), in_else = after_else.find(name);
    Typed a = side(after_then, then_region, name,
                   in_else == after_else.end() ? nullptr : &in_else->second);
    Typed b = side(after_else, else_region, name,
                   in_then == after_then.end() ? nullptr : &in_then->second);
    if (a.is_error() || b.is_error() || a.kind == Kind::nothing || b.kind == Kind::nothing) {
      variables()[name] = a.is_error() || a.kind == Kind::nothing ? a : b;
      continue;
    }
    if (!a.is_numeric() || !b.is_numeric()) {
      if (!same_shape(a, b))
        error("branch-types", span,
              spoken(name) + " is " + describe(a) + in_one + describe(b) + in_other,
              a.kind == Kind::text || a.kind == Kind::function
                  ? "texts and functions must be known when the program is compiled"
                  : "");
      variables()[name] = a;
      continue;
    }
    const auto shape = common_shape(a, b);
    if (!shape) {
      error("branch-types", span,
            spoken(name) + " is " + describe(a) + in_one + describe(b) + in_other);
      variables()[name] = Typed{};
      continue;
    }
    builder_->begin_region(then_region);
    after_then[name] = promote(a, *shape);
    builder_->end_region();
    builder_->begin_region(else_region);
    after_else[name] = promote(b, *shape);
    builder_->end_region();
    merges.push_back({name, *shape});
  }

  // Yield them and bind the results.
  for (const Merge& merge : merges) {
    const auto& a = after_then[merge.name].parts;
    const auto& b = after_else[merge.name].parts;
    then_region.yields.insert(then_region.yields.end(), a.begin(), a.end());
    else_region.yields.insert(else_region.yields.end(), b.begin(), b.end());
  }
  builder_->set_span(span);
  const std::vector<ir::Value> results =
      builder_->emit_if(condition, std::move(then_region), std::move(else_region));
  std::size_t next = 0;
  for (const Merge& merge : merges) {
    Typed value = merge.shape;
    for (ir::Value& part : value.parts) part = results[next++];
    variables()[merge.name] = value;
  }
  check_size();
}

Typed Lowering::branch_value(ir::Value condition, const std::function<Typed()>& if_true,
                             const std::function<Typed()>& if_false, const Span& span) {
  branch(
      condition, [&] { variables()["%value"] = if_true(); },
      [&] { variables()["%value"] = if_false(); }, span);
  const auto found = variables().find("%value");
  if (found == variables().end()) return {};
  Typed value = std::move(found->second);
  variables().erase(found);
  return value;
}

void Lowering::loop(const std::set<std::string>& assigned, const lang::Block& body_block,
                    const std::function<ir::Value()>& condition, const std::function<void()>& body,
                    const Span& span) {
  // Carry what the body assigns: names bound before, and names first set inside that are read after
  // the loop.
  struct Carried {
    std::string name;
    Typed shape;   // with the parameters as parts
    Typed initial;
  };
  std::vector<Carried> carried;
  const auto carry = [&](const std::string& name, const Typed& initial) {
    carried.push_back({name, initial, initial});
  };
  for (const std::string& name : assigned) {
    auto found = variables().find(name);
    if (found == variables().end()) {
      // A stream's name that the body changes starts as the stream's value.
      const StreamName* stream = call_ == &top_ && !is_internal(name) ? stream_name(name) : nullptr;
      if (!stream) continue;
      variables()[name] = read_stream(*stream);
      found = variables().find(name);
    }
    if (found->second.is_numeric()) carry(name, found->second);
  }

  const Variables before = variables();
  Diagnostics* const outer_diagnostics = diagnostics_;
  constexpr int most_attempts = 6;
  for (int attempt = 0;; ++attempt) {
    // Lower head and body with the shapes believed so far, into a region that is dropped if they
    // turn out wrong.
    Diagnostics attempt_diagnostics;
    diagnostics_ = &attempt_diagnostics;
    ir::Region head, body_region;
    const auto open = [&](ir::Region& region) {
      variables() = before;
      for (Carried& c : carried) {
        c.shape = c.initial;
        c.shape.parts.clear();
        for (const ir::Value part : c.initial.parts)
          c.shape.parts.push_back(builder_->add_param(region, builder_->type(part)));
        variables()[c.name] = c.shape;
      }
      builder_->begin_region(region);
    };
    const auto restore = [&] { diagnostics_ = outer_diagnostics; };
    try {
      open(head);
      head.yields = {condition()};
      builder_->end_region();
      open(body_region);
      body();
    } catch (...) {
      restore();
      throw;
    }

    // See what the body made of each carried variable, and what it set that is needed later.
    bool again = false;
    Variables after = variables();
    for (Carried& c : carried) {
      const Typed& now = after[c.name];
      if (now.is_error()) continue;
      const auto shape = common_shape(c.initial, now);
      if (!shape) {
        diagnostics_->error("loop-types", span,
                            "`" + c.name + "` is " + describe(c.initial) + " before the loop and " +
                                describe(now) + " in it");
        continue;
      }
      if (!same_shape(*shape, c.initial)) {
        again = true;
      } else {
        const Typed next = promote(now, *shape);
        body_region.yields.insert(body_region.yields.end(), next.parts.begin(), next.parts.end());
      }
    }
    // A name that every turn sets needs no value from the turn before: it joins without lowering
    // the body again.
    std::vector<std::pair<std::string, Typed>> first_set, joining;
    for (const auto& [name, value] : after) {
      if (before.contains(name) || name == "%value" || !value.is_numeric()) continue;
      if (std::any_of(carried.begin(), carried.end(),
                      [&](const Carried& c) { return c.name == name; }))
        continue;
      const bool needed = is_internal(name) || call_ == &top_ ||
                          count_mentions(*call_->body, name) > count_mentions(body_block, name);
      if (!needed) continue;
      (is_internal(name) || always_sets(body_block, name) ? joining : first_set)
          .emplace_back(name, value);
    }
    builder_->end_region();
    restore();
    variables() = before;
    again = again || !first_set.empty();

    if (again && attempt < most_attempts) {
      // Widen what grew and start again.
      for (Carried& c : carried) {
        const Typed& now = after[c.name];
        if (now.is_error()) continue;
        if (const auto shape = common_shape(c.initial, now)) c.initial = promote(c.initial, *shape);
      }
      for (const auto& [name, value] : first_set) carry(name, zero_of(value));
      check_size();
      if (++loop_attempts_ > 5000) {
        error("too-large", span, "loops that first set variables are nested too deeply here",
              "set the variables before the loops");
        throw TooLarge{};
      }
      continue;
    }
    for (const auto& [name, value] : joining) {
      for (const ir::Value part : value.parts) {
        builder_->add_param(head, builder_->type(part));
        builder_->add_param(body_region, builder_->type(part));
        body_region.yields.push_back(part);
      }
      carry(name, zero_of(value));
    }
    for (const Diagnostic& diagnostic : attempt_diagnostics.all()) diagnostics_->add(diagnostic);
    if (attempt_diagnostics.has_errors()) {
      // Keep the names bound so that later statements can be checked.
      for (const auto& [name, value] : after)
        if (!before.contains(name) && !is_internal(name)) variables()[name] = Typed{};
      return;
    }

    // Arrays and functions first bound inside stay bound; numbers become the loop's results.
    for (const auto& [name, value] : after)
      if (!before.contains(name) && (value.kind == Kind::array || value.kind == Kind::function))
        variables()[name] = value;
    std::vector<ir::Value> initial;
    for (const Carried& c : carried)
      initial.insert(initial.end(), c.initial.parts.begin(), c.initial.parts.end());
    builder_->set_span(span);
    const std::vector<ir::Value> results =
        builder_->emit_loop(initial, std::move(head), std::move(body_region));
    std::size_t next = 0;
    for (const Carried& c : carried) {
      Typed value = c.initial;
      for (ir::Value& part : value.parts) part = results[next++];
      variables()[c.name] = value;
    }
    check_size();
    return;
  }
}

ir::Value Lowering::flag_value(const char* flag) {
  const auto found = variables().find(flag);
  return found == variables().end() ? builder_->const_bool(false) : found->second.parts.front();
}

ir::Value Lowering::not_left(const Exits& exits) {
  ir::Value left = ir::no_value;
  const auto add = [&](bool wanted, const char* flag) {
    if (!wanted) return;
    const ir::Value value = flag_value(flag);
    left = left == ir::no_value ? value : emit(ir::Op::bor, {left, value});
  };
  add(exits.returns, "%returned");
  add(exits.breaks, "%broke");
  add(exits.continues, "%continued");
  if (left == ir::no_value) return builder_->const_bool(true);
  return emit(ir::Op::bnot, {left});
}

}  // namespace pse::lower
