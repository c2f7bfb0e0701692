// Every density of the gallery, held to its bounds, and how many boxes they prove empty.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "bounded.h"

namespace pse::bounds {

void expect_sound_density(const test::Bounded& program, const std::string& what, int* proven);

namespace {

namespace fs = std::filesystem;

TEST(Bounds, HoldEveryDensityOfTheGallery) {
  std::set<std::string> some;
  for (const char* folder : {"gallery/1989", "gallery/2002/hypertexture"})
    for (const auto& entry : fs::directory_iterator(fs::path(PSE_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".pse") continue;
      std::ifstream file(entry.path());
      std::stringstream text;
      text << file.rdbuf();
      const std::string name = entry.path().stem().string();
      if (text.str().find("\nfunction density(p)") == std::string::npos ||
          text.str().find("volume(") != std::string::npos)
        continue;
      int proven = 0;
      expect_sound_density(
          test::Bounded(text.str() + "\ndensity_here = density(point)\n", "density_here", false),
          name, &proven);
      RecordProperty(name, proven);
      std::printf("%-20s %3d of 512 boxes proven empty\n", name.c_str(), proven);
      if (proven > 50) some.insert(name);
    }
  // What is small in its surroundings is proven empty in many boxes.
  for (const char* name : {"noisy_sphere", "smoke", "fire_ball", "tribble", "eroded_cube"})
    EXPECT_TRUE(some.contains(name)) << name;
}

}  // namespace
}  // namespace pse::bounds
