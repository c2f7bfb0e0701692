// The module around OpenColorIO: the only home of that library. Loaded by ocio.cpp, on demand.
#include "image/ocio.h"

#include <OpenColorIO/OpenColorIO.h>

#include <array>
#include <cstdlib>

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

class Views : public OcioViews {
 public:
  OcioView* create(ColourSpace working, const std::string& display, const std::string& view,
                   std::string& error) override {
    try {
      const char* file = std::getenv("OCIO");
      if (file == nullptr || *file == '\0') {
        error = "the environment variable OCIO names no configuration";
        return nullptr;
      }
      const auto config = OCIO::Config::CreateFromFile(file);
      const std::string where = display.empty() ? config->getDefaultDisplay() : display;
      const std::string how = view.empty() ? config->getDefaultView(where.c_str()) : view;
      const auto processor = config->getProcessor(space_in(config, working), where.c_str(),
                                                  how.c_str(), OCIO::TRANSFORM_DIR_FORWARD);
      return new View(processor->getDefaultCPUProcessor());
    } catch (const std::exception& problem) {
      error = problem.what();
      return nullptr;
    }
  }
};

}  // namespace
}  // namespace pse::image

extern "C" pse::image::OcioViews* pse_ocio_views() {
  static pse::image::Views views;
  return &views;
}
