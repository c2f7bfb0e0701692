// Our side of the border to the OpenColorIO module; see ocio.h.
#include "image/ocio.h"

#include "image/module_loader.h"

namespace pse::image {

Result<std::shared_ptr<const OcioView>> open_ocio_view(ColourSpace working,
                                                       const OcioChoice& choice) {
  static const Result<OcioViews*> views = []() -> Result<OcioViews*> {
    const auto entry = load_module("pse_ocio", ocio_views_entry);
    if (!entry) return std::unexpected(entry.error());
    return reinterpret_cast<OcioViewsEntry>(*entry)();
  }();
  if (!views) return std::unexpected(views.error());
  std::string error;
  bool unknown = false;
  std::shared_ptr<const OcioView> made((*views)->create(working, choice, error, unknown));
  if (!made) return fail(unknown ? ErrorKind::bad_request : ErrorKind::cannot_read, error);
  return made;
}

}  // namespace pse::image
