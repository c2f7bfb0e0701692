// Tiles are filled once; a run is the kernel alone.
#include "pictures.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "stream/image_plane.h"

namespace pse::bench {
namespace {

// Floats between the starts of planes: whole vectors, and no two planes at the same address modulo
// 4096.
constexpr std::size_t plane_stride = 64 * 64 + 48;

std::string read_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

}  // namespace

Picture::Picture(const std::string& name, int size, int width, const std::string& cpu) {
  SourceMap sources;
  Diagnostics diagnostics;
  CompileOptions options;
  options.lower.stream = image_plane_names();
  options.lower.outputs = {"color"};
  options.codegen.width = width;
  options.codegen.cpu = cpu;
  const FileId file = sources.add(name, read_file(PSE_GALLERY "/measure/" + name + ".pse"));
  program_ = compile(sources, file, {}, options, diagnostics);
  if (!program_) {
    std::fprintf(stderr, "%s", print_text(diagnostics, sources, false).c_str());
    std::exit(1);
  }

  const ir::Module& module = program_->module();
  const ImagePlane plane{.width = size, .height = size};
  set_plane_uniforms(module, plane, state_);
  for (const Knob& knob : program_->knobs) {
    for (std::size_t i = 0; i < module.inputs.size(); ++i) {
      if (knob.value.size() == 1 && module.inputs[i].name == knob.name)
        state_.uniforms[i] = knob.value[0];
    }
  }
  RunStatus status;
  program_->kernel->run_frame(state_, status);

  // All tiles of a small picture; of a large one every fourth in both directions.
  const int step = size <= 512 ? tile_size : 4 * tile_size;
  const TileSource source = image_plane_source(module, plane, {0, 0, size, size});
  for (int y = step - tile_size; y < size; y += step) {
    for (int x = step - tile_size; x < size; x += step) {
      Tile& tile = tiles_.emplace_back();
      tile.inputs.resize(plane_stride * module.inputs.size());
      tile.outputs.resize(plane_stride * module.outputs.size());
      std::vector<float*> filled;
      for (std::size_t i = 0; i < module.inputs.size(); ++i)
        filled.push_back(tile.inputs.data() + plane_stride * i);
      for (std::size_t i = 0; i < module.outputs.size(); ++i)
        tile.out.push_back(tile.outputs.data() + plane_stride * i);
      tile.in.assign(filled.begin(), filled.end());
      source({{x, y, x + tile_size, y + tile_size}, tile_samples, filled});
    }
  }
}

void Picture::run() {
  RunStatus status;
  for (Tile& tile : tiles_) {
    program_->kernel->run_samples(state_, status, scratch_, tile.in.data(), tile.out.data(),
                                  tile_samples);
  }
}

bool Picture::agrees_with_interpreter() const {
  const auto interpreter = make_interpreted_kernel(program_->split);
  const ir::Module& module = program_->module();
  RunStatus status;
  Scratch scratch;
  for (const Tile& tile : tiles_) {
    // One row of pixels from the middle of each tile.
    constexpr std::ptrdiff_t first = tile_size * (tile_size / 2);
    std::vector<const float*> in;
    for (const float* plane : tile.in) in.push_back(plane + first);
    std::vector<std::vector<float>> results(module.outputs.size(), std::vector<float>(tile_size));
    std::vector<float*> out;
    for (auto& result : results) out.push_back(result.data());
    interpreter->run_samples(state_, status, scratch, in.data(), out.data(), tile_size);
    for (std::size_t o = 0; o < results.size(); ++o) {
      if (std::memcmp(results[o].data(), tile.out[o] + first, sizeof(float) * tile_size) != 0)
        return false;
    }
  }
  return true;
}

}  // namespace pse::bench
