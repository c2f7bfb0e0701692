// The option table as manual pages.
#pragma once

#include <string>

#include "app/option_table.h"

namespace pse::app {

// The page pse-COMMAND(1) in the format of man. `date` stands in its foot, for example
// "2026-11-22".
std::string man_page(const CommandSpec& command, const std::string& date);
// The page pse(1).
std::string overview_man_page(const std::string& date);

}  // namespace pse::app
