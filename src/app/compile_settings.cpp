// From arguments to the compiler's options.
#include "app/compile_settings.h"

#include <cstdlib>
#include <filesystem>

namespace pse::app {
namespace {

namespace fs = std::filesystem;

fs::path cache_folder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  if (cache != nullptr && *cache == '/') return fs::path(cache) / "pse";
  if (home != nullptr && *home == '/') return fs::path(home) / ".cache/pse";
  return {};
}

}  // namespace

CompileOptions compile_settings(const RenderOptions& options,
                                const std::vector<KnobSetting>& settings) {
  CompileOptions compile;
  for (const KnobSetting& setting : settings) {
    // The last setting of a name counts.
    std::erase_if(compile.lower.text_knobs,
                  [&](const auto& knob) { return knob.first == setting.name; });
    compile.lower.text_knobs.emplace_back(setting.name, setting.text);
  }
  compile.codegen.width = options.width;
  compile.codegen.optimize = options.optimize;
  if (options.cache) compile.codegen.cache = cache_folder();
  compile.tier = options.tier;
  compile.interpret = options.interpret;
  compile.optimize = options.optimize;
  return compile;
}

}  // namespace pse::app
