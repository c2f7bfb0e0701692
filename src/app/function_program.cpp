// Looking for functions in a tree, and writing the lines that call them.
#include "app/function_program.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "lower/scan.h"

namespace pse::app {

int required_parameters(const lang::Program& tree, const std::string& name) {
  for (const lang::StmtPtr& statement : tree.body) {
    const auto* function = statement ? std::get_if<lang::FunctionStmt>(&statement->node) : nullptr;
    if (function == nullptr || function->name != name) continue;
    return static_cast<int>(
        std::count_if(function->parameters.begin(), function->parameters.end(),
                      [](const lang::Parameter& p) { return p.default_value == nullptr; }));
  }
  return -1;
}

bool sets_at_top(const lang::Program& tree, const std::string& name) {
  std::set<std::string> set_names;
  lower::collect_assigned(tree.body, set_names);
  return set_names.contains(name);
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
