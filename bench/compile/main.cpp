// From a program's text to its first native code, and to LLVM's, for every program of the gallery:
// no cache, each time in a fresh process, as a user meets it. Both kernels must agree with the
// interpreter, bit for bit on 32 samples, before their times count.
// usage: bench_compile [RUNS] [WORDS OF A FILE'S PATH...]
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "app/free_names.h"
#include "ir/count.h"
#include "lang/parser.h"
#include "stream/image_plane.h"
#include "stream/program.h"

namespace {

using namespace pse;
namespace fs = std::filesystem;

// Milliseconds of one compilation by the clock; of its longest thread, which is what the clock says
// on a machine with nothing else to do; and of all its threads together.
struct Sample {
  double front = 0, passes = 0, codegen = 0, path = 0, work = 0;
  int instructions = 0, width = 0;
  int agrees = 0;
  double all() const { return front + passes + codegen; }
};

std::string read_file(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::shared_ptr<const Program> compile_file(const fs::path& path, Tier tier,
                                            bool interpret = false) {
  SourceMap sources;
  Diagnostics diagnostics;
  const FileId file = sources.add(path.string(), read_file(path));
  Diagnostics ignored;
  CompileOptions options;
  options.tier = tier;
  options.interpret = interpret;
  options.lower.stream = app::image_names_read(lang::parse(sources, file, ignored));
  for (const StreamName& name : image_plane_names()) options.lower.stream.push_back(name);
  LowerHost host;
  host.find_module = [&](SourceMap& map, const std::string& name) -> std::optional<FileId> {
    const fs::path module = path.parent_path() / (name + ".pse");
    if (!fs::exists(module)) return std::nullopt;
    return map.add(module.string(), read_file(module));
  };
  host.texture_components = [](const std::string&, const std::string& layer, std::string&) {
    return layer == "alpha" || layer == "Z" ? 1 : 3;
  };
  return compile(sources, file, host, options, diagnostics);
}

// What a texture would answer: here it only must be the same for both kernels.
void grey(void*, std::int64_t count, const float* const* arguments, float* const* results) {
  for (std::int64_t i = 0; i < count; ++i) results[0][i] = arguments[0][i] * 0.25f;
}

bool agree(const Program& a, const Program& b) {
  constexpr std::size_t samples = 32;
  std::vector<std::vector<float>> outputs[2];
  const Program* programs[] = {&a, &b};
  for (std::size_t which = 0; which < 2; ++which) {
    const Program& program = *programs[which];
    const ir::Module& module = program.module();
    for (const ir::External& external : module.externals)
      if (external.results != 1 || external.arguments < 1) return true;  // not comparable here
    FrameState state;
    set_plane_uniforms(module, {.width = 64, .height = 64}, state);
    for (const Knob& knob : program.knobs)
      for (std::size_t c = 0; c < knob.value.size(); ++c)
        for (std::size_t i = 0; i < module.inputs.size(); ++i)
          if (module.inputs[i].name ==
              (knob.value.size() == 1 ? knob.name : knob.name + "." + std::to_string(c)))
            state.uniforms[i] = knob.value[c];
    state.externals.resize(module.externals.size(), {grey, nullptr});
    RunStatus status;
    Scratch scratch;
    program.kernel->run_frame(state, status);
    std::vector<std::vector<float>> inputs(module.inputs.size(), std::vector<float>(samples));
    for (std::size_t i = 0; i < inputs.size(); ++i)
      for (std::size_t s = 0; s < samples; ++s)
        inputs[i][s] = static_cast<float>((s * 37 + i * 11) % 64) / 48.0f - 0.6f;
    outputs[which].assign(module.outputs.size(), std::vector<float>(samples));
    std::vector<const float*> in;
    std::vector<float*> out;
    for (auto& plane : inputs) in.push_back(plane.data());
    for (auto& plane : outputs[which]) out.push_back(plane.data());
    program.kernel->run_samples(state, status, scratch, in.data(), out.data(), samples);
  }
  for (std::size_t o = 0; o < outputs[0].size(); ++o)
    if (std::memcmp(outputs[0][o].data(), outputs[1][o].data(), samples * sizeof(float)) != 0)
      return false;
  return true;
}

double ms_of(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

Sample measure_here(const fs::path& path, Tier tier, bool check) {
  Sample sample;
  const double work = ms_of(CLOCK_PROCESS_CPUTIME_ID), own = ms_of(CLOCK_THREAD_CPUTIME_ID);
  const auto program = compile_file(path, tier);
  if (!program) return sample;
  const CompileTimes& t = program->times;
  sample.work = ms_of(CLOCK_PROCESS_CPUTIME_ID) - work;
  sample.path = ms_of(CLOCK_THREAD_CPUTIME_ID) - own + t.behind * 1e3;
  sample.front = (t.parse + t.lower) * 1e3;
  sample.passes = t.passes * 1e3;
  sample.codegen = t.codegen * 1e3;
  sample.instructions = static_cast<int>(ir::count_instructions(program->module()));
  sample.width = program->kernel->width();
  sample.agrees = 1;
  if (check) {
    const auto meaning = compile_file(path, tier, true);
    sample.agrees = meaning && agree(*program, *meaning);
  }
  return sample;
}

// In a child, so that LLVM is opened anew.
Sample measure(const fs::path& path, Tier tier, bool check = false) {
  std::array<int, 2> pipe_ends{};
  Sample sample;
  if (pipe(pipe_ends.data()) != 0) std::exit(1);
  const pid_t child = fork();
  if (child == 0) {
    const Sample found = measure_here(path, tier, check);
    _exit(write(pipe_ends[1], &found, sizeof found) == sizeof found ? 0 : 1);
  }
  close(pipe_ends[1]);
  if (read(pipe_ends[0], &sample, sizeof sample) != sizeof sample) sample = {};
  close(pipe_ends[0]);
  waitpid(child, nullptr, 0);
  return sample;
}

double at(std::vector<double> values, double part) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1) + 0.5)];
}

int run(int runs, const std::vector<std::string>& words) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(PSE_GALLERY))
    if (entry.path().extension() == ".pse") files.push_back(entry.path());
  std::ranges::sort(files);
  std::printf("%-40s %6s %7s %7s %6s %7s %-14s %8s %8s %8s %8s\n", "milliseconds, medians", "ops",
              "front", "passes", "code", "first", "quartiles", "LLVM", "in all", "path", "work");
  int wrong = 0, skipped = 0;
  double worst = 0;
  for (const fs::path& file : files) {
    const std::string name = fs::relative(file, PSE_GALLERY).string();
    const auto fits = [&](const std::string& word) { return name.contains(word); };
    if (!words.empty() && std::ranges::none_of(words, fits)) continue;
    const Sample checked = measure(file, Tier::optimised, true);
    if (checked.width == 0) {  // needs what only a renderer brings
      ++skipped;
      continue;
    }
    if (!checked.agrees || !measure(file, Tier::first, true).agrees) {
      std::printf("%s: a kernel and the interpreter differ\n", name.c_str());
      ++wrong;
      continue;
    }
    std::vector<Sample> first, optimised;
    for (int i = 0; i < runs; ++i) {
      first.push_back(measure(file, Tier::first));
      optimised.push_back(measure(file, Tier::optimised));
    }
    const auto column = [](const std::vector<Sample>& samples, auto value) {
      std::vector<double> values;
      for (const Sample& s : samples) values.push_back(value(s));
      return values;
    };
    const auto middle = [&](const std::vector<Sample>& samples, double Sample::*member) {
      return at(column(samples, [&](const Sample& s) { return s.*member; }), 0.5);
    };
    const auto total = column(first, [](const Sample& s) { return s.all(); });
    const auto with_llvm = column(optimised, [](const Sample& s) { return s.all(); });
    std::printf("%-40s %6d %7.2f %7.2f %6.2f %7.2f [%.1f .. %.1f] %10.2f %8.2f %8.2f %8.2f\n",
                name.c_str(), checked.instructions, middle(first, &Sample::front),
                middle(first, &Sample::passes), middle(first, &Sample::codegen), at(total, 0.5),
                at(total, 0.25), at(total, 0.75), middle(optimised, &Sample::codegen),
                at(with_llvm, 0.5), middle(optimised, &Sample::path),
                middle(optimised, &Sample::work));
    std::fflush(stdout);
    worst = std::max(worst, at(total, 0.5));
  }
  std::printf(
      "slowest to its first native code %.1f ms (goal: 50); %d programs need inputs that are not "
      "at hand\n",
      worst, skipped);
  return wrong != 0;
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 9,
             std::vector<std::string>(argv + std::min(argc, 2), argv + argc));
}
