// libFuzzer: any bytes as a program. The front end and the lowering must refuse or accept them
// without a crash or a hang; what parses must format to a text that parses, and formatting twice
// must change nothing more.
#include <cstdint>
#include <cstdlib>

#include "lang/parser.h"
#include "lower/lower.h"

namespace {

struct Parsed {
  pse::SourceMap sources;
  pse::Diagnostics diagnostics;
  pse::lang::Program program;
};

void parse(Parsed& parsed, std::string text) {
  const pse::FileId file = parsed.sources.add("input", std::move(text));
  parsed.program = pse::lang::parse(parsed.sources, file, parsed.diagnostics);
}

// Lowers what was understood, errors or not, as the image plane would bring its names.
void lower(Parsed& parsed) {
  pse::LowerOptions options;
  options.stream = {
      {"x"}, {"y"}, {"point", 3}, {"fg.color", 3}, {"frame", 1, pse::ir::Rate::frame}};
  options.max_instructions = 20'000;
  pse::Diagnostics diagnostics;
  pse::lower_program(parsed.sources, parsed.program, pse::LowerHost{}, options, diagnostics);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Parsed first;
  parse(first, std::string(reinterpret_cast<const char*>(data), size));
  first.diagnostics.sort();
  pse::print_text(first.diagnostics, first.sources, false);
  pse::print_json(first.diagnostics, first.sources);
  pse::lang::print_tokens(first.sources, first.program.file);
  lower(first);
  if (first.diagnostics.has_errors()) return 0;

  // What was accepted: its formatted text has the same tree and comments, and formats to itself.
  const std::string formatted = pse::lang::format(first.program, first.sources);
  Parsed second;
  parse(second, formatted);
  if (second.diagnostics.has_errors()) std::abort();
  if (pse::lang::print_ast(first.program) != pse::lang::print_ast(second.program)) std::abort();
  if (first.program.comments.size() != second.program.comments.size()) std::abort();
  if (pse::lang::format(second.program, second.sources) != formatted) std::abort();
  return 0;
}
