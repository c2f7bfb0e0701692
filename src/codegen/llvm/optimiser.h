// LLVM IR -> machine code: the passes that pay for their time, and the code generator.
// Last step inside the LLVM module.
#pragma once

#include <memory>
#include <string>

#include <llvm/IR/Module.h>
#include <llvm/Target/TargetMachine.h>

#include "codegen/target.h"

namespace pse {

// Null, with a reason, where LLVM knows no such processor.
std::unique_ptr<llvm::TargetMachine> make_target_machine(const Target& target, bool optimize,
                                                         std::string& error);
void optimise(llvm::Module& module, llvm::TargetMachine& machine);
// A relocatable object, or assembly text.
std::string generate(llvm::Module& module, llvm::TargetMachine& machine,
                     llvm::CodeGenFileType type);

}  // namespace pse
