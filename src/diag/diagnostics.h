// Errors and warnings as collected data. Every stage adds to a Diagnostics; only the program's edge
// prints it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "diag/source.h"

namespace pse {

enum class Severity { note, warning, error };

struct Diagnostic {
  Severity severity = Severity::error;
  std::string code;        // stable short name, for example "unknown-name"
  std::string message;     // one sentence: what is wrong
  Span span;               // where; invalid when the place is not in a text
  std::string expected;    // what would have been right; may be empty
  std::string suggestion;  // what to do, for example "did you mean `turbulence`?"; may be empty
};

class Diagnostics {
 public:
  // At most this many errors, and as many warnings, are kept; further errors are only counted.
  static constexpr std::size_t limit = 100;

  // With this many errors a text is no program: stages stop looking for more.
  static constexpr std::size_t give_up = 1000;

  void add(Diagnostic diagnostic);
  void error(std::string code, Span span, std::string message, std::string suggestion = {});
  void warning(std::string code, Span span, std::string message, std::string suggestion = {});

  bool has_errors() const { return errors_ > 0; }
  std::size_t error_count() const { return errors_; }
  const std::vector<Diagnostic>& all() const { return all_; }
  // Orders by file and place, and drops exact repetitions.
  void sort();

 private:
  std::vector<Diagnostic> all_;
  std::size_t errors_ = 0;       // all, kept or not
  std::size_t kept_errors_ = 0;
  std::size_t kept_others_ = 0;  // warnings and notes
};

// Source line, caret and suggestion for each diagnostic, ready for a terminal.
std::string print_text(const Diagnostics& diagnostics, const SourceMap& sources, bool colour);

// A JSON array with one object per diagnostic: severity, code, message, file, line, column,
// end_line, end_column, expected, suggestion. Lines and columns count from 1; columns, here and in
// print_text, count characters, not bytes.
std::string print_json(const Diagnostics& diagnostics, const SourceMap& sources);

// The candidate nearest to `name` by edit distance, if one is near enough to be worth naming; else
// one that begins or ends with it as a whole word (`hsv`: `hsv_to_rgb`); else empty.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace pse
