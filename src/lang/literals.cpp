// The values of numbers and texts as spelt.
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "lang/lexer.h"

namespace pse::lang {

double number_value(std::string_view spelling) {
  double value = 0;
  const auto [rest, error] =
      std::from_chars(spelling.data(), spelling.data() + spelling.size(), value);
  if (error != std::errc::result_out_of_range) return value;

  // Too large or too small: told apart by the position of the first digit that is not 0, and the
  // exponent.
  std::size_t digits = 0;
  long long magnitude = 0;
  bool fraction = false, seen = false;
  for (; digits < spelling.size(); ++digits) {
    const char c = spelling[digits];
    if (c == 'e' || c == 'E') break;
    if (c == '.') {
      fraction = true;
      continue;
    }
    seen |= c != '0';
    if (!fraction && seen) ++magnitude;
    if (fraction && !seen) --magnitude;
  }
  long long exponent = 0;
  bool negative = false;
  for (std::size_t i = digits + 1; i < spelling.size(); ++i) {
    if (spelling[i] == '-') negative = true;
    if (spelling[i] >= '0' && spelling[i] <= '9' && exponent < 1'000'000'000)
      exponent = exponent * 10 + (spelling[i] - '0');
  }
  const bool large = seen && magnitude + (negative ? -exponent : exponent) > 0;
  return large ? std::numeric_limits<double>::infinity() : 0.0;
}

std::string string_value(std::string_view token) {
  std::string value;
  if (token.empty()) return value;
  const char quote = token.front();
  for (std::size_t i = 1; i < token.size(); ++i) {
    if (token[i] == quote) break;
    if (token[i] != '\\' || i + 1 == token.size()) {
      value += token[i];
      continue;
    }
    switch (token[++i]) {
      case 'n':
        value += '\n';
        break;
      case 't':
        value += '\t';
        break;
      case 'r':
        value += '\r';
        break;
      default:
        value += token[i];
    }
  }
  return value;
}

}  // namespace pse::lang
