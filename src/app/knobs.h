// Values of knobs from outside the program: environment < parameter files < command line.
#pragma once

#include <map>

#include "app/session.h"
#include "codegen/kernel.h"
#include "lower/lower.h"

namespace pse::app {

// One value for one knob, as text until the program's knob says what it must be.
struct KnobSetting {
  std::string name;
  std::string text;
  std::string origin;  // for messages
};

// All settings in rising order of precedence. `words` are the Name=VALUE arguments.
std::vector<KnobSetting> knob_settings(const Session& session,
                                       const std::vector<std::string>& words);

// The knobs with the settings applied. Throws Failure (usage) for unknown names, wrong shapes and
// unknown options; warns about values outside [min, max]. Variables PSE_Name without such a knob
// are nobody's business.
std::vector<Knob> apply_settings(std::vector<Knob> knobs, const std::vector<KnobSetting>& settings,
                                 Console& console);

// Sets the uniforms of the module's inputs that are knobs; state.uniforms has room for every input.
void set_knob_uniforms(const ir::Module& module, const std::vector<Knob>& knobs, FrameState& state);

// A knob's value as the command line would take it: "0.5", "[1 0 0]", "true", "text".
std::string knob_text(const Knob& knob);
// The program's knobs for --help: name, value, range, help.
std::string knob_help(const std::vector<Knob>& knobs);

}  // namespace pse::app
