// Where a knob's value comes from, and options from the environment and from files.
#include "run_pse.h"

namespace pse::test {
namespace {

class Knobs : public CommandLine {
 protected:
  void SetUp() override {
    CommandLine::SetUp();
    file("a.pse", "Level = 1 [[ min = 0, max = 10 ]]\ncolor = [Level Level Level]\n");
  }
  // The value of Level that a run uses, or -1.
  float level(std::vector<std::string> words) {
    std::vector<std::string> all = {"render", "a.pse", "-o", "out.exr", "--res", "2x2", "--float"};
    all.insert(all.end(), words.begin(), words.end());
    last = pse(all);
    if (last.status != 0) return -1;
    const image::Image image = picture("out.exr");
    return image.at(image.spec.find("R"), 0, 0);
  }
  Ended last;
};

TEST_F(Knobs, ProgramThenEnvironmentThenFileThenCommandLine) {
  EXPECT_EQ(level({}), 1);
  environment["PSE_Level"] = "2";
  EXPECT_EQ(level({}), 2);
  file("p.txt", "# comment\nLevel 3\n");
  EXPECT_EQ(level({"--params", "p.txt"}), 3);
  EXPECT_EQ(level({"--params", "p.txt", "Level=4"}), 4);
  EXPECT_EQ(level({"-DLevel=5", "--params", "p.txt"}), 5);
  EXPECT_EQ(level({"-D", "Level=5", "-D", "Level=6"}), 6);
}

TEST_F(Knobs, OfImportedFiles) {
  file("tones.pse", "Level = 2 [[ max = 5, help = \"how much\" ]]\nfunction tone() return Level\n");
  file("a.pse", "import tones\ncolor = white * tone()\n");
  EXPECT_EQ(level({}), 2);
  EXPECT_EQ(level({"Level=4"}), 4);
  file("p.txt", "Level 3\n");
  EXPECT_EQ(level({"--params", "p.txt"}), 3);
  EXPECT_TRUE(contains(pse({"render", "a.pse", "--help"}).out, "how much (at most 5)"));
  file("a.pse", "import tones\nLevel = 10\ncolor = white * (Level + tone())\n");
  EXPECT_EQ(level({"Level=20"}), 22);
  EXPECT_EQ(level({"tones.Level=1"}), 11);
}

TEST_F(Knobs, ColoursByName) {
  file("a.pse", "Tint = white\ncolor = Tint\n");
  EXPECT_EQ(level({"Tint=0.5*red"}), 0.5f);
}

TEST_F(Knobs, ParameterFilesInBothForms) {
  file("p.toml", "Level = 7\n");
  EXPECT_EQ(level({"--params", "p.toml"}), 7);
  file("q.toml", "[knobs]\nLevel = 0.5\n");
  EXPECT_EQ(level({"--params", "q.toml"}), 0.5f);
  file("r.txt", "Level = 2 * 3\n");
  EXPECT_EQ(level({"--params", "r.txt"}), 6);
  file("bad.toml", "Level = = 1\n");
  level({"--params", "bad.toml"});
  EXPECT_EQ(last.status, 2);
  EXPECT_TRUE(contains(last.err, "bad.toml:1"));
  // What belongs on the command line is no knob, and is said so.
  file("s.txt", "RES 96 96\n");
  level({"--params", "s.txt"});
  EXPECT_EQ(last.status, 2);
  EXPECT_TRUE(contains(last.err, "`RES=...` on the command line, or $PSE_RES"));
  level({"--params", "missing.txt"});
  EXPECT_EQ(last.status, 4);
}

TEST_F(Knobs, ValuesBeyondTheRangeAreWarnedOfAndUsed) {
  EXPECT_EQ(level({"Level=11"}), 11);
  EXPECT_TRUE(contains(last.err, "warning"));
  EXPECT_TRUE(contains(last.err, "maximum of 10"));
}

TEST_F(Knobs, OtherKindsOfKnobs) {
  file("a.pse",
       "Level = [0 0 0]\nOn = false\nMode = \"a\" [[ options = \"a|b\" ]]\ncolor = On ? Level : [9 "
       "9 9]\n");
  EXPECT_EQ(level({"Level=1,2,3", "On=yes"}), 1);
  EXPECT_EQ(level({"Level=[4 5 6]", "On=true"}), 4);
  EXPECT_EQ(level({"Level=5", "On=1", "Mode=b"}), 5);
  level({"Level=1,2"});
  EXPECT_EQ(last.status, 2);
  EXPECT_TRUE(contains(last.err, "vector of 3"));
  level({"On=perhaps"});
  EXPECT_EQ(last.status, 2);
  level({"Mode=c"});
  EXPECT_EQ(last.status, 2);
}

TEST_F(Knobs, EnvironmentVariablesOfNoKnobAreIgnored) {
  environment["PSE_Lewel"] = "2";
  environment["PSE_PATH"] = "/nowhere";
  EXPECT_EQ(level({}), 1);
}

TEST_F(Knobs, ResolutionFromEveryPlace) {
  const auto width = [&](std::vector<std::string> words) {
    std::vector<std::string> all = {"render", "a.pse", "-o", "out.exr"};
    all.insert(all.end(), words.begin(), words.end());
    last = pse(all);
    EXPECT_EQ(last.status, 0) << last.err;
    return picture("out.exr").spec.display.width();
  };
  file("pse.toml", "res = \"11x5\"\n");
  EXPECT_EQ(width({}), 11);
  file("pse.toml", "res = \"11x5\"\n[render]\nres = \"12x5\"\n");
  EXPECT_EQ(width({}), 12);
  environment["PSE_RES"] = "13x5";
  EXPECT_EQ(width({}), 13);
  EXPECT_EQ(width({"RES=14x5"}), 14);
  EXPECT_EQ(width({"--res", "15x5"}), 15);
}

TEST_F(Knobs, ConfigurationFilesHereAndUpwardThenXdg) {
  file(".config/pse/pse.toml", "res = \"9x3\"\nthreads = 1\n");
  last = pse({"render", "a.pse", "-o", "out.exr", "--stats=json"});
  EXPECT_EQ(picture("out.exr").spec.display.width(), 9);
  EXPECT_TRUE(contains(last.out, "\"threads\": 1"));
  file("pse.toml", "res = \"8x3\"\nresolutoin = 3\n");
  last = pse({"render", "a.pse", "-o", "out.exr", "--stats=json"});
  EXPECT_EQ(picture("out.exr").spec.display.width(), 8);
  EXPECT_TRUE(contains(last.out, "\"threads\": 1"));
  EXPECT_TRUE(contains(last.err, "there is no option `resolutoin`"));
  file("pse.toml", "res = [\n");
  EXPECT_EQ(pse({"render", "a.pse", "-o", "out.exr"}).status, 2);
}

}  // namespace
}  // namespace pse::test
