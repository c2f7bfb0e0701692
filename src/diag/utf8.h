// UTF-8 as bytes come: one character at a time, never reading past the end, invalid bytes reported
// one by one. Used by the lexer (what may stand in a text) and by the printers (columns and
// carets).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pse {

struct Utf8Character {
  char32_t code = 0xfffd;  // U+FFFD where the bytes are not UTF-8
  std::size_t length = 1;  // bytes; 1 where they are not UTF-8
  bool valid = false;
};

// The character that begins at byte `at` of `text`; `at` must be inside. Overlong forms, surrogates
// and codes above U+10FFFF are invalid.
Utf8Character utf8_decode(std::string_view text, std::size_t at);

// Appends the character's bytes to `text`.
void utf8_append(std::string& text, char32_t code);

// How many characters `text` holds; an invalid byte counts as one.
std::size_t utf8_count(std::string_view text);

// How many terminal columns the character takes: 0 for a combining mark, 2 for East Asian wide
// ones, else 1.
int utf8_columns(char32_t code);

// A copy in which every invalid byte is U+FFFD.
std::string utf8_repaired(std::string_view text);

}  // namespace pse
