// The version as users see it; CMake's project() holds it.
#pragma once

#include <string_view>

namespace pse::app {

inline constexpr std::string_view version = PSE_VERSION;

}  // namespace pse::app
