// What a program's comments say must come out of it, and the check that it does.
//   # expect: name = 0.5            # expect: name = [1 2 3]            # expect: name = 0.5 within
//   0.01
//   ...  # error: code              ...  # warning: code                # fails: part of the
//   message
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/run_text.h"

namespace pse::test {

struct Expectations {
  struct Value {
    std::string name;
    std::vector<float> components;
    float tolerance = 1e-6f;
  };
  std::vector<Value> values;
  std::vector<std::pair<int, std::string>> errors, warnings;  // line, code
  std::string failure;                                        // part of a failed check's message
};

inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline Expectations read_expectations(const std::string& text) {
  Expectations result;
  const std::vector<std::string> lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string& line = lines[i];
    const int number = static_cast<int>(i) + 1;
    const auto after = [&](const char* mark) -> std::string {
      const std::size_t at = line.find(mark);
      return at == std::string::npos ? "" : line.substr(at + std::string(mark).size());
    };
    if (std::string rest = after("# expect: "); !rest.empty()) {
      Expectations::Value value;
      for (char& letter : rest)
        if (letter == '[' || letter == ']' || letter == ',') letter = ' ';
      std::istringstream words(rest);
      std::string word;
      words >> value.name >> word;
      while (words >> word) {
        if (word == "within")
          words >> value.tolerance;
        else
          value.components.push_back(std::stof(word));
      }
      result.values.push_back(std::move(value));
    }
    std::string code;
    if (std::istringstream words(after("# error: ")); words >> code)
      result.errors.emplace_back(number, code);
    if (std::istringstream words(after("# warning: ")); words >> code)
      result.warnings.emplace_back(number, code);
    if (const std::string message = after("# fails: "); !message.empty()) result.failure = message;
  }
  return result;
}

// Runs the program compiled and interpreted, and holds it to its comments. A program without any
// must run.
inline void check_program(const std::string& name, const std::string& text,
                          const std::map<std::string, std::string>& modules = {}) {
  const Expectations expected = read_expectations(text);
  for (const bool interpret : {false, true}) {
    SCOPED_TRACE(name + (interpret ? " (interpreted)" : " (compiled)"));
    const TextRun run = run_text(name, text, {.interpret = interpret, .modules = modules});

    // Exactly the expected errors and warnings, each on its line.
    std::vector<std::pair<int, std::string>> errors, warnings;
    for (const Diagnostic& diagnostic : run.diagnostics.all()) {
      const int line = diagnostic.span.valid() ? run.sources.position(diagnostic.span).line : 0;
      (diagnostic.severity == Severity::error ? errors : warnings)
          .emplace_back(line, diagnostic.code);
    }
    std::sort(errors.begin(), errors.end());
    std::sort(warnings.begin(), warnings.end());
    EXPECT_EQ(errors, expected.errors) << run.printed();
    EXPECT_EQ(warnings, expected.warnings) << run.printed();
    if (!expected.errors.empty() || !run.program) continue;
    if (!expected.failure.empty()) {
      EXPECT_NE(run.failure.find(expected.failure), std::string::npos) << run.failure;
      continue;
    }

    // The values at the middle pixel.
    EXPECT_EQ(run.failure, "");
    for (const Expectations::Value& value : expected.values) {
      const auto found = run.outputs.find(value.name);
      if (found == run.outputs.end()) {
        ADD_FAILURE() << "there is no output " << value.name;
        continue;
      }
      ASSERT_EQ(found->second.size(), value.components.size()) << value.name;
      for (std::size_t c = 0; c < value.components.size(); ++c) {
        const float want = value.components[c], got = found->second[c];
        if (std::isfinite(want))
          EXPECT_NEAR(got, want, value.tolerance * std::max(1.0f, std::abs(want)))
              << value.name << " [" << c + 1 << "]";
        else
          EXPECT_TRUE(std::isnan(want) ? std::isnan(got) : got == want)
              << value.name << " is " << got;
      }
    }
  }
}

}  // namespace pse::test
