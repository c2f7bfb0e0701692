// Counting and printing.
#include "app/stats.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "app/console.h"

namespace pse::app {
namespace {

// The most memory that the process ever had resident.
double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

}  // namespace

std::string operations_text(const OperationCounts& counts, std::string_view indent) {
  std::string out = fmt::format("{}operations    per constant  per frame  per sample\n", indent);
  out += fmt::format("{}  written     {:>12}  {:>9}  {:>10}\n", indent, counts.written[0],
                     counts.written[1], counts.written[2]);
  out += fmt::format("{}  compiled    {:>12}  {:>9}  {:>10}\n", indent, "-", counts.frame,
                     counts.sample);
  if (counts.samples_looked_at > 0)
    out += fmt::format("{}  run         {:>12}  {:>9.0f}  {:>10.1f}\n", indent, "-",
                       counts.frame_run, counts.sample_run);
  return out;
}

std::string stats_text(const RunStats& s) {
  const double compile = s.compile.parse + s.compile.lower + s.compile.passes + s.compile.codegen;
  std::string out;
  out +=
      fmt::format("compile       {} (parse {}, lower {}, passes {}, code {}{})\n",
                  human_seconds(compile), human_seconds(s.compile.parse),
                  human_seconds(s.compile.lower), human_seconds(s.compile.passes),
                  human_seconds(s.compile.codegen),
                  s.compile.from_cache   ? " from the cache"
                  : s.compile.first_tier ? " of the first tier"
                                         : "");
  out += operations_text(s.operations, "");
  out += fmt::format("samples       {:.0f} in {} frame{}\n", s.samples, s.frames,
                     s.frames == 1 ? "" : "s");
  const auto pixels = [&](std::int64_t count) {
    return fmt::format("{} ({:.2f}%)", count, 100 * double(count) / std::max(s.samples, 1.0));
  };
  if (s.antialias.filtered > 0)
    out += fmt::format("antialias     {} pixels filtered, {} blended, {} supersampled\n",
                       pixels(s.antialias.filtered), pixels(s.antialias.blended),
                       pixels(s.antialias.supersampled));
  if (s.antialias.left > 0)
    out += fmt::format(
        "              {} left as they are: stored pixels tell no more of their edges\n",
        pixels(s.antialias.left));
  if (s.tier_samples.first > 0)
    out += fmt::format("code          {} samples by the first tier, {} by the optimised code\n",
                       s.tier_samples.first, s.tier_samples.optimised);
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
        {"from_cache", s.compile.from_cache},
        {"first_tier", s.compile.first_tier}}},
      {"samples_by_tier",
       {{"first_tier", s.tier_samples.first}, {"optimised", s.tier_samples.optimised}}},
      {"operations",
       {{"written",
         {{"constant", s.operations.written[0]},
          {"frame", s.operations.written[1]},
          {"sample", s.operations.written[2]}}},
        {"compiled", {{"frame", s.operations.frame}, {"sample", s.operations.sample}}},
        {"run",
         {{"frame", s.operations.frame_run},
          {"sample", s.operations.sample_run},
          {"samples_looked_at", s.operations.samples_looked_at}}}}},
      {"frames", s.frames},
      {"samples", s.samples},
      {"antialias",
       {{"filtered", s.antialias.filtered},
        {"blended", s.antialias.blended},
        {"supersampled", s.antialias.supersampled},
        {"left", s.antialias.left}}},
      {"samples_per_second", s.compute_seconds > 0 ? s.samples / s.compute_seconds : 0.0},
      {"compute_seconds", s.compute_seconds},
      {"total_seconds", s.total_seconds},
      {"threads", s.threads},
      {"width", s.width},
      {"peak_bytes", peak_bytes()}};
  return json.dump(2) + "\n";
}

}  // namespace pse::app
