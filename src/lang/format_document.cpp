// Rendering documents: a group that fits stays on its line; else its parts go onto lines of their
// own.
#include "lang/format_document.h"

#include "diag/utf8.h"

namespace pse::lang {

namespace {

constexpr std::size_t shortest =
    25;  // a narrower group stays whole: broken, it reads worse than a line too long

std::string trimmed(std::string text) {
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

// How much of a row's parts from `first` on stands on the same line whatever is broken: up to the
// first group's bracket.
std::size_t fixed_width(const std::vector<Document>& parts, std::size_t first, std::size_t after) {
  std::size_t width = 0;
  for (std::size_t i = first; i < parts.size(); ++i) {
    const Document* part = &parts[i];
    while (part->kind == Document::Kind::row && !part->parts.empty()) {
      // The left end of a nested row; its own width is an upper bound that is good enough.
      if (part->parts.front().kind == Document::Kind::text) {
        width += part->parts.front().width;
        part = nullptr;
        break;
      }
      part = &part->parts.front();
    }
    if (part == nullptr) return width;
    if (part->kind == Document::Kind::group) return width + part->open.size();
    width += part->width;
  }
  return width + after;
}

// Whether a document ends in a bracketed group and has none before it, as `[...]` and `f(...)`.
const Document* only_group(const Document& document) {
  if (document.kind == Document::Kind::group) return &document;
  if (document.kind != Document::Kind::row || document.parts.empty()) return nullptr;
  for (std::size_t i = 0; i + 1 < document.parts.size(); ++i)
    if (document.parts[i].kind != Document::Kind::text) return nullptr;
  return only_group(document.parts.back());
}

// `f(a, [`, the last part's lines, `])`: where all but the last part of a call fits on the line,
// only that is broken.
bool break_last_part(const Document& group, std::size_t indent, std::size_t limit,
                     std::size_t after, std::string& out) {
  if (group.open != "(" || group.parts.empty()) return false;
  const Document& last = group.parts.back();
  const Document* inner = only_group(last);
  if (inner == nullptr || inner->parts.empty()) return false;
  std::size_t inner_width = inner->close.size();
  for (const Document& part : inner->parts) inner_width += part.width + inner->separator.size();
  const std::size_t head = group.width > inner_width ? group.width - inner_width : group.width;
  if (last_line_width(out) + head > limit) return false;

  out += group.open;
  for (std::size_t i = 0; i + 1 < group.parts.size(); ++i) {
    render_flat(group.parts[i], out);
    out += group.separator;
  }
  render(last, indent, limit, after + group.close.size(), out);
  out += group.close;
  return true;
}

void break_group(const Document& group, std::size_t indent, std::size_t limit, std::size_t after,
                 std::string& out) {
  if (break_last_part(group, indent, limit, after, out)) return;
  const std::size_t inner = indent + indent_step;
  const std::string separator = trimmed(group.separator);
  out += trimmed(group.open);
  std::size_t column = limit + 1;  // a new line first
  for (std::size_t i = 0; i < group.parts.size(); ++i) {
    const Document& part = group.parts[i];
    const bool last = i + 1 == group.parts.size();
    const std::size_t tail = last ? 0 : separator.size();
    if (group.fill && column + 1 + part.width + tail <= limit) {
      out += ' ';
    } else {
      out += '\n';
      out.append(inner, ' ');
    }
    render(part, inner, limit, tail, out);
    if (!last) out += separator;
    column = last_line_width(out);
  }
  out += '\n';
  out.append(indent, ' ');
  out += group.close.substr(group.close.find_first_not_of(' '));
}

}  // namespace

Document Document::of(std::string text) {
  Document document;
  document.width = utf8_count(text);
  document.text = std::move(text);
  return document;
}

Document Document::row(std::vector<Document> parts) {
  Document document;
  document.kind = Kind::row;
  for (const Document& part : parts) document.width += part.width;
  document.parts = std::move(parts);
  return document;
}

Document Document::group(std::string open, std::vector<Document> parts, std::string separator,
                         std::string close, bool fill) {
  Document document;
  document.kind = Kind::group;
  document.width = open.size() + close.size();
  for (const Document& part : parts) document.width += part.width;
  if (!parts.empty()) document.width += separator.size() * (parts.size() - 1);
  document.open = std::move(open);
  document.close = std::move(close);
  document.separator = std::move(separator);
  document.parts = std::move(parts);
  document.fill = fill;
  return document;
}

std::size_t last_line_width(const std::string& text) {
  const std::size_t newline = text.rfind('\n');
  return utf8_count(std::string_view(text).substr(newline == std::string::npos ? 0 : newline + 1));
}

void render_flat(const Document& document, std::string& out) {
  if (document.kind == Document::Kind::text) {
    out += document.text;
    return;
  }
  out += document.open;
  bool first = true;
  for (const Document& part : document.parts) {
    if (!first) out += document.separator;
    first = false;
    render_flat(part, out);
  }
  out += document.close;
}

void render(const Document& document, std::size_t indent, std::size_t limit, std::size_t after,
            std::string& out) {
  const bool fits = last_line_width(out) + document.width + after <= limit;
  if (fits || document.kind == Document::Kind::text) return render_flat(document, out);
  if (document.kind == Document::Kind::group) {
    if (document.parts.empty() || document.width < shortest) return render_flat(document, out);
    return break_group(document, indent, limit, after, out);
  }
  for (std::size_t i = 0; i < document.parts.size(); ++i)
    render(document.parts[i], indent, limit, fixed_width(document.parts, i + 1, after), out);
}

}  // namespace pse::lang
