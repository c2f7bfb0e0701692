// IR -> LLVM IR, once, for every vector width. A ModuleEmitter owns what a kernel shares (tables,
// called functions); a FunctionEmitter writes one function. A value that is the same for all
// samples of a vector is a scalar, any other is a vector of `width` lanes; at width 1 everything is
// a scalar. Split over files by what is emitted: module_, value_, control_, table_, byte_, array_
// and effect_emitter.cpp.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include <llvm/IR/MDBuilder.h>
#include <llvm/IR/Module.h>

#include "codegen/array_layout.h"
#include "codegen/backend.h"
#include "codegen/llvm/asked_bits.h"
#include "codegen/llvm/vector_tools.h"
#include "codegen/uniformity.h"

namespace pse {

class ModuleEmitter {
 public:
  ModuleEmitter(llvm::Module& out, const BackendRequest& request);

  // The two entry points, `void(KernelCall*)`.
  void emit_samples();
  void emit_frame();

  llvm::Module& out() { return out_; }
  const ir::Module& ir() const { return ir_; }
  const Target& target() const { return target_; }

  llvm::Type* type_of(ir::Type type, unsigned lanes);
  // A read-only global with these contents; equal contents are one global.
  llvm::Value* constant_data(llvm::Constant* contents);
  // How many of `count` bytes one instruction of this target takes.
  unsigned byte_piece(unsigned count) const;
  // The function `index` of the IR for vectors of `lanes`, where these parameters vary. Its LLVM
  // parameters are the KernelCall, the mask of active lanes (if it takes one), and the operands.
  llvm::Function* called_function(std::uint32_t index, const std::vector<bool>& varying,
                                  unsigned lanes);
  // Whether a function does anything that depends on which lanes are active.
  bool takes_mask(std::uint32_t index, unsigned lanes) const;
  // Which parameters vary in any of the calls with varying arguments: one body serves all.
  const std::vector<bool>& shape_of(std::uint32_t index) const { return shapes_[index]; }

 private:
  void find_shapes(const ir::Function& function, const Uniformity& uniformity);
  llvm::Function* add_function(llvm::FunctionType* type, const std::string& name, bool external);

  llvm::Module& out_;
  const ir::Module& ir_;
  const passes::SplitModule& split_;
  const Target& target_;
  unsigned width_;
  std::vector<std::vector<bool>> shapes_;  // per function of the IR
  std::map<llvm::Constant*, llvm::Value*> data_;
  std::map<std::pair<std::uint32_t, std::vector<bool>>, llvm::Function*> called_;
};

class FunctionEmitter {
 public:
  FunctionEmitter(ModuleEmitter& parent, const ir::Function& function, Uniformity uniformity,
                  unsigned lanes, llvm::Function* out);

  // The body of an entry point over all samples, or once.
  void emit_sample_loop(const std::vector<ir::Output>& outputs);
  void emit_once();
  // The body of a called function.
  void emit_called(bool takes_mask);

 private:
  // module_emitter.cpp: what is loaded once, before the samples
  llvm::Value* call_field(std::size_t offset, llvm::Type* type);
  void load_inputs();
  void find_used_inputs(const ir::Region& region);
  void leave();
  llvm::BasicBlock* stop_block();

  // value_emitter.cpp
  void emit_region(const ir::Region& region);
  void emit(const ir::Instruction& in);
  llvm::Value* emit_value(const ir::Instruction& in);
  llvm::Value* emit_input(const ir::Instruction& in);
  llvm::Value* divide(llvm::Value* dividend, llvm::Value* divisor);
  llvm::Value* multiply(llvm::Value* a, llvm::Value* b);
  llvm::Value* float_to_int(llvm::Value* value);
  llvm::Value* shift(ir::Op op, llvm::Value* value, llvm::Value* by);
  llvm::Value* canonical_nan(llvm::Value* value);
  bool varying(ir::Value value) const { return uniformity_.varying[value]; }
  ir::Type type(ir::Value value) const { return function_.values[value].type; }
  llvm::Value* get(ir::Value value) { return values_[value]; }
  llvm::Value* get_as(ir::Value value, bool as_varying);
  llvm::Value* splat(llvm::Value* value);
  llvm::Value* zero(ir::Type type, bool as_varying);

  // table_emitter.cpp
  llvm::Value* table_lookup(llvm::ArrayRef<llvm::Constant*> entries, llvm::Value* index);
  llvm::Value* table_in_registers(llvm::ArrayRef<llvm::Constant*> entries, llvm::Value* index);
  std::optional<std::array<std::uint8_t, 32>> top_bytes(llvm::ArrayRef<llvm::Constant*> entries);
  llvm::Value* table_in_bytes(const std::array<std::uint8_t, 32>& bytes, bool two_rows,
                              llvm::Value* index);
  llvm::Value* multiply_add(const ir::Instruction& in, bool wide);
  llvm::Value* permute_512(llvm::Constant* table, llvm::Value* index);
  llvm::Value* permute_256(llvm::Constant* table, llvm::Value* index);

  // byte_emitter.cpp
  llvm::Value* bytes_add(llvm::Value* a, llvm::Value* b);
  llvm::Value* shuffle_bytes(llvm::ArrayRef<std::uint8_t> row, llvm::Value* bytes);
  llvm::Value* choose_bytes(llvm::Value* mask, llvm::Value* yes, llvm::Value* no);
  llvm::Value* bit_on_top(llvm::Value* bytes, unsigned bit);
  llvm::Value* choose_row(llvm::ArrayRef<std::uint8_t> rows, std::size_t first, std::size_t count,
                          llvm::Value* low, llvm::ArrayRef<llvm::Value*> on_top);
  llvm::Value* bytes_lookup(const ir::ByteTable& table, llvm::Value* index, bool low_half);
  llvm::Value* spread_byte_lookup(const ir::ByteTable& table, llvm::Value* byte,
                                  std::uint32_t added);
  llvm::Value* bytes_lookup_vbmi(const ir::ByteTable& table, llvm::Value* bytes);
  llvm::Value* bytes_lookup_blends(const ir::ByteTable& table, llvm::Value* bytes);
  llvm::Value* low_half_lookup(const ir::ByteTable& table, llvm::Value* bytes);
  llvm::Value* bytes_lookup_shuffles(const ir::ByteTable& table, llvm::Value* bytes);
  llvm::Value* bytes_lookup_scalar(const ir::ByteTable& table, llvm::Value* index);

  // control_emitter.cpp
  void emit_if(const ir::Instruction& in);
  void emit_uniform_if(const ir::Instruction& in);
  void emit_varying_if(const ir::Instruction& in);
  void emit_loop(const ir::Instruction& in);
  void emit_uniform_loop(const ir::Instruction& in);
  void emit_varying_loop(const ir::Instruction& in);
  void bind_params(const std::vector<ir::Value>& params, const std::vector<llvm::Value*>& values);
  void poll();
  llvm::Value* any(llvm::Value* mask);
  llvm::Value* and_masks(llvm::Value* a, llvm::Value* b);  // null: all lanes
  llvm::Value* all_lanes();
  llvm::BasicBlock* new_block(const char* name);
  // Booleans live across blocks as integers of full width where the processor has no mask
  // registers.
  llvm::Value* to_stored(llvm::Value* value);
  llvm::Value* from_stored(llvm::Value* value, ir::Type type);

  // array_emitter.cpp
  struct ArrayState {
    llvm::Value* length = nullptr;  // sample rate: an alloca
  };
  void declare_arrays();
  void clear_arrays();
  bool is_sample_array(std::int32_t array) const;
  unsigned row_lanes(std::int32_t array) const;
  llvm::Value* load_length(std::int32_t array);
  void store_length(std::int32_t array, llvm::Value* length);
  llvm::Value* sample_row(std::int32_t array, llvm::Value* element, std::int32_t component);
  llvm::Value* sample_cells(std::int32_t array, llvm::Value* elements, std::int32_t component);
  llvm::Value* frame_cells(std::int32_t array, llvm::Value* element, std::int32_t component);
  llvm::Value* emit_array_load(const ir::Instruction& in);
  void emit_array_store(const ir::Instruction& in);
  void emit_array_resize(const ir::Instruction& in);
  void clear_elements(std::int32_t array, llvm::Value* from, llvm::Value* to,
                      llvm::Value* old_length, llvm::Value* new_length);

  // effect_emitter.cpp
  void emit_check(const ir::Instruction& in);
  void emit_call(const ir::Instruction& in);
  void emit_external(const ir::Instruction& in);
  llvm::AllocaInst* stack_slot(llvm::Type* type);

  ModuleEmitter& parent_;
  const ir::Module& ir_;
  const ir::Function& function_;
  Uniformity uniformity_;
  unsigned lanes_;
  llvm::Function* out_;
  IrBuilder b_;
  llvm::LLVMContext& context_;
  llvm::Type *f32_, *i32_, *i64_, *i1_, *ptr_;

  llvm::BasicBlock* entry_ = nullptr;  // allocas and loads of what never changes
  llvm::BasicBlock* stop_ = nullptr;   // leaves early
  llvm::Value* call_ = nullptr;        // the KernelCall
  llvm::Value* base_ =
      nullptr;  // index of the first sample of this vector; null outside a sample loop
  llvm::Value* mask_ = nullptr;       // active lanes; null: all
  std::vector<llvm::Value*> values_;  // per ir::Value
  std::vector<std::uint32_t> asked_;  // per ir::Value: the bits that somebody looks at
  // What the lookups of one block share: bytes found for whole words, entries known as twice a
  // half, factors already doubled.
  std::map<std::tuple<llvm::BasicBlock*, llvm::Value*, std::array<std::uint8_t, 32>>, llvm::Value*>
      found_bytes_;
  std::map<llvm::Value*, llvm::Value*> halves_;
  std::map<std::pair<llvm::BasicBlock*, llvm::Value*>, llvm::Value*> doubled_;
  // Words that hold one byte four times, and the byte; the same with a constant added.
  std::map<llvm::Value*, llvm::Value*> repeated_bytes_;
  std::map<llvm::Value*, std::pair<llvm::Value*, std::uint32_t>> spread_bytes_;
  std::vector<llvm::Value*>
      inputs_;  // per Module::inputs: the value if uniform, the array if of rate sample
  std::vector<bool> input_used_;
  std::vector<ArrayState> arrays_;
  std::map<std::size_t, llvm::Value*> call_fields_;
  SampleArrayLayout sample_layout_;
  FrameArrayLayout frame_layout_;
};

}  // namespace pse
