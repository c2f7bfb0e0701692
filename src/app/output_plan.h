// Which of a program's variables go into which file, as which channels.
#pragma once

#include "app/render_options.h"
#include "image/layers.h"
#include "image/movie.h"
#include "lang/ast.h"
#include "stream/program.h"

namespace pse::app {

struct PlannedChannel {
  image::Channel channel;
  std::size_t output = 0;  // index of Module::outputs
};

struct PlannedFile {
  std::string pattern;
  image::WriteOptions write;
  std::vector<PlannedChannel> channels;

  bool is_film() const { return image::is_movie_name(pattern); }
};

// The variables to compute, for LowerOptions::outputs; empty: all of them.
std::vector<std::string> wanted_variables(const RenderOptions& options, const lang::Program& tree);

// Throws Failure (usage) where an output asks for a variable that the program does not set.
std::vector<PlannedFile> plan_outputs(const RenderOptions& options, const Program& program);

}  // namespace pse::app
