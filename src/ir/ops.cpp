// The operator table itself.
#include "ir/ops.h"

#include <array>

namespace pse::ir {
namespace {

// Throughout: float is IEEE binary32, round to nearest even, subnormals kept, nothing contracted.
// Every NaN is the same value: no operator's result may depend on a NaN's sign or payload, and
// outputs store the NaN 0x7fc00000.
constexpr std::array operators = {
    OpInfo{Op::const_f32, "const.f", "", "f", true, "the float `imm`"},
    OpInfo{Op::const_i32, "const.i", "", "i", true, "the 32-bit integer `imm`"},
    OpInfo{Op::const_bool, "const.b", "", "b", true, "true if `imm` is not 0"},
    OpInfo{Op::input, "input", "", "f", true,
           "component `imm` of the flat list Module::inputs for this sample"},
    OpInfo{Op::slope, "slope", "f", "f", true,
           "how much a changes from this sample to the pixel on its right (`imm` 0) or below it "
           "(1), by the program's derivative; passes/slopes puts the derivative in its place "
           "before anything runs, and where it has not, this is 0"},
    OpInfo{Op::fadd, "fadd", "ff", "f", true, "a + b"},
    OpInfo{Op::fsub, "fsub", "ff", "f", true, "a - b"},
    OpInfo{Op::fmul, "fmul", "ff", "f", true, "a * b"},
    OpInfo{Op::fdiv, "fdiv", "ff", "f", true,
           "a / b; x/0 is an infinity of the product of the signs, 0/0 is NaN"},
    OpInfo{Op::fma, "fma", "fff", "f", true,
           "a * b + c with one rounding; the only fused operation there is"},
    OpInfo{Op::fneg, "fneg", "f", "f", true, "a with its sign bit flipped"},
    OpInfo{Op::fabs, "fabs", "f", "f", true, "a with its sign bit cleared"},
    OpInfo{Op::fsqrt, "fsqrt", "f", "f", true, "the correctly rounded square root; NaN below -0"},
    OpInfo{Op::fmin, "fmin", "ff", "f", true,
           "a < b ? a : b; so b where either is NaN and where both are zero"},
    OpInfo{Op::fmax, "fmax", "ff", "f", true,
           "a > b ? a : b; so b where either is NaN and where both are zero"},
    OpInfo{Op::ffloor, "ffloor", "f", "f", true,
           "the largest integer not above a; keeps -0, infinities and NaN"},
    OpInfo{Op::fceil, "fceil", "f", "f", true,
           "the smallest integer not below a; keeps -0, infinities and NaN"},
    OpInfo{Op::ftrunc, "ftrunc", "f", "f", true,
           "a without its fraction; keeps the sign of zero, infinities, NaN"},
    OpInfo{Op::fround, "fround", "f", "f", true,
           "the nearest integer, halves to even; keeps -0, infinities and NaN"},
    OpInfo{Op::feq, "feq", "ff", "b", true, "a equals b; false where either is NaN"},
    OpInfo{Op::fne, "fne", "ff", "b", true, "not feq: true where either is NaN"},
    OpInfo{Op::flt, "flt", "ff", "b", true, "a below b; false where either is NaN"},
    OpInfo{Op::fle, "fle", "ff", "b", true, "a below or equal to b; false where either is NaN"},
    OpInfo{Op::iadd, "iadd", "ii", "i", true, "a + b modulo 2^32"},
    OpInfo{Op::isub, "isub", "ii", "i", true, "a - b modulo 2^32"},
    OpInfo{Op::imul, "imul", "ii", "i", true, "a * b modulo 2^32"},
    OpInfo{Op::iand, "iand", "ii", "i", true, "bitwise and"},
    OpInfo{Op::ior, "ior", "ii", "i", true, "bitwise or"},
    OpInfo{Op::ixor, "ixor", "ii", "i", true, "bitwise exclusive or"},
    OpInfo{Op::ishl, "ishl", "ii", "i", true,
           "a shifted left by b; 0 where b as unsigned is above 31"},
    OpInfo{Op::ishr, "ishr", "ii", "i", true,
           "a shifted right by b, zeros in; 0 where b as unsigned is above 31"},
    OpInfo{Op::isar, "isar", "ii", "i", true,
           "a shifted right by b, sign in; as if by 31 where b as unsigned is above 31"},
    OpInfo{Op::ieq, "ieq", "ii", "b", true, "a equals b"},
    OpInfo{Op::ine, "ine", "ii", "b", true, "a differs from b"},
    OpInfo{Op::ilt, "ilt", "ii", "b", true, "a below b, signed"},
    OpInfo{Op::ile, "ile", "ii", "b", true, "a below or equal to b, signed"},
    OpInfo{Op::band, "band", "bb", "b", true, "both"},
    OpInfo{Op::bor, "bor", "bb", "b", true, "either or both"},
    OpInfo{Op::bxor, "bxor", "bb", "b", true, "one but not both"},
    OpInfo{Op::bnot, "bnot", "b", "b", true, "the other truth value"},
    OpInfo{Op::select, "select", "bTT", "T", true,
           "b where the condition is true, c where it is false; both are computed"},
    OpInfo{Op::f2i, "f2i", "f", "i", true,
           "a without its fraction as an integer; -2^31 where that does not fit and for NaN"},
    OpInfo{Op::i2f, "i2f", "i", "f", true, "the float nearest to a, halves to even"},
    OpInfo{Op::f2bits, "f2bits", "f", "i", true,
           "the 32 bits of a; any bits of a NaN for NaN, and the rest must not care which"},
    OpInfo{Op::bits2f, "bits2f", "i", "f", true, "the float with these bits"},
    OpInfo{Op::table_f32, "table.f", "i", "f", true,
           "entry (a mod size) of float table `imm`; the size is a power of two"},
    OpInfo{Op::table_i32, "table.i", "i", "i", true,
           "entry (a mod size) of integer table `imm`; the size is a power of two"},
    OpInfo{Op::bytes_add, "bytes.add", "ii", "i", true,
           "each of the four bytes of a plus the same byte of b, modulo 256"},
    OpInfo{Op::bytes_lookup, "bytes.lookup", "i", "i", true,
           "each of the four bytes of a replaced by that entry of the 256-entry byte table `imm`"},
    OpInfo{Op::array_load, "array.load", "i", "f", false,
           "component `component` of element a (from 0) of array `imm`; 0 outside [0, length)"},
    OpInfo{Op::array_store, "array.store", "if", "", false,
           "sets that component of element a; nothing outside [0, capacity)"},
    OpInfo{Op::array_length, "array.length", "", "i", false, "the length of array `imm`"},
    OpInfo{Op::array_resize, "array.resize", "i", "", false,
           "sets the length of array `imm` to a, cut to [0, capacity]; new elements are 0"},
    OpInfo{Op::check, "check", "b", "", false,
           "where a is false, reports Module::checks[imm] and ends the run with an error"},
    OpInfo{Op::call, "call", "*", "*", true,
           "the results of function `imm` for these operands; a called function is pure and has no "
           "inputs"},
    OpInfo{Op::external, "external", "*", "*", true,
           "calls Module::externals[imm], a pure function of floats to floats; one without results "
           "tells the host something, and is never left out"},
    OpInfo{Op::if_, "if", "b", "*", false,
           "runs region 0 where a is true, region 1 where it is false, and gives that region's "
           "yields"},
    OpInfo{Op::loop, "loop", "*", "*", false,
           "params = operands; while region 0's yield is true: params = region 1's yields; gives "
           "the params"},
};
static_assert(operators.size() == static_cast<std::size_t>(Op::loop) + 1);

}  // namespace

std::span<const OpInfo> op_table() { return operators; }
const OpInfo& info(Op op) { return operators[static_cast<std::size_t>(op)]; }

}  // namespace pse::ir
