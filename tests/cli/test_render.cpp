// `pse render`: files, sequences, filters, resuming, signals, exit statuses.
#include <signal.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "run_pse.h"

namespace pse::test {
namespace {

class Render : public CommandLine {};

TEST_F(Render, PixelsAreWhereTheyBelong) {
  file("a.pse", "color = [px py 0]\nalpha = 1\nheat = x\n");
  const Ended ended = pse({"render", "a.pse", "-o", "a.exr", "--res", "5x3", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.err, "wrote a.exr"));
  EXPECT_EQ(ended.out, "");
  const image::Image image = picture("a.exr");
  EXPECT_EQ(image.spec.display, (image::Window{0, 0, 5, 3}));
  for (const char* channel : {"R", "G", "B", "A", "heat.Y"})
    EXPECT_GE(image.spec.find(channel), 0) << channel;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      EXPECT_EQ(image.at(image.spec.find("R"), x, y), static_cast<float>(x) + 0.5f);
      EXPECT_EQ(image.at(image.spec.find("G"), x, y), static_cast<float>(y) + 0.5f);
    }
}

TEST_F(Render, AClipIsAPartOfTheSamePicture) {
  file("a.pse", "color = [px py x]\n");
  ASSERT_EQ(
      pse({"render", "a.pse", "-o", "a.exr", "--res", "50x30", "--clip", "7,5,23,17", "--float"})
          .status,
      0);
  const image::Image image = picture("a.exr");
  EXPECT_EQ(image.spec.display, (image::Window{0, 0, 50, 30}));
  EXPECT_EQ(image.spec.data, (image::Window{7, 5, 23, 17}));
  EXPECT_EQ(image.at(0 + image.spec.find("R"), 7, 5), 7.5f);
  EXPECT_EQ(image.at(image.spec.find("G"), 22, 16), 16.5f);
  EXPECT_EQ(image.at(image.spec.find("R"), 6, 5), 0.0f);
}

TEST_F(Render, ThreadsTilesAndWidthsDoNotChangeAPixel) {
  // Rays leave the march at different steps, octaves end at different turns.
  file("a.pse",
       "function density(p)\n"
       "    return saturate(8 * (1 + turbulence_up_to(3 * p, 4, 0.4) - norm(p)))\n"
       "function paint(p)\n"
       "    return saturate(abs(p))\n"
       "t = turbulence(point * 5)\n"
       "c = raymarch(density, paint, [x y 2], [0 0 -1], 0, 4, 0.1)\n"
       "color = t * [c.r c.g c.b]\n"
       "alpha = t > 0.5 ? 1 : 0\n");
  ASSERT_EQ(pse({"render", "a.pse", "-o", "a.exr", "--res", "61x43", "--float"}).status, 0);
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"-t", "1"},
                                             {"-t", "3", "--tile", "7"},
                                             {"--width", "1"},
                                             {"--width", "4"},
                                             {"--width", "8"},
                                             {"--width", "16"},
                                             {"--width", "32"},
                                             {"--tier", "first"},
                                             {"--interpret"},
                                             {"--no-optimize"},
                                             {"--tiled"},
                                             {"--compression", "none"},
                                             {"--no-cache"}}) {
    std::vector<std::string> words = {"render", "a.pse", "-o",     "b.exr",
                                      "--res",  "61x43", "--float"};
    words.insert(words.end(), options.begin(), options.end());
    ASSERT_EQ(pse(words).status, 0) << options.front();
    EXPECT_EQ(pse({"diff", "a.exr", "b.exr"}).status, 0) << options.front();
  }
}

TEST_F(Render, DitherIsNoEdge) {
  // What decides by px and py alone, and a march whose steps are jittered by them, stays as it is;
  // an edge beside them is still found.
  file("dither.pse",
       "Edge = 0\njitter = fract(52.98 * fract(0.067 * px + 0.0058 * py))\nt = jitter * 0.1\n"
       "while t < 1 and norm([x y t]) > 0.5\n    t += 0.1\n"
       "color = t * white\nif Edge > 0\n    color *= x > 0.3 * y ? 1 : 0\n");
  const auto refined = [&](const std::string& edge) {
    const Ended ended = pse({"render", "dither.pse", "-o", "a.exr", "--res", "64x64", "--antialias",
                             "procedural", "--stats=json", "-q", edge});
    EXPECT_EQ(ended.status, 0) << ended.err;
    return nlohmann::json::parse(ended.out)["antialias"]["filtered"].get<int>();
  };
  EXPECT_EQ(refined("Edge=0"), 0);
  EXPECT_GT(refined("Edge=1"), 60);
  EXPECT_LT(refined("Edge=1"), 64 * 64 / 4);
}

TEST_F(Render, SamplesThatStoredPixelsCannotGiveAreSaid) {
  make_input("in.exr");
  file("stored.pse", "color = 2 * color\n");
  file("made.pse", "color = x * white\n");
  const auto said = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"-o", "a.exr", "--samples", "4"});
    const Ended ended = pse(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return contains(ended.err, "stored pixels");
  };
  EXPECT_TRUE(said({"render", "stored.pse", "in.exr"}));
  EXPECT_FALSE(said({"render", "made.pse", "--res", "8x8"}));
}

TEST_F(Render, ImagesComeInAsNamesAndChainThroughPipes) {
  make_input("in.exr");
  file("a.pse", "color = 2 * color\n");
  file("b.pse", "color = fg.color + bg.color\nZ = fg.Z\n");
  ASSERT_EQ(pse({"render", "b.pse", "fg=in.exr", "bg=in.exr", "-o", "sum.exr", "--float"}).status,
            0);
  Ended twice = pse({"render", "a.pse", "in.exr", "-o", "-", "--float"});
  ASSERT_EQ(twice.status, 0) << twice.err;
  file("twice.exr", twice.out);
  EXPECT_EQ(pse({"diff", "sum.exr", "twice.exr"}).status, 6);  // sum.exr has Z as well
  // The same through standard input.
  file("id.pse", "color = color\n");
  const Ended chained = pse({"render", "id.pse", "-", "-o", "chained.exr", "--float"}, twice.out);
  EXPECT_EQ(chained.status, 0) << chained.err;
  EXPECT_EQ(pse({"diff", "twice.exr", "chained.exr"}).status, 0);
  EXPECT_EQ(picture("sum.exr").at(picture("sum.exr").spec.find("R"), 3, 0), 1.75f);
}

TEST_F(Render, TheProgramMayComeFromStandardInput) {
  const Ended ended = pse({"render", "-", "-o", "a.exr", "--res", "2x2"}, "color = [1 2 3]\n");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(picture("a.exr").at(picture("a.exr").spec.find("B"), 0, 0), 3.0f);
}

TEST_F(Render, ImagesOfDifferentSizesAreRefused) {
  make_input("in.exr");
  file("b.pse", "color = fg.color + bg.color\n");
  ASSERT_EQ(pse({"render", "make.pse", "-o", "big.exr", "--res", "8x8"}).status, 0);
  const Ended ended = pse({"render", "b.pse", "fg=in.exr", "bg=big.exr", "-o", "out.exr"});
  EXPECT_EQ(ended.status, 4);
  EXPECT_TRUE(contains(ended.err, "4x2"));
  EXPECT_TRUE(contains(ended.err, "8x8"));
  EXPECT_EQ(
      pse({"render", "b.pse", "fg=in.exr", "bg=in.exr", "-o", "out.exr", "--res", "9x9"}).status,
      4);
}

TEST_F(Render, ExitStatusesOfErrors) {
  file("good.pse", "color = white\n");
  file("bad.pse", "color = = 1\n");
  file("unknown.pse", "color = wite\n");
  file("broken.exr", "not an image");
  file("fails.pse", "a = [1 2 3]\nn = floor(u * 9)\ncolor = white * a[n]\n");
  const std::vector<std::pair<std::vector<std::string>, int>> cases = {
      {{"missing.pse", "-o", "a.png"}, 4},
      {{".", "-o", "a.png"}, 4},
      {{"bad.pse", "-o", "a.png"}, 3},
      {{"unknown.pse", "-o", "a.png"}, 3},
      {{"good.pse", "missing.exr", "-o", "a.png"}, 4},
      {{"good.pse", "broken.exr", "-o", "a.png"}, 4},
      {{"good.pse", "-o", "no/such/folder/a.png"}, 5},
      {{"good.pse", "-o", "/dev/full", "--format", "exr"}, 5},
      {{"fails.pse", "-o", "a.png"}, 1},
  };
  for (const auto& [words, status] : cases) {
    std::vector<std::string> all = {"render"};
    all.insert(all.end(), words.begin(), words.end());
    const Ended ended = pse(all);
    EXPECT_EQ(ended.status, status) << words.front() << " " << words[1] << "\n" << ended.err;
    EXPECT_TRUE(contains(ended.err, "error"));
    EXPECT_FALSE(exists("a.png"));
  }
}

TEST_F(Render, AFailedCheckSaysWhichLineAndPixel) {
  file("fails.pse", "a = [1 2 3]\nn = px > 5 ? 9 : 1\ncolor = white * a[n]\n");
  const Ended ended = pse({"render", "fails.pse", "-o", "a.exr", "--res", "8x1", "-f", "3"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_TRUE(contains(ended.err, "fails.pse:3"));
  EXPECT_TRUE(contains(ended.err, "pixel (5, 0)"));
}

TEST_F(Render, NanIsReportedOnceAndTreatedAsAsked) {
  file("a.pse", "# comment\ncolor = white * sqrt(x)\n");
  const auto run = [&](const std::string& policy) {
    return pse({"render", "a.pse", "-o", "a.exr", "--res", "4x1", "--nan", policy});
  };
  Ended ended = run("keep");
  EXPECT_EQ(ended.status, 0);
  EXPECT_TRUE(contains(ended.err, "a.pse:2"));
  EXPECT_TRUE(contains(ended.err, "`color`"));
  EXPECT_TRUE(std::isnan(picture("a.exr").at(picture("a.exr").spec.find("R"), 0, 0)));
  EXPECT_EQ(run("black").status, 0);
  EXPECT_EQ(picture("a.exr").at(picture("a.exr").spec.find("R"), 0, 0), 0.0f);
  std::filesystem::remove(folder() / "a.exr");
  ended = run("error");
  EXPECT_EQ(ended.status, 6);
  EXPECT_FALSE(exists("a.exr"));
}

TEST_F(Render, Sequences) {
  file("a.pse", "color = [frame time fps]\n");
  Ended ended =
      pse({"render", "a.pse", "-f", "-1-3x2", "-o", "s.####.exr", "--res", "2x2", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  for (const char* name : {"s.-001.exr", "s.0001.exr", "s.0003.exr"}) {
    EXPECT_TRUE(exists(name)) << name;
    EXPECT_TRUE(contains(ended.err, name));
  }
  EXPECT_EQ(picture("s.0003.exr").at(picture("s.0003.exr").spec.find("R"), 0, 0), 3.0f);
  EXPECT_EQ(picture("s.0003.exr").at(picture("s.0003.exr").spec.find("G"), 0, 0), 0.125f);
  // A sequence in, a sequence out: the frames are those of the input.
  file("b.pse", "color = color + 1\n");
  std::filesystem::remove(folder() / "s.-001.exr");
  ended = pse({"render", "b.pse", "s.%04d.exr", "-o", "t.#.exr", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(picture("t.0001.exr").at(picture("t.0001.exr").spec.find("R"), 1, 1), 2.0f);
  EXPECT_TRUE(exists("t.0003.exr"));
  EXPECT_FALSE(exists("t.0002.exr"));
  ended = pse({"render", "a.pse", "-f", "1-3", "-o", "one.exr"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_TRUE(contains(ended.err, "%04d"));
  EXPECT_EQ(pse({"render", "b.pse", "missing.%04d.exr", "-f", "7", "-o", "t.#.exr"}).status, 4);
}

TEST_F(Render, AFilmHoldsAllFrames) {
  if (std::system("command -v ffmpeg ffprobe > /dev/null") != 0) GTEST_SKIP() << "no ffmpeg here";
  file("a.pse", "color = [u v frame / 4]\n");
  const Ended ended =
      pse({"render", "a.pse", "-f", "1-5", "-o", "a.mp4", "--res", "32x16", "--fps", "25"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.err, "wrote a.mp4"));
  const std::string probe = "ffprobe -v error -show_entries stream=nb_frames,width,r_frame_rate " +
                            (folder() / "a.mp4").string() + " > " + (folder() / "probe").string();
  ASSERT_EQ(std::system(probe.c_str()), 0);
  for (const char* part : {"nb_frames=5", "width=32", "r_frame_rate=25/1"})
    EXPECT_TRUE(contains(read("probe"), part));
}

TEST_F(Render, ResumeSkipsOnlyTheSameRecipe) {
  file("a.pse", "Level = 1\ncolor = [Level frame 0]\n");
  const auto run = [&](std::vector<std::string> more) {
    std::vector<std::string> words = {"render",     "a.pse", "-f",  "1-3",     "-o",
                                      "s.%04d.exr", "--res", "2x2", "--resume"};
    words.insert(words.end(), more.begin(), more.end());
    return pse(words);
  };
  EXPECT_TRUE(contains(run({}).err, "wrote s.0003.exr"));
  std::filesystem::remove(folder() / "s.0002.exr");
  Ended again = run({});
  EXPECT_EQ(again.status, 0);
  EXPECT_TRUE(contains(again.err, "kept s.0001.exr"));
  EXPECT_TRUE(contains(again.err, "wrote s.0002.exr"));
  EXPECT_TRUE(contains(again.err, "kept s.0003.exr"));
  EXPECT_TRUE(contains(run({"Level=2"}).err, "wrote s.0001.exr"));
  EXPECT_TRUE(contains(run({"Level=2", "--seed", "4"}).err, "wrote s.0001.exr"));
  EXPECT_TRUE(contains(run({"Level=2", "--seed", "4", "--float"}).err, "wrote s.0001.exr"));
  EXPECT_TRUE(
      contains(run({"Level=2", "--seed", "4", "--float", "-t", "1"}).err, "kept s.0001.exr"));
  file("a.pse", "Level = 1\ncolor = [Level frame 1]\n");
  EXPECT_TRUE(contains(run({"Level=2", "--seed", "4", "--float"}).err, "wrote s.0001.exr"));
}

TEST_F(Render, ProvenanceUnlessLeftOut) {
  file("a.pse", "Level = 1\ncolor = [Level frame 0]\n");
  for (const char* name : {"a.exr", "a.png"}) {
    ASSERT_EQ(
        pse({"render", "a.pse", "-o", name, "--res", "2x2", "Level=3", "--seed", "5", "-f", "7"})
            .status,
        0);
    auto attributes = picture(name).spec.attributes;
    EXPECT_TRUE(contains(attributes["pse/program"], "[Level frame 0]"));
    EXPECT_TRUE(contains(attributes["pse/knobs"], "Level=3"));
    EXPECT_EQ(attributes["pse/seed"], "5");
    EXPECT_EQ(attributes["pse/frame"], "7");
    ASSERT_EQ(pse({"render", "a.pse", "-o", name, "--res", "2x2", "--no-provenance"}).status, 0);
    for (const auto& [key, text] : picture(name).spec.attributes)
      EXPECT_FALSE(key.starts_with("pse/")) << key;
  }
}

TEST_F(Render, VariablesGoWhereTheyAreSent) {
  file("a.pse", "color = [1 0 0]\nalpha = 0.5\nN = [x 1 0]\nheat = u\n");
  ASSERT_EQ(pse({"render", "a.pse", "-o", "all.exr", "-o", "heat=heat.png", "-o", "N,heat=data.exr",
                 "-o", "c.png", "--res", "4x4"})
                .status,
            0);
  EXPECT_GE(picture("all.exr").spec.find("N.X"), 0);
  const image::Image data = picture("data.exr");
  EXPECT_EQ(data.spec.find("R"), -1);
  EXPECT_EQ(data.spec.channels.size(), 4u);
  EXPECT_EQ(picture("heat.png").spec.find("G"), -1);
  ASSERT_EQ(
      pse({"render", "a.pse", "-o", "few.exr", "--layers", "color,heat", "--res", "4x4"}).status,
      0);
  EXPECT_EQ(picture("few.exr").spec.channels.size(), 4u);
  EXPECT_EQ(pse({"render", "a.pse", "-o", "N,heat=data.png", "--res", "4x4"}).status, 2);
}

TEST_F(Render, StagesOfTheCompiler) {
  file("a.pse", "color = white * x\n");
  for (const char* stage : {"tokens", "ast", "ir", "opt", "llvm", "asm"}) {
    const Ended ended = pse({"render", "a.pse", "--emit", stage});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_GT(ended.out.size(), 20u) << stage;
  }
  file("bad.pse", "color = = 1\n");
  EXPECT_EQ(pse({"render", "bad.pse", "--emit", "ir"}).status, 3);
}

TEST_F(Render, Statistics) {
  file("a.pse", "color = white * turbulence(point)\n");
  Ended ended = pse({"render", "a.pse", "--stats", "--res", "64x64"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  for (const char* part : {"compile", "per sample", "samples per second", "thread", "memory"})
    EXPECT_TRUE(contains(ended.err, part));
  ended = pse({"render", "a.pse", "--stats=json", "--res", "64x64"});
  EXPECT_TRUE(contains(ended.out, "\"samples\": 4096"));
}

TEST_F(Render, OperationsByRate) {
  const auto count = [&](const std::string& part) {
    const Ended ended = pse({"render", "a.pse", "--stats=json", "--res", "64x64"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    const nlohmann::json numbers = nlohmann::json::parse(ended.out);
    return numbers["operations"].at(nlohmann::json::json_pointer(part)).get<double>();
  };
  // sqrt(2) * 3 + 1 is worked out when compiling; a product and a sum hold for the frame. Straight
  // code runs what is compiled.
  file("a.pse", "k = sqrt(2) * 3 + 1\nheat = x * (2 * frame + k) + y * y\n");
  EXPECT_EQ(count("/written/constant"), 3);
  EXPECT_EQ(count("/written/frame"), 2);
  EXPECT_EQ(count("/written/sample"), 3);
  EXPECT_EQ(count("/compiled/frame"), 2);
  EXPECT_EQ(count("/compiled/sample"), 3);
  EXPECT_EQ(count("/run/frame"), 2);
  EXPECT_EQ(count("/run/sample"), 3);
  EXPECT_EQ(count("/run/samples_looked_at"), 64);
  // On objects too.
  file("b.pse", "heat = normal.x * (2 * frame + sqrt(2)) + normal.y * normal.z\n");
  const Ended ended = pse({"render", "b.pse", "--stats=json", "--on", "sphere", "--res", "8x8"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(nlohmann::json::parse(ended.out)["operations"]["compiled"]["sample"], 3);
  // Where half of the samples turn a loop more often, the average shows it.
  const std::string loop = "t = 0\nwhile t < (x > 0 ? Turns : 1)\n    t += 1\nheat = t\n";
  file("a.pse", "Turns = 11\n" + loop);
  const double few = count("/run/sample");
  file("a.pse", "Turns = 61\n" + loop);
  const double many = count("/run/sample");
  file("a.pse", "Turns = 111\n" + loop);
  EXPECT_EQ(count("/run/sample") - many, many - few);
  EXPECT_GE(many - few, 50);
}

TEST_F(Render, ProgressAsJsonAndPlain) {
  file("a.pse", "color = white\n");
  EXPECT_TRUE(contains(pse({"render", "a.pse", "-o", "a.png", "--progress", "json"}).err,
                       "\"done\": 1.0000"));
  EXPECT_TRUE(
      contains(pse({"render", "a.pse", "-o", "a.png", "--progress", "plain"}).err, "100 %"));
  EXPECT_EQ(pse({"render", "a.pse", "-o", "a.png", "-q"}).err, "");
}

TEST_F(Render, SignalsStopCleanlyAndLeaveTheOldFile) {
  file("slow.pse", "i = 0\nwhile i < 1e30\n    i = i + u\ncolor = white * i\n");
  for (const auto& [signal, status] : {std::pair{SIGINT, 130}, {SIGTERM, 143}}) {
    file("a.exr", "the old file");
    file(".in", "");
    const auto started = std::chrono::steady_clock::now();
    const pid_t process = start({"render", "slow.pse", "-o", "a.exr"});
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    kill(process, signal);
    const Ended ended = finish(process);
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_EQ(read("a.exr"), "the old file");
    EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(30));
    // Nothing else is left in the folder.
    for (const auto& entry : std::filesystem::directory_iterator(folder())) {
      const std::string name = entry.path().filename().string();
      EXPECT_TRUE(name == "a.exr" || name == "slow.pse" || name.starts_with(".")) << name;
    }
  }
}

// Other formats are read in a forked process, where a lock that a thread of ours held at that moment
// would never open. It used to happen in one of twenty runs.
// 12 million pixels of 12 bytes are too many to be kept: every third of every third row is.
TEST_F(Render, ASnapshotOfALargePictureIsThinned) {
  file("half.pse", "i = 0\nif v < 0.5\n    while i < 1e30\n        i = i + v\ncolor = [px i py]\n");
  file(".in", "");
  const pid_t process = start({"render", "half.pse", "-o", "a.exr", "--res", "4000x3000", "-t", "1",
                               "--layers", "color", "--antialias", "none"});
  for (int i = 0; i < 100 && !exists("a.snapshot.exr"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kill(process, SIGUSR1);
  }
  kill(process, SIGTERM);
  const Ended ended = finish(process);
  EXPECT_EQ(ended.status, 143);
  EXPECT_TRUE(contains(ended.err, "wrote a.snapshot.exr, 1 of 3x3 pixels")) << ended.err;
  ASSERT_TRUE(exists("a.snapshot.exr"));
  const image::Image snapshot = picture("a.snapshot.exr");
  EXPECT_EQ(snapshot.spec.data, (image::Window{0, 0, 1334, 1000}));
  const int r = snapshot.spec.find("R"), b = snapshot.spec.find("B");
  EXPECT_EQ(snapshot.at(r, 25, 0), 75.5f);  // the next row of tiles would begin at 64
  EXPECT_EQ(snapshot.at(b, 25, 7), 21.5f);
  EXPECT_EQ(snapshot.at(b, 1333, 999), 0.0f);
}

TEST_F(Render, ASnapshotOnSigusr1) {
  // The upper half is quick; the lower half never ends.
  file("half.pse", "i = 0\nif v < 0.5\n    while i < 1e30\n        i = i + v\ncolor = [1 i 0]\n");
  file(".in", "");
  const pid_t process =
      start({"render", "half.pse", "-o", "a.exr", "--res", "64x64", "--tile", "16", "-t", "1"});
  for (int i = 0; i < 100 && !exists("a.snapshot.exr"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    kill(process, SIGUSR1);
  }
  kill(process, SIGTERM);
  const Ended ended = finish(process);
  EXPECT_EQ(ended.status, 143);
  ASSERT_TRUE(exists("a.snapshot.exr"));
  EXPECT_FALSE(exists("a.exr"));
  const image::Image snapshot = picture("a.snapshot.exr");
  EXPECT_EQ(snapshot.at(snapshot.spec.find("R"), 0, 0), 1.0f);
  EXPECT_EQ(snapshot.at(snapshot.spec.find("R"), 63, 63), 0.0f);
}

// A density and the chapter's other functions are a picture by themselves.
TEST_F(Render, ADensityAloneIsAPicture) {
  const std::string matter =
      "Size = 0.7\nfunction density(p)\n    return soft_sphere(p, Size, 0.3)\n"
      "function compute_color(d)\n    return [0.3 0.7 0.4]\n";
  file("alone.pse", matter);
  file("said.pse", matter + "color = hypertexture(density, compute_color)\n");
  const auto pixels = [&](const std::vector<std::string>& arguments) {
    std::vector<std::string> all = {"render"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    all.insert(all.end(), {"--res", "24x24", "-o", "out.png"});
    const Ended ended = pse(all);
    EXPECT_EQ(ended.status, 0) << ended.err;
    const std::string png = read("out.png");
    return png.substr(png.find("IDAT"));  // the texts before it are others
  };
  const std::string said = pixels({"said.pse"});
  EXPECT_GT(said.size(), 500u);
  EXPECT_EQ(pixels({"alone.pse"}), said);
  EXPECT_EQ(pixels({"alone.pse", "--prepass", "4"}), said);
  EXPECT_NE(pixels({"alone.pse", "Size=0.4"}), said);
  // What sets something says itself what is seen.
  file("set.pse", matter + "color = [0.1 0.2 0.3]\n");
  EXPECT_NE(pixels({"set.pse"}), said);
}

TEST_F(Render, ModulesAreFoundBesideTheProgramAndOnThePath) {
  file("a.pse", "import shades\ncolor = shade(u)\n");
  const std::vector<std::string> words = {"render", "a.pse", "-o", "a.exr", "--res", "2x2"};
  EXPECT_EQ(pse(words).status, 3);
  file("lib/shades.pse", "function shade(t)\n    return [t t 1]\n");
  std::vector<std::string> with = words;
  with.push_back("-Ilib");
  EXPECT_EQ(pse(with).status, 0);
  environment["PSE_PATH"] = "nowhere:lib";
  EXPECT_EQ(pse(words).status, 0);
  environment.clear();
  file("pse.toml", "path = [\"lib\"]\n");
  EXPECT_EQ(pse(words).status, 0);
}

}  // namespace
}  // namespace pse::test
