// Feeds a module to a hasher, each list preceded by its length.
#include "codegen/module_hash.h"

namespace pse {
namespace {

void hash_values(Hasher& h, const std::vector<ir::Value>& values) {
  h.add(values.size());
  for (const ir::Value value : values) h.add(value);
}

void hash_region(Hasher& h, const ir::Region& region) {
  hash_values(h, region.params);
  h.add(region.body.size());
  for (const ir::Instruction& in : region.body) {
    h.add(in.op);
    h.add(in.imm);
    h.add(in.component);
    hash_values(h, in.operands);
    hash_values(h, in.results);
    h.add(in.regions.size());
    for (const ir::Region& inner : in.regions) hash_region(h, inner);
  }
  hash_values(h, region.yields);
}

void hash_function(Hasher& h, const ir::Function& function) {
  h.add(function.values.size());
  for (const ir::ValueInfo& value : function.values) h.add(value.type);
  h.add(function.arrays.size());
  for (const ir::Array& array : function.arrays) {
    h.add(array.components);
    h.add(array.capacity);
    h.add(array.rate);
    h.add(array.initial_length);
  }
  hash_region(h, function.body);
}

template <class Tables>
void hash_tables(Hasher& h, const Tables& tables) {
  h.add(tables.size());
  for (const auto& table : tables) h.add_bytes(std::as_bytes(std::span(table.entries)));
}

}  // namespace

void hash_program(Hasher& hasher, const passes::SplitModule& split) {
  const ir::Module& module = split.module;
  hasher.add(module.entry);
  hasher.add(split.frame);
  hasher.add(split.first_slot);
  hasher.add(module.functions.size());
  for (const ir::Function& function : module.functions) hash_function(hasher, function);
  hash_tables(hasher, module.float_tables);
  hash_tables(hasher, module.int_tables);
  hash_tables(hasher, module.byte_tables);
  hasher.add(module.inputs.size());
  for (const ir::Input& input : module.inputs) hasher.add(input.rate);
  hasher.add(module.outputs.size());
  hasher.add(module.externals.size());
}

}  // namespace pse
