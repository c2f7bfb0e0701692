// Builtins as programs call them: names, binding of arguments, messages, and the same bits as the C++ templates.
#include "builtin_run.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "noise/improved.h"
#include "noise/seed.h"

namespace pse::test {
namespace {

TEST(Builtins, NamesAreUniqueAndAliasesLead) {
  std::set<std::string_view> names;
  for (const Builtin& builtin : builtins()) {
    EXPECT_TRUE(names.insert(builtin.name).second) << builtin.name;
    if (builtin.same_as.empty()) EXPECT_FALSE(builtin.doc.empty()) << builtin.name;
    else EXPECT_NE(find_builtin(builtin.same_as), nullptr) << builtin.name;
  }
  EXPECT_EQ(find_builtin("nothing_like_it"), nullptr);
}

TEST(Builtins, PositionMayBeAVectorOrNumbers) {
  const auto whole = run_builtin("Noise", {{0.25f, 0.5f, 0.75f}});
  EXPECT_EQ(whole, run_builtin("noise", {{0.25f}, {0.5f}, {0.75f}}));
  EXPECT_EQ(whole, run_builtin("snoise", {{0.25f, 0.5f}, {0.75f}}));
  EXPECT_NEAR(whole.at(0), -0.2697153091430664, 2e-7);
}

TEST(Builtins, ElementwiseRepeatsNumbers) {
  EXPECT_EQ(run_builtin("sqrt", {{1, 4, 9}}), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(run_builtin("max", {{1, 5, 9}, {4}}), (std::vector<float>{4, 5, 9}));
}

TEST(Builtins, SaysWhatIsWrong) {
  const auto error = [](const char* name, const Vectors& arguments,
                        const std::vector<std::pair<std::string, std::vector<float>>>& named = {}) {
    return BuiltinProgram(name, arguments, named).error;
  };
  EXPECT_EQ(error("sqrt", {}), "'a' is missing in the call of sqrt(a)");
  EXPECT_EQ(error("sqrt", {{1}, {2}}), "too many arguments for sqrt(a)");
  EXPECT_EQ(error("sqrt", {{1}}, {{"seed", {1}}}), "sqrt(a) has no parameter 'seed'");
  EXPECT_EQ(error("max", {{1, 2}, {1, 2, 3}}),
            "max takes vectors of one length, and these have 2 and 3 components");
  EXPECT_EQ(error("Noise", {{1, 2, 3, 4, 5}}), "Noise takes a position of 1 to 4 coordinates, and this has 5");
  EXPECT_EQ(error("pnoise", {{1, 2, 3}}), "'period' is missing in the call of pnoise(p..., period, seed = 0)");
  EXPECT_EQ(error("pnoise", {{1, 2, 3}, {4, 4}}),
            "the period of pnoise is one number or one for each of the 3 coordinates");
  EXPECT_EQ(error("Noise", {{1, 2, 3}}, {{"seed", {1, 2}}}), "the seed of Noise is one number");
  EXPECT_EQ(error("dot", {{1, 2, 3}, {1, 2}}),
            "dot takes two vectors of one length, and these have 3 and 2 components");
}

TEST(Builtins, LargeBodiesAreWrittenOnce) {
  ir::Module module;
  module.functions.reserve(1 + BuiltinEmitter::room_for_builtins);
  ir::Builder builder(module, module.functions.emplace_back());
  BuiltinEmitter emitter(module);
  const Components point(3, builder.const_f32(0.5f));
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(emitter.emit(builder, {"Noise", {point}, {}}));
  EXPECT_EQ(module.functions.size(), 2u);
  EXPECT_EQ(module.byte_tables.size(), 1u);
  EXPECT_EQ(module.float_tables.size(), 3u);
}

// The IR that a template writes gives the template's own bits.
template <std::size_t N>
void noise_agrees() {
  std::mt19937 random(N);
  std::uniform_real_distribution<float> coordinate(-300.0f, 300.0f);
  const std::vector<float> zeros(N, 0.0f);
  const BuiltinProgram plain("Noise", {zeros}), gradient("Dnoise", {zeros}), vector("vnoise", {zeros});
  const BuiltinProgram periodic("pnoise", {zeros, {7.0f}}, {{"seed", {3.0f}}});
  for (int i = 0; i < 300; ++i) {
    std::array<float, N> p;
    for (float& x : p) x = i < 250 ? coordinate(random) : std::ldexp(coordinate(random), i - 250);
    const std::vector<float> at(p.begin(), p.end());
    EXPECT_TRUE(same(plain.run(at)[0], num::improved_noise(p)));
    const auto slopes = num::gradient(num::improved_noise(num::variables(p)));
    const auto three = num::improved_vector_noise(p);
    const auto ran_slopes = gradient.run(at), ran_three = vector.run(at);
    for (std::size_t k = 0; k < N; ++k) EXPECT_TRUE(same(ran_slopes[k], slopes[k]));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(same(ran_three[k], three[k]));
    num::NoiseOptions<float, N> options;
    options.period.emplace();
    options.period->fill(7.0f);
    options.key = num::key_of_seed(3.0f);
    auto with_options = at;
    with_options.push_back(7.0f);
    with_options.push_back(3.0f);
    EXPECT_TRUE(same(periodic.run(with_options)[0], num::improved_noise(p, options)));
  }
}
TEST(Builtins, NoiseAgreesWithTheTemplate) {
  noise_agrees<1>();
  noise_agrees<2>();
  noise_agrees<3>();
  noise_agrees<4>();
}

}  // namespace
}  // namespace pse::test
