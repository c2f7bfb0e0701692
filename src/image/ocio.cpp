// Our side of the border to the OpenColorIO module; see ocio.h.
#include "image/ocio.h"

#include "image/module_loader.h"

namespace pse::image {

Result<std::shared_ptr<const OcioView>> open_ocio_view(ColourSpace working,
                                                       const std::string& name) {
  static const Result<OcioViews*> views = []() -> Result<OcioViews*> {
    const auto entry = load_module("pse_ocio", ocio_views_entry);
    if (!entry) return std::unexpected(entry.error());
    return reinterpret_cast<OcioViewsEntry>(*entry)();
  }();
  if (!views) return fail(ErrorKind::cannot_write, views.error().message);
  const auto slash = name.find('/');
  const std::string display = slash == std::string::npos ? "" : name.substr(0, slash);
  const std::string view = slash == std::string::npos ? name : name.substr(slash + 1);
  std::string error;
  std::shared_ptr<const OcioView> made((*views)->create(working, display, view, error));
  if (!made)
    return fail(ErrorKind::cannot_write, "the colour configuration cannot be used: " + error);
  return made;
}

}  // namespace pse::image
