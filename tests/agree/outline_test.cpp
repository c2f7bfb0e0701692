// Large programs, whose repeated calls become functions again: what every pass leaves is sound, and
// the kernel gives the bits of the program as it was written.
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "ir/count.h"
#include "ir/verifier.h"
#include "stream/image_plane.h"
#include "stream/program.h"

namespace pse {
namespace {

namespace fs = std::filesystem;

std::string read_file(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

struct Built {
  std::shared_ptr<const Program> program;
  std::string complaint;
  std::size_t written = 0, made = 0;  // functions before and behind the pass
  bool large = false;                 // too much for the interpreter
};

Built build(const std::string& name, const std::string& text, const fs::path& folder,
            bool optimize) {
  Built built;
  SourceMap sources;
  Diagnostics diagnostics;
  CompileOptions options;
  options.lower.stream = image_plane_names();
  options.optimize = optimize;
  options.interpret = !optimize;
  options.after_pass = [&](std::string_view pass, const ir::Module& module) {
    if (pass == "outline") built.made = module.functions.size();
    if (built.made == 0) built.written = module.functions.size();
    if (pass == "outline") built.large = ir::count_instructions(module) > 4000;
    if (pass != "outline" && pass != "compact") return;
    const auto complaints = ir::verify(module);
    if (!complaints.empty() && built.complaint.empty())
      ADD_FAILURE() << name << ", " << pass << ": " << (built.complaint = complaints.front());
  };
  LowerHost host;
  host.find_module = [&](SourceMap& map, const std::string& module) -> std::optional<FileId> {
    const fs::path path = folder / (module + ".pse");
    if (!fs::exists(path)) return std::nullopt;
    return map.add(path.string(), read_file(path));
  };
  built.program = compile(sources, sources.add(name, text), host, options, diagnostics);
  return built;
}

std::vector<std::vector<float>> run(const Program& program) {
  constexpr std::size_t samples = 16;
  const ir::Module& module = program.module();
  FrameState state;
  set_plane_uniforms(module, {.width = 64, .height = 64}, state);
  for (const Knob& knob : program.knobs) {
    for (std::size_t i = 0; i < module.inputs.size(); ++i)
      if (knob.value.size() == 1 && module.inputs[i].name == knob.name)
        state.uniforms[i] = knob.value[0];
  }
  RunStatus status;
  Scratch scratch;
  program.kernel->run_frame(state, status);
  std::vector<std::vector<float>> inputs,
      outputs(module.outputs.size(), std::vector<float>(samples));
  std::vector<const float*> in;
  std::vector<float*> out;
  for (const ir::Input& input : module.inputs) {
    // By name: unused inputs may be missing from one of two builds.
    const std::size_t salt = std::hash<std::string>{}(input.name) % 64;
    std::vector<float>& plane = inputs.emplace_back(samples);
    for (std::size_t s = 0; s < samples; ++s)
      plane[s] = static_cast<float>((s * 37 + salt) % 64) / 32.0f - 1.0f;
  }
  for (auto& plane : inputs) in.push_back(plane.data());
  for (auto& plane : outputs) out.push_back(plane.data());
  program.kernel->run_samples(state, status, scratch, in.data(), out.data(), samples);
  return outputs;
}

void expect_same(const std::string& name, const std::string& text, const fs::path& folder) {
  const Built optimised = build(name, text, folder, true);
  EXPECT_EQ(optimised.complaint, "") << name;
  if (optimised.large) return;
  const Built plain = build(name, text, folder, false);
  if (!optimised.program || !plain.program || !optimised.program->module().externals.empty())
    return;
  const auto expected = run(*plain.program), found = run(*optimised.program);
  ASSERT_EQ(expected.size(), found.size());
  for (std::size_t o = 0; o < expected.size(); ++o)
    for (std::size_t s = 0; s < expected[o].size(); ++s)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(expected[o][s]),
                std::bit_cast<std::uint32_t>(found[o][s]))
          << name << ": output " << o << " of sample " << s;
}

TEST(Outline, GalleryKeepsItsBits) {
  for (const auto& entry : fs::recursive_directory_iterator(PSE_SOURCE_DIR "/gallery")) {
    if (entry.path().extension() != ".pse") continue;
    expect_same(entry.path().string(), read_file(entry.path()), entry.path().parent_path());
  }
}

// A body of some size, called with other constants, within a loop, and one value used twice.
constexpr const char* repeated = R"(function bump(p, k)
    a = 0
    for i in [1 .. 40]
        a += sin(k * p.x + i) * cos(p.y - i / k) + norm(p) * k
        if a > 3 a -= exp(-a) * k
    q = p.x * p.y + k * a + fbm(p * k, 3) + spline(a, [0.1 0.7 0.2 0.9])
    return [a, q, a * q + k * p.z + unoise(p + a)]

)";

TEST(Outline, CopiesBecomeOneFunction) {
  std::string text = repeated;
  text += "t = 0\n";
  for (int i = 1; i <= 6; ++i) {
    const std::string k = std::to_string(i);
    text += "b" + k + " = bump([x, y, t * 0.01], " + k + ")\nt += b" + k + ".x + b" + k + ".z\n";
  }
  text += "color = [t, b1.y, b6.z]\n";
  const Built built = build("repeated.pse", text, ".", true);
  ASSERT_TRUE(built.program);
  EXPECT_EQ(built.complaint, "");
  EXPECT_GT(built.made, built.written);
  EXPECT_LT(ir::count_instructions(built.program->module()), 1500u);
  expect_same("repeated.pse", text, ".");
}

}  // namespace
}  // namespace pse
