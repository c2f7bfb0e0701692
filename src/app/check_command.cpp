// `pse check`: errors and warnings of programs. With images among the arguments, their channels are
// what may be read.
#include <fmt/format.h>

#include <algorithm>

#include "app/input_images.h"
#include "app/program_file.h"
#include "app/render_job.h"
#include "app/report.h"

namespace pse::app {
namespace {

// The names that the images among the arguments bring; the programs go to `programs`.
std::vector<StreamName> image_names(const Session& session, std::vector<std::string>& programs) {
  RenderOptions options;
  for (const std::string& word : session.arguments.positionals) {
    const std::size_t equals = word.find('=');
    const bool is_program = word == "-" || word.ends_with(".pse");
    if (is_program)
      programs.push_back(word);
    else if (equals == std::string::npos)
      options.images.push_back({"", word});
    else
      options.images.push_back({word.substr(0, equals), word.substr(equals + 1)});
  }
  if (options.images.empty()) return {};
  InputImages images(options, session);
  images.open(choose_frames(options).front());
  return images.names();
}

}  // namespace

Exit check_command(Session& session) {
  std::vector<std::string> names;
  const std::vector<StreamName> images = image_names(session, names);
  if (names.empty()) throw usage_error("check needs a program", "pse check PROGRAM...");
  if (std::count(names.begin(), names.end(), "-") > 1)
    throw usage_error("standard input can be read only once");
  const WarningPolicy& policy = session.console.warnings();
  const bool json = session.arguments.has("json");

  Exit worst = Exit::ok;
  std::string all_json;
  for (const std::string& name : names) {
    ProgramFile program = read_program(name, session);
    Diagnostics found;
    survey(program, module_host(program.path, session), found, images);
    const Diagnostics shown = filtered(found, policy);
    if (json) {
      // Join the files' arrays into one.
      const std::string list = print_json(shown, program.sources);
      const std::string inner =
          list.substr(list.find('[') + 1, list.rfind(']') - list.find('[') - 1);
      const bool empty = inner.find('{') == std::string::npos;
      if (!empty) all_json += (all_json.empty() ? "" : ",") + inner;
    } else {
      show(found, program.sources, session.console);
      if (shown.all().empty())
        session.console.note(fmt::format("{}: no errors", program.sources.file(program.file).name));
    }
    const Exit exit = exit_of(shown, policy);
    if (worst == Exit::ok || exit == Exit::program) worst = exit == Exit::ok ? worst : exit;
  }
  if (json) session.console.print("[" + all_json + "]\n");
  return worst;
}

}  // namespace pse::app
