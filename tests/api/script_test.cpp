// The public API as a caller uses it, header and all.
#include "pse/script.h"

#include <gtest/gtest.h>

namespace pse {
namespace {

TEST(Script, RunsOnTheCallersArrays) {
  auto script = Script::compile(
      "Gain = 2\ncolor = Gain * p + offset",
      {.inputs = {{"p", 2}, {"offset", 1, true}}, .module_path = {}, .cache_folder = {}});
  ASSERT_TRUE(script) << script.error();
  ASSERT_EQ(script->outputs().size(), 1u);
  EXPECT_EQ(script->outputs()[0].components, 2);

  // An odd count, larger than one batch.
  constexpr int count = 10007;
  std::vector<float> x(count), y(count), red(count), green(count);
  for (int i = 0; i < count; ++i) {
    x[static_cast<std::size_t>(i)] = static_cast<float>(i);
    y[static_cast<std::size_t>(i)] = static_cast<float>(-i);
  }
  const float offset = 0.5f;
  const auto run = [&] {
    return script->run(count, {{"p", {x.data(), y.data()}}, {"offset", {&offset}}},
                       {{"color", {red.data(), green.data()}}});
  };
  ASSERT_TRUE(run()) << run().error();
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(red[i], 2 * x[i] + 0.5f);
    ASSERT_EQ(green[i], 2 * y[i] + 0.5f);
  }
  const float three = 3;
  ASSERT_TRUE(script->set("Gain", {&three, 1}));
  ASSERT_TRUE(run());
  EXPECT_EQ(red[100], 300.5f);
}

TEST(Script, SaysWhatIsWrong) {
  const auto broken = Script::compile("a = nosie(3)\n");
  ASSERT_FALSE(broken);
  EXPECT_NE(broken.error().find("<text>:1:5"), std::string::npos) << broken.error();

  auto script = Script::compile("v = [1 2 3]\na = v[k]",
                                {.inputs = {{"k"}}, .module_path = {}, .cache_folder = {}});
  ASSERT_TRUE(script) << script.error();
  const float four = 4;
  float a = 0;
  EXPECT_FALSE(script->run(1, {}, {}));
  const auto out_of_range = script->run(1, {{"k", {&four}}}, {{"a", {&a}}});
  ASSERT_FALSE(out_of_range);
  EXPECT_NE(out_of_range.error().find("<text>:2"), std::string::npos) << out_of_range.error();
  EXPECT_FALSE(script->run(1, {{"k", {&four}}}, {{"b", {&a}}}));
  EXPECT_FALSE(script->set("Nothing", {&four, 1}));
}

}  // namespace
}  // namespace pse
