// Reading CSV, a block of the file at a time; see table.h.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <new>

#include "image/table.h"

namespace pse::image {
namespace {

constexpr std::size_t longest_line = std::size_t{1} << 20;

// The lines of a file, without their ends.
class Lines {
 public:
  explicit Lines(const ByteSource& bytes) : bytes_(bytes) {}

  // False at the end. `line` is valid until the next call.
  Result<bool> next(std::string_view& line) {
    ++number_;
    while (true) {
      const auto end =
          std::find(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.end(), '\n');
      if (end != buffer_.end() || at_end_) {
        if (begin_ == buffer_.size()) return false;
        const auto stop = static_cast<std::size_t>(end - buffer_.begin());
        line = std::string_view(buffer_.data() + begin_, stop - begin_);
        begin_ = std::min(stop + 1, buffer_.size());
        if (line.ends_with('\r')) line.remove_suffix(1);
        return true;
      }
      if (buffer_.size() - begin_ > longest_line)
        return fail(ErrorKind::too_large, place() + "the line is longer than 1 MiB");
      if (auto more = fill(); !more) return std::unexpected(more.error());
    }
  }

  std::string place() const { return bytes_.name() + ":" + std::to_string(number_) + ": "; }

 private:
  Result<void> fill() {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    const std::size_t kept = buffer_.size();
    buffer_.resize(kept + longest_line);
    const std::int64_t got = bytes_.read_at(offset_, buffer_.data() + kept, longest_line);
    if (got < 0) return fail(ErrorKind::cannot_read, "cannot read " + bytes_.name());
    buffer_.resize(kept + static_cast<std::size_t>(got));
    offset_ += static_cast<std::uint64_t>(got);
    at_end_ = got == 0;
    return {};
  }

  const ByteSource& bytes_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;
  std::uint64_t offset_ = 0;
  bool at_end_ = false;
  std::size_t number_ = 0;
};

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    text = text.substr(1, text.size() - 2);
  return text;
}

// Cuts the first cell off a line; `more` is false after the last.
std::string_view take_cell(std::string_view& line, char divider, bool& more) {
  const std::size_t end = std::min(line.find(divider), line.size());
  more = end < line.size();
  const std::string_view cell = trimmed(line.substr(0, end));
  line.remove_prefix(std::min(end + 1, line.size()));
  return cell;
}

// As a person would read it in a message: not too long, and without signs that hurt a terminal.
std::string quoted(std::string_view cell) {
  std::string text = "`";
  for (const char c : cell.substr(0, 40)) text += static_cast<unsigned char>(c) < 32 ? '?' : c;
  return text + (cell.size() > 40 ? "...`" : "`");
}

Result<void> read_names(std::string_view line, char divider, const Lines& lines,
                        const ReadLimits& limits, Columns& table) {
  for (bool more = true; more;) {
    const std::string name(take_cell(line, divider, more));
    float number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error == std::errc() && end == name.data() + name.size())
      return fail(ErrorKind::damaged, lines.place() +
                                          "the first line of a table names its columns, " +
                                          quoted(name) + " is a number");
    const bool usable = !name.empty() && name.size() <= 255 &&
                        std::all_of(name.begin(), name.end(), [](unsigned char c) {
                          return std::isalnum(c) != 0 || c == '_' || c == '.' || c == ' ';
                        });
    if (!usable)
      return fail(ErrorKind::damaged, lines.place() + "column " +
                                          std::to_string(table.names.size() + 1) + " is called " +
                                          quoted(name) + "; names have letters, digits, _ and .");
    if (table.find(name) >= 0)
      return fail(ErrorKind::damaged, lines.place() + "two columns are called " + quoted(name));
    table.names.push_back(name);
    if (static_cast<int>(table.names.size()) > limits.max_channels)
      return fail(ErrorKind::too_large, lines.place() + "there are more than " +
                                            std::to_string(limits.max_channels) + " columns");
  }
  table.values.resize(table.names.size());
  return {};
}

Result<void> read_row(std::string_view line, char divider, const Lines& lines, Columns& table) {
  std::size_t column = 0;
  bool more = true;
  for (; more && column < table.names.size(); ++column) {
    std::string_view cell = take_cell(line, divider, more);
    const std::string& name = table.names[column];
    const std::string_view shown = cell;
    if (cell.starts_with('+')) cell.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
    if (cell.empty())
      return fail(ErrorKind::damaged, lines.place() + "column `" + name + "` is empty");
    if (error == std::errc::invalid_argument || end != cell.data() + cell.size())
      return fail(ErrorKind::damaged,
                  lines.place() + quoted(shown) + " in column `" + name + "` is no number");
    const auto value = static_cast<float>(number);
    if (error != std::errc() || !std::isfinite(value))
      return fail(ErrorKind::not_finite, lines.place() + quoted(shown) + " in column `" + name +
                                             "`: NaN, infinity and what a float cannot hold "
                                             "cannot be used");
    table.values[column].push_back(value);
  }
  if (column != table.names.size() || more)
    return fail(ErrorKind::damaged, lines.place() + "the row has " +
                                        (column < table.names.size() ? "fewer" : "more") +
                                        " numbers than the " + std::to_string(table.names.size()) +
                                        " columns that the first line names");
  return {};
}

}  // namespace

int Columns::find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

bool is_csv(const ByteSource& bytes) {
  const std::string format = format_of_name(bytes.name());
  return format == "csv" || format == "tsv";
}

Result<Columns> read_csv(const ByteSource& bytes, const ReadLimits& limits) try {
  Columns table;
  Lines lines(bytes);
  std::string_view line;
  char divider = ',';
  while (true) {
    const auto some = lines.next(line);
    if (!some) return std::unexpected(some.error());
    if (!*some) break;
    if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    if (line.starts_with('#') || line.find_first_not_of(" \t") == std::string_view::npos) continue;
    if (table.names.empty()) {
      for (const char candidate : {'\t', ';', ','})
        if (line.find(candidate) != std::string_view::npos) divider = candidate;
      if (auto done = read_names(line, divider, lines, limits, table); !done)
        return std::unexpected(done.error());
      continue;
    }
    if (auto done = read_row(line, divider, lines, table); !done)
      return std::unexpected(done.error());
    const auto rows = static_cast<std::int64_t>(table.rows());
    if (rows > limits.max_pixels || rows >= 1 << 29 ||
        rows * static_cast<std::int64_t>(4 * table.names.size()) > limits.max_bytes)
      return fail(ErrorKind::too_large, bytes.name() + " has too many rows");
  }
  if (table.names.empty()) return fail(ErrorKind::truncated, bytes.name() + " is empty");
  if (table.rows() == 0)
    return fail(ErrorKind::truncated, bytes.name() + " names its columns and has no rows");
  return table;
} catch (const std::bad_alloc&) {
  return fail(ErrorKind::too_large, "not enough memory for " + bytes.name());
}

}  // namespace pse::image
