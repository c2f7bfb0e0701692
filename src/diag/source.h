// Source texts and places in them. First stop of the flow: every later stage refers to text by
// Span.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pse {

using FileId = std::uint32_t;
inline constexpr FileId no_file = 0xffffffffu;

// A half-open range of bytes [begin, end) of one source file.
struct Span {
  FileId file = no_file;
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  bool valid() const { return file != no_file; }
  // The smallest span that covers both; `other` must lie in the same file.
  Span to(const Span& other) const;
  friend bool operator==(const Span&, const Span&) = default;
};

// Line and column count from 1; the column counts bytes.
struct LineColumn {
  int line = 0;
  int column = 0;
};

struct SourceFile {
  std::string name;  // as the user would type it, or "<text>"
  std::string text;
  std::vector<std::uint32_t> line_starts;

  LineColumn position(std::uint32_t offset) const;
  // The text of a line without its newline; empty when the line does not exist.
  std::string_view line(int number) const;
};

// All source texts of one compilation.
class SourceMap {
 public:
  FileId add(std::string name, std::string text);
  const SourceFile& file(FileId id) const { return files_[id]; }
  std::size_t size() const { return files_.size(); }
  LineColumn position(const Span& span) const { return files_[span.file].position(span.begin); }
  std::string_view text(const Span& span) const;
  // "name:line:column", or "<unknown>" for an invalid span.
  std::string describe(const Span& span) const;

 private:
  std::vector<SourceFile> files_;
};

}  // namespace pse
