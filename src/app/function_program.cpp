// Looking for functions in a tree, and writing the lines that call them.
#include "app/function_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <set>

#include "lower/scan.h"

namespace pse::app {
namespace {

// The same in one expression.
std::optional<Span> find_call(const lang::ExprPtr& expr, const std::string& name) {
  if (!expr) return std::nullopt;
  const auto among = [&](std::initializer_list<const lang::ExprPtr*> parts) {
    std::optional<Span> found;
    for (const lang::ExprPtr* part : parts)
      if (!found) found = find_call(*part, name);
    return found;
  };
  if (const auto* call = std::get_if<lang::CallExpr>(&expr->node)) {
    const auto* callee = std::get_if<lang::NameExpr>(&call->callee->node);
    if (callee != nullptr && callee->name == name) return expr->span;
    for (const lang::Argument& argument : call->arguments)
      if (const auto found = find_call(argument.value, name)) return found;
  }
  if (const auto* pair = std::get_if<lang::BinaryExpr>(&expr->node))
    return among({&pair->left, &pair->right});
  if (const auto* unary = std::get_if<lang::UnaryExpr>(&expr->node))
    return among({&unary->operand});
  if (const auto* choice = std::get_if<lang::ConditionalExpr>(&expr->node))
    return among({&choice->condition, &choice->if_true, &choice->if_false});
  if (const auto* member = std::get_if<lang::MemberExpr>(&expr->node))
    return among({&member->base});
  if (const auto* index = std::get_if<lang::IndexExpr>(&expr->node)) return among({&index->base});
  return std::nullopt;
}

}  // namespace

std::optional<Span> find_call(const lang::Program& tree, const std::string& name) {
  for (const lang::StmtPtr& statement : tree.body) {
    const auto* set = statement ? std::get_if<lang::AssignStmt>(&statement->node) : nullptr;
    if (set == nullptr) continue;
    if (const auto found = find_call(set->value, name)) return found;
  }
  return std::nullopt;
}

namespace {

const lang::FunctionStmt* find_function(const lang::Program& tree, const std::string& name) {
  for (const lang::StmtPtr& statement : tree.body) {
    const auto* function = statement ? std::get_if<lang::FunctionStmt>(&statement->node) : nullptr;
    if (function != nullptr && function->name == name) return function;
  }
  return nullptr;
}

}  // namespace

int required_parameters(const lang::Program& tree, const std::string& name) {
  const lang::FunctionStmt* function = find_function(tree, name);
  if (function == nullptr) return -1;
  return static_cast<int>(
      std::count_if(function->parameters.begin(), function->parameters.end(),
                    [](const lang::Parameter& p) { return p.default_value == nullptr; }));
}

std::optional<Span> function_head(const lang::Program& tree, const std::string& name) {
  const lang::FunctionStmt* function = find_function(tree, name);
  return function == nullptr ? std::nullopt : std::optional(function->head);
}

std::string density_wants_more(const lang::Program& tree) {
  const int parameters = required_parameters(tree, "density");
  if (parameters < 2) return "";
  return fmt::format(
      "`density` wants {} arguments and there is no ray here, only a place; what else "
      "it takes needs a default",
      parameters);
}

bool sets_at_top(const lang::Program& tree, const std::string& name) {
  std::set<std::string> set_names;
  lower::collect_assigned(tree.body, set_names);
  return set_names.contains(name);
}

std::string hypertexture_line(const lang::Program& tree) {
  if (required_parameters(tree, "density") < 1) return "";
  std::set<std::string> set_names;
  lower::collect_assigned(tree.body, set_names);
  const auto is_written = [](const std::string& name) {
    return name.front() != '_' && std::isupper(static_cast<unsigned char>(name.front())) == 0;
  };
  if (std::ranges::any_of(set_names, is_written)) return "";
  std::string line = "color = hypertexture(density";
  for (const char* name : {"compute_color", "compute_shading", "init_density"})
    if (required_parameters(tree, name) >= 0) line += fmt::format(", {0} = {0}", name);
  return line + ")\n";
}

std::string calls_at_point(const lang::Program& tree, const std::vector<std::string>& names) {
  // All calls first: once a variable is set, it hides the function of its name.
  std::string calls, settings;
  const auto call = [&](const std::string& name) {
    const bool two = required_parameters(tree, name) == 2;
    calls += fmt::format("{0}_here = {0}(point{1})\n", name, two ? ", density_here" : "");
  };
  const bool needs_density = std::any_of(names.begin(), names.end(), [&](const auto& name) {
    return name == "density" || required_parameters(tree, name) == 2;
  });
  if (needs_density) call("density");
  for (const std::string& name : names) {
    if (name != "density") call(name);
    settings += fmt::format("{0} = {0}_here\n", name);
  }
  return calls + settings;
}

void append_lines(ProgramFile& program, const std::string& lines) {
  const std::string shown = program.sources.file(program.file).name;
  program.file = program.sources.add(shown, program.text() + "\n" + lines);
}

}  // namespace pse::app
