// Binding the externals "texture LAYER FILTER WRAP FILE" (lower/intrinsics.cpp) and "volume LENGTH
// GRID FILE" (lower/intrinsic_volume.cpp) to what they name.
#include "app/textures.h"

#include <filesystem>
#include <sstream>

#include "app/input_images.h"
#include "image/sequence.h"

namespace pse::app {
namespace {

struct TextureName {
  std::string layer, filter, wrap, file;
};

// Takes the words of an external's name apart; the file is the rest and may hold spaces.
TextureName parse_name(std::string_view name) {
  const auto word = [&] {
    const std::size_t end = std::min(name.find(' '), name.size());
    const std::string text(name.substr(0, end));
    name.remove_prefix(std::min(name.size(), end + 1));
    return text;
  };
  word();  // "texture"
  TextureName parts;
  parts.layer = word();
  parts.filter = word();
  parts.wrap = word();
  parts.file = std::string(name);
  return parts;
}

// Where the first call of an external is written; invalid where none is left.
Span call_in(const ir::Region& region, std::int32_t external) {
  for (const ir::Instruction& in : region.body) {
    if (in.op == ir::Op::external && in.imm == external) return in.span;
    for (const ir::Region& inner : in.regions)
      if (const Span span = call_in(inner, external); span.valid()) return span;
  }
  return {};
}

Span call_of(const ir::Module& module, std::int32_t external) {
  for (const ir::Function& function : module.functions)
    if (const Span span = call_in(function.body, external); span.valid()) return span;
  return {};
}

}  // namespace

Textures::Textures(const Session& session, const std::string& program_path,
                   image::ColourSpace working) {
  namespace fs = std::filesystem;
  const fs::path beside = program_path == "-" ? fs::path() : fs::path(program_path).parent_path();
  resolve_ = [&session, beside](const std::string& file) {
    std::error_code error;
    if (fs::path(file).is_relative() &&
        (fs::exists(beside / file, error) ||
         (image::is_pattern(file) && !image::existing_frames((beside / file).string()).empty())))
      return (beside / file).string();
    return session.find_file(file);
  };
  image::ReadOptions options;
  options.working = working;
  cache_ = std::make_shared<image::TextureCache>(options, resolve_);
  volumes_ = std::make_shared<volume::VolumeCache>(resolve_);
}

void Textures::answer(LowerHost& host) const {
  host.texture_components = [cache = cache_](const std::string& file, const std::string& layer,
                                             std::string& error) {
    const auto components = cache->components(file, layer);
    if (!components) error = components.error().message;
    return components.value_or(0);
  };
  host.volume_components = [volumes = volumes_](const std::string& file, const std::string& grid,
                                                std::string& error) {
    const auto components = volumes->components(file, grid);
    if (!components) error = components.error().message;
    return components.value_or(0);
  };
  host.texture_size = [cache = cache_](const std::string& file, std::string& error) {
    const auto size = cache->size(file);
    if (!size) error = size.error().message;
    return size.value_or(std::pair(0, 0));
  };
}

Diagnostics Textures::load(const ir::Module& module) {
  Diagnostics diagnostics;
  for (std::size_t i = 0; i < module.externals.size(); ++i) {
    const ir::External& external = module.externals[i];
    const bool texture = external.name.starts_with("texture ");
    if (!texture && !external.name.starts_with("volume ")) {
      functions_.push_back({});  // somebody else binds it
      continue;
    }
    const auto bound = texture ? bind_texture(external) : bind_volume(external);
    if (!bound)
      diagnostics.error(texture ? "texture" : "volume",
                        call_of(module, static_cast<std::int32_t>(i)), bound.error().message);
    functions_.push_back(bound.value_or(ExternalFunction{}));
  }
  return diagnostics;
}

image::Result<ExternalFunction> Textures::bind_texture(const ir::External& external) {
  const TextureName name = parse_name(external.name);
  const auto texture = cache_->load(name.file, name.layer);
  if (!texture) return std::unexpected(texture.error());
  texture_calls_.push_back(std::make_unique<image::TextureCall>(image::TextureCall{
      *texture, image::filter_from_name(name.filter).value_or(image::Filter::linear),
      image::wrap_from_name(name.wrap).value_or(image::Wrap::repeat), external.arguments > 2}));
  if (const auto ready = (*texture)->prepare(texture_calls_.back()->filter); !ready)
    return std::unexpected(ready.error());
  identities_.emplace_back(name.file, file_identity(resolve_(name.file)));
  return ExternalFunction{&image::TextureCall::run, texture_calls_.back().get()};
}

image::Result<ExternalFunction> Textures::bind_volume(const ir::External& external) {
  std::istringstream words(external.name);
  std::string word, grid, file;
  std::size_t length = 0;
  words >> word >> length;
  grid.resize(length);
  words.get();
  words.read(grid.data(), static_cast<std::streamsize>(length));
  words.get();
  std::getline(words, file, '\0');
  const auto volume = volumes_->load(file, grid);
  if (!volume) return std::unexpected(volume.error());
  volume_calls_.push_back(std::make_unique<volume::VolumeCall>(volume::VolumeCall{*volume}));
  identities_.emplace_back(file, file_identity(resolve_(file)));
  return ExternalFunction{&volume::VolumeCall::run, volume_calls_.back().get()};
}

}  // namespace pse::app
