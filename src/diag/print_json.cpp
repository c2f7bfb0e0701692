// Diagnostics as JSON, for editors and scripts.
#include <nlohmann/json.hpp>

#include "diag/diagnostics.h"
#include "diag/utf8.h"

namespace pse {

namespace {

const char* name_of(Severity severity) {
  switch (severity) {
    case Severity::note:
      return "note";
    case Severity::warning:
      return "warning";
    case Severity::error:
      return "error";
  }
  return "error";
}

struct Place {
  std::size_t line = 0, column = 0;
};

// Line and column of a byte, the column in characters.
Place place_of(const SourceFile& file, std::uint32_t offset) {
  const LineColumn at = file.position(offset);
  const auto start = file.line_starts[static_cast<std::size_t>(at.line) - 1];
  const std::string_view before = std::string_view(file.text).substr(start, offset - start);
  return {static_cast<std::size_t>(at.line), utf8_count(before) + 1};
}

}  // namespace

std::string print_json(const Diagnostics& diagnostics, const SourceMap& sources) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    nlohmann::ordered_json entry;
    entry["severity"] = name_of(diagnostic.severity);
    entry["code"] = utf8_repaired(diagnostic.code);
    entry["message"] = utf8_repaired(diagnostic.message);

    // A diagnostic without a place has null in its stead.
    if (diagnostic.span.valid()) {
      const SourceFile& file = sources.file(diagnostic.span.file);
      const Place begin = place_of(file, diagnostic.span.begin);
      const Place end = place_of(file, diagnostic.span.end);
      entry["file"] = utf8_repaired(file.name);
      entry["line"] = begin.line;
      entry["column"] = begin.column;
      entry["end_line"] = end.line;
      entry["end_column"] = end.column;
    } else {
      for (const char* key : {"file", "line", "column", "end_line", "end_column"})
        entry[key] = nullptr;
    }
    entry["expected"] = utf8_repaired(diagnostic.expected);
    entry["suggestion"] = utf8_repaired(diagnostic.suggestion);
    list.push_back(std::move(entry));
  }
  return list.dump(2) + "\n";
}

}  // namespace pse
