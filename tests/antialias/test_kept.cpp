// What pictures leave for the next ones (src/antialias/kept.h) changes none of their bits.
#include "antialias/kept.h"

#include "antialias/picture.h"

namespace pse::antialias {
namespace {

using namespace test;

// Edges, corners, fine noise and a circle: each list of the memory has something in it.
constexpr const char* program = R"(
_ring = abs(length([x - 0.2, y]) - 0.3) < 0.08
_board = (floor(9 * x) + floor(7 * y)) % 2
c = _ring ? 0.1 : _board > 0.5 ? 0.8 : 0.4 + 0.3 * noise(60 * x, 60 * y)
)";

// One after the other, all of the same programs, each as of programs of its own.
TEST(Kept, NoPictureShowsWhatCameBefore) {
  const Programs programs = compiled(program, {.antialias = procedural()});
  std::vector<PictureOptions> all;
  for (const int size : {40, 97, 24})
    for (const int count : {64, 20})
      for (const FilterKind kind : {FilterKind::cubic, FilterKind::box}) {
        Options antialias = procedural(kind);
        antialias.samples = count;
        all.push_back({.width = size, .height = size - 3, .tile = 32, .antialias = antialias});
        all.push_back({.width = size, .height = size, .threads = 2, .antialias = antialias});
        antialias.mode = Mode::supersample;
        all.push_back({.width = size, .height = size, .tile = 16, .antialias = antialias});
      }
  all.push_back(all.front());
  for (const PictureOptions& options : all) {
    Programs fresh = programs;
    fresh.kept = nullptr;
    const Picture picture = render(programs, options);
    EXPECT_EQ(picture.planes, render(fresh, options).planes)
        << options.width << " " << options.antialias.samples;
    EXPECT_GT(picture.counts.supersampled + (options.antialias.mode == Mode::supersample), 0);
  }
}

// A picture whose programs have other inputs at the same addresses must not find its memory.
TEST(Kept, MemoryForgetsWhoseItWas) {
  Kept kept;
  auto work = kept.take();
  work->inputs.emplace_back(nullptr, Planes());
  const Work* const address = work.get();
  kept.give(std::move(work));
  const auto again = kept.take();
  EXPECT_EQ(again.get(), address);
  EXPECT_TRUE(again->inputs.empty());
  EXPECT_NE(kept.take().get(), address);
}

TEST(Kept, PatternsAreThoseOfTheKernelAndTheNumber) {
  Kept kept;
  const Filter cubic, box(FilterKind::box), wide(FilterKind::cubic, 1.5f);
  const auto first = kept.patterns(cubic, 64);
  EXPECT_EQ(kept.patterns(cubic, 64), first);
  for (const auto& [filter, count] :
       {std::pair(box, 64u), std::pair(wide, 64u), std::pair(wide, 16u), std::pair(cubic, 64u)}) {
    const auto found = kept.patterns(filter, count);
    EXPECT_NE(found, first);
    const Patterns made(filter, count);
    const Offsets a = found->of(5, 3, count), b = made.of(5, 3, count);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_TRUE(a.x[k] == b.x[k] && a.y[k] == b.y[k]);
  }
}

}  // namespace
}  // namespace pse::antialias
