// Arrays that grow by assignment: memory of the function, indexed from 1 in the language and from 0
// in the IR.
#include "lower/lowering.h"

namespace pse::lower {

Typed Lowering::new_array(const std::string& name, std::int32_t capacity) {
  auto& arrays = builder_->function().arrays;
  arrays.push_back({.name = name, .components = 0, .capacity = capacity});
  Typed array{.kind = Kind::array, .text = {}, .function = {}};
  array.array = static_cast<std::int32_t>(arrays.size()) - 1;
  builder_->emit_void(ir::Op::array_resize, {integer(0)}, array.array);
  return array;
}

void Lowering::bind_arrays(const lang::Block& body) {
  // An array belongs to the whole function, so it is made where the function begins, not in the
  // loop that fills it.
  for (const std::string& name : array_candidates(body))
    if (!variables().contains(name) && !(call_ == &top_ && stream_name(name)))
      variables()[name] = new_array(name, 1024);
}

void Lowering::add_check(ir::Value condition, const std::string& message, const Span& span) {
  const Blame found = blame("index-range", span, message, {});
  module_.checks.push_back({found.span, found.message});
  builder_->emit_void(ir::Op::check, {condition},
                      static_cast<std::int32_t>(module_.checks.size()) - 1);
}

Typed Lowering::array_length(const Typed& array) {
  const ir::Type type = ir::Type::i32;
  const auto results = builder_->emit_multi(ir::Op::array_length, {}, {&type, 1}, array.array);
  return number(emit(ir::Op::i2f, {results.front()}));
}

Typed Lowering::load_element(const Typed& array, ir::Value index, const Span& span, bool checked) {
  const ir::Array& info = builder_->function().arrays[static_cast<std::size_t>(array.array)];
  if (info.components == 0) {
    if (!given_up_.contains(array.array))
      error("empty-array", span, "`" + info.name + "` is read before anything is put into it");
    return {};
  }
  const int components = info.components;
  const bool is_matrix_row = components > 1;
  if (checked) {
    const ir::Type type = ir::Type::i32;
    const ir::Value length =
        builder_->emit_multi(ir::Op::array_length, {}, {&type, 1}, array.array).front();
    const ir::Value inside = emit(
        ir::Op::band, {emit(ir::Op::ile, {integer(0), index}), emit(ir::Op::ilt, {index, length})});
    add_check(inside, "index of `" + info.name + "` is outside the array", span);
  }
  std::vector<ir::Value> parts;
  for (int c = 0; c < components; ++c)
    parts.push_back(emit(ir::Op::array_load, {index}, array.array, c));
  return is_matrix_row ? vector(std::move(parts)) : number(parts.front());
}

void Lowering::store_element(const Typed& array, ir::Value index, const Typed& value,
                             const Span& span) {
  const Typed plain = to_number(value);
  if (plain.kind != Kind::number && plain.kind != Kind::vector)
    return error("element-type", span,
                 "an array holds numbers or vectors, this is " + describe(value));
  ir::Array& info = builder_->function().arrays[static_cast<std::size_t>(array.array)];
  if (info.components == 0) info.components = plain.components();
  Typed shaped = plain;
  if (plain.kind == Kind::number && info.components > 1)
    shaped.parts.assign(static_cast<std::size_t>(info.components), plain.parts.front());
  if (shaped.components() != info.components)
    return error(
        "element-type", span,
        "`" + info.name + "` holds " +
            (info.components == 1 ? "numbers" : "vectors of " + std::to_string(info.components)) +
            ", this is " + describe(value));
  const std::string name = info.name;
  const std::int32_t capacity = info.capacity;

  // The index must lie within what the array can hold; the array grows to reach it.
  const ir::Value inside = emit(ir::Op::band, {emit(ir::Op::ile, {integer(0), index}),
                                               emit(ir::Op::ilt, {index, integer(capacity)})});
  add_check(inside, "index of `" + name + "` is outside 1.." + std::to_string(capacity), span);
  const ir::Type type = ir::Type::i32;
  const ir::Value length =
      builder_->emit_multi(ir::Op::array_length, {}, {&type, 1}, array.array).front();
  ir::Region grow, keep;
  const ir::Value beyond = emit(ir::Op::ile, {length, index});
  builder_->begin_region(grow);
  builder_->emit_void(ir::Op::array_resize, {emit(ir::Op::iadd, {index, integer(1)})}, array.array);
  builder_->end_region();
  builder_->emit_if(beyond, std::move(grow), std::move(keep));
  for (int c = 0; c < shaped.components(); ++c)
    builder_->emit_void(ir::Op::array_store, {index, shaped.parts[static_cast<std::size_t>(c)]},
                        array.array, c);
}

Typed Lowering::copy_array(const Typed& array, const std::string& name) {
  const auto& arrays = builder_->function().arrays;
  const ir::Array source = arrays[static_cast<std::size_t>(array.array)];
  const Typed copy = new_array(name, source.capacity);
  builder_->function().arrays[static_cast<std::size_t>(copy.array)].components = source.components;
  const ir::Type type = ir::Type::i32;
  const ir::Value length =
      builder_->emit_multi(ir::Op::array_length, {}, {&type, 1}, array.array).front();
  builder_->emit_void(ir::Op::array_resize, {length}, copy.array);

  // Element by element.
  ir::Region head, body;
  const ir::Value at_head = builder_->add_param(head, ir::Type::i32);
  builder_->begin_region(head);
  head.yields = {emit(ir::Op::ilt, {at_head, length})};
  builder_->end_region();
  const ir::Value at = builder_->add_param(body, ir::Type::i32);
  builder_->begin_region(body);
  for (int c = 0; c < source.components; ++c)
    builder_->emit_void(ir::Op::array_store, {at, emit(ir::Op::array_load, {at}, array.array, c)},
                        copy.array, c);
  body.yields = {emit(ir::Op::iadd, {at, integer(1)})};
  builder_->end_region();
  const ir::Value zero = integer(0);
  builder_->emit_loop({&zero, 1}, std::move(head), std::move(body));
  return copy;
}

}  // namespace pse::lower
