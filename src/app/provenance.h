// What a picture was made from: stored in the file as pse/... attributes, and the recipe that
// --resume compares.
#pragma once

#include <map>
#include <string>

#include "app/input_images.h"
#include "app/output_plan.h"
#include "stream/program.h"

namespace pse::app {

struct RenderContext {
  const RenderOptions& options;
  const SourceMap& sources;
  FileId file;
  const Program& program;
  const std::vector<Knob>& knobs;  // with their final values
  const ImagePlane& plane;         // with the frame
  const Rect& window;
  std::vector<std::pair<std::string, std::string>> inputs;  // files read, with their identities
};

// A hash of everything that decides the pixels of `file`, and of how they are stored.
std::string recipe(const RenderContext& context, const PlannedFile& file);

// The attributes to store. The recipe differs from file to file and is added by the caller.
std::map<std::string, std::string> provenance(const RenderContext& context);

inline constexpr const char* recipe_attribute = "pse/recipe";

// Whether `name` exists and was made by this recipe.
bool is_done(const std::string& name, const std::string& recipe);

}  // namespace pse::app
