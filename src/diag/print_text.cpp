// Diagnostics for a terminal: place and message, the source line, a caret under the place, and what
// to do.
#include <algorithm>

#include "diag/diagnostics.h"
#include "diag/utf8.h"

namespace pse {

namespace {

// At most this many columns of a source line are shown, around the caret.
constexpr int excerpt_columns = 96;

struct Style {
  const char *error = "", *warning = "", *note = "", *bold = "", *dim = "", *reset = "";
};
constexpr Style plain_style{};
constexpr Style colour_style{"\x1b[1;31m", "\x1b[1;35m", "\x1b[1;36m",
                             "\x1b[1m",    "\x1b[2m",    "\x1b[0m"};

// One character as shown: tabs widened, control characters and invalid bytes replaced, so that no
// text can send escape sequences to the terminal.
struct Glyph {
  std::string text;
  int columns = 1;
  std::size_t begin = 0;  // byte in the line
};

Glyph glyph_at(std::string_view line, std::size_t at, std::size_t& length) {
  const Utf8Character character = utf8_decode(line, at);
  length = character.length;
  Glyph glyph{{}, 1, at};
  const bool control = character.code < 0x20 || (character.code >= 0x7f && character.code < 0xa0);
  const bool steering = (character.code >= 0x200b && character.code <= 0x200f) ||
                        (character.code >= 0x2028 && character.code <= 0x202e) ||
                        (character.code >= 0x2066 && character.code <= 0x2069) ||
                        character.code == 0xfeff;
  if (!character.valid || control || steering) {
    utf8_append(glyph.text, 0xfffd);
  } else {
    glyph.text = line.substr(at, length);
    glyph.columns = utf8_columns(character.code);
  }
  return glyph;
}

// The part of a line to show, and where the marked bytes [begin, end) fall in it.
struct Excerpt {
  std::string text;
  int mark_begin = 0, mark_columns = 0;
};

Excerpt excerpt_of(std::string_view line, std::size_t begin, std::size_t end) {
  // Only bytes near the mark can be shown: a line may be megabytes long.
  constexpr std::size_t reach = 4 * excerpt_columns;
  std::size_t first = begin > reach ? begin - reach : 0;
  while (first > 0 && first < begin && (static_cast<unsigned char>(line[first]) & 0xc0) == 0x80)
    ++first;

  // Glyphs with their columns; a tab reaches to the next multiple of 8.
  std::vector<Glyph> glyphs;
  int column = 0, mark_begin = -1, mark_end = -1;
  for (std::size_t at = first, length = 1; at < line.size() && at < begin + reach; at += length) {
    if (mark_begin < 0 && at >= begin) mark_begin = column;
    if (mark_end < 0 && at >= end) mark_end = column;
    Glyph glyph = glyph_at(line, at, length);
    if (line[at] == '\t') {
      glyph.columns = 8 - column % 8;
      glyph.text.assign(static_cast<std::size_t>(glyph.columns), ' ');
    }
    column += glyph.columns;
    glyphs.push_back(std::move(glyph));
  }
  if (mark_begin < 0) mark_begin = column;
  if (mark_end < 0) mark_end = std::max(column, mark_begin);

  // A line that fits is shown whole; else a window with the mark in its first third.
  const bool cut_before = first > 0, cut_after = begin + reach < line.size();
  int from = 0, to = column;
  if (cut_before || cut_after || column > excerpt_columns) {
    const int wanted = mark_begin - excerpt_columns / 3;
    from = std::clamp(wanted, 0, std::max(0, column - excerpt_columns));
    to = std::min(column, from + excerpt_columns);
  }

  Excerpt excerpt;
  const bool dots_before = cut_before || from > 0, dots_after = cut_after || to < column;
  if (dots_before) excerpt.text += "...";
  int at = 0, shown_begin = -1, shown = dots_before ? 3 : 0;
  for (const Glyph& glyph : glyphs) {
    const int glyph_end = at + glyph.columns;
    if (at >= from && glyph_end <= to) {
      if (shown_begin < 0 && at >= mark_begin) shown_begin = shown;
      excerpt.text += glyph.text;
      shown += glyph.columns;
    }
    at = glyph_end;
  }
  if (dots_after) excerpt.text += "...";
  excerpt.mark_begin = shown_begin < 0 ? shown : shown_begin;
  excerpt.mark_columns =
      std::clamp(mark_end - mark_begin, 1, std::max(1, shown - excerpt.mark_begin));
  return excerpt;
}

// The bytes of a text that comes from elsewhere, safe for a terminal.
std::string safe(std::string_view text) {
  std::string shown;
  for (std::size_t at = 0, length = 1; at < text.size(); at += length)
    shown += text[at] == '\n' ? "\n" : glyph_at(text, at, length).text;
  return shown;
}

void print_place(std::string& out, const Diagnostic& diagnostic, const SourceMap& sources,
                 const Style& style) {
  const SourceFile& file = sources.file(diagnostic.span.file);
  const LineColumn begin = file.position(diagnostic.span.begin);
  const LineColumn end = file.position(diagnostic.span.end);
  const std::string_view line = file.line(begin.line);
  const auto first = std::min(static_cast<std::size_t>(begin.column) - 1, line.size());
  const auto last = end.line == begin.line
                        ? std::min(static_cast<std::size_t>(end.column) - 1, line.size())
                        : line.size();

  // ` 12 | source line`, and below it the caret.
  const Excerpt excerpt = excerpt_of(line, first, last);
  std::string number = std::to_string(begin.line);
  number.insert(0, number.size() < 4 ? 4 - number.size() : 0, ' ');
  const std::string margin(number.size(), ' ');
  out += std::string(style.dim) + number + " | " + style.reset + excerpt.text + "\n";
  out += std::string(style.dim) + margin + " | " + style.reset;
  out.append(static_cast<std::size_t>(excerpt.mark_begin), ' ');
  out += style.error;
  out += '^';
  out.append(static_cast<std::size_t>(excerpt.mark_columns) - 1, '~');
  out += std::string(style.reset) + "\n";
}

}  // namespace

std::string print_text(const Diagnostics& diagnostics, const SourceMap& sources, bool colour) {
  const Style& style = colour ? colour_style : plain_style;
  std::string out;
  std::size_t errors_shown = 0;
  for (const Diagnostic& diagnostic : diagnostics.all()) {
    // `file:line:column: error: message`, the column in characters.
    out += style.bold;
    if (diagnostic.span.valid()) {
      const SourceFile& file = sources.file(diagnostic.span.file);
      const LineColumn at = file.position(diagnostic.span.begin);
      const std::string_view before = file.line(at.line).substr(
          0, std::min(static_cast<std::size_t>(at.column) - 1, file.line(at.line).size()));
      out += safe(file.name) + ":" + std::to_string(at.line) + ":" +
             std::to_string(utf8_count(before) + 1) + ": ";
    }
    switch (diagnostic.severity) {
      case Severity::error:
        out += std::string(style.error) + "error: ";
        break;
      case Severity::warning:
        out += std::string(style.warning) + "warning: ";
        break;
      case Severity::note:
        out += std::string(style.note) + "note: ";
        break;
    }
    out += style.reset;
    out += style.bold + safe(diagnostic.message) + style.reset;
    if (!diagnostic.code.empty())
      out += std::string(style.dim) + " [" + safe(diagnostic.code) + "]" + style.reset;
    out += "\n";
    if (diagnostic.span.valid()) print_place(out, diagnostic, sources, style);
    if (!diagnostic.expected.empty()) out += "       expected: " + safe(diagnostic.expected) + "\n";
    if (!diagnostic.suggestion.empty()) out += "       help: " + safe(diagnostic.suggestion) + "\n";
    errors_shown += diagnostic.severity == Severity::error;
  }
  if (diagnostics.error_count() > errors_shown) {
    const std::size_t more = diagnostics.error_count() - errors_shown;
    out += "and " + std::to_string(more) + " more error" + (more == 1 ? "" : "s") + "\n";
  }
  return out;
}

}  // namespace pse
