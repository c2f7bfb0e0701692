// The LLVM module's one door: a request in, an object file or a listing out.
// Opened by codegen/backend.cpp.
#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include <llvm/IR/LLVMContext.h>
#include <llvm/IR/Verifier.h>
#include <llvm/Support/raw_ostream.h>

#include "codegen/llvm/emitter.h"
#include "codegen/llvm/optimiser.h"

namespace pse {
namespace {

std::string text_of(const llvm::Module& module) {
  std::string text;
  llvm::raw_string_ostream stream(text);
  module.print(stream, nullptr);
  return text;
}

// Leaves one piece of the functions defined and declares the others: emitting costs little beside
// compiling, so every piece emits all. Largest first, each to the piece that has least so far;
// every piece comes to the same result.
void keep_piece(llvm::Module& module, int piece, int pieces) {
  std::vector<std::pair<unsigned, llvm::Function*>> sizes;
  for (llvm::Function& function : module) {
    if (!function.isDeclaration()) sizes.emplace_back(function.getInstructionCount(), &function);
  }
  std::ranges::stable_sort(sizes, std::greater(), [](const auto& entry) { return entry.first; });
  std::vector<unsigned> loads(static_cast<std::size_t>(pieces));
  for (const auto& [size, function] : sizes) {
    const auto least = std::ranges::min_element(loads);
    *least += size;
    if (function->hasLocalLinkage()) {
      function->setLinkage(llvm::GlobalValue::ExternalLinkage);
      function->setVisibility(llvm::GlobalValue::HiddenVisibility);
    }
    if (least - loads.begin() != piece) function->deleteBody();
  }
}

void run(const BackendRequest& request, BackendReply& reply) {
  const auto machine = make_target_machine(*request.target, request.optimize, reply.error);
  if (!machine) return;
  llvm::LLVMContext context;
  llvm::Module module("pse", context);
  module.setDataLayout(machine->createDataLayout());
  module.setTargetTriple(machine->getTargetTriple().str());
  ModuleEmitter emitter(module, request);
  if (request.part != BackendPart::frame) emitter.emit_samples();
  if (request.part != BackendPart::samples) emitter.emit_frame();
  if (request.pieces > 1) keep_piece(module, request.piece, request.pieces);
  // Cheap, and LLVM crashes on what it should not be given.
  llvm::raw_string_ostream complaints(reply.error);
  if (llvm::verifyModule(module, &complaints)) return;
  if (request.optimize) optimise(module, *machine);
  if (request.product == BackendProduct::llvm) {
    reply.bytes = text_of(module);
    return;
  }
  const auto type = request.product == BackendProduct::object ? llvm::CodeGenFileType::ObjectFile
                                                              : llvm::CodeGenFileType::AssemblyFile;
  reply.bytes = generate(module, *machine, type);
}

}  // namespace
}  // namespace pse

extern "C" __attribute__((visibility("default"))) void pse_llvm_compile(
    const pse::BackendRequest* request, pse::BackendReply* reply) {
  pse::run(*request, *reply);
}
