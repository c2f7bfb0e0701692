// Display transforms from an OpenColorIO configuration ($OCIO), through a shared module that is
// opened on demand (modules/ocio.cpp).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "image/colour.h"
#include "image/error.h"

namespace pse::image {

// What crosses the border to the module: pure virtual functions.
struct OcioView {
  virtual ~OcioView() = default;
  // In place, interleaved R G B: from the working space to what the display is sent.
  virtual void apply(float* colours, std::int64_t count) const = 0;
};
struct OcioViews {
  virtual ~OcioViews() = default;
  virtual OcioView* create(ColourSpace working, const std::string& display, const std::string& view,
                           std::string& error) = 0;
};
using OcioViewsEntry = OcioViews* (*)();
inline constexpr const char* ocio_views_entry = "pse_ocio_views";

// `name` is "view" or "display/view"; empty: the configuration's default.
Result<std::shared_ptr<const OcioView>> open_ocio_view(ColourSpace working,
                                                       const std::string& name);

}  // namespace pse::image
