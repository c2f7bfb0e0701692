// Compiles a program's text and runs it at a few samples, for tests that look at values.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "diag/diagnostics.h"
#include "stream/program.h"

namespace pse::test {

// Named inputs: components of one sample, or of a frame.
struct Sample {
  std::map<std::string, std::vector<float>> stream;  // names of rate sample
  std::map<std::string, std::vector<float>> frame;   // names of rate frame
  std::map<std::string, std::vector<float>> knobs;   // overrides
};

struct Outcome {
  bool compiled = false;
  Diagnostics diagnostics;
  SourceMap sources;
  std::shared_ptr<const Program> program;
  std::map<std::string, std::vector<float>> values;  // outputs by name
  std::string failed_check;                          // message of the check that ended the run
  // All messages, "line:code: message", one per line.
  std::string messages() const;
  // The only component of an output.
  float number(const std::string& name) const;
};

struct RunSettings {
  bool interpret = true;
  bool optimize = true;
  int width = 0;
  std::map<std::string, std::string> modules;  // texts for `import`
};

Outcome run_program(const std::string& text, const Sample& sample = {},
                    const RunSettings& settings = {});

}  // namespace pse::test
