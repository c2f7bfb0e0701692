// `pse fmt`: programs in the one layout.
#include <fmt/format.h>

#include "app/program_file.h"
#include "app/report.h"
#include "image/output_file.h"
#include "lang/parser.h"

namespace pse::app {
namespace {

void rewrite(const std::string& path, const std::string& text) {
  auto file = image::OutputFile::create(path);
  if (!file) throw Failure(Exit::output, file.error().message);
  file->write(text.data(), text.size());
  if (const auto done = file->commit(); !done) throw Failure(Exit::output, done.error().message);
}

}  // namespace

Exit fmt_command(Session& session) {
  const auto& names = session.arguments.positionals;
  const bool check = session.arguments.has("check"), in_place = session.arguments.has("in-place");
  if (names.empty())
    throw usage_error("fmt needs a program, or `-` for standard input", "pse fmt PROGRAM...");
  if (check && in_place)
    throw usage_error("--check changes nothing, so it cannot go with --in-place");

  Exit worst = Exit::ok;
  for (const std::string& name : names) {
    const ProgramFile program = read_program(name, session);
    Diagnostics diagnostics;
    const lang::Program tree = lang::parse(program.sources, program.file, diagnostics);
    if (diagnostics.has_errors()) {
      diagnostics.sort();
      session.console.raw_error(print_text(diagnostics, program.sources, session.console.colour()));
      worst = Exit::program;
      continue;
    }
    const std::string text = lang::format(tree, program.sources);
    const bool same = text == program.text();
    if (check && !same) {
      session.console.note(
          fmt::format("{}: not formatted", program.sources.file(program.file).name));
      if (worst == Exit::ok) worst = Exit::strict;
    } else if (in_place && program.path != "-") {
      if (same) continue;
      rewrite(program.path, text);
      session.console.note(fmt::format("{}: formatted", program.path));
    } else if (!check) {
      session.console.print(text);
    }
  }
  return worst;
}

}  // namespace pse::app
