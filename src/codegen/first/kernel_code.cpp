// The frame around the functions: registers saved and set, the loop over samples, the lookups and
// the constants behind the code.
#include "codegen/first/kernel_code.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "codegen/first/function_code.h"
#include "codegen/kernel_call.h"

namespace pse::first {
namespace {

using enum Gpr;
constexpr Gpr saved[] = {rbx, rbp, r12, r13, r14, r15};

class Writer {
 public:
  explicit Writer(const passes::SplitModule& split)
      : k_(split), code_(k_.code), entered_(split.module.main()) {}

  std::expected<KernelCode, std::string> write() {
    lay_out();
    begin();
    functions_of(entered_.body);
    if (!k_.refused.empty()) return std::unexpected(k_.refused);
    FunctionCode samples(k_, entered_);
    loop_over(samples);
    for (auto& [table, label] : k_.byte_lookups) byte_lookup(table, label);
    if (!k_.refused.empty()) return std::unexpected(k_.refused);
    return finish();
  }

 private:
  // Row 0 keeps the stack pointer; then the block for calls of the host, and lengths.
  void lay_out() {
    k_.frame_size = row_size;
    std::int32_t rows = 2;
    for (const ir::External& external : k_.split.module.externals)
      rows = std::max(rows, external.arguments + external.results);
    k_.call_block = take(rows);
    for (const ir::Array& array : entered_.arrays)
      k_.lengths.push_back(array.rate == ir::Rate::sample ? take(1) : 0);
    constexpr std::int64_t most = std::int64_t{1} << 28;
    if (k_.sample_arrays.size > most || k_.frame_arrays.size > most) k_.refused = "huge arrays";
  }

  std::int32_t take(std::int32_t rows) {
    const std::int32_t first = k_.frame_size;
    k_.frame_size += rows * row_size;
    return first;
  }

  // Registers, and a jump over the functions that are called.
  void begin() {
    for (const Gpr reg : saved) code_.push(reg);
    code_.add(rsp, -8);
    code_.move(call_base, rdi);
    code_.load(Places::frame, {call_base, offsetof(KernelCall, scratch)});
    code_.add(Places::frame, static_cast<std::int32_t>(4 * k_.sample_arrays.size));
    code_.load(Places::uniforms, {call_base, offsetof(KernelCall, uniforms)});
    code_.load(cancel_flag, {call_base, offsetof(KernelCall, cancel)});
    constants_ = code_.address_ahead(Constants::base);
    code_.store({Places::frame}, rsp);
    code_.set32(sample_index, 0);
    code_.jump(start_);
  }

  // Called functions before their callers, which must know their rows.
  void functions_of(const ir::Region& region) {
    for (const ir::Instruction& in : region.body) {
      for (const ir::Region& inner : in.regions) functions_of(inner);
      const auto index = static_cast<std::uint32_t>(in.imm);
      if (in.op != ir::Op::call || k_.callees.contains(index)) continue;
      const ir::Function& function = k_.split.module.functions[index];
      functions_of(function.body);
      Callee& callee = k_.callees[index];
      callee.mask = take(1);
      callee.params = take(static_cast<std::int32_t>(function.body.params.size()));
      callee.results = take(static_cast<std::int32_t>(function.body.yields.size()));
      FunctionCode(k_, function).write_called(callee);
    }
  }

  void loop_over(FunctionCode& samples) {
    Label next;
    code_.bind(start_);
    code_.bind(next);
    code_.compare(sample_index, {call_base, offsetof(KernelCall, count)});
    code_.jump(Assembler::When::not_less, k_.leave);
    code_.compare_byte({cancel_flag}, 0);
    code_.jump(Assembler::When::not_equal, k_.leave);
    samples.write_samples();
    code_.add(sample_index, lanes);
    code_.jump(next);

    // From anywhere, called functions included.
    code_.bind(k_.leave);
    code_.load(rsp, {Places::frame});
    code_.zero_upper();
    code_.add(rsp, 8);
    for (auto reg = std::rbegin(saved); reg != std::rend(saved); ++reg) code_.pop(*reg);
    code_.ret();
  }

  // Register 0: each byte replaced by its entry. A shuffle looks up 16 entries and gives 0 where
  // the index is negative, so with the index lowered by 16 at each step the steps 0..k all answer
  // an index of row k; rows that hold the difference to the row before (by exclusive or) make the
  // sum of these answers the entry. Each half of the table answers only for its half of the
  // indices.
  void byte_lookup(std::int32_t table, Label& label) {
    constexpr Ymm index = 0, lowered = 1, sum = 2, answer = 3;
    const auto& entries = k_.split.module.byte_tables[static_cast<std::size_t>(table)].entries;
    code_.bind(label);
    code_.vector(op::xor_ps, sum, sum, sum);
    for (std::size_t half = 0; half < 2; ++half) {
      if (half == 1) code_.vector(op::xor_ps, index, index, k_.constants.all(0x80808080u));
      for (std::size_t row = 0; row < 8; ++row) {
        const std::size_t first = 128 * half + 16 * row;
        std::array<std::uint8_t, 32> difference{};
        for (std::size_t i = 0; i < 32; ++i) {
          const int before = row == 0 ? 0 : entries[first + i % 16 - 16];
          difference[i] = static_cast<std::uint8_t>(entries[first + i % 16] ^ before);
        }
        const auto step = static_cast<std::uint32_t>(16 * row * 0x01010101u);
        if (row > 0) code_.vector(op::sub_saturated_b, lowered, index, k_.constants.all(step));
        code_.load(answer, k_.constants.row(std::bit_cast<Constants::Row>(difference)));
        code_.vector(op::shuffle_b, answer, answer, row == 0 ? index : lowered);
        code_.vector(op::xor_ps, sum, sum, answer);
      }
    }
    code_.move(0, sum);
    code_.ret();
  }

  KernelCode finish() {
    KernelCode made;
    const std::size_t place = (code_.size() + 63) / 64 * 64;
    code_.fill_distance(constants_, place);
    made.bytes = code_.code();
    const auto& words = k_.constants.words();
    made.bytes.resize(place + words.size() * sizeof words[0]);
    std::memcpy(made.bytes.data() + place, words.data(), words.size() * sizeof words[0]);
    made.frame_floats = k_.frame_size / 4;
    return made;
  }

  KernelState k_;
  Assembler& code_;
  const ir::Function& entered_;
  Label start_;
  std::size_t constants_ = 0;
};

}  // namespace

std::expected<KernelCode, std::string> write_kernel(const passes::SplitModule& split) {
  return Writer(split).write();
}

}  // namespace pse::first
