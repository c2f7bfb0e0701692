// From the bytes of the code to a kernel.
#include "codegen/first/first_kernel.h"

#include "codegen/first/kernel_code.h"
#include "codegen/target.h"

namespace pse {

bool has_first_tier() {
  const Target* target = host_target();
  return target != nullptr && target->avx2;
}

std::expected<std::unique_ptr<Kernel>, std::string> first_kernel(
    const passes::SplitModule& split, std::unique_ptr<const FrameCode> frame) {
  if (!has_first_tier()) return std::unexpected(std::string("a processor without AVX2"));
  auto code = first::write_kernel(split);
  if (!code) return std::unexpected(code.error());
  auto pages = CodeObject::from_code(std::as_bytes(std::span(code->bytes)), samples_symbol);
  if (!pages) return std::unexpected(pages.error());
  return CompiledKernel::make(split, std::move(*pages), first::lanes, std::move(frame),
                              static_cast<std::size_t>(code->frame_floats));
}

}  // namespace pse
