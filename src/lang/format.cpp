// `pse fmt`: not written yet; gives the text back.
#include "lang/parser.h"

namespace pse::lang {

std::string format(const Program& program, const SourceMap& sources) {
  return sources.file(program.file).text;
}

}  // namespace pse::lang
