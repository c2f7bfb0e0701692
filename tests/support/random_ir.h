// Valid random modules over every operator, biased to edge values, for tests that compare two ways
// to run the same IR. The same seed gives the same module on every machine.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "ir/builder.h"
#include "ir/evaluate.h"
#include "ir/interpreter.h"

namespace pse::test {

struct RandomIrOptions {
  int instructions = 40;  // about so many per function
  bool arrays = true;
  bool calls = true;
  bool checks = false;  // checks fail now and then
  bool externals = true;
  bool control = true;  // ifs and loops
};

// Small deterministic choices.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  std::uint32_t bits() { return static_cast<std::uint32_t>(engine_() >> 32); }
  int below(int n) { return static_cast<int>(bits() % static_cast<std::uint32_t>(n)); }
  bool one_in(int n) { return below(n) == 0; }
  template <typename T, std::size_t n>
  const T& pick(const std::array<T, n>& from) {
    return from[static_cast<std::size_t>(below(n))];
  }
  template <typename T>
  const T& pick(const std::vector<T>& from) {
    return from[static_cast<std::size_t>(below(static_cast<int>(from.size())))];
  }

  // Zeros, infinities, NaN, subnormals, the ends of what f2i and i2f can do, and ordinary numbers.
  float floating() {
    static const std::array<float, 26> edges = {0.0f,
                                                -0.0f,
                                                1.0f,
                                                -1.0f,
                                                2.0f,
                                                -0.5f,
                                                0.5f,
                                                1.5f,
                                                2.5f,
                                                -2.5f,
                                                0.1f,
                                                3.0f,
                                                std::numeric_limits<float>::infinity(),
                                                -std::numeric_limits<float>::infinity(),
                                                std::numeric_limits<float>::quiet_NaN(),
                                                std::numeric_limits<float>::min(),
                                                std::numeric_limits<float>::denorm_min(),
                                                -1e-40f,
                                                std::numeric_limits<float>::max(),
                                                8388608.0f,
                                                16777216.0f,
                                                16777218.0f,
                                                2147483648.0f,
                                                -2147483648.0f,
                                                2147483520.0f,
                                                1e30f};
    switch (below(4)) {
      case 0:
        return pick(edges);
      case 1:
        return std::ldexp(static_cast<float>(bits() & 0xffffff) - 8388608.0f, below(60) - 50);
      case 2:
        return static_cast<float>(below(21) - 10);
      default:
        return (static_cast<float>(bits() >> 8) * 0x1p-24f - 0.5f) * 8.0f;
    }
  }
  std::int32_t integer() {
    static const std::array<std::int32_t, 16> edges = {0,
                                                       1,
                                                       -1,
                                                       2,
                                                       3,
                                                       7,
                                                       31,
                                                       32,
                                                       33,
                                                       255,
                                                       -256,
                                                       0x01020304,
                                                       16777217,
                                                       std::numeric_limits<std::int32_t>::max(),
                                                       std::numeric_limits<std::int32_t>::min(),
                                                       -2147483647};
    switch (below(3)) {
      case 0:
        return pick(edges);
      case 1:
        return below(12) - 2;
      default:
        return static_cast<std::int32_t>(bits());
    }
  }

 private:
  std::mt19937_64 engine_;
};

class RandomIr {
 public:
  RandomIr(std::uint64_t seed, const RandomIrOptions& options) : dice_(seed), options_(options) {}

  ir::Module make() {
    make_tables();
    module_.inputs = {{"x", ir::Rate::sample},
                      {"y", ir::Rate::sample},
                      {"z", ir::Rate::sample},
                      {"time", ir::Rate::frame},
                      {"Size", ir::Rate::frame}};
    module_.checks = {{{}, "first"}, {{}, "second"}};
    if (options_.externals) module_.externals = {{"one of two", 2, 1}, {"two of one", 1, 2}};

    const int callees = options_.calls ? dice_.below(4) : 0;
    for (int i = 0; i < callees; ++i) make_function("f" + std::to_string(i), false);
    module_.entry = static_cast<std::uint32_t>(module_.functions.size());
    make_function("main", true);
    for (std::size_t i = 0; i < module_.main().body.yields.size(); ++i)
      module_.outputs.push_back({"o" + std::to_string(i)});
    return std::move(module_);
  }

 private:
  // Values that may be used now, by type.
  using Pool = std::array<std::vector<ir::Value>, 3>;
  using Op = ir::Op;
  using Type = ir::Type;

  void make_tables() {
    ir::FloatTable floats{.name = "floats"};
    for (int i = 0; i < 8; ++i) floats.entries.push_back(dice_.floating());
    ir::IntTable ints{.name = "ints"};
    for (int i = 0; i < 16; ++i) ints.entries.push_back(dice_.integer());
    ir::ByteTable bytes{.name = "bytes"};
    for (int i = 0; i < 256; ++i) bytes.entries.push_back(static_cast<std::uint8_t>(dice_.bits()));
    module_.float_tables = {floats, {.name = "single", .entries = {0.25f}}};
    module_.int_tables = {ints};
    module_.byte_tables = {bytes};
  }

  void make_function(const std::string& name, bool entry) {
    // Built apart: the module's list of functions grows while callees are added.
    ir::Function function{.name = name};
    in_entry_ = entry;
    pool_ = {};
    if (entry && options_.arrays) {
      const int arrays = dice_.below(4);
      for (int i = 0; i < arrays; ++i) {
        ir::Array array{.name = "a" + std::to_string(i),
                        .components = 1 + dice_.below(3),
                        .capacity = dice_.below(10)};
        array.initial_length = dice_.one_in(3) ? 0 : dice_.below(array.capacity + 1);
        function.arrays.push_back(array);
      }
    }
    ir::Builder builder(module_, function);
    b_ = &builder;
    if (!entry) {
      const int params = 1 + dice_.below(3);
      for (int i = 0; i < params; ++i) {
        const Type type = random_type();
        add(builder.add_param(function.body, type), type);
      }
    }
    if (entry) start_with_inputs();
    fill(options_.instructions / 2 + dice_.below(options_.instructions), 0);
    const int yields = 1 + dice_.below(entry ? 20 : 3);
    std::vector<ir::Value> results;
    for (int i = 0; i < yields; ++i) results.push_back(entry ? observed() : any(random_type()));
    function.body.yields = results;
    module_.functions.push_back(std::move(function));
  }

  Type random_type() {
    const int n = dice_.below(6);
    return n < 3 ? Type::f32 : n < 5 ? Type::i32 : Type::boolean;
  }

  void add(ir::Value value, Type type) { pool_[static_cast<std::size_t>(type)].push_back(value); }
  void add(ir::Value value) { add(value, b_->type(value)); }

  ir::Value constant(Type type) {
    switch (type) {
      case Type::f32:
        return b_->const_f32(dice_.floating());
      case Type::i32:
        return b_->const_i32(dice_.integer());
      default:
        return b_->const_bool(dice_.one_in(2));
    }
  }

  // A value of this type: a recent one, any one, or a fresh constant.
  ir::Value any(Type type) {
    const auto& values = pool_[static_cast<std::size_t>(type)];
    if (values.empty() || dice_.one_in(10)) {
      const ir::Value value = constant(type);
      if (values.empty() || dice_.one_in(4)) add(value, type);
      return value;
    }
    const int size = static_cast<int>(values.size());
    const int back = dice_.one_in(2) ? dice_.below(std::min(size, 6)) : dice_.below(size);
    return values[static_cast<std::size_t>(size - 1 - back)];
  }

  // All inputs, and something of the other types that depends on them, so that not all is constant.
  void start_with_inputs() {
    for (std::size_t i = 0; i < module_.inputs.size(); ++i) {
      const ir::Value input = b_->emit(Op::input, {}, static_cast<std::int32_t>(i));
      add(input);
      add(b_->emit(Op::f2i, {input}));
      add(b_->emit(Op::flt, {input, b_->const_f32(dice_.floating())}));
    }
    // A few indices that many array accesses share: the same for all, per sample, per frame.
    const auto small = [&](int input) {
      const ir::Value whole = b_->emit(Op::f2i, {b_->emit(Op::input, {}, input)});
      return b_->emit(Op::iand, {whole, b_->const_i32(3)});
    };
    calm_indices_ = {b_->const_i32(0), b_->const_i32(1), b_->const_i32(2), small(3)};
    calm_values_ = {b_->emit(Op::input, {}, 3), b_->emit(Op::input, {}, 4), b_->const_f32(0.75f)};
    indices_ = calm_indices_;
    indices_.push_back(small(0));
  }

  // Some value of any type as a float, so that outputs observe much of what is computed.
  ir::Value observed() {
    const Type type = random_type();
    const auto& values = pool_[static_cast<std::size_t>(type)];
    const ir::Value value = values.empty() ? any(type) : dice_.pick(values);
    if (type == Type::i32) return b_->emit(Op::i2f, {value});
    if (type == Type::boolean)
      return b_->emit(Op::select, {value, b_->const_f32(1.0f), b_->const_f32(0.0f)});
    return value;
  }

  void fill(int count, int depth) {
    for (int i = 0; i < count; ++i) {
      const int kind = dice_.below(30);
      if (kind == 0 && options_.control && depth < 3) {
        make_if(depth);
      } else if (kind == 1 && options_.control && depth < 3) {
        make_loop(depth);
      } else if (kind == 2 && !module_.functions.empty()) {
        make_call();
      } else if (kind == 3 && !module_.externals.empty()) {
        make_external();
      } else if (kind < 7 && in_entry_) {
        add(b_->emit(Op::input, {}, dice_.below(static_cast<int>(module_.inputs.size()))));
      } else if (kind < (depth > 0 ? 14 : 11) && in_entry_ && !b_->function().arrays.empty()) {
        make_array_access();
      } else if (kind == 14 && in_entry_ && options_.checks) {
        // True two times out of three and more.
        const ir::Value condition = b_->emit(Op::bor, {any(Type::boolean), any(Type::boolean)});
        b_->emit_void(Op::check, {condition}, dice_.below(2));
      } else {
        make_scalar();
      }
    }
  }

  // One instruction of the operators from fadd to bytes_lookup, or a constant.
  void make_scalar() {
    const auto first = static_cast<int>(Op::fadd), last = static_cast<int>(Op::bytes_lookup);
    const auto op = static_cast<Op>(first + dice_.below(last - first + 1));
    const std::string_view letters = ir::info(op).operands;
    if (op == Op::f2bits) return make_f2bits();
    const Type generic = random_type();
    std::array<ir::Value, 3> v{};
    for (std::size_t i = 0; i < letters.size(); ++i) v[i] = any(type_of(letters[i], generic));
    // Often the same operand twice, which is where rewrites hide their mistakes.
    if (letters.size() >= 2 && letters[0] == letters[1] && dice_.one_in(6)) v[1] = v[0];
    std::int32_t imm = 0;
    if (op == Op::table_f32) imm = dice_.below(static_cast<int>(module_.float_tables.size()));
    switch (letters.size()) {
      case 1:
        return add(b_->emit(op, {v[0]}, imm));
      case 2:
        return add(b_->emit(op, {v[0], v[1]}, imm));
      default:
        return add(b_->emit(op, {v[0], v[1], v[2]}, imm));
    }
  }

  Type type_of(char letter, Type generic) {
    return letter == 'f'   ? Type::f32
           : letter == 'i' ? Type::i32
           : letter == 'b' ? Type::boolean
                           : generic;
  }

  // The bits of a NaN are nobody's business, so only numbers are asked for theirs.
  void make_f2bits() {
    const ir::Value value = any(Type::f32);
    const ir::Value is_number = b_->emit(Op::feq, {value, value});
    const ir::Value number = b_->emit(Op::select, {is_number, value, b_->const_f32(1.5f)});
    add(b_->emit(Op::f2bits, {number}));
  }

  void make_array_access() {
    const int array = dice_.below(static_cast<int>(b_->function().arrays.size()));
    const int component =
        dice_.below(b_->function().arrays[static_cast<std::size_t>(array)].components);
    // Mostly small indices, so that arrays are hit, and the same ones.
    const auto small = [&] {
      if (!dice_.one_in(3)) return dice_.pick(indices_);
      const ir::Value index = any(Type::i32);
      return dice_.one_in(4) ? index : b_->emit(Op::iand, {index, b_->const_i32(7)});
    };
    // Every other array is written with values of the frame only, so that some are of rate frame.
    const bool calm = array % 2 == 1;
    switch (dice_.below(7)) {
      case 0:
        return b_->emit_void(Op::array_resize, {calm ? dice_.pick(calm_indices_) : small()}, array);
      case 1:
        return add(b_->emit(Op::array_length, {}, array));
      case 2:
      case 3: {
        const ir::Value index = calm ? dice_.pick(calm_indices_) : small();
        const ir::Value value = calm ? dice_.pick(calm_values_) : any(Type::f32);
        return b_->emit_void(Op::array_store, {index, value}, array, component);
      }
      default:
        return add(b_->emit(Op::array_load, {small()}, array, component));
    }
  }

  void make_call() {
    const int callee = dice_.below(static_cast<int>(module_.functions.size()));
    // A copy: types of the callee's parameters and results.
    const ir::Function& function = module_.functions[static_cast<std::size_t>(callee)];
    std::vector<ir::Value> operands;
    for (const ir::Value param : function.body.params)
      operands.push_back(any(function.values[param].type));
    std::vector<Type> types;
    for (const ir::Value result : function.body.yields)
      types.push_back(function.values[result].type);
    for (const ir::Value result : b_->emit_multi(Op::call, operands, types, callee)) add(result);
  }

  void make_external() {
    const int index = dice_.below(static_cast<int>(module_.externals.size()));
    const ir::External& external = module_.externals[static_cast<std::size_t>(index)];
    std::vector<ir::Value> operands;
    for (int i = 0; i < external.arguments; ++i) operands.push_back(any(Type::f32));
    const std::vector<Type> types(static_cast<std::size_t>(external.results), Type::f32);
    for (const ir::Value result : b_->emit_multi(Op::external, operands, types, index)) add(result);
  }

  void make_if(int depth) {
    const ir::Value condition = any(Type::boolean);
    std::vector<Type> types(static_cast<std::size_t>(dice_.below(4)));
    for (Type& type : types) type = random_type();
    std::array<ir::Region, 2> regions;
    for (ir::Region& region : regions) {
      const Pool outer = pool_;
      b_->begin_region(region);
      fill(dice_.below(8), depth + 1);
      std::vector<ir::Value> yields;
      for (const Type type : types) yields.push_back(any(type));
      b_->end_region();
      region.yields = yields;
      pool_ = outer;
    }
    for (const ir::Value result :
         b_->emit_if(condition, std::move(regions[0]), std::move(regions[1])))
      add(result);
  }

  // A loop of a few turns: the first parameter counts up to a small number.
  void make_loop(int depth) {
    const ir::Value limit = dice_.one_in(2)
                                ? b_->const_i32(dice_.below(6))
                                : b_->emit(Op::iand, {any(Type::i32), b_->const_i32(3)});
    std::vector<Type> types = {Type::i32};
    std::vector<ir::Value> initial = {b_->const_i32(dice_.one_in(4) ? 3 : 0)};
    const int carried = dice_.below(4);
    for (int i = 0; i < carried; ++i) {
      types.push_back(random_type());
      initial.push_back(any(types.back()));
    }

    ir::Region head, body;
    const Pool outer = pool_;
    b_->begin_region(head);
    for (const Type type : types) add(b_->add_param(head, type), type);
    if (dice_.one_in(3)) fill(dice_.below(4), depth + 1);
    ir::Value condition = b_->emit(Op::ilt, {head.params[0], limit});
    if (dice_.one_in(3)) condition = b_->emit(Op::band, {condition, any(Type::boolean)});
    b_->end_region();
    head.yields = {condition};
    pool_ = outer;

    b_->begin_region(body);
    for (const Type type : types) add(b_->add_param(body, type), type);
    fill(1 + dice_.below(8), depth + 1);
    std::vector<ir::Value> yields = {b_->emit(Op::iadd, {body.params[0], b_->const_i32(1)})};
    for (std::size_t i = 1; i < types.size(); ++i)
      yields.push_back(dice_.one_in(5) ? body.params[i] : any(types[i]));
    b_->end_region();
    body.yields = yields;
    pool_ = outer;
    for (const ir::Value result : b_->emit_loop(initial, std::move(head), std::move(body)))
      add(result);
  }

  Dice dice_;
  RandomIrOptions options_;
  ir::Module module_;
  ir::Builder* b_ = nullptr;
  Pool pool_;
  std::vector<ir::Value> indices_;
  std::vector<ir::Value> calm_indices_;
  std::vector<ir::Value> calm_values_;
  bool in_entry_ = false;
};

inline ir::Module random_module(std::uint64_t seed, const RandomIrOptions& options = {}) {
  return RandomIr(seed, options).make();
}

// What the externals of random modules do.
inline const ir::ExternalCallback& random_externals() {
  static const ir::ExternalCallback callback =
      [](std::uint32_t external, std::span<const float> arguments, std::span<float> results) {
        if (external == 0) {
          results[0] = arguments[0] * 0.5f + arguments[1];
        } else {
          results[0] = arguments[0] + 1.0f;
          results[1] = arguments[0] * arguments[0];
        }
      };
  return callback;
}

// Values for the inputs of a random module.
inline std::vector<float> random_inputs(const ir::Module& module, std::uint64_t seed) {
  Dice dice(seed);
  std::vector<float> inputs;
  for (std::size_t i = 0; i < module.inputs.size(); ++i) inputs.push_back(dice.floating());
  return inputs;
}

}  // namespace pse::test
