// Searching, widening, following, probing; and again in smaller steps where that has missed
// something.
#include "app/prepass.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/prepass_proof.h"
#include "image/writer.h"

namespace pse::app {
namespace {

constexpr float nowhere_near = 1e30f, nowhere_far = -1e30f;
constexpr int probe_block = 12;       // one probe in a square of so many pixels
constexpr int quarters = 4;           // of a cell: one ray through each
constexpr std::int64_t enough = 500;  // rays that meet matter, to judge by
constexpr float margin = 2;           // what is found is widened by so many coarse steps
// What may hold matter is all marched where that is at most this part of all, or this many rays.
constexpr double little = 1.0 / 40, few_rays = 128 * 128;
// Where this part of all is found, a picture takes less long by ten at most: no reason to miss any.
constexpr double much = 1.0 / 10;

// A place within a block that looks random and is the same at every run.
int scattered(int x, int y, int salt, int below) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b1u ^
                    static_cast<std::uint32_t>(y) * 0x85ebca77u ^
                    static_cast<std::uint32_t>(salt) * 0xc2b2ae3du;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h ^= h >> 12;
  return static_cast<int>(h % static_cast<std::uint32_t>(below));
}

// One prepass at work.
class Prepass {
 public:
  Prepass(SpanSearch& search, int width, int height, int factor, PrepassReport& report)
      : search_(search), width_(width), height_(height), report_(report) {
    spans_ = Spans::nowhere(width, height, factor);
    checked_.assign(spans_.near.size(), false);
  }

  // `possible`: all there is to look at, where that is known. Stops where it is found to be much.
  std::optional<Spans> run(const Possible* all) {
    const Spans* possible = all != nullptr ? &all->spans : nullptr;
    if (!search(possible) || !follow()) return std::nullopt;
    found_much_ = all != nullptr && within(*possible).marched() >= much * all->all;
    if (found_much_) return spans_;
    // Other rays and other steps, until enough of them have met matter and nothing that was missed.
    if (!probe(possible)) return std::nullopt;
    for (int k = 1; k < quarters && !is_too_coarse(); ++k) {
      const std::int64_t before = missed_;
      if (!search_elsewhere(possible, k) || !follow()) return std::nullopt;
      settled_ = missed_ == before;
      if (settled_ && met_ >= enough) break;
    }
    return possible != nullptr ? within(*possible) : spans_;
  }
  // How many rays met what had not been found before them, of those that met anything.
  std::int64_t missed() const { return missed_; }
  std::int64_t met() const { return met_; }
  // Whether so much was found that all that is possible may as well be marched.
  bool found_much() const { return found_much_; }
  // Whether the last rays met nothing else.
  bool settled() const { return settled_ && !is_too_coarse(); }

 private:
  using Rays = std::vector<SpanSearch::Ray>;

  // Where one ray in so many meets what was missed, there is more that no ray has met.
  bool is_too_coarse() const { return enough * missed_ > met_; }

  // A ray of each cell, in coarse steps. Each cell takes its neighbours' stretches too.
  bool search(const Spans* possible) {
    Rays rays = cell_rays(possible, 0);
    if (!look(rays, spans_.cell)) return false;
    for (const auto& ray : rays)
      if (ray.near < ray.far) reach_ = std::min(reach_, ray.far - ray.near);
    for (const auto& ray : rays)
      if (ray.near < ray.far) spread(ray);
    return true;
  }

  // The same by other rays: what they meet outside of the stretches was missed.
  bool search_elsewhere(const Spans* possible, int quarter) {
    Rays rays = cell_rays(possible, quarter);
    if (!look(rays, spans_.cell)) return false;
    // Where matter begins is known to a step.
    take_missed(rays, reach_);
    return true;
  }

  // A ray of each cell, anywhere in a quarter of it, so that nothing lies between all rays.
  Rays cell_rays(const Spans* within, int quarter) const {
    Rays rays;
    const double n = spans_.cell;
    const int salt = 3 + 2 * quarter;
    // The first two lie across from each other.
    const double left = quarter == 0 || quarter == 3 ? 0 : 0.5;
    const double top = quarter == 0 || quarter == 2 ? 0 : 0.5;
    for (int y = 0; y < spans_.height; ++y)
      for (int x = 0; x < spans_.width; ++x) {
        const double right = left + scattered(x, y, salt, 64) / 128.0;
        const double down = top + scattered(x, y, salt + 1, 64) / 128.0;
        SpanSearch::Ray ray{std::min((x + right) * n, width_ - 0.5),
                            std::min((y + down) * n, height_ - 0.5)};
        if (within != nullptr) {
          const auto [near, far] = stretch(*within, x, y);
          if (!(near <= far)) continue;
          ray.near = near, ray.far = far;
        }
        rays.push_back(ray);
      }
    return rays;
  }

  bool look(Rays& rays, int step) {
    report_.searched += static_cast<std::int64_t>(rays.size());
    return search_.look(rays, step);
  }

  std::pair<int, int> cell_of(const SpanSearch::Ray& ray) const {
    return {static_cast<int>(ray.x) / spans_.cell, static_cast<int>(ray.y) / spans_.cell};
  }

  // Adds what rays have met by more than `slack` outside of the stretches.
  void take_missed(const Rays& rays, float slack) {
    for (const auto& ray : rays) {
      if (!(ray.near < ray.far)) continue;
      ++met_;
      const auto [x, y] = cell_of(ray);
      const std::size_t i = spans_.at(x, y);
      if (!spans_.empty(i) && spans_.near[i] <= ray.near + slack &&
          spans_.far[i] >= ray.far - slack)
        continue;
      ++missed_;
      if (!std::isfinite(reach_)) reach_ = 0;
      reach_ = std::max(reach_, ray.far - ray.near);
      spread(ray);
    }
  }

  // What other spans have within a cell.
  std::pair<float, float> stretch(const Spans& other, int x, int y) const {
    const int n = spans_.cell;
    std::pair<float, float> found{nowhere_near, nowhere_far};
    for (int oy = y * n / other.cell;
         oy <= std::min(((y + 1) * n - 1) / other.cell, other.height - 1); ++oy)
      for (int ox = x * n / other.cell;
           ox <= std::min(((x + 1) * n - 1) / other.cell, other.width - 1); ++ox) {
        const std::size_t i = other.at(ox, oy);
        if (other.empty(i)) continue;
        found = {std::min(found.first, other.near[i]), std::max(found.second, other.far[i])};
      }
    return found;
  }

  // Gives a stretch to a ray's cell and its neighbours; those that change are to be checked.
  void spread(const SpanSearch::Ray& ray) {
    const auto [x, y] = cell_of(ray);
    const float from = ray.near - margin * reach_, to = ray.far + margin * reach_;
    each_neighbour(x, y, [&](int nx, int ny) {
      const std::size_t i = spans_.at(nx, ny);
      if (spans_.widen(i, from, to)) checked_[i] = false;
    });
  }

  template <class Work>
  void each_neighbour(int x, int y, Work work) const {
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, spans_.height - 1); ++ny)
      for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, spans_.width - 1); ++nx) work(nx, ny);
  }

  // What cell i has and cell (x, y) lacks, by more than a coarse step: before and behind what that
  // has; nothing outside of the picture.
  std::pair<float, float> lacking(std::size_t i, int x, int y) const {
    if (x < 0 || y < 0 || x >= spans_.width || y >= spans_.height)
      return {nowhere_near, nowhere_far};
    const std::size_t other = spans_.at(x, y);
    const float near = spans_.near[i] - reach_, far = spans_.far[i] + reach_;
    if (spans_.empty(other)) return {near, far};
    const bool before = spans_.near[other] > spans_.near[i] + 2 * reach_;
    const bool behind = spans_.far[other] < spans_.far[i] - 2 * reach_;
    return {before   ? near
            : behind ? spans_.far[other]
                     : nowhere_near,
            behind   ? far
            : before ? spans_.near[other]
                     : nowhere_far};
  }

  // Where cells with matter border on cells without any, or without any as near or as far, looks at
  // the outermost pixels step by step: if there is matter, it may go on next door.
  bool follow() {
    for (;;) {
      Rays rays;
      for (int y = 0; y < spans_.height; ++y)
        for (int x = 0; x < spans_.width; ++x) {
          const std::size_t i = spans_.at(x, y);
          if (spans_.empty(i) || checked_[i]) continue;
          checked_[i] = true;
          add_border(x, y, rays);
        }
      if (rays.empty()) return true;
      if (!look(rays, 1)) return false;
      for (const auto& ray : rays)
        if (ray.near < ray.far) spread(ray);
    }
  }

  // The pixels of a cell that touch cells which lack something, and where on their rays that is.
  void add_border(int cx, int cy, Rays& rays) const {
    const int n = spans_.cell;
    const int x0 = cx * n, y0 = cy * n;
    const int x1 = std::min(x0 + n, width_) - 1, y1 = std::min(y0 + n, height_) - 1;
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const int dx = x == x0 ? -1 : x == x1 ? 1 : 0, dy = y == y0 ? -1 : y == y1 ? 1 : 0;
        if (dx == 0 && dy == 0) continue;
        const std::size_t i = spans_.at(cx, cy);
        SpanSearch::Ray ray{x + 0.5, y + 0.5, nowhere_near, nowhere_far};
        for (const auto& [nx, ny] : {std::pair{cx + dx, cy}, {cx, cy + dy}, {cx + dx, cy + dy}}) {
          const auto [near, far] = lacking(i, nx, ny);
          ray.near = std::min(ray.near, near), ray.far = std::max(ray.far, far);
        }
        if (!(ray.near <= ray.far)) continue;
        rays.push_back(ray);
      }
  }

  // What was found, as far as it is possible.
  Spans within(const Spans& possible) const {
    const int cell = std::gcd(spans_.cell, possible.cell);
    Spans both = Spans::nowhere(width_, height_, cell);
    for (int y = 0; y < both.height; ++y)
      for (int x = 0; x < both.width; ++x) {
        const auto there = [&](const Spans& spans) {
          return spans.at(x * cell / spans.cell, y * cell / spans.cell);
        };
        const std::size_t i = both.at(x, y), a = there(spans_), b = there(possible);
        both.near[i] = std::max(spans_.near[a], possible.near[b]);
        both.far[i] = std::min(spans_.far[a], possible.far[b]);
      }
    return both;
  }

  // Single pixels, all steps of their rays: what is found outside the stretches was missed.
  bool probe(const Spans* possible) {
    Rays rays;
    for (int y0 = 0; y0 < height_; y0 += probe_block)
      for (int x0 = 0; x0 < width_; x0 += probe_block) {
        const int x = x0 + scattered(x0, y0, 1, probe_block),
                  y = y0 + scattered(x0, y0, 2, probe_block);
        if (x >= width_ || y >= height_) continue;
        SpanSearch::Ray ray{x + 0.5, y + 0.5};
        if (possible != nullptr) {
          const std::size_t i = possible->at(x / possible->cell, y / possible->cell);
          if (possible->empty(i)) continue;
          ray.near = possible->near[i], ray.far = possible->far[i];
        }
        rays.push_back(ray);
      }
    if (!look(rays, 1)) return false;
    take_missed(rays, 0);
    return true;
  }

  SpanSearch& search_;
  const int width_, height_;
  PrepassReport& report_;
  Spans spans_;
  std::vector<bool> checked_;
  std::int64_t missed_ = 0, met_ = 0;
  bool settled_ = false, found_much_ = false;
  float reach_ = std::numeric_limits<float>::infinity();  // a coarse step along the ray
};

}  // namespace

Spans Spans::nowhere(int width, int height, int cell) {
  Spans spans;
  spans.cell = cell;
  spans.width = (width + cell - 1) / cell;
  spans.height = (height + cell - 1) / cell;
  const auto cells = std::size_t(spans.width) * std::size_t(spans.height);
  spans.near.assign(cells, nowhere_near);
  spans.far.assign(cells, nowhere_far);
  return spans;
}

Spans Spans::everywhere(int width, int height) {
  Spans spans = nowhere(width, height, 64);
  std::swap(spans.near, spans.far);
  return spans;
}

double Spans::marched() const {
  double sum = 0;
  for (std::size_t i = 0; i < near.size(); ++i)
    if (!empty(i)) sum += double(far[i]) - double(near[i]);
  return sum * cell * cell;
}

bool Spans::widen(std::size_t i, float from, float to) {
  if (near[i] <= from && far[i] >= to) return false;
  near[i] = std::min(near[i], from);
  far[i] = std::max(far[i], to);
  return true;
}

std::optional<Spans> find_spans(SpanSearch& search, BoxBounds* bounds, int width, int height,
                                int factor, PrepassReport& report) {
  const std::int64_t pixels = std::int64_t{width} * height;
  const double enough_proven = std::max(little, few_rays / double(pixels));
  std::optional<Possible> possible;
  if (bounds != nullptr) {
    possible = find_possible(*bounds, width, height, pixels);
    if (!possible) return std::nullopt;
    report.boxes = possible->asked;
    report.possible = possible->part;
  }
  const auto all = [&] {
    report.left = 0, report.step = 1;
    return possible ? std::move(possible->spans) : Spans::everywhere(width, height);
  };
  if (report.possible <= enough_proven) return all();

  // What has missed something is done again, in steps half as large: of 1 it can only be all.
  for (report.step = factor; report.step > 1 || report.step == factor; report.step /= 2) {
    Prepass prepass(search, width, height, report.step, report);
    auto spans = prepass.run(possible ? &*possible : nullptr);
    report.evaluations = search.evaluations();
    if (!spans) return std::nullopt;
    if (possible && prepass.found_much()) return all();
    if (prepass.settled()) {
      // A closer look at what is neither found nor proven empty; what is no more than is found is
      // marched too.
      report.left = 1;
      if (possible) {
        const double most = std::max(enough_proven, spans->marched() / possible->all);
        if (!prove_rest(*bounds, *possible, *spans, pixels / 8, most)) return std::nullopt;
        report.boxes = possible->asked;
        report.left = possible->rest <= most ? 0 : possible->rest;
      }
      report.met = prepass.met(), report.met_new = prepass.missed();
      return spans;
    }
    if (report.step == factor) report.missed = prepass.missed();
  }
  return all();
}

void write_spans(const Spans& spans, int width, int height, const std::string& file) {
  image::ImageSpec spec;
  spec.display = spec.data = {0, 0, width, height};
  spec.channels = {{"near.Y", image::PixelType::float32}, {"far.Y", image::PixelType::float32}};
  image::Image image(spec);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t cell = spans.at(x / spans.cell, y / spans.cell);
      image.pixel(0, x, y) = spans.near[cell];
      image.pixel(1, x, y) = spans.far[cell];
    }
  image::WriteOptions options;
  options.format = "exr";
  options.sync = false;
  if (const auto done = image::write_image(file, image, options); !done)
    throw Failure(Exit::output, done.error().message);
}

}  // namespace pse::app
