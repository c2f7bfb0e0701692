// The door to LLVM: a shared module of its own, opened only when a kernel must really be compiled.
// Start-up is a feature: a program whose kernel is cached never loads LLVM
// (docs/decisions/2026-11-22-kernels.md).
#pragma once

#include <expected>
#include <filesystem>
#include <string>

#include "codegen/target.h"
#include "passes/pipeline.h"

namespace pse {

enum class BackendProduct { object, llvm, assembly };
// Which entry points: objects hold one, listings show both.
enum class BackendPart { samples, frame, both };

struct BackendRequest {
  const passes::SplitModule* split = nullptr;
  const Target* target = nullptr;
  int width = 0;
  bool optimize = true;
  BackendProduct product = BackendProduct::object;
  BackendPart part = BackendPart::samples;
  // Large programs are cut into pieces that compile side by side: the functions of piece `piece`.
  int piece = 0, pieces = 1;
};

struct BackendReply {
  std::string bytes;  // a relocatable ELF object, or text
  std::string error;  // empty: none
};

// The one symbol of the module.
inline constexpr const char* backend_symbol = "pse_llvm_compile";
using BackendEntry = void (*)(const BackendRequest*, BackendReply*);

// The module's file, found beside the running program or library, in ../lib/pse, or where it was
// built.
std::filesystem::path backend_path();
// Loads the module ahead of its use; failure shows at the next run_backend().
void open_backend();
std::expected<std::string, std::string> run_backend(const BackendRequest& request);

}  // namespace pse
