// A program of a user's own: compile a text once, run it on arrays. docs/cpp.md shows it.
#include <pse/noise.h>
#include <pse/script.h>

#include <cstdio>
#include <vector>

int main() {
  const auto script = pse::Script::compile("Tint = [1 0.8 0.5]\n"
                                           "color = Tint * (0.5 + 0.5 * Noise(p))\n",
                                           {.inputs = {{"p", 3}}});
  if (!script) {
    std::fputs(script.error().c_str(), stderr);
    return 1;
  }

  // One array for each component of what the program reads and sets.
  const std::vector<float> x = {0.5f, 1.5f}, y = {0.5f, 2.5f}, z = {0.5f, 3.5f};
  std::vector<float> red(2), green(2), blue(2);
  const auto done = script->run(2, {{"p", {x.data(), y.data(), z.data()}}},
                                {{"color", {red.data(), green.data(), blue.data()}}});
  if (!done) {
    std::fprintf(stderr, "%s\n", done.error().c_str());
    return 1;
  }
  std::printf("%g %g %g\n", red[0], green[0], blue[0]);
  // The functions of noise.h give what the language's give.
  return red[1] == 0.5f + 0.5f * pse::noise({x[1], y[1], z[1]}) ? 0 : 1;
}
