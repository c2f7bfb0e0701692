// Registers and rows. See the header.
#include "codegen/first/places.h"

#include <utility>

#include "codegen/first/constants.h"

namespace pse::first {

Places::Places(const ir::Function& function, Assembler& assembler, std::int32_t frame_size)
    : code_(assembler),
      lifetimes_(function),
      places_(function.values.size()),
      frame_end_(frame_size) {
  holds_.fill(nobody);
}

// ---- Rows ----

Memory Places::take_row() {
  if (free_rows_.empty()) {
    frame_end_ += row_size;
    return {frame, frame_end_ - row_size};
  }
  const std::int32_t row = free_rows_.back();
  free_rows_.pop_back();
  return {frame, row};
}

void Places::set_row(ir::Value value, const Memory& row, bool owned) {
  Place& place = places_[value];
  place.row = row.disp;
  place.stored = true;
  place.owned = owned;
}

void Places::hand_over(ir::Value from, ir::Value to) {
  if (places_[from].reg >= 0) assign(to, std::exchange(places_[from].reg, std::int8_t{-1}));
}

// ---- Registers ----

void Places::touch(Ymm reg) {
  touched_[static_cast<std::size_t>(reg)] = ++clock_;
  pinned_ |= 1u << reg;
}

void Places::store(ir::Value value) {
  Place& place = places_[value];
  if (place.stored || remade(place)) return;
  if (place.row < 0) {
    place.row = take_row().disp;
    place.owned = true;
  }
  code_.store({frame, place.row}, place.reg);
  place.stored = true;
}

void Places::evict(Ymm reg) {
  const ir::Value value = std::exchange(holds_[static_cast<std::size_t>(reg)], nobody);
  if (value == nobody) return;
  store(value);
  places_[value].reg = -1;
}

// An empty one, else the one used longest ago.
Ymm Places::free_register() {
  Ymm best = -1;
  for (Ymm reg = 0; reg < 16; ++reg) {
    if ((pinned_ >> reg & 1) != 0) continue;
    const auto i = static_cast<std::size_t>(reg);
    if (holds_[i] == nobody) return touch(reg), reg;
    if (best < 0 || touched_[i] < touched_[static_cast<std::size_t>(best)]) best = reg;
  }
  evict(best);
  touch(best);
  return best;
}

void Places::assign(ir::Value value, Ymm reg) {
  holds_[static_cast<std::size_t>(reg)] = value;
  places_[value].reg = static_cast<std::int8_t>(reg);
}

Ymm Places::in_register(ir::Value value) {
  const Place& place = places_[value];
  if (place.reg >= 0) return touch(place.reg), place.reg;
  const Ymm reg = free_register();
  if (place.constant >= 0) {
    code_.load(reg, {Constants::base, place.constant});
  } else if (place.uniform >= 0) {
    code_.vector(op::broadcast, reg, 0, Memory{uniforms, 4 * place.uniform});
  } else {
    code_.load(reg, {frame, place.row});
  }
  assign(value, reg);
  return reg;
}

Operand Places::operand(ir::Value value) {
  const Place& place = places_[value];
  if (place.reg < 0) {
    if (place.constant >= 0) return Memory{Constants::base, place.constant};
    if (place.uniform < 0 && dies(value)) return Memory{frame, place.row};
  }
  return in_register(value);
}

Ymm Places::copy(ir::Value value) {
  if (places_[value].reg >= 0 && dies(value)) {
    const Ymm reg = in_register(value);
    holds_[static_cast<std::size_t>(reg)] = nobody;
    places_[value].reg = -1;
    return reg;
  }
  const Operand from = operand(value);
  const Ymm reg = free_register();
  if (from.in_memory) {
    code_.load(reg, from.memory);
  } else {
    code_.move(reg, from.reg);
  }
  return reg;
}

Ymm Places::define(ir::Value value) {
  const Ymm reg = free_register();
  assign(value, reg);
  return reg;
}

void Places::define(ir::Value value, Ymm in) { assign(value, in); }

Ymm Places::temporary() { return free_register(); }

void Places::take_register(Ymm reg) {
  evict(reg);
  touch(reg);
}

// ---- Steps ----

void Places::release(std::int32_t time) {
  const auto& order = lifetimes_.order;
  for (; released_ < order.size() && lifetimes_.last_use[order[released_]] <= time; ++released_) {
    Place& place = places_[order[released_]];
    if (place.reg >= 0) {
      holds_[static_cast<std::size_t>(place.reg)] = nobody;
      pinned_ &= ~(1u << place.reg);
    }
    if (place.row >= 0 && place.owned) freed_rows_.push_back(place.row);
    place = {};
  }
}

void Places::end_step() {
  release(2 * step_ + 1);
  // Not before: the step's instruction may read a row that its operand leaves.
  free_rows_.insert(free_rows_.end(), freed_rows_.begin(), freed_rows_.end());
  freed_rows_.clear();
  ++step_;
  pinned_ = 0;
}

// ---- Where code joins ----

void Places::store_all() {
  for (const ir::Value value : holds_)
    if (value != nobody) store(value);
}

void Places::forget_registers() {
  for (ir::Value& value : holds_)
    if (value != nobody) places_[std::exchange(value, nobody)].reg = -1;
  pinned_ = 0;
}

}  // namespace pse::first
