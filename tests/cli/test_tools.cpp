// check, fmt, info, doc, diff.
#include "run_pse.h"

namespace pse::test {
namespace {

class Tools : public CommandLine {};

TEST_F(Tools, CheckReportsAllErrorsOfAllFiles) {
  file("good.pse", "color = fg.color * bg.alpha\n");
  file("bad.pse", "color = wite * x\nheat = sinn(x)\n");
  Ended ended = pse({"check", "good.pse"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  ended = pse({"check", "good.pse", "bad.pse"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(contains(ended.err, "bad.pse:1:9"));
  EXPECT_TRUE(contains(ended.err, "`white`"));
  EXPECT_TRUE(contains(ended.err, "bad.pse:2:8"));
  ended = pse({"check", "--json", "good.pse", "bad.pse"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(contains(ended.out, "\"line\""));
  EXPECT_EQ(ended.err, "");
  EXPECT_EQ(pse({"check", "--json", "good.pse"}).out, "[]\n");
  EXPECT_EQ(pse({"check"}).status, 2);
  EXPECT_EQ(pse({"check", "missing.pse"}).status, 4);
  EXPECT_EQ(pse({"check", "-"}, "color = white\n").status, 0);
}

TEST_F(Tools, CheckKnowsTheChannelsOfImages) {
  file("make.pse", "color = white\nheat = x\n");
  ASSERT_EQ(pse({"render", "make.pse", "-o", "heat.exr", "--res", "2x2"}).status, 0);
  file("fire.pse", "color = white * heat\n");
  file("named.pse", "color = white * a.heat\n");
  EXPECT_EQ(pse({"check", "fire.pse"}).status, 3);
  EXPECT_EQ(pse({"check", "fire.pse", "heat.exr"}).status, 0);
  EXPECT_EQ(pse({"check", "named.pse", "a=heat.exr"}).status, 0);
  EXPECT_EQ(pse({"check", "named.pse", "b=heat.exr"}).status, 3);
  EXPECT_EQ(pse({"check", "fire.pse", "missing.exr"}).status, 4);
}

TEST_F(Tools, WarningsCanBeErrorsOrHidden) {
  file("a.pse", "Level = 1 [[ colour = 3 ]]\ncolor = white * Level\n");
  EXPECT_EQ(pse({"check", "a.pse"}).status, 0);
  EXPECT_TRUE(contains(pse({"check", "a.pse"}).err, "warning"));
  EXPECT_EQ(pse({"check", "-Werror", "a.pse"}).status, 6);
  EXPECT_EQ(pse({"check", "-Werror", "-Wno-unknown-meta", "a.pse"}).status, 0);
  EXPECT_EQ(pse({"check", "-Werror", "-Wnone", "a.pse"}).status, 0);
}

TEST_F(Tools, FormatPrintsRewritesOrChecks) {
  file("a.pse", "color=white*x\n");
  const Ended printed = pse({"fmt", "a.pse"});
  EXPECT_EQ(printed.out, "color = white * x\n");
  EXPECT_EQ(read("a.pse"), "color=white*x\n");
  EXPECT_EQ(pse({"fmt", "-"}, "color=white*x\n").out, printed.out);
  EXPECT_EQ(pse({"fmt", "--check", "a.pse"}).status, 6);
  EXPECT_EQ(pse({"fmt", "-i", "a.pse"}).status, 0);
  EXPECT_EQ(read("a.pse"), printed.out);
  EXPECT_EQ(pse({"fmt", "--check", "a.pse"}).status, 0);
  file("bad.pse", "color = (\n");
  EXPECT_EQ(pse({"fmt", "-i", "bad.pse"}).status, 3);
  EXPECT_EQ(read("bad.pse"), "color = (\n");
  EXPECT_EQ(pse({"fmt", "--check", "-i", "a.pse"}).status, 2);
}

TEST_F(Tools, InfoOfProgramsAndImages) {
  file("a.pse", "Level = 1 [[ min = 0, help = \"how much\" ]]\ncolor = [x Level time]\n");
  Ended ended = pse({"info", "a.pse"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  for (const char* part : {"x", "time", "color[3]", "per sample", "Level=1", "how much"})
    EXPECT_TRUE(contains(ended.out, part));
  ended = pse({"info", "--json", "a.pse"});
  EXPECT_TRUE(contains(ended.out, "\"knob\": \"Level\""));
  ASSERT_EQ(pse({"render", "a.pse", "-o", "a.exr", "--res", "7x5"}).status, 0);
  ended = pse({"info", "a.exr"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.out, "7"));
  EXPECT_TRUE(contains(ended.out, "Level=1"));
  EXPECT_TRUE(contains(pse({"info", "--json", "a.exr"}).out, "\"width\": 7"));
  file("empty.exr", "");
  EXPECT_EQ(pse({"info", "empty.exr"}).status, 4);
  EXPECT_EQ(pse({"info", "missing.exr"}).status, 4);
}

TEST_F(Tools, DocumentationOfEverythingListed) {
  const Ended list = pse({"doc", "--list"});
  EXPECT_EQ(list.status, 0);
  for (const char* name : {"Noise", "turbulence", "bias", "gain", "lerp", "point", "begin_frame"})
    EXPECT_TRUE(contains(list.out, std::string(name) + "\n"));
  const Ended ended = pse({"doc", "turbulence", "Noise"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_TRUE(contains(ended.out, "turbulence("));
  EXPECT_TRUE(contains(ended.out, "Noise("));
  // Everything has a text.
  const std::string json = pse({"doc", "--json"}).out;
  EXPECT_EQ(json.find("\"text\": \"\""), std::string::npos);
}

TEST_F(Tools, EveryFunctionThatCanBeCalledIsDocumented) {
  for (const char* name : {"march", "hypertexture", "texture", "texture_size", "volume", "count", "select", "min", "any",
                           "array", "identity", "isnan", "PI", "white", "color", "normal", "soft_sphere"}) {
    const Ended ended = pse({"doc", name});
    EXPECT_EQ(ended.status, 0) << name;
    EXPECT_TRUE(contains(ended.out, name));
  }
  // However many lines a signature has in the library, it is one.
  EXPECT_TRUE(contains(pse({"doc", "march"}).out, "march(density, compute_color, compute_shading, origin, dir,"));
  EXPECT_TRUE(contains(pse({"doc", "marhc"}).err, "did you mean `march`?"));
}

TEST_F(Tools, FilesBesideTheProgramHideTheLibrarys) {
  file("waves.pse", "function mine() return 1\n");
  file("a.pse", "import waves\ncolor = white * mine() * cycloid(0)\n");
  const Ended ended = pse({"check", "a.pse"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.err, "hides-library"));
}

TEST_F(Tools, WhatContradictsItselfIsQuestioned) {
  file("a.pse", "import a\nPower = 7 [[ min = 0, max = 5 ]]\nMode = 'x' [[ options = 'y|z' ]]\n"
                "Tint = [0 0.5 2] [[ max = 1 ]]\nFine = 5 [[ min = 0, max = 5 ]]\n"
                "color = Power * Tint * Fine\n");
  const Ended ended = pse({"check", "a.pse"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  for (const char* part : {"a.pse:1:8: warning: `a` is this file itself",
                           "a.pse:2:1: warning: the value of knob `Power` is above its maximum",
                           "a.pse:3:1: warning: the value of knob `Mode` is none of its options",
                           "a.pse:4:1: warning: the value of knob `Tint` is above its maximum"})
    EXPECT_TRUE(contains(ended.err, part));
  EXPECT_FALSE(contains(ended.err, "Fine"));
}

TEST_F(Tools, MissingNamesAreToldWhereTheyComeFrom) {
  file("a.pse", "color = white * normal.z\n");
  EXPECT_TRUE(contains(pse({"render", "a.pse", "-o", "a.png"}).err, "--on sphere"));
  file("b.pse", "color = white\n");
  ASSERT_EQ(pse({"render", "b.pse", "-o", "b.exr", "--res", "2x2"}).status, 0);
  file("c.pse", "color = 1 - color\n");
  EXPECT_TRUE(contains(pse({"render", "c.pse", "fg=b.exr", "-o", "c.png"}).err, "`fg.color`"));
  EXPECT_EQ(pse({"render", "b.pse", "-o", "b.xyz"}).status, 2);
}

TEST_F(Tools, DiffToleratesWhatItIsToldTo) {
  file("a.pse", "Level = 0\ncolor = [Level 0 0]\n");
  for (const char* level : {"0", "0.25"})
    ASSERT_EQ(pse({"render", "a.pse", "-o", std::string(level) + ".exr", "--res", "3x3", "--float",
                   std::string("Level=") + level})
                  .status,
              0);
  Ended ended = pse({"diff", "0.exr", "0.25.exr", "-o", "d.exr"});
  EXPECT_EQ(ended.status, 6);
  EXPECT_TRUE(contains(ended.out, "0.25"));
  EXPECT_EQ(picture("d.exr").at(picture("d.exr").spec.find("R"), 2, 2), 0.25f);
  EXPECT_EQ(pse({"diff", "0.exr", "0.25.exr", "--tolerance", "0.3"}).status, 0);
  EXPECT_EQ(pse({"diff", "0.exr", "missing.exr"}).status, 4);
  EXPECT_EQ(pse({"diff", "0.exr"}).status, 2);
}

}  // namespace
}  // namespace pse::test
