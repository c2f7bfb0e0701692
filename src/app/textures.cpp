// Binding the externals "texture LAYER FILTER WRAP FILE" (lower/intrinsics.cpp) to loaded textures.
#include "app/textures.h"

#include <filesystem>

#include "app/input_images.h"

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
  if (word() != "texture")
    throw Failure(Exit::running, "the program calls something that is no texture");
  TextureName parts;
  parts.layer = word();
  parts.filter = word();
  parts.wrap = word();
  parts.file = std::string(name);
  return parts;
}

}  // namespace

Textures::Textures(const Session& session, const std::string& program_path,
                   image::ColourSpace working) {
  namespace fs = std::filesystem;
  const fs::path beside = program_path == "-" ? fs::path() : fs::path(program_path).parent_path();
  resolve_ = [&session, beside](const std::string& file) {
    std::error_code error;
    if (fs::path(file).is_relative() && fs::exists(beside / file, error))
      return (beside / file).string();
    return session.find_file(file);
  };
  image::ReadOptions options;
  options.working = working;
  cache_ = std::make_shared<image::TextureCache>(options, resolve_);
}

void Textures::answer(LowerHost& host) const {
  host.texture_components = [cache = cache_](const std::string& file, const std::string& layer,
                                             std::string& error) {
    const auto components = cache->components(file, layer);
    if (!components) error = components.error().message;
    return components.value_or(0);
  };
}

void Textures::load(const ir::Module& module) {
  for (const ir::External& external : module.externals) {
    if (!external.name.starts_with("texture ")) {
      calls_.push_back(nullptr);  // somebody else binds it
      continue;
    }
    const TextureName name = parse_name(external.name);
    const auto texture = cache_->load(name.file, name.layer);
    if (!texture) throw Failure(Exit::input, texture.error().message);
    calls_.push_back(std::make_unique<image::TextureCall>(image::TextureCall{
        *texture, image::filter_from_name(name.filter).value_or(image::Filter::linear),
        image::wrap_from_name(name.wrap).value_or(image::Wrap::repeat), external.arguments > 2}));
    identities_.emplace_back(name.file, file_identity(resolve_(name.file)));
  }
}

std::vector<ExternalFunction> Textures::functions() const {
  std::vector<ExternalFunction> functions;
  for (const auto& call : calls_)
    functions.push_back(call ? ExternalFunction{&image::TextureCall::run, call.get()}
                             : ExternalFunction{});
  return functions;
}

}  // namespace pse::app
