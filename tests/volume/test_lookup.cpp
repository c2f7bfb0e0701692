// volume() in programs: the same bits compiled and interpreted, linear between voxels, and files
// that are not what they should be.
#include <pthread.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "run_pse.h"
#include "volume/vdb.h"

namespace pse::test {
namespace {

class Lookup : public CommandLine {
 protected:
  // A grid that is linear in x, y and z, so that values between voxels are known too.
  void make_ramp() {
    file("ramp.pse", "density = x + 2 * y + 4 * z + 8\ncolor = [x y z] + 2\n");
    ASSERT_EQ(pse({"bake", "ramp.pse", "-o", "ramp.vdb", "--res", "16", "--float"}).status, 0);
  }
  image::Image render(const std::string& text, std::vector<std::string> options = {}) {
    file("a.pse", text);
    options.insert(options.begin(), {"render", "a.pse", "-o", "a.exr", "--res", "32", "--float"});
    ended = pse(options);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return picture("a.exr");
  }
  std::string error_of(const std::string& text, int status) {
    file("a.pse", text);
    ended = pse({"render", "a.pse", "-o", "a.exr", "--res", "8"});
    EXPECT_EQ(ended.status, status) << ended.err;
    return ended.err;
  }
  Ended ended;
};

TEST_F(Lookup, IsLinearBetweenVoxelsAndExactAtThem) {
  make_ramp();
  // |p| <= 0.9 keeps all eight voxels inside, but not those of what is beside the picture. The
  // planes cut blocks at all their faces.
  const image::Image image = render(
      "p = 0.9 * [x, y, x * y]\n"
      "wrong = volume(\"ramp.vdb\", p) - (p.x + 2 * p.y + 4 * p.z + 8)\n",
      {"--antialias", "none"});
  for (const float value : image.planes[static_cast<std::size_t>(image.spec.find("wrong.Y"))])
    ASSERT_LT(std::abs(value), 1e-5f);
}

TEST_F(Lookup, GridsAreChosenByName) {
  make_ramp();
  const image::Image image = render(
      "c = volume(\"ramp.vdb\", 0.5 * [x y 0], grid = \"color\")\n"
      "d = volume(\"ramp.vdb\", 0.5 * [x y 0], \"density\")\n"
      "wrong = max(abs(c.x - 0.5 * x - 2), abs(d - 0.5 * x - y - 8))\n");
  for (const float value : image.planes[static_cast<std::size_t>(image.spec.find("wrong.Y"))])
    ASSERT_LT(value, 1e-5f);
}

TEST_F(Lookup, CompiledAndInterpretedHaveTheSameBits) {
  file("n.pse", "density = max(0, Noise(5 * point))\n");
  ASSERT_EQ(pse({"bake", "n.pse", "-o", "n.vdb", "--res", "40"}).status, 0);
  const std::string text =
      "a = volume(\"n.vdb\", [1.3 * x, 1.3 * y, 0.3 * x])\nb = 1 / (x - x) * a\n"
      "c = volume(\"n.vdb\", [x, y, 1 / (x - x)])\n";
  const image::Image one = render(text);
  for (const char* width : {"1", "4", "8", "16"}) {
    const image::Image other = render(text, {"--width", width});
    for (std::size_t p = 0; p < one.planes.size(); ++p)
      for (std::size_t i = 0; i < one.planes[p].size(); ++i)
        ASSERT_EQ(std::bit_cast<int>(one.planes[p][i]), std::bit_cast<int>(other.planes[p][i]));
  }
  const image::Image slow = render(text, {"--interpret"});
  for (std::size_t p = 0; p < one.planes.size(); ++p)
    for (std::size_t i = 0; i < one.planes[p].size(); ++i)
      ASSERT_EQ(std::bit_cast<int>(one.planes[p][i]), std::bit_cast<int>(slow.planes[p][i]));
}

TEST_F(Lookup, PicturesAreSlices) {
  // Eight slices of 8 x 8; voxel (i, j, k) holds i + 16 j + 256 k.
  file("slice.pse", "v = (px - 0.5) + 16 * (7.5 - py) + 256 * frame\n");
  ASSERT_EQ(
      pse({"render", "slice.pse", "-o", "s.%02d.exr", "-f", "0-7", "--res", "8", "--float"}).status,
      0);
  // The stack is a cube from -1/2 to 1/2 with centres at odd sixteenths.
  const image::Image image = render(
      "i = floor(px / 4)\nj = floor((32 - py) / 4)\n"
      "p = ([i j 5] + 0.5) / 8 - 0.5\n"
      "wrong = volume(\"s.%02d.exr\", p) - (i + 16 * j + 256 * 5)\n"
      "outside = volume(\"s.%02d.exr\", p + 2)\n");
  for (const char* name : {"wrong.Y", "outside.Y"})
    for (const float value : image.planes[static_cast<std::size_t>(image.spec.find(name))])
      ASSERT_EQ(value, 0.0f) << name;
}

TEST_F(Lookup, StacksWithGapsOrOtherPicturesAreRefused) {
  file("one.pse", "v = px\n");
  file("three.pse", "v = [px py 1]\n");
  const auto slices = [&](const std::string& numbers, const std::string& program = "one.pse") {
    ASSERT_EQ(pse({"render", program, "-o", "s.%02d.exr", "-f", numbers, "--res", "8"}).status, 0);
  };
  const std::string program = "a = volume(\"s.%02d.exr\", point)\n";
  slices("0-5");
  std::filesystem::remove(folder() / "s.03.exr");
  EXPECT_TRUE(contains(error_of(program, 4), "has a gap: after s.02.exr comes s.04.exr"))
      << ended.err;
  slices("3", "three.pse");
  EXPECT_TRUE(contains(error_of(program, 4), "s.03.exr has 3 of v, s.00.exr 1")) << ended.err;
  // Numbers may have a step; the first two tell it, unless they are where the gap is.
  for (const char* gone : {"s.01.exr", "s.03.exr", "s.05.exr"})
    std::filesystem::remove(folder() / gone);
  error_of(program, 0);
  slices("3");
  EXPECT_TRUE(contains(error_of(program, 4), "has a gap: after s.00.exr comes s.02.exr"))
      << ended.err;
}

TEST_F(Lookup, WhatIsNoFileIsNamed) {
  file("empty.vdb", "");
  EXPECT_TRUE(contains(error_of("a = volume(\"empty.vdb\", point)\n", 4), "empty.vdb is empty"));
  std::filesystem::create_directory(folder() / "folder.vdb");
  EXPECT_TRUE(contains(error_of("a = volume(\"folder.vdb\", point)\n", 4), "it is a folder"));
  std::filesystem::create_symlink("/dev/zero", folder() / "zero.vdb");
  EXPECT_TRUE(contains(error_of("a = volume(\"zero.vdb\", point)\n", 4), "it is no file"));
}

TEST_F(Lookup, NamesOfGridsAreShownWithoutControl) {
  EXPECT_EQ(volume::shown_name(""), "(no name)");
  EXPECT_EQ(volume::shown_name("a\x1b[31m\nb"), "a?[31m?b");
}

TEST_F(Lookup, ErrorsSayWhatIsThere) {
  make_ramp();
  EXPECT_TRUE(contains(error_of("a = volume(\"ramp.vdb\", point, \"smoke\")\n", 4),
                       "ramp.vdb has no grid `smoke`; it has color, density"));
  EXPECT_TRUE(
      contains(error_of("a = volume(\"none.vdb\", point)\n", 4), "there is no file none.vdb"));
  EXPECT_TRUE(
      contains(error_of("a = volume(\"none.%04d.exr\", point)\n", 4), "there are no pictures"));
  file("text.vdb", "this is no grid");
  EXPECT_TRUE(
      contains(error_of("a = volume(\"text.vdb\", point)\n", 4), "text.vdb is not a VDB file"));
  EXPECT_TRUE(
      contains(error_of("a = volume(\"ramp.vdb\")\n", 3), "needs the name of a file and a point"));
  EXPECT_TRUE(contains(error_of("a = volume(3, point)\n", 3), "the file of `volume` is a text"));
  EXPECT_TRUE(contains(error_of("a = volume(\"ramp.vdb\", [1 2])\n", 3), "a vector of three"));
}

TEST_F(Lookup, FilesCutAnywhereAreRefused) {
  make_ramp();
  const std::string whole = read("ramp.vdb");
  file("c.pse", "a = volume(\"cut.vdb\", point)\n");
  for (std::size_t k = 1; k < 40; ++k) {
    file("cut.vdb", whole.substr(0, whole.size() * k / 40));
    const Ended cut = pse({"render", "c.pse", "-o", "c.exr", "--res", "4"});
    EXPECT_EQ(cut.status, 4) << k << cut.err;
    EXPECT_TRUE(contains(cut.err, "cut.vdb is damaged or cut off")) << cut.err;
  }
}

TEST_F(Lookup, DamageIsToldWithPlaceAndRemedy) {
  make_ramp();
  // A type that no tree has, in the list of grids; then the middle of the only grid.
  std::string head = read("ramp.vdb");
  head[head.find("Tree_float") + 5] = 'q';
  file("head.vdb", head);
  const std::string first = error_of("a = volume(\"head.vdb\", point)\n", 4);
  EXPECT_TRUE(contains(first,
                       "head.vdb is damaged or cut off: its head cannot be read; copy or "
                       "write the file anew (OpenVDB: "))
      << first;
  EXPECT_TRUE(contains(first, "a.pse:1:12")) << first;
  file("one.pse", "density = 8 + unoise(5 * point)\n");
  ASSERT_EQ(pse({"bake", "one.pse", "-o", "one.vdb", "--res", "32"}).status, 0);
  std::string voxels = read("one.vdb");
  // Pieces that say they have no length.
  const std::size_t from = voxels.size() * 6 / 10, to = voxels.size() * 3 / 4;
  std::fill(voxels.begin() + std::ptrdiff_t(from), voxels.begin() + std::ptrdiff_t(to), '\0');
  file("voxels.vdb", voxels);
  const std::string second = error_of("a = volume(\"voxels.vdb\", point)\n", 4);
  EXPECT_TRUE(contains(second, "voxels.vdb is damaged or cut off: grid `density` cannot be read"))
      << second;
  EXPECT_TRUE(contains(second, "a.pse:1:5")) << second;
  EXPECT_TRUE(contains(second, "    ^~~~")) << second;
}

// Where the child process that reads is moved to; nowhere if null.
const char* place_of_children = nullptr;
void move_child() {
  if (place_of_children != nullptr && ::chdir(place_of_children) != 0) std::abort();
}

// Children are moved to the folder in which alone the name stands for a file: what is read there
// was not read here.
TEST_F(Lookup, FilesAreReadInAProcessOfTheirOwn) {
  make_ramp();
  ASSERT_FALSE(std::filesystem::exists("ramp.vdb"));
  const auto vdb = volume::open_vdb();
  ASSERT_TRUE(vdb) << vdb.error().message;
  ASSERT_EQ(::pthread_atfork(nullptr, nullptr, move_child), 0);
  const std::string there = folder().string();
  place_of_children = there.c_str();
  const auto info = (*vdb)->info("ramp.vdb");
  const auto grid = (*vdb)->read("ramp.vdb", "density", std::size_t{1} << 30);
  place_of_children = nullptr;
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->grids.size(), 2u);
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_FALSE(grid->voxels.empty());
  EXPECT_FALSE((*vdb)->info("ramp.vdb"));
}

TEST_F(Lookup, DamagedFilesNeverCrashOrHang) {
  make_ramp();
  const std::string whole = read("ramp.vdb");
  file("c.pse", "a = volume(\"bad.vdb\", point)\n");
  std::srand(5);
  for (int k = 0; k < 60; ++k) {
    std::string bad = whole;
    const std::size_t at = static_cast<std::size_t>(std::rand()) % (k % 2 ? 600 : bad.size());
    bad[at] = static_cast<char>(std::rand());
    file("bad.vdb", bad);
    ended = pse({"render", "c.pse", "-o", "c.exr", "--res", "4"});
    EXPECT_TRUE(ended.status == 0 || ended.status == 4)
        << "byte " << at << ": " << ended.status << ended.err;
  }
}

}  // namespace
}  // namespace pse::test
