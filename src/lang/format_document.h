// Text with places where it may be broken into lines: what the formatter makes of an expression
// before it knows the width. After D. Oppen, "Prettyprinting", 1980, cut down to bracketed groups.
#pragma once

#include <string>
#include <vector>

namespace pse::lang {

// The columns that a block is further in.
inline constexpr std::size_t indent_step = 4;

// A text; a row of documents; or a group: documents in brackets, broken into lines only when it
// does not fit.
struct Document {
  enum class Kind { text, row, group } kind = Kind::text;
  std::string text;             // of a text
  std::vector<Document> parts;  // of a row or a group
  std::string open, close;      // of a group
  std::string separator;        // of a group: between its parts when flat
  bool fill = false;            // of a group: several parts on each of its lines
  std::size_t width = 0;        // on one line, in characters

  static Document of(std::string text);
  static Document row(std::vector<Document> parts);
  static Document group(std::string open, std::vector<Document> parts, std::string separator,
                        std::string close, bool fill);
};

// Appends the document to `out`, whose last line is `column` characters long, breaking groups so
// that lines are at most `limit` long where that is possible; `after` characters follow it. Broken
// lines are indented below `indent`.
void render(const Document& document, std::size_t indent, std::size_t limit, std::size_t after,
            std::string& out);

// The same on one line.
void render_flat(const Document& document, std::string& out);

// The length of the last line of `text`, in characters.
std::size_t last_line_width(const std::string& text);

}  // namespace pse::lang
