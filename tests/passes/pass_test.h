// Helpers for tests of single passes: modules written as text, and what is left of them.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "ir/count.h"
#include "ir/text.h"
#include "ir/verifier.h"
#include "passes/passes.h"

namespace pse::test {

// The text of the module's inputs, tables, outputs; `body` is that of the entry function.
inline ir::Module module_of(const std::string& body, const std::string& functions = "") {
  const std::string text = R"(table.f 0 "four" 1 2 3 4
input 0 "x" sample
input 1 "y" sample
input 2 "time" frame
input 3 "Size" frame
output 0 "out"
check 0 "must hold"
external 0 "lookup" 1 1
)" + functions + "entry function 9 \"main\" {\n" +
                           body + "}\n";
  auto module = ir::parse(text);
  EXPECT_TRUE(module) << module.error();
  if (!module) return {};
  const auto complaints = ir::verify(*module);
  EXPECT_TRUE(complaints.empty()) << complaints.front();
  return std::move(*module);
}

// The body of the entry function after a pass, as text without comments, marks of rate, and
// indentation.
inline std::string body_of(const ir::Function& function) {
  ir::Module alone;
  alone.functions.push_back(function);
  const std::string text = ir::print(alone);
  std::string kept;
  for (std::size_t begin = text.find('\n') + 1; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    line.erase(0, line.find_first_not_of(' '));
    for (std::size_t mark; (mark = line.find('!')) != std::string::npos;) line.erase(mark, 2);
    if (line != "}" || begin < text.size()) kept += line + "\n";
  }
  return kept;
}

inline std::size_t count(const ir::Module& module, ir::Op op) {
  return ir::count_instructions(module.main().body, op);
}

}  // namespace pse::test
