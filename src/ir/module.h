// The typed IR: SSA values, structured control flow, scalars only (a vector is its components).
// Third stage of the flow: tree -> IR -> passes -> kernel. ops.h says what each operator means.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "diag/source.h"
#include "ir/ops.h"

namespace pse::ir {

// How often a value is computed: once per program, per frame, per sample. Rates are assigned by
// passes/rates.
enum class Rate : std::uint8_t { constant, frame, sample };

// A value is an index into Function::values. Every value is defined exactly once, before its uses,
// and is visible in its own region after its definition and in regions nested there.
using Value = std::uint32_t;
inline constexpr Value no_value = 0xffffffffu;

struct ValueInfo {
  Type type = Type::f32;
  Rate rate = Rate::sample;
};

struct Instruction;

// A list of instructions with parameters (loops only) and yields.
struct Region {
  std::vector<Value> params;
  std::vector<Instruction> body;
  std::vector<Value> yields;
};

struct Instruction {
  Op op = Op::const_f32;
  std::vector<Value> operands;
  std::vector<Value> results;
  // const_f32 (as float bits), const_i32, const_bool: the value. Others: an index, see ops.h.
  std::int32_t imm = 0;
  std::int32_t component = 0;   // array_load, array_store
  // if_: then, else. loop: head (params; yields the condition), body (params; yields the next).
  std::vector<Region> regions;
  Span span;                    // what the user wrote, for reports; may be invalid

  float imm_f32() const { return __builtin_bit_cast(float, imm); }
  Value result() const { return results.front(); }
};

// Memory that `a[i] = v` grows. Stored as `components` planes of `capacity` elements.
struct Array {
  std::string name;
  std::int32_t components = 1;
  std::int32_t capacity = 0;
  Rate rate = Rate::sample;
  std::int32_t initial_length = 0;
};

// body.params are the function's parameters and body.yields its results.
struct Function {
  std::string name;
  std::vector<ValueInfo> values;
  std::vector<Array> arrays;  // only the entry function has any
  Region body;

  Value add_value(Type type) {
    values.push_back({type, Rate::sample});
    return static_cast<Value>(values.size() - 1);
  }
};

struct FloatTable {
  std::string name;
  std::vector<float> entries;  // a power of two of them
};
struct IntTable {
  std::string name;
  std::vector<std::int32_t> entries;  // a power of two of them
};
struct ByteTable {
  std::string name;
  std::vector<std::uint8_t> entries;  // exactly 256
};

// Whether the stream can tell how much an input changes from pixel to pixel; of_frame: by the same
// amount everywhere.
enum class InputSlopes : std::uint8_t { none, of_frame, of_sample };

// One float that the stream brings (rate sample) or that holds for a frame (knobs, frame, time).
struct Input {
  std::string name;  // "point.0", "Radius"
  Rate rate = Rate::sample;
  InputSlopes slopes = InputSlopes::none;
};

// One float that the program sets. body.yields of the entry function are in this order.
struct Output {
  std::string name;  // "color.0"
};

struct Check {
  Span span;
  std::string message;
};

// A function outside the program (image lookup, ray cast), bound by the host before the run.
struct External {
  std::string name;  // "texture cloud.exr color linear repeat": the host parses it
  std::int32_t arguments = 0;
  std::int32_t results = 0;
};

struct Module {
  std::vector<Function> functions;  // functions[entry] is the program; the others are called
  std::uint32_t entry = 0;
  std::vector<FloatTable> float_tables;
  std::vector<IntTable> int_tables;
  std::vector<ByteTable> byte_tables;
  std::vector<Input> inputs;
  std::vector<Output> outputs;
  std::vector<Check> checks;
  std::vector<External> externals;

  const Function& main() const { return functions[entry]; }
  Function& main() { return functions[entry]; }
};

}  // namespace pse::ir
