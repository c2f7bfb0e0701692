// Shapes and their names.
#include "lower/value.h"

namespace pse::lower {

bool same_shape(const Typed& a, const Typed& b) {
  if (a.kind != b.kind || a.rows != b.rows || a.columns != b.columns) return false;
  if (a.kind == Kind::text) return a.text == b.text;
  if (a.kind == Kind::array) return a.array == b.array;
  if (a.kind == Kind::function)
    return a.function.definition == b.function.definition &&
           a.function.builtin == b.function.builtin;
  return true;
}

std::string describe(const Typed& value) {
  switch (value.kind) {
    case Kind::error: return "an error";
    case Kind::nothing: return "nothing";
    case Kind::number: return "a number";
    case Kind::boolean: return "a truth value";
    case Kind::vector: return "a vector of " + std::to_string(value.rows);
    case Kind::matrix:
      return "a " + std::to_string(value.rows) + "x" + std::to_string(value.columns) + " matrix";
    case Kind::text: return "a text";
    case Kind::array: return "an array";
    case Kind::function: return "a function";
  }
  return "?";
}

}  // namespace pse::lower
