// What a tile's pixels become once the edges through them are known: the midway list of the 2002
// chapter's "More Detailed Description", pixel by pixel.
#pragma once

#include "antialias/circles.h"
#include "antialias/half_grid.h"
#include "antialias/patterns.h"
#include "antialias/places.h"
#include "antialias/programs.h"
#include "antialias/tile.h"

namespace pse::antialias {

// How many pixels were treated in which way.
struct Counts {
  std::int64_t filtered = 0;      // looked at by the high-contrast filter: an edge may be near
  std::int64_t blended = 0;       // one edge: both sides, by the kernel's share
  std::int64_t supersampled = 0;  // run at more samples
  std::int64_t left = 0;          // of stored pixels: with an edge that nothing tells more of

  Counts& operator+=(const Counts& other) {
    filtered += other.filtered, blended += other.blended, supersampled += other.supersampled;
    left += other.left;
    return *this;
  }
};

// The picture after antialiasing at some pixels: values[o][i] is output o at pixels[i].
struct Refined {
  std::vector<Pixel> pixels;
  std::vector<std::vector<float>> values;
  // The pixels from here on are means of so many samples within noise: what their neighbours make
  // of them (smooth.h) counts as one more.
  std::size_t first_mean = static_cast<std::size_t>(-1);
  std::uint32_t samples = 0;
  Refined(std::vector<Pixel> list, std::size_t outputs) : pixels(std::move(list)), values(outputs) {
    resize(pixels.size());
  }
  void resize(std::size_t count) {
    pixels.resize(count);
    for (auto& plane : values) plane.resize(count);
  }
  void reserve(std::size_t count) {
    pixels.reserve(count);
    for (auto& plane : values) plane.reserve(count);
  }
};

class Refiner {
 public:
  // `edges` may be null: then everything is supersampled. `courses`: those of the outputs; without
  // any that is bent, samples half a pixel apart are not taken. `patterns`: of the options' kernel
  // and samples. All must outlive this.
  Refiner(const PlaceRunner& program, const PlaceRunner* edges, const Options& options,
          const Patterns& patterns, std::size_t outputs, std::span<const Course> courses)
      : program_(program),
        edges_(edges),
        options_(options),
        patterns_(patterns),
        outputs_(outputs),
        courses_(courses.begin(), courses.end()) {
    if (std::ranges::find(courses_, Course::bent) != courses_.end())
      half_means_ = half_means_of(options.filter);
  }

  // The pixels of a tile whose values change, in the procedural mode. Every value depends on the
  // pixel alone.
  Refined refine(const Tile& tile, Work& work, RunStatus& status, Counts& counts) const;

  // All pixels of a list at options.samples samples each.
  Refined supersample(std::vector<Pixel> pixels, Work& work, RunStatus& status) const;

 private:
  void find_crossings(CrossingLists& crossings, bool may_bend, Work& work, RunStatus& status) const;
  void follow(CrossingLists& crossings, bool may_bend, Work& work, RunStatus& status) const;
  void smooth(const Tile& tile, const Work& work, Refined& result) const;
  void settle_shares(const CrossingLists& crossings) const;
  CrossingLists::Edge edge_of(const Circle& circle) const;
  void find_circles(CrossingLists& crossings, Work& work, RunStatus& status) const;
  void blend(const Tile& tile, const CrossingLists& crossings, Refined& result, Work& work,
             RunStatus& status) const;
  std::uint32_t count() const { return static_cast<std::uint32_t>(options_.samples); }
  template <class Visit>
  void sample(std::span<const Pixel> pixels, std::uint32_t first, std::uint32_t last, Work& work,
              RunStatus& status, const Visit& visit) const;
  bool by_regions(const Unclear& pixel, std::uint32_t look, const Results& results, std::size_t at,
                  std::span<float> values) const;
  void add_means(std::span<const Pixel> pixels, std::uint32_t count, Refined& result, Work& work,
                 RunStatus& status) const;
  void settle_halves(const Tile& tile, Refined& result, Counts& counts, Work& work,
                     RunStatus& status) const;
  void fill_halves(Work& work, RunStatus& status) const;
  void settle_noise(Refined& result, Counts& counts, Work& work, RunStatus& status) const;
  static Range range_around(const float* middle, std::ptrdiff_t width);
  void judge(const Tile& tile, std::span<const std::size_t> now, std::uint32_t first,
             std::uint32_t last, Work& work) const;
  void settle(const Tile& tile, Refined& result, Counts& counts, Work& work,
              RunStatus& status) const;

  const PlaceRunner& program_;
  const PlaceRunner* edges_;
  const Options& options_;
  const Patterns& patterns_;
  std::size_t outputs_;
  std::vector<Course> courses_;
  std::optional<HalfMeans> half_means_;
};

}  // namespace pse::antialias
