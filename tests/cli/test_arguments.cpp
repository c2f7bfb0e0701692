// Words of the command line: help, versions, unknown things, wrong values of every kind.
#include <cstdlib>

#include "run_pse.h"

namespace pse::test {
namespace {

class Arguments : public CommandLine {};

constexpr const char* plain = "Scale = 2\ncolor = [u v Scale]\n";

TEST_F(Arguments, VersionAndHelp) {
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"--version"}, {"version"}, {"-V"}}) {
    const Ended ended = pse(words);
    EXPECT_EQ(ended.status, 0);
    EXPECT_TRUE(contains(ended.out, "pse 0."));
  }
  for (const char* command :
       {"render", "check", "fmt", "info", "doc", "diff", "completion", "help", "version"}) {
    EXPECT_TRUE(contains(pse({"--help"}).out, command));
    const Ended ended = pse({command, "--help"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_TRUE(contains(ended.out, std::string("usage: pse ") + command));
    EXPECT_EQ(pse({"help", command}).out, ended.out);
  }
}

TEST_F(Arguments, NothingAtAllIsAUsageError) {
  const Ended ended = pse({});
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_TRUE(contains(ended.err, "usage: pse COMMAND"));
}

TEST_F(Arguments, UnknownNamesComeWithTheNearestOne) {
  file("a.pse", plain);
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"rendr", "a.pse"}, "did you mean `render`?"},
      {{"a.pse"}, "did you mean `pse render a.pse`?"},
      {{"render", "a.pse", "-o", "a.png", "--thread", "2"}, "did you mean `--threads`?"},
      {{"render", "a.pse", "-o", "a.png", "--resum"}, "did you mean `--resume`?"},
      {{"render", "a.pse", "-o", "a.png", "--nan", "blak"}, "did you mean `black`?"},
      {{"render", "a.pse", "-o", "a.png", "Scal=3"}, "did you mean `Scale`?"},
      {{"render", "a.pse", "-o", "colr=a.exr"}, "did you mean `color`?"},
      {{"help", "chek"}, "did you mean `check`?"},
      {{"doc", "turbulense"}, "did you mean `turbulence`?"},
  };
  for (const auto& [words, hint] : cases) {
    const Ended ended = pse(words);
    EXPECT_EQ(ended.status, 2) << ended.err;
    EXPECT_TRUE(contains(ended.err, hint));
  }
}

TEST_F(Arguments, WrongValuesAreUsageErrorsThatNameTheOption) {
  file("a.pse", plain);
  const std::vector<std::vector<std::string>> cases = {
      {"--res", "0x5"},
      {"--res", "axb"},
      {"--res", "1x2x3"},
      {"--res", "9999999x1"},
      {"--res", "24x"},
      {"--res", "x24"},
      {"--res", "24,"},
      {"RES=24x"},
      {"--res", ""},
      {"--clip", "1,2,3"},
      {"--clip", "0,0,a,1"},
      {"--clip", "9,9,1,1"},
      {"--clip", "600,0,700,9"},
      {"--xform", "1,2,3"},
      {"--xform", "1,2,x,4,5,6"},
      {"--xform", "0,0,0,0,0,0"},
      {"--xform", "0,0,0.5,0,0,0.5"},
      {"--xform", "1,0,0,0,1,0,0,0,0"},
      {"XFORM=0,0,0,0,0,0,0,0,0"},
      {"-f", "1-"},
      {"-f", "a"},
      {"-f", "1-5x0"},
      {"-f", ""},
      {"-t", "-1"},
      {"-t", "x"},
      {"-t", "99999"},
      {"--tile", "0"},
      {"--width", "3"},
      {"--tier", "fast"},
      {"--tier", "first", "--width", "4"},
      {"--fps", "0"},
      {"--fps", "nan"},
      {"--seed", "-1"},
      {"--seed", "1.5"},
      {"--bits", "9"},
      {"--compression", "lzw"},
      {"--colorspace", "x"},
      {"--display", "crt"},
      {"--progress", "x"},
      {"--emit", "x"},
      {"--stats=xml"},
      {"-Wx"},
      {"-D", "Scale"},
      {"-D", "=3"},
      {"Scale=red green"},
      {"Scale=[1 2]"},
      {"Scale="},
      {"--half", "--float"},
      {"--slice", "z"},
      {"--slice", "w=0"},
      {"--slice", "z=nan"},
      {"--slice", "z=inf"},
      {"--slice", "z=0", "--prepass", "4"},
      {"--prepass", "0"},
      {"--resume", "--no-provenance"},
      {"x.exr", "y.exr"},
      {"a=x.exr", "a=y.exr"},
      {"a="},
      {"-o", "b.png", "-o", "b.png"},
      {"-o", ""},
      {"-o"},
      {"--layers", "nothing"},
  };
  for (const std::vector<std::string>& words : cases) {
    std::vector<std::string> all = {"render", "a.pse", "-o", "a.exr"};
    all.insert(all.end(), words.begin(), words.end());
    const Ended ended = pse(all);
    EXPECT_EQ(ended.status, 2) << words.front() << " " << words.back() << "\n" << ended.err;
    EXPECT_TRUE(contains(ended.err, "error: "));
    EXPECT_EQ(ended.out, "");
    EXPECT_FALSE(exists("a.exr")) << words.front();
  }
}

TEST_F(Arguments, RenderNeedsAProgramAndAPlaceToWrite) {
  file("marble.pse", plain);
  EXPECT_EQ(pse({"render"}).status, 2);
  const Ended ended = pse({"render", "marble.pse"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_TRUE(contains(ended.err, "-o marble.png"));
}

TEST_F(Arguments, FlagsStandInAnyOrder) {
  file("a.pse", plain);
  EXPECT_EQ(pse({"render", "-o", "a.exr", "Scale=3", "--res", "8x8", "a.pse"}).status, 0);
  EXPECT_EQ(pse({"render", "--res=8x8", "Scale=3", "a.pse", "-ob.exr"}).status, 0);
  EXPECT_EQ(pse({"diff", "a.exr", "b.exr"}).status, 0);
}

TEST_F(Arguments, AProgramsHelpListsItsKnobs) {
  file("a.pse",
       "Scale = 2 [[ min = 1, max = 8, help = \"size of the veins\", units = \"m\" ]]\n"
       "Mode = \"soft\" [[ options = \"soft|hard\" ]]\nOn = true\nTint = [1 0.5 0]\ncolor = Tint * "
       "Scale\n");
  const Ended ended = pse({"render", "a.pse", "--help"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  for (const char* part : {"Scale=2", "size of the veins", "1 to 8", "in m", "Mode=soft",
                           "soft | hard", "On=true", "Tint=[1 0.5 0]"})
    EXPECT_TRUE(contains(ended.out, part));
}

TEST_F(Arguments, CompletionsAndManPagesKnowEveryOption) {
  const std::string help = pse({"render", "--help"}).out;
  const std::string man = pse({"help", "--man", "render"}).out;
  EXPECT_TRUE(contains(man, ".TH"));
  EXPECT_TRUE(contains(pse({"help", "--man"}).out, ".SH COMMANDS"));
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const std::string script = pse({"completion", shell}).out;
    // Every long option of the help is in the script and in the manual page.
    for (std::size_t at = 0; (at = help.find("  --", at)) != std::string::npos; ++at) {
      const std::size_t start = at + 4, end = help.find_first_of(" \n[=", start);
      const std::string name = help.substr(start, end - start);
      EXPECT_TRUE(contains(script, name)) << shell;
      std::string escaped = name;
      for (std::size_t dash = 0; (dash = escaped.find('-', dash)) != std::string::npos; dash += 2)
        escaped.replace(dash, 1, "\\-");
      EXPECT_NE(man.find(escaped), std::string::npos) << name;
    }
  }
  EXPECT_EQ(pse({"completion", "tcsh"}).status, 2);
}

// The script, run by the shell as a Tab would: nothing may be said on the terminal.
TEST_F(Arguments, BashCompletesWithoutAWord) {
  if (std::system("command -v bash >/dev/null") != 0) GTEST_SKIP() << "there is no bash";
  file("c.bash", pse({"completion", "bash"}).out +
                     "complete_line() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); "
                     "_pse; echo \"${COMPREPLY[*]}\"; }\n"
                     "complete_line pse ren\n"
                     "complete_line pse render a.pse --nan b\n"
                     "complete_line pse render a.pse --resu\n"
                     "complete_line pse render a.pse --antialias p\n");
  const std::string run =
      "cd '" + folder().string() + "' && bash --norc c.bash >out.txt 2>err.txt";
  ASSERT_EQ(std::system(run.c_str()), 0);
  EXPECT_EQ(read("err.txt"), "");
  EXPECT_EQ(read("out.txt"), "render\nblack box3\n--resume\nprocedural\n");
}

TEST_F(Arguments, TheManualPagesDateIsFixedBySourceDateEpoch) {
  environment["SOURCE_DATE_EPOCH"] = "86400";
  EXPECT_TRUE(contains(pse({"help", "--man", "render"}).out, "1970-01-02"));
}

}  // namespace
}  // namespace pse::test
