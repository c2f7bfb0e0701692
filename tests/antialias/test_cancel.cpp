// Cancelling reaches what antialiasing runs besides the program itself.
#include <gtest/gtest.h>

#include "picture.h"

namespace pse::antialias {
namespace {

// A frame whose loop turns once for the program that is shown, and for ever for those at its side.
TEST(Cancel, TheFramesOfTheOtherProgramsStopToo) {
  const std::string text =
      "t = 0\nwhile t < time\n    t = min(t + 1, 2)\nc = x < 0 ? t : 3\n";
  for (const int endless : {1, 2}) {  // the second and the third program that is asked for
    CompileOptions compile;
    const auto programs = compile_programs(test::lowered(text), compile, Mode::procedural);
    ASSERT_TRUE(programs);
    const ImagePlane plane{.width = 32, .height = 32};
    RunStatus status;
    std::atomic<int> asked = 0;
    const Host host{[&](const Program& program) {
                      ImagePlane at = plane;
                      at.frame = 1;
                      at.fps = 1;
                      const bool here = asked++ == endless;
                      if (here) at.frame = 1e9, status.cancel = true;
                      FrameState state;
                      set_plane_uniforms(program.module(), at, state);
                      return state;
                    },
                    [&](const ir::Module& of) { return image_plane_samples(of, plane); }};
    Counts counts;
    const RunResult result =
        execute(*programs, host, test::procedural(),
                image_plane_source(programs->shown->module(), plane, {-2, -2, 34, 34}),
                [](const TileView&) {}, {.window = {0, 0, 32, 32}, .threads = 2}, status, counts);
    EXPECT_EQ(result.end, RunEnd::cancelled) << endless;
    EXPECT_EQ(asked, endless + 1);
  }
}

}  // namespace
}  // namespace pse::antialias
