// Counting and printing.
#include "app/stats.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "app/console.h"

namespace pse::app {
namespace {

bool is_constant(ir::Op op) {
  return op == ir::Op::const_f32 || op == ir::Op::const_i32 || op == ir::Op::const_bool;
}

void count(const ir::Region& region, int& constant, int& others) {
  for (const ir::Instruction& instruction : region.body) {
    ++(is_constant(instruction.op) ? constant : others);
    for (const ir::Region& inner : instruction.regions) count(inner, constant, others);
  }
}

// The most memory that the process ever had resident.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

}  // namespace

OperationCounts count_operations(const passes::SplitModule& split) {
  OperationCounts counts;
  for (std::uint32_t i = 0; i < split.module.functions.size(); ++i)
    count(split.module.functions[i].body, counts.constant,
          i == split.frame ? counts.frame : counts.sample);
  return counts;
}

std::string stats_text(const RunStats& s) {
  const double compile = s.compile.parse + s.compile.lower + s.compile.passes + s.compile.codegen;
  std::string out;
  out +=
      fmt::format("compile       {} (parse {}, lower {}, passes {}, code {}{})\n",
                  human_seconds(compile), human_seconds(s.compile.parse),
                  human_seconds(s.compile.lower), human_seconds(s.compile.passes),
                  human_seconds(s.compile.codegen), s.compile.from_cache ? " from the cache" : "");
  out += fmt::format("operations    {} constant, {} per frame, {} per sample\n",
                     s.operations.constant, s.operations.frame, s.operations.sample);
  out += fmt::format("samples       {:.0f} in {} frame{}\n", s.samples, s.frames,
                     s.frames == 1 ? "" : "s");
  if (s.compute_seconds > 0)
    out += fmt::format("speed         {:.2f} million samples per second, {:.1f} ns each\n",
                       s.samples / s.compute_seconds * 1e-6,
                       s.compute_seconds / std::max(s.samples, 1.0) * 1e9);
  out += fmt::format("machine       {} thread{}, {} samples per vector\n", s.threads,
                     s.threads == 1 ? "" : "s", s.width);
  out += fmt::format("time          {} computing, {} in all\n", human_seconds(s.compute_seconds),
                     human_seconds(s.total_seconds));
  return out + fmt::format("memory        {}", human_bytes(peak_bytes()));
}

std::string stats_json(const RunStats& s) {
  const nlohmann::ordered_json json = {
      {"compile",
       {{"parse", s.compile.parse},
        {"lower", s.compile.lower},
        {"passes", s.compile.passes},
        {"codegen", s.compile.codegen},
        {"from_cache", s.compile.from_cache}}},
      {"operations",
       {{"constant", s.operations.constant},
        {"frame", s.operations.frame},
        {"sample", s.operations.sample}}},
      {"frames", s.frames},
      {"samples", s.samples},
      {"samples_per_second", s.compute_seconds > 0 ? s.samples / s.compute_seconds : 0.0},
      {"compute_seconds", s.compute_seconds},
      {"total_seconds", s.total_seconds},
      {"threads", s.threads},
      {"width", s.width},
      {"peak_bytes", peak_bytes()}};
  return json.dump(2) + "\n";
}

}  // namespace pse::app
