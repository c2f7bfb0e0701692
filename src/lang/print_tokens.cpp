// `--emit tokens`: one word on each line, with its place.
#include <string>

#include "diag/utf8.h"
#include "lang/lexer.h"
#include "lang/parser.h"

namespace pse::lang {

std::string print_tokens(const SourceMap& sources, FileId file) {
  Diagnostics ignored;
  const SourceFile& source = sources.file(file);
  std::string out;
  for (const Token& token : lex(sources, file, ignored).tokens) {
    const LineColumn at = source.position(token.begin);
    std::string place = std::to_string(at.line) + ":" + std::to_string(at.column);
    place.resize(std::max<std::size_t>(place.size() + 1, 10), ' ');
    out += place;
    const std::string_view text(source.text.data() + token.begin, token.end - token.begin);
    switch (token.kind) {
      case TokenKind::newline:
        out += "line, indented by " + std::to_string(token.indent);
        break;
      case TokenKind::end:
        out += "end";
        break;
      case TokenKind::number:
        out += "number " + std::string(text);
        break;
      case TokenKind::name:
        out += "name " + std::string(text);
        break;
      case TokenKind::string:
        out += "string " + utf8_repaired(text);
        break;
      case TokenKind::invalid:
        out += "unknown " + utf8_repaired(text);
        break;
      default:
        out += describe(token.kind);
    }
    out += token.made_up ? " (missing in the text)\n" : "\n";
  }
  return out;
}

}  // namespace pse::lang
