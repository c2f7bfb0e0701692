// tree -> typed IR: type inference by specialisation. A function is lowered into its caller for the
// types it is called with, so functions can be arguments and need no declarations. See
// docs/language.md for the rules.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "diag/diagnostics.h"
#include "ir/call_range.h"
#include "ir/module.h"
#include "lang/ast.h"

namespace pse {

// A name that the stream brings: a sample's coordinate, an image's channel, the frame number.
struct StreamName {
  std::string name;    // "point", "frame", "fg.color"
  int components = 1;  // 1: a number; n: a vector of n
  ir::Rate rate = ir::Rate::sample;
  ir::InputSlopes slopes = ir::InputSlopes::none;
};

// A top-level capitalised name with a constant value.
struct Knob {
  std::string name;
  std::vector<float> value;        // the program's own value; empty for a string knob
  std::string text;                // value of a string knob
  bool is_boolean = false;
  std::optional<float> min, max;
  std::string label, help, widget, units, page;
  std::vector<std::string> options;
  Span span;

  bool is_text() const { return value.empty(); }
};

// A lower-case name that the program sets at top level.
struct ProgramOutput {
  std::string name;
  int components = 1;
  Span span;  // where it was last set
};

// What the lowering asks of its host.
struct LowerHost {
  // The text of module `name` (of `import name`), added to the map; nothing when there is none.
  std::function<std::optional<FileId>(SourceMap&, const std::string& name)> find_module;
  // The number of components of a stored texture's layer, or an error message. See `texture()` in
  // docs/language.md.
  std::function<int(const std::string& file, const std::string& layer, std::string& error)>
      texture_components;
  // The same of a stored volume's grid, see `volume()`; an empty name is the file's main grid.
  std::function<int(const std::string& file, const std::string& grid, std::string& error)>
      volume_components;
  // The width and height of a stored texture; 0 and a message where there is none.
  std::function<std::pair<int, int>(const std::string& file, std::string& error)> texture_size;
};

struct LowerOptions {
  std::vector<StreamName> stream;
  std::vector<std::string> outputs;  // the outputs wanted; empty: all
  std::vector<std::pair<std::string, std::string>> text_knobs;  // overrides of string knobs
  std::size_t max_instructions = 400'000;
};

struct Lowered {
  // Inputs: the stream names read (by component), then the knobs read (rate frame).
  ir::Module module;
  std::vector<Knob> knobs;  // all of the program's, read or not, in order of appearance
  std::vector<ProgramOutput> outputs;
  std::vector<std::string> reads;  // stream names read
  // The functions of the language that were written into the program.
  std::vector<ir::CallRange> calls;
};

// Errors go to `diagnostics`; the result is meaningful only when there are none.
Lowered lower_program(SourceMap& sources, const lang::Program& program, const LowerHost& host,
                      const LowerOptions& options, Diagnostics& diagnostics);

// After errors of the parser: adds what else is wrong with the statements that it understood, and
// sorts. Names that nothing is like are left out, since a statement that was not understood may
// have set them.
void add_later_errors(SourceMap& sources, const lang::Program& program, const LowerHost& host,
                      const LowerOptions& options, Diagnostics& diagnostics);

}  // namespace pse
