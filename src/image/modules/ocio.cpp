// The module around OpenColorIO: the only home of that library. Loaded by ocio.cpp, on demand.
#include "image/ocio.h"

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <optional>
#include <vector>

namespace pse::image {
namespace {

namespace OCIO = OCIO_NAMESPACE;

// The names under which configurations keep our working spaces; the scene-linear role when none is
// there.
const char* space_in(const OCIO::ConstConfigRcPtr& config, ColourSpace working) {
  constexpr std::array<const char*, 5> rec709 = {"lin_rec709", "Linear Rec.709 (sRGB)", "lin_srgb",
                                                 "lin_rec709_scene", "Utility - Linear - sRGB"};
  constexpr std::array<const char*, 5> acescg = {"ACEScg", "acescg", "ACES - ACEScg", "lin_ap1",
                                                 "lin_ap1_scene"};
  for (const char* name : working == ColourSpace::acescg ? acescg : rec709)
    if (config->getColorSpace(name)) return name;
  return OCIO::ROLE_SCENE_LINEAR;
}

class View : public OcioView {
 public:
  explicit View(OCIO::ConstCPUProcessorRcPtr processor) : processor_(std::move(processor)) {}
  void apply(float* colours, std::int64_t count) const override {
    OCIO::PackedImageDesc image(colours, static_cast<long>(count), 1, 3);
    processor_->apply(image);
  }

 private:
  OCIO::ConstCPUProcessorRcPtr processor_;
};

// `name`, or the default where it is empty; nothing, with the names there are, where it is not
// among them.
std::optional<std::string> pick(const std::string& name, const char* usual,
                                const std::vector<std::string>& known, const std::string& what,
                                std::string& error) {
  if (name.empty()) return usual;
  if (std::find(known.begin(), known.end(), name) != known.end()) return name;
  error = what + " `" + name + "`; it has ";
  for (std::size_t i = 0; i < known.size(); ++i) error += (i > 0 ? ", " : "") + known[i];
  if (known.empty()) error += "none";
  return std::nullopt;
}

class Views : public OcioViews {
 public:
  OcioView* create(ColourSpace working, const OcioChoice& choice, std::string& error,
                   bool& unknown) override {
    const char* file = std::getenv("OCIO");
    if (file == nullptr || *file == '\0') {
      error = "the environment variable OCIO names no OpenColorIO configuration";
      return nullptr;
    }
    const std::string called = std::string("the colour configuration ") + file;
    try {
      const auto config = configuration(file);
      std::vector<std::string> names;
      for (int i = 0; i < config->getNumDisplays(); ++i) names.emplace_back(config->getDisplay(i));
      unknown = true;
      const auto display = pick(choice.display, config->getDefaultDisplay(), names,
                                called + " has no display", error);
      if (!display) return nullptr;
      names.clear();
      for (int i = 0; i < config->getNumViews(display->c_str()); ++i)
        names.emplace_back(config->getView(display->c_str(), i));
      const auto view = pick(choice.view, config->getDefaultView(display->c_str()), names,
                             "the display `" + *display + "` of " + called + " has no view", error);
      if (!view) return nullptr;
      unknown = false;
      const auto processor = config->getProcessor(space_in(config, working), display->c_str(),
                                                  view->c_str(), OCIO::TRANSFORM_DIR_FORWARD);
      return new View(processor->getDefaultCPUProcessor());
    } catch (const std::exception& problem) {
      unknown = false;
      error = called + " cannot be used: " + problem.what();
      return nullptr;
    }
  }

 private:
  // Read once, as every frame of a film asks again; and again when the file has changed.
  OCIO::ConstConfigRcPtr configuration(const std::string& file) {
    std::error_code ignored;
    const auto changed = std::filesystem::last_write_time(file, ignored);
    const std::lock_guard lock(mutex_);
    if (!last_ || file != last_file_ || changed != last_changed_) {
      last_ = OCIO::Config::CreateFromFile(file.c_str());
      last_file_ = file;
      last_changed_ = changed;
    }
    return last_;
  }

  std::mutex mutex_;
  OCIO::ConstConfigRcPtr last_;
  std::string last_file_;
  std::filesystem::file_time_type last_changed_;
};

}  // namespace
}  // namespace pse::image

extern "C" pse::image::OcioViews* pse_ocio_views() {
  static pse::image::Views views;
  return &views;
}
