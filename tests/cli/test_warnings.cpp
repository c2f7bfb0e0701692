// Every warning of the command line goes through -W: shown, hidden by its name or all, or exit 6.
#include <chrono>
#include <csignal>
#include <thread>

#include "run_pse.h"

namespace pse::test {
namespace {

class Warnings : public CommandLine {
 protected:
  // The command warns with this name; -W hides the warning and makes it an error.
  void governed(std::vector<std::string> words, const std::string& name) {
    SCOPED_TRACE(name);
    const auto with = [&](const std::vector<std::string>& more) {
      std::vector<std::string> all = words;
      all.insert(all.end(), more.begin(), more.end());
      return pse(all);
    };
    Ended ended = with({});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(contains(ended.err, "warning: "));
    EXPECT_TRUE(contains(ended.err, "[" + name + "]"));
    ended = with({"-Werror"});
    EXPECT_EQ(ended.status, 6) << ended.err;
    EXPECT_TRUE(contains(ended.err, "-Werror"));
    const std::vector<std::vector<std::string>> hidden = {{"-Wnone"}, {"-Wno-" + name}};
    for (const std::vector<std::string>& more : hidden) {
      std::vector<std::string> strict = more;
      strict.push_back("-Werror");
      ended = with(strict);
      EXPECT_EQ(ended.status, 0) << ended.err;
      EXPECT_FALSE(ended.err.contains("warning")) << ended.err;
    }
  }
  std::vector<std::string> render(const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "-o", "a.exr", "--res", "4x4"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(Warnings, OfKnobs) {
  file("a.pse", "Level = 1 [[ min = 0, max = 2 ]]\ncolor = white * Level\n");
  governed(render({"a.pse", "Level=3"}), "knob-range");
  file("knobs.toml", "Level = 3\n");
  governed(render({"a.pse", "--params", "knobs.toml"}), "knob-range");
  environment["PSE_Level"] = "3";
  governed(render({"a.pse"}), "knob-range");
}

// Several programs of a job may find the same, as a prepass's does.
TEST_F(Warnings, AreSaidOnce) {
  file("a.pse", "Level = 1 [[ min = 0, max = 2 ]]\ncolor = white * Level\n");
  const std::string said = pse(render({"a.pse", "Level=3", "Level=3"})).err;
  const std::size_t first = said.find("knob-range");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(said.find("knob-range", first + 1), std::string::npos) << said;
}

TEST_F(Warnings, OfConfiguration) {
  file("a.pse", "color = white\n");
  file("pse.toml", "[render]\nthread = 1\n");
  governed(render({"a.pse"}), "configuration");
  governed({"check", "a.pse"}, "configuration");
  file("pse.toml", "[rendre]\nthreads = 1\n");
  governed(render({"a.pse"}), "configuration");
  file("pse.toml", "[render]\nthread = 1\nwarn = [\"error\"]\n");
  EXPECT_EQ(pse(render({"a.pse"})).status, 6);
}

TEST_F(Warnings, OfNanAndInfinity) {
  file("a.pse", "color = white / (x - x)\n");
  governed(render({"a.pse"}), "not-finite");
  file("v.pse", "density = 1 / (point.x - point.x)\n");
  governed({"bake", "v.pse", "-o", "v.vdb", "--res", "4", "-Wno-empty"}, "not-finite");
}

TEST_F(Warnings, OfDensities) {
  file("a.pse", "function density(p)\n    return NAN\ncolor = hypertexture(density)\n");
  governed(render({"a.pse"}), "expect");
}

TEST_F(Warnings, OfVolumes) {
  file("empty.pse", "density = 0\n");
  governed({"bake", "empty.pse", "-o", "v.vdb", "--res", "4"}, "empty");
  file("full.pse", "density = 1\n");
  governed({"bake", "full.pse", "-o", "v.vdb", "--res", "4"}, "cut");
}

TEST_F(Warnings, OfSurfaces) {
  file("a.pse", "color = white\n");
  governed(render({"a.pse", "--on", "sphere", "--camera", "eye=0,0,0.1"}), "inside");
  file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                "f 1/1 2/2 3/3\nf 1/1 2/2 2/2\n");
  governed(render({"a.pse", "--on", "m.obj"}), "mesh");
  governed({"bake", "a.pse", "m.obj", "-o", "b.exr", "--res", "8"}, "mesh");
  governed({"bake", "m.obj", "-o", "m.vdb", "--res", "8"}, "mesh");
  file("o.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                "f 1/1 2/2 3/3\nf 4/1 3/2 2/3\n");
  governed({"bake", "a.pse", "o.obj", "-o", "b.exr", "--res", "8"}, "overlap");
  file("n.pse", "color = [u / (u - u) 0 0]\n");
  file("p.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  governed({"bake", "n.pse", "p.obj", "-o", "b.exr", "--res", "8"}, "not-finite");
}

TEST_F(Warnings, OfWhatIsNotSeen) {
  file("a.pse", "color = white\n");
  file("blob.pse", "density = 4 - norm(point)\n");
  governed(render({"a.pse", "--on", "blob.pse"}), "unseen");
}

// A film and standard output have no snapshots.
TEST_F(Warnings, OfSnapshots) {
  file("slow.pse", "i = 0\nwhile i < 1e30\n    i = i + v\ncolor = [i i i]\n");
  const auto said = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "slow.pse", "-o", "-", "-f", "1"};
    words.insert(words.end(), more.begin(), more.end());
    const pid_t process = start(words);
    for (int i = 0; i < 8; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      kill(process, SIGUSR1);
    }
    kill(process, SIGTERM);
    const Ended ended = finish(process);
    EXPECT_EQ(ended.status, 143) << ended.err;  // a signal's status comes before a strict check's
    return ended.err;
  };
  EXPECT_TRUE(contains(said({"-Werror"}), "[snapshot]"));
  EXPECT_FALSE(said({"-Wnone"}).contains("warning"));
}

TEST_F(Warnings, OfSamplesThatChangeNothing) {
  file("make.pse", "color = white * x\n");
  ASSERT_EQ(pse({"render", "make.pse", "-o", "in.exr", "--res", "4x4"}).status, 0);
  file("a.pse", "shade = 0\nif color.x > 0.5\n    shade = 1\ncolor = white * shade\n");
  governed(render({"a.pse", "in.exr", "--samples", "4"}), "samples");
}

TEST_F(Warnings, OfWidthsThatNoFilterUses) {
  file("make.pse", "color = white * x\n");
  ASSERT_EQ(pse({"render", "make.pse", "-o", "in.exr", "--res", "4x4"}).status, 0);
  file("a.pse", "color = texture(\"in.exr\", x, y, width = 0.1)\n");
  governed(render({"a.pse"}), "unused-width");
  file("b.pse", "color = texture(\"in.exr\", x, y, filter = \"mipmap\", width = 0.1)\n");
  EXPECT_EQ(pse(render({"b.pse", "-Werror"})).status, 0);
}

}  // namespace
}  // namespace pse::test
