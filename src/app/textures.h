// What is stored and looked up while a program runs: pictures with texture(), volumes with
// volume().
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/session.h"
#include "codegen/kernel.h"
#include "diag/diagnostics.h"
#include "image/error.h"
#include "image/texture.h"
#include "lower/lower.h"
#include "volume/volume.h"

namespace pse::app {

class Textures {
 public:
  // Files are looked for as named, beside the program, and on the search path.
  Textures(const Session& session, const std::string& program_path, image::ColourSpace working);

  // Lets the lowering ask for the components of textures and volumes.
  void answer(LowerHost& host) const;
  // Loads what the module calls. Returns errors of code "texture" or "volume", each at a call of
  // what cannot be read; with one, the module must not run.
  Diagnostics load(const ir::Module& module);
  // What the module's externals are bound to; valid as long as this object.
  std::vector<ExternalFunction> functions() const { return functions_; }
  // Files loaded, with their identities.
  std::vector<std::pair<std::string, std::string>> identities() const { return identities_; }

 private:
  image::Result<ExternalFunction> bind_texture(const ir::External& external);
  image::Result<ExternalFunction> bind_volume(const ir::External& external);

  std::shared_ptr<image::TextureCache> cache_;
  std::shared_ptr<volume::VolumeCache> volumes_;
  std::function<std::string(const std::string&)> resolve_;
  std::vector<std::unique_ptr<image::TextureCall>> texture_calls_;
  std::vector<std::unique_ptr<volume::VolumeCall>> volume_calls_;
  std::vector<ExternalFunction> functions_;  // one per external of the module
  std::vector<std::pair<std::string, std::string>> identities_;
};

}  // namespace pse::app
