// Display transforms from an OpenColorIO configuration ($OCIO), through a shared module that is
// opened on demand (modules/ocio.cpp).
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "image/colour.h"
#include "image/error.h"

namespace pse::image {

// A view of a display, by the configuration's names; empty: its default.
struct OcioChoice {
  std::string display, view;
  friend bool operator==(const OcioChoice&, const OcioChoice&) = default;
};

// What crosses the border to the module: pure virtual functions.
struct OcioView {
  virtual ~OcioView() = default;
  // In place, interleaved R G B: from the working space to what the display is sent.
  virtual void apply(float* colours, std::int64_t count) const = 0;
};
struct OcioViews {
  virtual ~OcioViews() = default;
  // Null, with a sentence, when there is none; `unknown`: because the configuration has no such
  // name.
  virtual OcioView* create(ColourSpace working, const OcioChoice& choice, std::string& error,
                           bool& unknown) = 0;
};
using OcioViewsEntry = OcioViews* (*)();
inline constexpr const char* ocio_views_entry = "pse_ocio_views";

// The error is bad_request for a name that the configuration does not have, and lists those that it
// has; cannot_read when there is no configuration to be read; unsupported without OpenColorIO.
Result<std::shared_ptr<const OcioView>> open_ocio_view(ColourSpace working,
                                                       const OcioChoice& choice);

}  // namespace pse::image
