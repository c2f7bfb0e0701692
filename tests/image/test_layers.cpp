// Channels to named values and back.
#include "files.h"
#include "image/layers.h"

namespace pse::image {
namespace {

using namespace test;

// "color(R G B) alpha(A)" for these channel names.
std::string told(const std::vector<std::string>& names) {
  ImageSpec spec;
  for (const auto& name : names) spec.channels.push_back({name, PixelType::float16});
  std::string text;
  for (const auto& layer : layers_of(spec)) {
    text += (text.empty() ? "" : " ") + layer.name + (layer.colour ? "*" : "") + "(";
    for (std::size_t i = 0; i < layer.channels.size(); ++i)
      text += (i == 0 ? "" : " ") + spec.channels[static_cast<std::size_t>(layer.channels[i])].name;
    text += ")";
  }
  return text;
}

TEST(Layers, Root) {
  EXPECT_EQ(told({"A", "B", "G", "R"}), "color*(R G B) alpha(A)");
  EXPECT_EQ(told({"B", "G", "R", "Z", "mask"}), "color*(R G B) Z(Z) mask(mask)");
  EXPECT_EQ(told({"Y"}), "color*(Y Y Y) Y(Y)");
  EXPECT_EQ(told({"Y", "A"}), "color*(Y Y Y) alpha(A) Y(Y)");
  EXPECT_EQ(told({"R"}), "R(R)");
  EXPECT_EQ(told({"X", "Y", "Z"}), "Z(Z) X(X) Y(Y)");
}

TEST(Layers, Vectors) {
  EXPECT_EQ(told({"N.X", "N.Y", "N.Z"}), "N(N.X N.Y N.Z)");
  EXPECT_EQ(told({"N.Z", "N.Y", "N.X"}), "N(N.X N.Y N.Z)");
  EXPECT_EQ(told({"uv.U", "uv.V"}), "uv(uv.U uv.V)");
  EXPECT_EQ(told({"heat.Y"}), "heat(heat.Y)");
  EXPECT_EQ(told({"spec.B", "spec.G", "spec.R"}), "spec*(spec.R spec.G spec.B)");
  EXPECT_EQ(told({"spec.A", "spec.B", "spec.G", "spec.R"}), "spec*(spec.R spec.G spec.B spec.A)");
  EXPECT_EQ(told({"m.c2", "m.c1", "m.c3"}), "m(m.c1 m.c2 m.c3)");
  EXPECT_EQ(told({"d.left.x", "d.left.y"}), "d_left(d.left.x d.left.y)");
}

TEST(Layers, MixedGroupsAndClashes) {
  EXPECT_EQ(told({"left.A", "left.B", "left.G", "left.R", "left.Z"}),
            "left*(left.R left.G left.B left.A) left_Z(left.Z)");
  EXPECT_EQ(told({"a.foo", "a.bar"}), "a_foo(a.foo) a_bar(a.bar)");
  EXPECT_EQ(told({"a.b.Y", "a_b.Y"}), "a_b(a.b.Y) a_b_2(a_b.Y)");
  EXPECT_EQ(told({"2nd pass.Y"}), "_2nd_pass(2nd pass.Y)");
  EXPECT_EQ(told({"."}), "_(.)");
}

std::string stored(const std::string& variable, int components) {
  std::string text;
  for (const auto& out : channels_of(variable, components))
    text += (text.empty() ? "" : " ") + out.channel.name + ":" + std::to_string(out.component) +
            (out.channel.type == PixelType::float16 ? "h" : "");
  return text;
}

TEST(Layers, NamesForWriting) {
  EXPECT_EQ(stored("color", 3), "R:0h G:1h B:2h");
  EXPECT_EQ(stored("color", 1), "R:0h G:0h B:0h");
  EXPECT_EQ(stored("alpha", 1), "A:0h");
  EXPECT_EQ(stored("Z", 1), "Z:0");
  EXPECT_EQ(stored("N", 3), "N.X:0 N.Y:1 N.Z:2");
  EXPECT_EQ(stored("uv", 2), "uv.U:0 uv.V:1");
  EXPECT_EQ(stored("base_st", 2), "base_st.U:0 base_st.V:1");
  EXPECT_EQ(stored("flow", 2), "flow.X:0 flow.Y:1");
  EXPECT_EQ(stored("heat", 1), "heat.Y:0");
  EXPECT_EQ(stored("rim_light", 3), "rim_light.R:0h rim_light.G:1h rim_light.B:2h");
  EXPECT_EQ(stored("rimLight2", 3), "rimLight2.R:0h rimLight2.G:1h rimLight2.B:2h");
  EXPECT_EQ(stored("m", 9).substr(0, 17), "m.c1:0 m.c2:1 m.c");
}

// What is written under a name comes back under that name, with its components in order.
TEST(Layers, BackAndForth) {
  for (const auto& [name, components] : std::vector<std::pair<std::string, int>>{{"color", 3},
                                                                                 {"alpha", 1},
                                                                                 {"Z", 1},
                                                                                 {"N", 3},
                                                                                 {"uv", 2},
                                                                                 {"flow", 2},
                                                                                 {"heat", 1},
                                                                                 {"four", 4},
                                                                                 {"rim_light", 3},
                                                                                 {"m", 9}}) {
    ImageSpec spec;
    const auto channels = channels_of(name, components);
    for (auto it = channels.rbegin(); it != channels.rend(); ++it)
      spec.channels.push_back(it->channel);
    const auto layers = layers_of(spec);
    ASSERT_EQ(layers.size(), 1u) << name;
    EXPECT_EQ(layers[0].name, name);
    ASSERT_EQ(layers[0].components(), components);
    for (int i = 0; i < components; ++i)
      EXPECT_EQ(layers[0].channels[static_cast<std::size_t>(i)], components - 1 - i) << name;
  }
}

TEST(Layers, TheRealSequence) {
  PSE_REAL_FILE(path, "singlepart.0001.exr");
  auto reader = open_reader(path);
  ASSERT_TRUE(reader) << message_of(reader);
  const auto layers = layers_of((*reader)->spec());
  std::vector<std::string> names;
  for (const auto& layer : layers) names.push_back(layer.name);
  EXPECT_EQ(names, (std::vector<std::string>{"color", "alpha", "Z", "disparityL", "disparityR",
                                             "forward_left", "forward_right", "left", "left_Z",
                                             "whitebarmask_left", "whitebarmask_right"}));
}

}  // namespace
}  // namespace pse::image
