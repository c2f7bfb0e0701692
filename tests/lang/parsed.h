// A text, its tree and its diagnostics, for the tests of the front end.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "lang/parser.h"

namespace pse::test {

struct Parsed {
  SourceMap sources;
  Diagnostics diagnostics;
  lang::Program program;

  explicit Parsed(std::string text, const lang::ParseLimits& limits = {}) {
    const FileId file = sources.add("t.pse", std::move(text));
    program = lang::parse(sources, file, diagnostics, limits);
    diagnostics.sort();
  }

  bool ok() const { return !diagnostics.has_errors(); }
  std::string printed() const { return print_text(diagnostics, sources, false); }
  std::string tree() const { return lang::print_ast(program); }
  std::string formatted() const { return lang::format(program, sources); }

  // "line:column code" of each diagnostic, in order.
  std::string summary() const {
    std::string out;
    for (const Diagnostic& diagnostic : diagnostics.all()) {
      const LineColumn at = sources.position(diagnostic.span);
      out += (out.empty() ? "" : ", ") + std::to_string(at.line) + ":" + std::to_string(at.column) +
             " " + diagnostic.code;
    }
    return out;
  }
};

// The tree of a text that must be understood without a word.
inline std::string tree_of(const std::string& text) {
  const Parsed parsed(text);
  EXPECT_EQ(parsed.printed(), "") << text;
  return parsed.tree();
}

// The tree of one expression.
inline std::string expression(const std::string& text) {
  const std::string tree = tree_of("r = " + text);
  return tree.starts_with("set r ") ? tree.substr(6, tree.size() - 7) : tree;
}

}  // namespace pse::test
