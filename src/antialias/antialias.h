// Procedural antialiasing (2002 chapter, "Antialiased rendering of procedural textures"): a program
// run over a picture with clean edges at about one sample per pixel. The table of contents:
//
//   decisions  where the program's conditionals are, and what has none and jumps (seams); loops
//              that march (searches); what is chance and none of them (dither); what decides for
//              one branch alone (sink)
//   path       the program with one more output: which way each sample takes; and where it marches
//              by a loop, one of what that ended with
//   fine       noise that is finer than a pixel
//   forms      how each value changes with the place between two edges: linearly, bent (asked by
//              bent and courses)
//   bent       edges that may lie between the samples, unseen
//   derive     the program that gives the edges around a sample (rules, activity, rotate,
//              edge_state)
//   programs   compiling both
//   tile       neighbours with different paths, across which the picture jumps
//   refine     one edge: both sides and the kernel's share (filter); edges that bend within
//              the kernel (circles, filter_circle); more: supersample (spread)
//   steps      what is done for many pixels at once, compiled for each kind of processor
//              (neighbours, fine_steps, smooth_steps, crossing_steps, sample_steps)
//   smooth     the mean of what bends between edges, from neighbouring samples; of outputs that
//              bend (courses)
//   places     running a program anywhere (stream/sample_source.h)
//   kept       what a picture leaves for the next one
//   stored     where samples are known at pixels only: conditions laid open (force), their values
//              fitted to neighbours (fit)
//
// A pixel's whole path is bifurcated, not each conditional by itself: for one edge under the kernel
// that is the chapter's LERP, and what follows the conditional need not be linear.
#pragma once

#include <functional>
#include <optional>

#include "antialias/refine.h"

namespace pse::antialias {

// How to run a program of a Programs: its state, with uniforms of knobs and frame names and
// externals set, and its sample-rate inputs anywhere.
struct Host {
  std::function<FrameState(const Program&)> state;
  std::function<std::unique_ptr<SampleSource>(const ir::Module&)> samples;
  // Where samples are known at pixels only: the pixels of the picture.
  std::optional<Rect> stored = {};
};

// As pse::execute() of programs.shown, whose state the host makes; `source` fills the tiles of
// `options.window` and, where samples are known anywhere, up to 2 pixels around it. The sink gets
// the planes of the program's own outputs, then up to four without meaning where there are paths.
// Programs without paths are smoothed too.
// The result does not depend on tile size, threads or vector width.
RunResult execute(const Programs& programs, const Host& host, const Options& antialias,
                  const TileSource& source, const TileSink& sink, const ExecuteOptions& options,
                  RunStatus& status, Counts& counts);

}  // namespace pse::antialias
