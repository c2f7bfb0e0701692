// text -> words. The second half, layout.h, then balances brackets and marks where lines begin.
#pragma once

#include "diag/diagnostics.h"
#include "lang/tokens.h"

namespace pse::lang {

// A text with more words, line starts included, is refused.
inline constexpr std::size_t max_words = 2'000'000;

// The words of a text as they stand, with a newline token (outside and inside brackets alike)
// before the first word of each line. Errors go to `diagnostics`; any bytes are accepted, in linear
// time.
TokenList scan(const SourceFile& source, FileId file, Diagnostics& diagnostics);

// scan(), then lay_out(): what the parser reads.
TokenList lex(const SourceMap& sources, FileId file, Diagnostics& diagnostics);

// The value of a number as spelt; infinity where it is too large for a double.
double number_value(std::string_view spelling);

// The text that a string token with its quotes means: escapes \n \t \r \\ \" \' resolved.
std::string string_value(std::string_view token);

}  // namespace pse::lang
