// Texts without an end to them: refused with a message, quickly, and without using up the stack.
#include <gtest/gtest.h>

#include <functional>

#include "lang/parser.h"
#include "lower/lower.h"

namespace pse {
namespace {

// The codes of the errors that a program gets.
std::string errors_of(const std::string& text, LowerOptions options = {}) {
  SourceMap sources;
  Diagnostics diagnostics;
  const FileId file = sources.add("limits.pse", text);
  options.stream = {{"x"}, {"y"}};
  const lang::Program program = lang::parse(sources, file, diagnostics);
  lower_program(sources, program, LowerHost{}, options, diagnostics);
  std::string codes;
  for (const Diagnostic& each : diagnostics.all())
    if (each.severity == Severity::error) codes += each.code + " ";
  return codes;
}

std::string repeated(int count, const std::function<std::string(int)>& part) {
  std::string text;
  for (int i = 0; i < count; ++i) text += part(i);
  return text;
}

std::string chain(int count) {
  return "a = 0\nif x > 0\n    a = 1\n" + repeated(count, [](int i) {
           return "else if x > " + std::to_string(i) + "\n    a = " + std::to_string(i) + "\n";
         });
}

TEST(Limits, ALongChainOfElseIf) {
  EXPECT_EQ(errors_of(chain(400)), "");
  EXPECT_EQ(errors_of(chain(600)), "too-deep ");
  EXPECT_EQ(errors_of(chain(50'000)), "too-deep ");
}

TEST(Limits, ManyEarlyReturns) {
  const auto returns = [](int count) {
    return "function f(t)\n" +
           repeated(count,
                    [](int i) {
                      return "    if t > " + std::to_string(i) + "\n        return " +
                             std::to_string(i) + "\n";
                    }) +
           "    return t\na = f(x)\n";
  };
  EXPECT_EQ(errors_of(returns(400)), "");
  EXPECT_EQ(errors_of(returns(20'000)), "too-deep ");
}

TEST(Limits, AsManyOutputsAsAnImageHasChannels) {
  const auto outputs = [](int count) {
    return repeated(count, [](int i) { return "o" + std::to_string(i) + " = x\n"; });
  };
  EXPECT_EQ(errors_of(outputs(1024)), "");
  EXPECT_EQ(errors_of(outputs(1025)), "too-many-outputs ");
  // Those that nobody wants cost nothing.
  LowerOptions few;
  few.outputs = {"o7"};
  EXPECT_EQ(errors_of(outputs(20'000), few), "");
  EXPECT_EQ(errors_of("v = [x y x]\n" + outputs(1022)), "too-many-outputs ");
}

}  // namespace
}  // namespace pse
