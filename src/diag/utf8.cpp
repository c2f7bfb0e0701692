// UTF-8 decoding by the well-formedness table of the Unicode standard (chapter 3, table 3-7).
#include "diag/utf8.h"

#include <array>

namespace pse {

Utf8Character utf8_decode(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(at);
  if (first < 0x80) return {first, 1, true};

  // The lead byte fixes the length and the smallest code that needs it.
  std::size_t length = 0;
  char32_t code = 0, smallest = 0;
  if (first >= 0xc2 && first < 0xe0) {
    length = 2, code = first & 0x1f, smallest = 0x80;
  } else if (first >= 0xe0 && first < 0xf0) {
    length = 3, code = first & 0x0f, smallest = 0x800;
  } else if (first >= 0xf0 && first < 0xf5) {
    length = 4, code = first & 0x07, smallest = 0x10000;
  } else {
    return {};
  }
  if (at + length > text.size()) return {};
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(at + i) & 0x3fu);
  }
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (code < smallest || code > 0x10ffff || surrogate) return {};
  return {code, length, true};
}

void utf8_append(std::string& text, char32_t code) {
  const auto put = [&](char32_t byte) {
    text += static_cast<char>(static_cast<unsigned char>(byte));
  };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xc0 | code >> 6), put(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    put(0xe0 | code >> 12), put(0x80 | (code >> 6 & 0x3f)), put(0x80 | (code & 0x3f));
  } else {
    put(0xf0 | code >> 18), put(0x80 | (code >> 12 & 0x3f));
    put(0x80 | (code >> 6 & 0x3f)), put(0x80 | (code & 0x3f));
  }
}

std::size_t utf8_count(std::string_view text) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size(); ++count)
    at += static_cast<unsigned char>(text[at]) < 0x80 ? 1 : utf8_decode(text, at).length;
  return count;
}

int utf8_columns(char32_t code) {
  struct Range {
    char32_t first, last;
  };
  static constexpr std::array combining = {Range{0x300, 0x36f},   Range{0x1ab0, 0x1aff},
                                           Range{0x200b, 0x200f}, Range{0x20d0, 0x20ff},
                                           Range{0xfe00, 0xfe0f}, Range{0xfe20, 0xfe2f}};
  static constexpr std::array wide = {
      Range{0x1100, 0x115f},   Range{0x2e80, 0x303e},  Range{0x3041, 0xa4cf}, Range{0xac00, 0xd7a3},
      Range{0xf900, 0xfaff},   Range{0xfe30, 0xfe6f},  Range{0xff00, 0xff60}, Range{0xffe0, 0xffe6},
      Range{0x1f300, 0x1faff}, Range{0x20000, 0x3fffd}};
  for (const Range& range : combining)
    if (code >= range.first && code <= range.last) return 0;
  for (const Range& range : wide)
    if (code >= range.first && code <= range.last) return 2;
  return 1;
}

std::string utf8_repaired(std::string_view text) {
  std::string repaired;
  repaired.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character character = utf8_decode(text, at);
    if (character.valid)
      repaired += text.substr(at, character.length);
    else
      utf8_append(repaired, 0xfffd);
    at += character.length;
  }
  return repaired;
}

}  // namespace pse
