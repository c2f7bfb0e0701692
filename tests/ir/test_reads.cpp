// Which inputs a module reads, wherever the instruction stands.
#include <gtest/gtest.h>

#include "ir/reads.h"
#include "ir/text.h"

namespace pse::ir {
namespace {

TEST(Reads, InputsAreFoundWithinBranchesToo) {
  const auto module = parse(R"(
input 0 "a" sample
input 1 "b" sample
input 2 "c" sample
output 0 "out"
entry function 0 "main" {
  %0 = input 0
  %1 = const.b true
  %2:f = if %1 {
    %3 = input 2
    yield %3
  } else {
    yield %0
  }
  yield %2
}
)");
  ASSERT_TRUE(module) << module.error();
  EXPECT_EQ(inputs_read(*module), (std::vector<bool>{true, false, true}));
}

}  // namespace
}  // namespace pse::ir
