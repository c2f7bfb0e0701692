// A quick look at the library's texts; a file is parsed only when one of its functions is called.
#include "lower/library.h"

#include <cctype>

namespace pse {

std::vector<std::string> functions_defined_in(std::string_view text) {
  constexpr std::string_view keyword = "function ";
  std::vector<std::string> names;
  for (std::size_t at = 0; at < text.size();) {
    if (text.substr(at).starts_with(keyword)) {
      std::size_t begin = at + keyword.size();
      while (begin < text.size() && text[begin] == ' ') ++begin;
      std::size_t end = begin;
      while (end < text.size() &&
             (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_'))
        ++end;
      names.emplace_back(text.substr(begin, end - begin));
    }
    const std::size_t newline = text.find('\n', at);
    if (newline == std::string_view::npos) break;
    at = newline + 1;
  }
  return names;
}

}  // namespace pse
