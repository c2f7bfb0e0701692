// The arguments of `pse render`, understood.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "antialias/programs.h"
#include "app/session.h"
#include "app/values.h"
#include "image/nan_policy.h"
#include "image/splat.h"
#include "image/writer.h"
#include "stream/image_plane.h"

namespace pse::app {

// `fg=ball.%04d.exr`, or a bare name.
struct ImageRequest {
  std::string name;  // empty: its channels are bare names
  std::string file;  // may be a pattern
  bool derived = false;  // made by this run from what it already has: no input of the user's
};

// `--rule stars.z=nearest`, or `--rule stars=max` for all of its columns.
struct InsertRule {
  std::string name, rule_name;
  image::Rule rule = image::Rule::sum;
};

// `-o out.exr`, `-o heat=heat.exr`, `-o N,P=data.exr`.
struct OutputRequest {
  std::vector<std::string> variables;  // empty: what the format usually holds
  std::string file;                    // may be a pattern; "-" is standard output
};

struct RenderOptions {
  std::string program;
  std::vector<ImageRequest> images;
  std::vector<ImageRequest> insertions;  // --insert: tables spread over the picture
  std::vector<InsertRule> rules;         // --rule: how their rows meet in a pixel
  std::vector<std::string> knob_words;  // Name=VALUE
  std::vector<OutputRequest> outputs;

  std::vector<int> frames;  // empty: not given
  std::optional<Resolution> resolution;
  std::optional<OptionValue> clip;
  std::optional<PlaneTransform> transform;
  double fps = 24;
  std::uint32_t seed = 0;

  bool trace = false;  // `pse trace`: surfaces themselves are the picture
  std::string on;      // --on: one shape or mesh
  std::string camera;  // --camera
  std::string scene;   // --scene, or the program where its name ends in .toml

  antialias::Options antialias;
  std::string antialias_text = "procedural", filter_text = "cubic";  // as given, for the recipe

  int prepass = 0;                 // of how many pixels and steps one is looked at first; 0: none
  std::string prepass_image;       // where what was found is kept; empty: nowhere
  bool count_evaluations = false;  // --stats
  std::optional<std::pair<int, double>> slice;  // axis and place of a z-slice

  int threads = 0, tile = 0, width = 0;
  bool interpret = false, optimize = true, cache = true;
  Tier tier = Tier::automatic;

  image::WriteOptions write;
  std::optional<image::PixelType> storage;  // --half, --float
  image::NanPolicy nan = image::NanPolicy::keep;
  bool resume = false, provenance = true;
};

// Throws Failure (usage).
RenderOptions render_options(const Session& session);

}  // namespace pse::app
