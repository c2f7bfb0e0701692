// The programs that antialiasing runs in place of one: the program with its paths, and its edges.
#pragma once

#include <future>

#include "antialias/courses.h"
#include "antialias/derive.h"
#include "antialias/filter.h"
#include "stream/program.h"

namespace pse::antialias {

class Kept;  // kept.h

enum class Mode : std::uint8_t {
  none,         // one sample in the middle of each pixel
  procedural,   // edges found in the program; more samples only where that is not enough
  supersample,  // the same number of samples for each pixel
};

struct Options {
  Mode mode = Mode::procedural;
  // Of a pixel that is supersampled; within objects the procedural mode takes half as many.
  int samples = 64;
  Filter filter = Filter();
  bool smooth = true;  // in the procedural mode: what bends between edges too (smooth.h)
};

struct Programs {
  // The program. With paths, "$path" and what else path.h adds stand behind `outputs` of its own.
  std::shared_ptr<const Program> shown;
  // The same without checks: for samples at places that the user has not asked for.
  std::shared_ptr<const Program> quiet;
  std::size_t outputs = 0;
  std::vector<Course> courses;  // of these outputs; none: nothing is smoothed
  // Its edges (antialias/derive.h), compiled meanwhile; not valid where the program has no jumps:
  // paths then tell objects apart, or where noise is fine.
  using Result = std::expected<std::shared_ptr<const Program>, std::string>;
  std::shared_future<Result> edges;
  // The program with its conditions laid open (antialias/force.h), compiled when it is asked for.
  std::shared_future<Result> conditions;
  bool has_paths = false;
  // Paths are there for noise that may be finer than a pixel (fine.h), and for nothing else.
  bool has_only_noise = false;
  // How fine some of it is is not told (Noises::others).
  bool has_untold_noise = false;
  // From picture to picture; null: nothing is.
  std::shared_ptr<Kept> kept;
};

// What becomes of a program's expectations (ir/expectations.h): reported by the host, which binds
// their externals, at the pixels' centres at least; or dropped.
enum class Expectations : std::uint8_t { dropped, reported };

// `changes`: what is known of the samples that the programs will run on; `filter`: the kernel whose
// reach unseen edges are looked for in, if it is above a pixel's. The error is a sentence for the
// user.
std::expected<Programs, std::string> compile_programs(
    CompiledFront front, const CompileOptions& options, Mode mode,
    const InputChanges& changes = unknown_changes, const Filter& filter = Filter(),
    Expectations expectations = Expectations::dropped);

// What the kernels of all of them say.
TierSamples tier_samples(const Programs& programs);

}  // namespace pse::antialias
