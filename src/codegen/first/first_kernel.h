// The first tier as a Kernel: native code at once, of about half the speed of LLVM's. The same
// bits. Between kernel_code.cpp and whoever runs kernels; tiered_kernel.cpp runs it until LLVM is
// done.
#pragma once

#include <expected>
#include <memory>
#include <string>

#include "codegen/compiled_kernel.h"

namespace pse {

// Whether this processor runs the first tier's code.
bool has_first_tier();

// `frame` runs the frame function. The error says why there is no first tier for this program or
// this processor; it is no error of the user's.
std::expected<std::unique_ptr<Kernel>, std::string> first_kernel(
    const passes::SplitModule& split, std::unique_ptr<const FrameCode> frame);

}  // namespace pse
