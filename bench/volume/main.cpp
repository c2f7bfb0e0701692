// What the prepass saves: smoke programs with and without --prepass, the number of density
// evaluations and the largest difference between the pictures. The chapter's own figure is 30-fold;
// no pixel may differ by more than 2/255.
// usage: bench_volume [--res N] [program [Name=VALUE...]]
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "app/console.h"
#include "app/session.h"
#include "image/reader.h"

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

// Runs pse in this process; gives its messages and its time.
double run_pse(const Words& words, const fs::path& log, std::string& said) {
  std::FILE* err = std::fopen(log.c_str(), "w");
  pse::app::Console console(stdout, err);
  const auto start = std::chrono::steady_clock::now();
  const int status = pse::app::run_command_line(words, console);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::fclose(err);
  std::FILE* in = std::fopen(log.c_str(), "r");
  said.clear();
  for (int c = std::fgetc(in); c != EOF; c = std::fgetc(in)) said += static_cast<char>(c);
  std::fclose(in);
  if (status != 0) {
    fmt::print(stderr, "{}", said);
    std::exit(1);
  }
  return seconds;
}

pse::image::Image read(const fs::path& file, bool as_stored) {
  pse::image::ReadOptions options;
  if (as_stored) options.working.reset();
  return *pse::image::read_image(file.string(), options);
}

double sum(const pse::image::Image& image) {
  double total = 0;
  for (const float value : image.planes[0]) total += double(value);
  return total;
}

// The largest difference of two 8-bit pictures, in steps of 1/255.
double difference(const fs::path& a, const fs::path& b) {
  const auto one = read(a, true), other = read(b, true);
  double largest = 0;
  for (std::size_t p = 0; p < one.planes.size(); ++p)
    for (std::size_t i = 0; i < one.planes[p].size(); ++i)
      largest = std::max(largest, 255.0 * std::abs(double(one.planes[p][i]) - double(other.planes[p][i])));
  return largest;
}

bool measure(const std::string& name, const Words& program, const std::string& res,
             const fs::path& folder) {
  std::string said;
  const auto render = [&](const std::string& tag, const Words& more) {
    Words words = {"render"};
    words.insert(words.end(), program.begin(), program.end());
    words.insert(words.end(), {"--antialias", "none", "--res", res, "-o", (folder / (tag + ".png")).string()});
    words.insert(words.end(), more.begin(), more.end());
    return run_pse(words, folder / "log", said);
  };
  const auto count = [&](const std::string& tag, const Words& more) {
    Words words = {"-o", "evaluations=" + (folder / (tag + ".exr")).string(), "--stats"};
    words.insert(words.end(), more.begin(), more.end());
    render("unused", words);
    return sum(read(folder / (tag + ".exr"), false));
  };
  const double full = count("full", {}), rest = count("rest", {"--prepass", "4"});
  const auto number_after = [&](const std::string& text) {
    const std::size_t at = said.find(text);
    return at == std::string::npos ? 0 : std::atof(said.c_str() + at + text.size());
  };
  // The bounds of a box cost about as much as three densities.
  const double boxes = number_after("the bounds of ");
  const double prepass = number_after("prepass: ") + 3 * boxes;
  const double slow = render("a", {}), fast = render("b", {"--prepass", "4"});
  const double apart = difference(folder / "a.png", folder / "b.png");
  const double times = full / (rest + prepass);
  fmt::print("{:<28} {:>12.0f} {:>8.0f} {:>10.0f} {:>10.0f} {:>7.1f} {:>8.2f} {:>8.2f} {:>8.1f}\n", name, full,
             boxes, prepass, rest, times, slow, fast, apart);
  return times >= 30 && apart <= 2;
}

}  // namespace

int main(int count, char** arguments) {
  Words words(arguments + 1, arguments + count);
  std::string res = "512x512";
  if (words.size() >= 2 && words[0] == "--res") {
    res = words[1];
    words.erase(words.begin(), words.begin() + 2);
  }
  std::string folder = (fs::temp_directory_path() / "pse-bench-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return 1;
  fmt::print("{:<28} {:>12} {:>8} {:>10} {:>10} {:>7} {:>8} {:>8} {:>8}\n", "density evaluations at " + res,
             "without", "boxes", "prepass", "picture", "fewer", "s", "s with", "of 255");
  bool good = true;
  if (!words.empty()) {
    good = measure(words.front(), words, res, folder);
  } else {
    const std::string smoke = PSE_SOURCE_DIR "/gallery/2002/hypertexture/smoke.pse";
    for (const auto& [name, more] : std::vector<std::pair<std::string, Words>>{
             {"smoke", {smoke}},
             {"smoke, wide", {smoke, "Width=0.065"}},
             {"smoke, later", {smoke, "Time=1.7"}},
             {"smoke ring",
              {smoke, "Amount=0.9", "Frequency=3", "Near=12", "Width=0.035", "Time=0.3"}}})
      good = measure(name, more, res, folder) && good;
  }
  fs::remove_all(folder);
  return good ? 0 : 1;
}
