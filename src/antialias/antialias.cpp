// Tiles with aprons as batches; each is computed, compared and refined within one batch.
#include "antialias/antialias.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "antialias/fine.h"
#include "antialias/kept.h"
#include "antialias/path.h"
#include "antialias/smooth.h"
#include "antialias/steps.h"
#include "antialias/stored.h"
#include "stream/blocks.h"
#include "stream/planes.h"
#include "stream/tiling.h"

namespace pse::antialias {
namespace {

std::int64_t size_of(const Rect& rect) { return std::int64_t{rect.width()} * rect.height(); }

// A program with what it takes to run it at any place.
struct Placed {
  FrameState state;
  std::unique_ptr<SampleSource> samples;
  std::optional<PlaceRunner> runner;

  Placed(const Program& program, const Host& host, RunStatus& status)
      : state(host.state(program)), samples(host.samples(program.module())) {
    program.kernel->run_frame(state, status);
    runner.emplace(program, state, *samples);
  }
};

class Execution {
 public:
  Execution(const Programs& programs, const Host& host, const Options& antialias,
            const TileSource& source, const TileSink& sink, const ExecuteOptions& options,
            RunStatus& status, Counts& counts)
      : programs_(programs),
        host_(host),
        antialias_(antialias),
        source_(source),
        sink_(sink),
        options_(options),
        status_(status),
        counts_(counts),
        kept_(programs.kept ? programs.kept : std::make_shared<Kept>()),
        tiling_(options.window, options.tile_width, options.tile_height),
        paths_end_(programs.shown->module().outputs.size()) {
    const auto& names = programs.shown->module().outputs;
    const auto take_last = [&](const char* name) {
      return paths_end_ > 0 && names[paths_end_ - 1].name == name ? --paths_end_ : nowhere;
    };
    bent_ = take_last(bent_name);
    fine_ = take_last(fine_name);
  }

  RunResult run() {
    const auto start = std::chrono::steady_clock::now();
    RunResult result = compute();
    for (auto& work : works_) kept_->give(std::move(work));
    works_.clear();
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }

 private:
  RunResult compute() {
    // What holds for the whole frame.
    const Program& shown = *programs_.shown;
    FrameState state = host_.state(shown);
    shown.kernel->run_frame(state, status_);
    if (status_.failed_check >= 0) return {RunEnd::failed, status_.failed_check, -1, -1, 0};
    if (status_.cancel) return {RunEnd::cancelled};
    RunStatus unchecked{.outer = &status_};
    const Placed quiet(*programs_.quiet, host_, unchecked);
    if (status_.cancel) return {RunEnd::cancelled};
    const bool anywhere = quiet.samples->anywhere();
    const bool wanted = antialias_.mode == Mode::procedural && programs_.has_paths;
    stored_ = wanted && host_.stored && programs_.conditions.valid();
    procedural_ = wanted && (stored_ || (anywhere && !host_.stored));
    supersample_ = antialias_.mode == Mode::supersample;
    const std::size_t fine = procedural_ && anywhere ? find_fine(*quiet.runner) : nowhere;
    if (fine == nowhere && programs_.has_only_noise) procedural_ = false;
    smooths_ = smooths(anywhere);
    if (smooths_) smoothing_ = smoothing_of(antialias_.filter);
    apron_ = procedural_ ? apron_of(antialias_.filter) : smooths_ ? 1 : 0;

    std::optional<Refiner> all;
    if (supersample_)
      all.emplace(*quiet.runner, nullptr, antialias_, patterns(), programs_.outputs,
                  programs_.courses);
    BatchPlan plan;
    plan.batches = tiling_.count();
    plan.capacity =
        (std::min(options_.tile_width, options_.window.width()) + 2 * apron_) *
        std::int64_t{std::min(options_.tile_height, options_.window.height()) + 2 * apron_};
    plan.count = [&](std::int64_t tile) { return size_of(area(tile)); };
    plan.fill = [&](std::int64_t tile, std::span<float* const> planes) {
      const Rect rect = area(tile);
      source_({rect, size_of(rect), planes});
      if (stored_) extend_stored(rect, *host_.stored, planes);
    };
    // What tells objects apart, where the program or its source has it.
    const auto& inputs_of = shown.module().inputs;
    const auto id = std::ranges::find_if(inputs_of, [](const ir::Input& input) {
      return input.name == "id" && input.rate == ir::Rate::sample;
    });
    plan.compute = [&](std::int64_t number, std::span<float* const> inputs,
                       std::span<float* const> outputs, Scratch& scratch, RunStatus& status) {
      const Rect around = area(number);
      if (programs_.quiet != programs_.shown && apron_ > 0) {
        run_checks(state, number, inputs, status);
        if (status.failed_check >= 0 || status.cancel) return;
        run_tile(*programs_.quiet, quiet.state, status, scratch, inputs, outputs, around.width(),
                 around.height());
      } else {
        run_tile(shown, state, status, scratch, inputs, outputs, around.width(), around.height());
      }
      if (status.failed_check >= 0 || status.cancel) return;
      Tile tile{tiling_.rect(number), area(number), outputs.first(paths_end_), programs_.outputs};
      if (fine != nowhere) tile.fine = outputs[fine];
      if (bent_ != nowhere && !stored_) tile.bent = outputs[bent_];
      if (id != inputs_of.end())
        tile.ids = inputs[static_cast<std::size_t>(id - inputs_of.begin())];
      if (!supersample_ && apron_ == 0) return;
      const Borrowed work(*this);
      if (supersample_) return put(tile, all->supersample(pixels_of(tile.rect), *work, status));
      Counts counts;
      std::optional<Refined> refined;
      if (!procedural_) {
        refined.emplace(std::vector<Pixel>(), programs_.outputs);
      } else if (stored_) {
        if (const StoredRefiner* refiner = conditions())
          refined = refiner->refine(tile, inputs, status, counts);
      } else if (const Refiner* refiner = edges()) {
        refined = refiner->refine(tile, *work, status, counts);
      }
      if (!refined) return;
      cut_apron(tile);
      put({tile.rect, tile.rect, outputs, programs_.outputs}, *refined);
      const std::lock_guard lock(mutex_);
      counts_ += counts;
    };
    plan.drain = [&](std::int64_t number, std::span<float* const> planes) {
      const Rect rect = tiling_.rect(number);
      sink_({rect, size_of(rect), planes});
    };
    plan.ordered = options_.ordered_sink;
    plan.memory_limit = options_.memory_limit;
    plan.threads = options_.threads;
    plan.progress = options_.progress;
    quiet_ = &quiet;
    const BatchEnd end = run_batches(shown, state, plan, status_);

    RunResult result{end.end, end.failed_check, 0, 0, 0};
    if (end.end == RunEnd::failed) {
      const Rect rect = tiling_.rect(end.failed_batch);
      result.x = rect.x0 + static_cast<int>(end.failed_sample % rect.width());
      result.y = rect.y0 + static_cast<int>(end.failed_sample / rect.width());
    }
    return result;
  }

  // The output that tells where noise is fine; nowhere if there is none, or if it is the same in
  // all of the picture and not fine.
  std::size_t find_fine(const PlaceRunner& runner) const {
    if (fine_ == nowhere || programs_.has_untold_noise) return fine_;
    const ir::Function& main = programs_.quiet->module().main();
    if (main.values[main.body.yields[fine_]].rate == ir::Rate::sample) return fine_;
    Work work;
    work.places.resize(1);
    work.places.x[0] = options_.window.x0 + 0.5, work.places.y[0] = options_.window.y0 + 0.5;
    RunStatus unchecked{.outer = &status_};
    return runner.run(work, unchecked)[fine_][0] > least_move_squared ? fine_ : nowhere;
  }

  // The program with its checks on the tile alone: what is outside of the picture cannot fail.
  void run_checks(const FrameState& state, std::int64_t number, std::span<float* const> inputs,
                  RunStatus& status) const {
    std::vector<bool> used;
    for (const float* plane : inputs) used.push_back(plane != nullptr);
    const Rect rect = tiling_.rect(number), around = area(number);
    const Planes in(used, size_of(rect));
    const Planes out(std::vector<bool>(programs_.shown->module().outputs.size(), true),
                     size_of(rect));
    const Tile tile{rect, around, {}, 0};
    for (std::size_t p = 0; p < inputs.size(); ++p) {
      if (inputs[p] == nullptr) continue;
      float* to = in.pointers()[p];
      for (int y = rect.y0; y < rect.y1; ++y, to += rect.width())
        std::copy_n(inputs[p] + tile.at(rect.x0, y), rect.width(), to);
    }
    Scratch scratch;
    programs_.shown->kernel->run_samples(state, status, scratch, in.pointers().data(),
                                         out.pointers().data(), size_of(rect));
  }

  // A tile with its apron.
  Rect area(std::int64_t number) const {
    const Rect rect = tiling_.rect(number);
    return {rect.x0 - apron_, rect.y0 - apron_, rect.x1 + apron_, rect.y1 + apron_};
  }

  // The first tile with an edge waits for its program; null when the run is cancelled meanwhile.
  const Refiner* edges() {
    std::call_once(once_, [&] {
      const PlaceRunner* edges = nullptr;
      if (programs_.edges.valid()) {
        while (programs_.edges.wait_for(std::chrono::milliseconds(5)) ==
               std::future_status::timeout)
          if (status_.cancel) return;
        const auto& program = programs_.edges.get();
        if (!program) throw std::runtime_error(program.error());
        RunStatus unchecked{.outer = &status_};
        edge_program_.emplace(**program, host_, unchecked);
        edges = &*edge_program_->runner;
      }
      refiner_.emplace(*quiet_->runner, edges, antialias_, patterns(), programs_.outputs,
                       programs_.courses);
    });
    return refiner_ && !status_.cancel ? &*refiner_ : nullptr;
  }

  // Likewise where samples are stored.
  const StoredRefiner* conditions() {
    std::call_once(once_, [&] {
      while (programs_.conditions.wait_for(std::chrono::milliseconds(5)) ==
             std::future_status::timeout)
        if (status_.cancel) return;
      const auto& program = programs_.conditions.get();
      if (!program) throw std::runtime_error(program.error());
      open_state_ = host_.state(**program);
      RunStatus unchecked{.outer = &status_};
      (*program)->kernel->run_frame(*open_state_, unchecked);
      stored_refiner_.emplace(**program, *open_state_, *programs_.shown, antialias_,
                              programs_.outputs, *host_.stored);
    });
    return stored_refiner_ && !status_.cancel ? &*stored_refiner_ : nullptr;
  }

  // Asked for once at most.
  const Patterns& patterns() {
    patterns_ = kept_->patterns(antialias_.filter, static_cast<std::uint32_t>(antialias_.samples));
    return *patterns_;
  }

  static std::vector<Pixel> pixels_of(const Rect& rect) {
    std::vector<Pixel> pixels;
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x) pixels.push_back({x, y});
    return pixels;
  }

  // Into a tile that is smooth already.
  void put(const Tile& tile, const Refined& refined) const {
    for (std::size_t o = 0; o < tile.outputs; ++o) {
      const std::size_t last = is_smooth(o) ? std::min(refined.first_mean, refined.pixels.size())
                                            : refined.pixels.size();
      const auto at = [&](std::size_t i) -> float& {
        return tile.planes[o][tile.at(refined.pixels[i].x, refined.pixels[i].y)];
      };
      for (std::size_t i = 0; i < last; ++i) at(i) = refined.values[o][i];
      const auto all = static_cast<float>(refined.samples + 1);
      for (std::size_t i = last; i < refined.pixels.size(); ++i) {
        const float mean = refined.values[o][i], apart = at(i) - mean;
        at(i) = std::isfinite(apart) ? mean + apart / all : mean;
      }
    }
  }
  bool is_smooth(std::size_t output) const {
    return smooths_ && programs_.courses[output] == Course::bent;
  }

  // Whether some output is to be smoothed. Stored pixels are left as they are.
  bool smooths(bool anywhere) const {
    return antialias_.mode == Mode::procedural && antialias_.smooth && anywhere && !host_.stored &&
           std::ranges::find(programs_.courses, Course::bent) != programs_.courses.end();
  }

  // Moves the tile's rows together, smooth where that is wanted.
  void cut_apron(const Tile& tile) const {
    std::vector<float*> bent;
    bent.reserve(programs_.outputs);
    for (std::size_t o = 0; o < programs_.outputs; ++o) {
      float* to = tile.planes[o];
      if (is_smooth(o)) {
        bent.push_back(to);
        continue;
      }
      for (int y = tile.rect.y0; y < tile.rect.y1; ++y, to += tile.rect.width()) {
        const float* from = tile.planes[o] + tile.at(tile.rect.x0, y);
        std::copy(from, from + tile.rect.width(), to);
      }
    }
    if (!bent.empty()) steps().smooth(tile, smoothing_, bent);
  }

  // A thread's memory for one tile; it goes back to the others then.
  class Borrowed {
   public:
    explicit Borrowed(Execution& from) : from_(from) {
      const std::lock_guard lock(from.mutex_);
      if (from.works_.empty()) {
        work_ = from.kept_->take();
      } else {
        work_ = std::move(from.works_.back());
        from.works_.pop_back();
      }
    }
    ~Borrowed() {
      const std::lock_guard lock(from_.mutex_);
      from_.works_.push_back(std::move(work_));
    }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;
    Work& operator*() const { return *work_; }

   private:
    Execution& from_;
    std::unique_ptr<Work> work_;
  };

  const Programs& programs_;
  const Host& host_;
  const Options& antialias_;
  const TileSource& source_;
  const TileSink& sink_;
  const ExecuteOptions& options_;
  RunStatus& status_;
  Counts& counts_;
  const std::shared_ptr<Kept> kept_;
  const Tiling tiling_;
  static constexpr auto nowhere = static_cast<std::size_t>(-1);
  std::size_t paths_end_;  // outputs before this are the program's own, their path and ends
  std::size_t fine_ = nowhere, bent_ = nowhere;  // outputs of path.h, if there are any
  int apron_ = 0;
  bool procedural_ = false, supersample_ = false, stored_ = false, smooths_ = false;
  Smoothing smoothing_;
  std::shared_ptr<const Patterns> patterns_;
  const Placed* quiet_ = nullptr;
  std::once_flag once_;
  std::optional<Placed> edge_program_;
  std::optional<Refiner> refiner_;
  std::optional<FrameState> open_state_;
  std::optional<StoredRefiner> stored_refiner_;
  std::vector<std::unique_ptr<Work>> works_;  // those that are not in use
  std::mutex mutex_;                          // of counts_ and works_
};

}  // namespace

RunResult execute(const Programs& programs, const Host& host, const Options& antialias,
                  const TileSource& source, const TileSink& sink, const ExecuteOptions& options,
                  RunStatus& status, Counts& counts) {
  return Execution(programs, host, antialias, source, sink, options, status, counts).run();
}

}  // namespace pse::antialias
