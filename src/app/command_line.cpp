// From words to a command: the table of contents of the application.
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>

#include "app/completion.h"
#include "app/help.h"
#include "app/man_page.h"
#include "app/report.h"
#include "app/session.h"
#include "app/version.h"
#include "diag/diagnostics.h"

namespace pse::app {
namespace {

// The date for a manual page: fixed by SOURCE_DATE_EPOCH where that is set.
std::string today() {
  std::time_t time = std::time(nullptr);
  if (const char* fixed = std::getenv("SOURCE_DATE_EPOCH")) time = std::strtoll(fixed, nullptr, 10);
  std::tm parts{};
  gmtime_r(&time, &parts);
  return fmt::format("{:04}-{:02}-{:02}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday);
}

[[noreturn]] void unknown_command(const std::string& name) {
  std::vector<std::string> names;
  for (const CommandSpec& command : commands()) names.emplace_back(command.name);
  const std::string near = nearest_name(name, names);
  const bool is_program = name.ends_with(".pse");
  throw usage_error(fmt::format("there is no command `{}`", name),
                    is_program      ? fmt::format("did you mean `pse render {}`?", name)
                    : !near.empty() ? fmt::format("did you mean `{}`?", near)
                                    : "`pse --help` lists the commands");
}

const CommandSpec& command_named(const std::string& name) {
  const CommandSpec* command = find_command(name);
  if (command == nullptr) unknown_command(name);
  return *command;
}

Exit help_command(Session& session) {
  const auto& names = session.arguments.positionals;
  const bool man = session.arguments.has("man");
  if (names.size() > 1) throw usage_error("help takes one command");
  if (names.empty())
    session.console.print(man ? overview_man_page(today()) : overview_help());
  else
    session.console.print(man ? man_page(command_named(names[0]), today())
                              : command_help(command_named(names[0])));
  return Exit::ok;
}

Exit completion_command(Session& session) {
  const auto& names = session.arguments.positionals;
  const std::string script = names.size() == 1 ? completion_script(names[0]) : std::string();
  if (script.empty()) throw usage_error("completion takes the name of a shell: bash, zsh or fish");
  session.console.print(script);
  return Exit::ok;
}

void print_version(Console& console) { console.print(fmt::format("pse {}\n", version)); }

Exit dispatch(Session& session) {
  const std::string_view name = session.arguments.command->name;
  if (session.arguments.has("help") && name != "render") {
    session.console.print(command_help(*session.arguments.command));
    return Exit::ok;
  }
  if (name == "render" || name == "trace") return render_command(session);
  if (name == "bake") return bake_command(session);
  if (name == "check") return check_command(session);
  if (name == "fmt") return fmt_command(session);
  if (name == "info") return info_command(session);
  if (name == "doc") return doc_command(session);
  if (name == "diff") return diff_command(session);
  if (name == "help") return help_command(session);
  if (name == "completion") return completion_command(session);
  print_version(session.console);
  return Exit::ok;
}

std::optional<std::string> environment_variable(const std::string& name) {
  const char* value = std::getenv(name.c_str());
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

Exit run(const std::vector<std::string>& words, Console& console) {
  // Words before the command.
  if (words.empty()) {
    console.raw_error(overview_help());
    return Exit::usage;
  }
  if (words[0] == "--version" || words[0] == "-V") return print_version(console), Exit::ok;
  if (words[0] == "--help" || words[0] == "-h") return console.print(overview_help()), Exit::ok;
  if (words[0].starts_with("-"))
    throw usage_error(fmt::format("`{}` stands before a command", words[0]),
                      "usage: pse COMMAND ...");

  // The command with its options: command line, then environment, then configuration files.
  const CommandSpec& command = command_named(words[0]);
  Session session{parse_arguments(command, {words.begin() + 1, words.end()}), {}, console};
  console.set_quiet(session.arguments.has("quiet"));
  add_environment(session.arguments, environment_variable);
  session.configuration = add_configuration(session.arguments);
  check_choices(session.arguments);
  console.set_warnings(warning_policy(session.arguments));
  for (const std::string& line : session.configuration.unknown)
    console.warning("configuration", line);
  const Exit exit = dispatch(session);
  if (exit == Exit::ok && console.strict_failure()) throw strict_failure();
  return exit;
}

}  // namespace

int run_command_line(const std::vector<std::string>& words, Console& console) {
  Exit status = Exit::running;
  try {
    status = run(words, console);
  } catch (const Failure& failure) {
    if (*failure.what() != 0) console.error(failure.what(), failure.hint());
    status = failure.exit();
  } catch (const std::bad_alloc&) {
    console.error("out of memory");
  } catch (const std::exception& error) {
    console.error(error.what());
  }
  if (!console.flush() && status == Exit::ok) {
    console.error("cannot write to standard output");
    status = Exit::output;
  }
  return static_cast<int>(status);
}

}  // namespace pse::app
