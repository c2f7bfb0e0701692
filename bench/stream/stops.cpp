// How soon a job ends that is told to: from SIGTERM to the end of the process, for jobs that are
// busy with different things. Each must end with 143 and leave nothing. The promise is 50 ms on a
// machine of its own. usage: bench_stop [RUNS]
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "programs.h"

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

struct Job {
  const char* name;
  std::string program;             // its text
  std::vector<std::string> words;  // behind the program
  int after_ms = 700;              // into it
};

std::string straight_line() {
  std::string text = "t = 0\n";
  for (int i = 1; i <= 200; ++i) text += "t += Noise(point * " + std::to_string(i) + ")\n";
  return text + "color = white * t\n";
}

std::vector<Job> jobs() {
  const std::string endless = "i = 0\nwhile i < 1e30\n    i = i + ";
  return {
      {"an endless loop", endless + "u\ncolor = white * i\n", {"-o", "a.exr"}},
      {"an endless loop once per frame",
       endless + "time + 1\ncolor = white * i * u\n",
       {"-o", "a.exr"}},
      {"the same by the interpreter",
       endless + "u\ncolor = white * i\n",
       {"-o", "a.exr", "--interpret"}},
      {"200 noises in a row, tiles of 4096",
       straight_line(),
       {"-o", "a.exr", "--res", "16384x16384", "--tile", "4096"}},
      {"edges, 4096 samples a pixel",
       "color = white * (fract(400 * x * y) < 0.5 ? 1 : turbulence(9 * point))\n",
       {"-o", "a.exr", "--res", "4096x4096", "--samples", "4096"}},
      {"packing an EXR 16384 wide",
       "color = [Noise(90 * point) u v]\nalpha = 1\n",
       {"-o", "a.exr", "--res", "16384x16384", "--float"},
       1500},
      {"packing a PNG 16384 wide",
       "color = [Noise(90 * point) u v]\n",
       {"-o", "a.png", "--res", "16384x16384"},
       1500},
      {"a film",
       "color = [Noise(90 * point) u time]\n",
       {"-o", "a.mp4", "-f", "1-1000", "--res", "1920x1080"},
       1500},
      {"rays into spheres",
       "color = normal\n",
       {"-o", "a.exr", "--on", "sphere", "--res", "8192x8192", "--samples", "64"}},
      {"writing to a reader that does not read",
       "color = [x y u]\n",
       {"-o", "-", "--float", "--compression", "none", "--res", "512x512"}},
  };
}

// Milliseconds from the signal to the end; negative: it ended otherwise.
double stop(const fs::path& folder, const Job& job) {
  std::vector<std::string> words = {"render", "p.pse", "-q"};
  words.insert(words.end(), job.words.begin(), job.words.end());
  const pid_t process = pse::bench::start_pse(words, folder);
  std::this_thread::sleep_for(std::chrono::milliseconds(job.after_ms));
  if (waitpid(process, nullptr, WNOHANG) != 0) return -1;
  const auto asked = Clock::now();
  kill(process, SIGTERM);
  int status = 0;
  waitpid(process, &status, 0);
  const double took = std::chrono::duration<double, std::milli>(Clock::now() - asked).count();
  return WIFEXITED(status) && WEXITSTATUS(status) == 143 ? took : -1;
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  const fs::path folder = fs::temp_directory_path() / "pse_bench_stop";
  bool good = true;
  std::printf("%-44s %9s      [fastest .. slowest of %d]   goal\n", "from SIGTERM to the end",
              "median", runs);
  for (const Job& job : jobs()) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(folder / "p.pse") << job.program;
    std::vector<double> times;
    for (int i = 0; i < runs; ++i) times.push_back(stop(folder, job));
    std::sort(times.begin(), times.end());
    const bool ended = times.front() >= 0;
    const bool clean = std::distance(fs::directory_iterator(folder), {}) == 1;
    good = good && ended && clean;
    std::printf("%-44s %9.1f ms   [%.1f .. %.1f]   <= 50%s%s\n", job.name, times[times.size() / 2],
                times.front(), times.back(), ended ? "" : "   WRONG: not ended by the signal",
                clean ? "" : "   WRONG: something is left");
  }
  fs::remove_all(folder);
  return good ? 0 : 1;
}
