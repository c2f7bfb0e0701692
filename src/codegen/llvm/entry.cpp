// The LLVM module's one door: a request in, an object file or a listing out.
// Opened by codegen/backend.cpp.
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

void run(const BackendRequest& request, BackendReply& reply) {
  const auto machine = make_target_machine(*request.target, request.optimize, reply.error);
  if (!machine) return;
  llvm::LLVMContext context;
  llvm::Module module("pse", context);
  module.setDataLayout(machine->createDataLayout());
  module.setTargetTriple(machine->getTargetTriple().str());
  ModuleEmitter emitter(module, request);
  emitter.emit_samples();
  emitter.emit_frame();
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
