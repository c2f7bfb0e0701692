// Line tables and lookup of places in source texts.
#include "diag/source.h"

#include <algorithm>

namespace pse {

Span Span::to(const Span& other) const {
  if (!valid()) return other;
  if (!other.valid()) return *this;
  return {file, std::min(begin, other.begin), std::max(end, other.end)};
}

LineColumn SourceFile::position(std::uint32_t offset) const {
  auto after = std::upper_bound(line_starts.begin(), line_starts.end(), offset);
  const auto index = static_cast<std::size_t>(after - line_starts.begin()) - 1;
  return {static_cast<int>(index) + 1, static_cast<int>(offset - line_starts[index]) + 1};
}

std::string_view SourceFile::line(int number) const {
  if (number < 1 || static_cast<std::size_t>(number) > line_starts.size()) return {};
  const std::size_t begin = line_starts[static_cast<std::size_t>(number) - 1];
  std::size_t end = text.find('\n', begin);
  if (end == std::string::npos) end = text.size();
  if (end > begin && text[end - 1] == '\r') --end;
  return std::string_view(text).substr(begin, end - begin);
}

FileId SourceMap::add(std::string name, std::string text) {
  SourceFile file{std::move(name), std::move(text), {0}};
  for (std::size_t i = 0; i < file.text.size(); ++i)
    if (file.text[i] == '\n') file.line_starts.push_back(static_cast<std::uint32_t>(i) + 1);
  files_.push_back(std::move(file));
  return static_cast<FileId>(files_.size() - 1);
}

std::string_view SourceMap::text(const Span& span) const {
  if (!span.valid()) return {};
  return std::string_view(files_[span.file].text).substr(span.begin, span.end - span.begin);
}

std::string SourceMap::describe(const Span& span) const {
  if (!span.valid()) return "<unknown>";
  const LineColumn place = position(span);
  return files_[span.file].name + ":" + std::to_string(place.line) + ":" +
         std::to_string(place.column);
}

}  // namespace pse
