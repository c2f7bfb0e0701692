// The public API: compile a program once, run it on arrays as often as wanted.
//
//   auto script = pse::Script::compile("Tint = [1 0.8 0.5]\ncolor = Tint * (0.5 + Noise(p))",
//                                      {.inputs = {{"p", 3}}});
//   if (!script) return fail(script.error());
//   script->run(1000, {{"p", {px, py, pz}}}, {{"color", {red, green, blue}}});
#pragma once

#include <cstdint>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pse {

// A name that the caller brings, with 1 (a number) or more (a vector) components. `per_run` names
// have one value for all samples of a run, and what is computed from them alone is computed once.
struct ScriptInput {
  std::string name;
  int components = 1;
  bool per_run = false;
};

struct ScriptOptions {
  std::vector<ScriptInput> inputs = {};
  std::vector<std::string> module_path = {};  // folders searched by `import`
  bool interpret = false;  // run by the reference interpreter instead of compiled code
  std::string cache_folder = {};              // compiled kernels are kept here; empty: nowhere
};

// Arrays of one name, one per component, `count` floats each. Unlike inside pse they need no
// padding or alignment.
struct ConstArrays {
  std::string name;
  std::vector<const float*> components;
};
struct Arrays {
  std::string name;
  std::vector<float*> components;
};

struct ScriptName {
  std::string name;
  int components = 1;
};

struct ScriptKnob {
  std::string name;
  std::vector<float> value;  // empty for a text knob
  std::string text;
  std::string help;
};

// A compiled program with its knobs' values. Copies share the compiled code. Different Scripts may
// run in different threads at once; one Script may too as long as nobody sets its knobs meanwhile.
class Script {
 public:
  // The error is every error of the program, ready for a terminal.
  static std::expected<Script, std::string> compile(std::string_view text,
                                                    const ScriptOptions& options = {});

  const std::vector<ScriptName>& outputs() const;
  const std::vector<ScriptKnob>& knobs() const;
  // The inputs that the program reads.
  const std::vector<std::string>& reads() const;

  // Sets a knob; a sentence about what is wrong otherwise.
  std::expected<void, std::string> set(std::string_view knob, std::span<const float> value);

  // Runs the program on samples [0, count). Every input that the program reads must be given;
  // `per_run` inputs give arrays of one float. Outputs that are not asked for are not stored. The
  // error is a sentence: a missing or misshapen array, or an index out of range in the program.
  std::expected<void, std::string> run(std::int64_t count, const std::vector<ConstArrays>& inputs,
                                       const std::vector<Arrays>& outputs) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
  std::vector<std::vector<float>> values_;  // of the knobs, in their order
};

}  // namespace pse
