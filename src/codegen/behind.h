// Work that nobody waits for: LLVM compiling while the first tier already draws. Under
// tiered_kernel.cpp.
#pragma once

#include <functional>

namespace pse {

// Runs `work` on a thread of its own, one piece of work after another. What it uses it must own. At
// the end of the process, work that has begun is waited for, unless the process ends by _Exit.
void run_behind(std::function<void()> work);

}  // namespace pse
