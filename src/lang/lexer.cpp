// The scanner: one pass over the bytes. Paper and section: the language of the 1985 paper ("A Pixel
// Stream Editing Language"), with the chapter's `//` comments and braces.
#include "lang/lexer.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include "diag/utf8.h"
#include "lang/layout.h"

namespace pse::lang {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_word(char c) { return is_letter(c) || is_digit(c); }

struct Spelling {
  std::string_view text;
  TokenKind kind;
};

constexpr auto brackets = std::to_array<Spelling>({
    {"(", TokenKind::left_paren},
    {")", TokenKind::right_paren},
    {"[", TokenKind::left_bracket},
    {"]", TokenKind::right_bracket},
    {"{", TokenKind::left_brace},
    {"}", TokenKind::right_brace},
    {",", TokenKind::comma},
    {";", TokenKind::semicolon},
});

// Longest first.
constexpr auto spellings = std::to_array<Spelling>({
    {"**=", TokenKind::power_assign},
    {"==", TokenKind::equal},
    {"!=", TokenKind::not_equal},
    {"<=", TokenKind::less_equal},
    {">=", TokenKind::greater_equal},
    {"&&", TokenKind::kw_and},
    {"||", TokenKind::kw_or},
    {"**", TokenKind::power},
    {"+=", TokenKind::plus_assign},
    {"-=", TokenKind::minus_assign},
    {"*=", TokenKind::star_assign},
    {"/=", TokenKind::slash_assign},
    {"^=", TokenKind::power_assign},
    {"..", TokenKind::dot_dot},
    {":", TokenKind::colon},
    {"?", TokenKind::question},
    {".", TokenKind::dot},
    {"+", TokenKind::plus},
    {"-", TokenKind::minus},
    {"*", TokenKind::star},
    {"/", TokenKind::slash},
    {"%", TokenKind::percent},
    {"^", TokenKind::power},
    {"<", TokenKind::less},
    {">", TokenKind::greater},
    {"=", TokenKind::assign},
    {"!", TokenKind::kw_not},
});

// What is written in other languages, or by a word processor, and how it is written here. `kind` is
// what the parser goes on with.
struct Lookalike {
  std::string_view text;
  TokenKind kind;
  std::string_view instead;
};
constexpr auto lookalikes = std::to_array<Lookalike>({
    {"...", TokenKind::dot_dot, "ranges are written `[1 .. n]`"},
    {"===", TokenKind::equal, "write `==`"},
    {"!==", TokenKind::not_equal, "write `!=`"},
    {"<>", TokenKind::not_equal, "write `!=`"},
    {"=<", TokenKind::less_equal, "write `<=`"},
    {"=>", TokenKind::greater_equal, "write `>=`"},
    {":=", TokenKind::assign, "write `=`"},
    {"&", TokenKind::kw_and, "write `and` or `&&`"},
    {"|", TokenKind::kw_or, "write `or` or `||`"},
    {"%=", TokenKind::assign, "write `a = a % b`"},
    {"\u2212", TokenKind::minus, "write `-`"},
    {"\u2013", TokenKind::minus, "write `-`"},
    {"\u2014", TokenKind::minus, "write `-`"},
    {"\u00d7", TokenKind::star, "write `*`"},
    {"\u00b7", TokenKind::star, "write `*`"},
    {"\u00f7", TokenKind::slash, "write `/`"},
    {"\u2264", TokenKind::less_equal, "write `<=`"},
    {"\u2265", TokenKind::greater_equal, "write `>=`"},
    {"\u2260", TokenKind::not_equal, "write `!=`"},
    {"\u2026", TokenKind::dot_dot, "write `..`"},
    {"\u03c0", TokenKind::name, "write `PI`"},
    {"\u00b2", TokenKind::invalid, "write `^2`"},
    {"\u201c", TokenKind::invalid, "write a straight `\"`"},
    {"\u201d", TokenKind::invalid, "write a straight `\"`"},
    {"\u2018", TokenKind::invalid, "write a straight `'`"},
    {"\u2019", TokenKind::invalid, "write a straight `'`"},
});

class Scanner {
 public:
  Scanner(const SourceFile& source, FileId file, Diagnostics& diagnostics)
      : text_(source.text), file_(file), diagnostics_(diagnostics) {}

  TokenList run() {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
    while (at_ < text_.size() && !given_up()) {
      if (skip_space()) continue;
      if (skip_comment()) continue;
      start_line();
      scan_word();
      space_ = false;
    }
    list_.tokens.push_back({.kind = TokenKind::end,
                            .begin = static_cast<std::uint32_t>(at_),
                            .end = static_cast<std::uint32_t>(at_)});
    return std::move(list_);
  }

 private:
  std::string_view text_;
  FileId file_;
  Diagnostics& diagnostics_;
  TokenList list_;
  static constexpr std::size_t longest_name = 255;
  std::size_t at_ = 0;
  std::uint32_t indent_ = 0;  // of this line, while only white space has been seen on it
  bool line_start_ = true;    // no word yet on this line
  bool space_ = true;         // white space before what comes next
  bool tab_ = false, blank_before_tab_ = false, blank_ = false;
  bool open_comment_ = true;  // a `*/` may still follow
  std::set<std::string_view> foreign_names_;  // reported

  // Whether the text is too wrong, or too long, to be read to its end.
  bool given_up() {
    if (list_.tokens.size() <= max_words) return diagnostics_.error_count() >= Diagnostics::give_up;
    diagnostics_.error("program-too-large", span(at_, at_),
                       "the program has more than " + std::to_string(max_words) + " words",
                       "divide it into modules");
    return true;
  }

  bool starts(std::string_view word) const { return text_.substr(at_).starts_with(word); }
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }
  Span span(std::size_t begin, std::size_t end) const {
    return {file_, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
  }
  void emit(TokenKind kind, std::size_t begin, std::size_t end) {
    list_.tokens.push_back({.kind = kind,
                            .space_before = space_,
                            .begin = static_cast<std::uint32_t>(begin),
                            .end = static_cast<std::uint32_t>(end)});
  }

  // White space; keeps count of the indentation, a tab reaching to the next multiple of 8.
  bool skip_space() {
    const char c = text_[at_];
    if (c == '\n') {
      line_start_ = true, indent_ = 0;
      tab_ = blank_ = blank_before_tab_ = false;
    } else if (c == '\t') {
      indent_ += 8 - indent_ % 8;
      blank_before_tab_ |= blank_;
      tab_ = true;
    } else if (c == ' ') {
      ++indent_;
      blank_ = true;
    } else if (c != '\r' && c != '\f' && c != '\v') {
      return false;
    }
    space_ = true;
    ++at_;
    return true;
  }

  // `# ...` and `// ...`, to the end of the line.
  bool skip_comment() {
    if (starts("/*")) return skip_block_comment();
    const std::size_t marker = starts("#") ? 1 : starts("//") ? 2 : 0;
    if (marker == 0) return false;
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != '\n') skip_text_character("comment");
    std::size_t end = at_;
    while (end > begin + marker &&
           (text_[end - 1] == '\r' || text_[end - 1] == ' ' || text_[end - 1] == '\t'))
      --end;
    list_.comments.push_back({span(begin, end),
                              std::string(text_.substr(begin + marker, end - begin - marker)),
                              line_start_});
    space_ = true;
    return true;
  }

  bool skip_block_comment() {
    diagnostics_.error("block-comment", span(at_, at_ + 2), "there are no `/* */` comments",
                       "begin each line of the comment with `#` or `//`");
    const std::size_t close = open_comment_ ? text_.find("*/", at_ + 2) : std::string_view::npos;
    if (close == std::string_view::npos) {
      open_comment_ = false;
      at_ += 2;
    } else {
      at_ = close + 2;
    }
    space_ = true;
    return true;
  }

  // One character of a comment or a string: anything that is UTF-8, but no NUL.
  void skip_text_character(const char* where) {
    const Utf8Character character = utf8_decode(text_, at_);
    if (!character.valid || character.code == 0) {
      const std::size_t begin = at_;
      while (at_ < text_.size() && text_[at_] != '\n') {
        const Utf8Character next = utf8_decode(text_, at_);
        if (next.valid && next.code != 0) break;
        at_ += next.length;
      }
      diagnostics_.error("bad-bytes", span(begin, at_),
                         std::string("this ") + where + " holds bytes that are not text",
                         "save the file as UTF-8");
    } else {
      at_ += character.length;
    }
  }

  // A newline token before the first word of a line.
  void start_line() {
    if (!line_start_) return;
    line_start_ = false;
    list_.tokens.push_back({.kind = TokenKind::newline,
                            .space_before = true,
                            .begin = static_cast<std::uint32_t>(at_),
                            .end = static_cast<std::uint32_t>(at_),
                            .indent = indent_});
    if (blank_before_tab_)
      diagnostics_.warning("mixed-indentation", span(at_ - std::min<std::size_t>(at_, 1), at_),
                           "this line is indented with blanks followed by tabs",
                           "indent with blanks only; a tab reaches to the next multiple of 8");
  }

  void scan_word() {
    const char c = peek();
    if (is_digit(c) || (c == '.' && is_digit(peek(1)) && !after_value())) return scan_number();
    const bool pi = text_.substr(at_).starts_with("\u03c0");
    if (is_letter(c) || (!pi && foreign_letter(at_) > 0)) return scan_name();
    if (c == '"' || c == '\'') return scan_string();
    scan_symbol();
  }

  // `a.5` is not `a .5`: a dot right behind a name or a bracket selects a member.
  bool after_value() const {
    if (space_ || list_.tokens.empty()) return false;
    const TokenKind kind = list_.tokens.back().kind;
    return kind == TokenKind::name || kind == TokenKind::right_paren ||
           kind == TokenKind::right_bracket;
  }

  // 12, 1.5, .5, 1., 1e-3; the dots of `1..5` belong to the range.
  void scan_number() {
    const std::size_t begin = at_;
    while (is_digit(peek())) ++at_;
    if (peek() == '.' && peek(1) != '.') {
      ++at_;
      while (is_digit(peek())) ++at_;
    }
    if (peek() == 'e' || peek() == 'E') {
      const std::size_t sign = peek(1) == '+' || peek(1) == '-';
      if (is_digit(peek(1 + sign))) {
        at_ += 1 + sign;
        while (is_digit(peek())) ++at_;
      }
    }
    if (is_letter(peek())) return report_suffix(begin);
    emit(TokenKind::number, begin, at_);
  }

  // Letters right behind a number: 1.5f, 0x10, 2x.
  void report_suffix(std::size_t begin) {
    const std::size_t suffix = at_;
    while (is_word(peek())) ++at_;
    const std::string digits(text_.substr(begin, std::min<std::size_t>(suffix - begin, 40)));
    const std::string letters(text_.substr(suffix, std::min<std::size_t>(at_ - suffix, 40)));
    std::string help = "write `" + digits + " * " + letters + "` to multiply";
    if (letters == "f" || letters == "F" || letters == "h" || letters == "u")
      help = "write `" + digits + "`: numbers have no suffix";
    if (digits == "0" && (letters[0] == 'x' || letters[0] == 'X' || letters[0] == 'b'))
      help = "write the number in decimal";
    if (letters[0] == '_') help = "write the digits without `_`";
    diagnostics_.error("bad-number", span(begin, at_), "a number cannot run into letters", help);
    emit(TokenKind::number, begin, suffix);
  }

  // A letter of another alphabet at `at`: its length in bytes, else 0.
  std::size_t foreign_letter(std::size_t at) const {
    if (at >= text_.size() || static_cast<unsigned char>(text_[at]) < 0x80) return 0;
    const Utf8Character c = utf8_decode(text_, at);
    const auto in = [&](char32_t first, char32_t last) {
      return c.code >= first && c.code <= last;
    };
    const bool letter = in(0xb5, 0xb5) || (in(0xc0, 0x24f) && c.code != 0xd7 && c.code != 0xf7) ||
                        in(0x300, 0x1fff) || in(0x3041, 0xd7ff) || in(0x20000, 0x3ffff);
    return c.valid && letter ? c.length : 0;
  }

  // A name, of other letters too: the parser goes on with it, so that it is reported once, and not
  // what follows from it.
  void scan_name() {
    const std::size_t begin = at_;
    std::size_t foreign = text_.size();
    while (at_ < text_.size()) {
      const std::size_t length = is_word(peek()) ? 1 : foreign_letter(at_);
      if (length == 0) break;
      if (!is_word(peek())) foreign = std::min(foreign, at_);
      at_ += length;
    }
    if (at_ - begin > longest_name) {
      diagnostics_.error("name-too-long", span(begin, at_),
                         "this name has more than " + std::to_string(longest_name) + " characters",
                         "choose a shorter name");
      return emit(TokenKind::invalid, begin, at_);
    }
    const std::string_view name = text_.substr(begin, at_ - begin);
    if (foreign < at_ && foreign_names_.insert(name).second)
      diagnostics_.error(
          "bad-character", span(begin, at_),
          "`" + std::string(text_.substr(foreign, utf8_decode(text_, foreign).length)) +
              "` does not belong to the language",
          "names are made of the letters a-z, A-Z, digits and `_`");
    emit(keyword(name), begin, at_);
  }

  void scan_string() {
    const std::size_t begin = at_;
    const char quote = text_[at_++];
    while (at_ < text_.size() && text_[at_] != '\n' && text_[at_] != quote) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size() && text_[at_ + 1] != '\n') {
        if (std::string_view("ntr\\\"'").find(text_[at_ + 1]) == std::string_view::npos)
          diagnostics_.error(
              "bad-escape", span(at_, at_ + 1), "no such escape in a text",
              "the escapes are \\n \\t \\r \\\\ \\\" \\'; write `\\\\` for a backslash");
        ++at_;
      }
      skip_text_character("text");
    }
    const bool open = at_ == text_.size() || text_[at_] == '\n';
    if (open)
      diagnostics_.error("open-string", span(begin, at_), "this text has no closing quote",
                         std::string("put `") + quote + "` at its end, on the same line");
    else
      ++at_;
    emit(TokenKind::string, begin, at_);
    list_.tokens.back().open = open;
  }

  void scan_symbol() {
    // Brackets and separators, which begin nothing longer.
    for (const Spelling& bracket : brackets) {
      if (peek() != bracket.text[0]) continue;
      emit(bracket.kind, at_, at_ + 1);
      ++at_;
      return;
    }

    // Foreign spellings first: they contain the known ones. `=>` is not met in `a=>b` by accident.
    const bool may_be_foreign =
        static_cast<unsigned char>(peek()) >= 0x80 || std::string_view(".=!<:&|%").contains(peek());
    for (const Lookalike& lookalike : lookalikes) {
      if (!may_be_foreign || !starts(lookalike.text)) continue;
      if ((lookalike.text == "&" && starts("&&")) || (lookalike.text == "|" && starts("||")))
        continue;
      const std::size_t begin = at_;
      at_ += lookalike.text.size();
      if (lookalike.instead.starts_with("write a straight")) skip_curly_quotes();
      diagnostics_.error("foreign-spelling", span(begin, at_),
                         "`" + std::string(lookalike.text) + "` does not belong to the language",
                         std::string(lookalike.instead));
      return emit(lookalike.kind, begin, at_);
    }
    for (const Spelling& spelling : spellings) {
      if (!starts(spelling.text)) continue;
      const std::size_t begin = at_;
      at_ += spelling.text.size();
      return emit(spelling.kind, begin, at_);
    }
    scan_unknown();
  }

  // Behind a quote of a word processor: to its partner on this line, if it has one.
  void skip_curly_quotes() {
    for (std::size_t end = at_; end < text_.size() && text_[end] != '\n'; ++end)
      for (const std::string_view quote : {"\u201d", "\u201c", "\u2019", "\u2018", "\"", "'"})
        if (text_.substr(end).starts_with(quote)) {
          at_ = end + quote.size();
          return;
        }
  }

  // Bytes that begin no word: reported once for each run of them.
  void scan_unknown() {
    const std::size_t begin = at_;
    const Utf8Character first = utf8_decode(text_, at_);
    if (first.valid && first.code == 0xa0) {
      diagnostics_.error("bad-character", span(at_, at_ + 2), "this is a non-breaking space",
                         "replace it by a common space");
      at_ += 2;
      space_ = true;
      return;
    }
    const auto is_unknown = [&] {
      const auto c = static_cast<unsigned char>(text_[at_]);
      return c >= 0x80 || (c < 0x20 && !(c >= '\t' && c <= '\r')) || c == 0x7f ||
             std::string_view("@$`~\\").contains(static_cast<char>(c));
    };
    bool text_like = true;
    do {
      const Utf8Character character = utf8_decode(text_, at_);
      text_like &= character.valid && character.code >= 0x20 && character.code != 0x7f;
      at_ += character.length;
    } while (at_ < text_.size() && is_unknown());

    if (text_like) {
      diagnostics_.error("bad-character", span(begin, at_),
                         "`" + std::string(text_.substr(begin, utf8_decode(text_, begin).length)) +
                             "` does not belong to the language",
                         "names are made of the letters a-z, A-Z, digits and `_`");
    } else {
      diagnostics_.error("bad-bytes", span(begin, at_), "these bytes are not text",
                         "save the file as UTF-8");
    }
    emit(TokenKind::invalid, begin, at_);
  }
};

}  // namespace

TokenList scan(const SourceFile& source, FileId file, Diagnostics& diagnostics) {
  return Scanner(source, file, diagnostics).run();
}

TokenList lex(const SourceMap& sources, FileId file, Diagnostics& diagnostics) {
  const SourceFile& source = sources.file(file);
  TokenList list = scan(source, file, diagnostics);
  list.tokens = lay_out(list.tokens, source, file, diagnostics);
  return list;
}

}  // namespace pse::lang
