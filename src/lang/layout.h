// Brackets and lines: the second half of the lexer. After it every bracket has its partner, and
// newlines remain only where they mean something.
#pragma once

#include "diag/diagnostics.h"
#include "lang/tokens.h"

namespace pse::lang {

// Reports brackets without a partner, each at its place, and repairs them: a closing bracket too
// many is dropped, a missing one is put in where its line, or its statement, ends. Drops the
// newlines inside ( ) and [ ], and marks each `[` whose elements are set apart by white space
// alone.
std::vector<Token> lay_out(const std::vector<Token>& tokens, const SourceFile& source, FileId file,
                           Diagnostics& diagnostics);

}  // namespace pse::lang
