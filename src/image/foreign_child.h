// A ForeignReader in a process of its own: OpenImageIO's readers of the rarer formats end the
// process they are in when a damaged file contradicts what they take for granted.
#pragma once

#include <functional>

#include "image/foreign.h"

namespace pse::image {

// `open` runs in the child and gives its reader; its file is known to have `bytes`. Null, with a
// sentence, where it gives none, breaks down, or takes too long.
std::unique_ptr<ForeignReader> open_in_child(
    const std::function<std::unique_ptr<ForeignReader>(std::string& error)>& open,
    std::uint64_t bytes, std::string& error);

}  // namespace pse::image
