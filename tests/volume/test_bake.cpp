// `pse bake`: what the program says at a voxel's centre is what the file holds there, and nothing
// is stored where there is nothing.
#include <sys/mount.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "run_pse.h"
#include "volume/volume.h"

namespace pse::test {
namespace {

class Bake : public CommandLine {
 protected:
  void bake(const std::string& text, std::vector<std::string> options = {}) {
    file("a.pse", text);
    options.insert(options.begin(), {"bake", "a.pse", "-o", "a.vdb"});
    ended = pse(options);
  }
  volume::GridData grid(const std::string& name, const std::string& in = "a.vdb") {
    const auto vdb = volume::open_vdb();
    EXPECT_TRUE(vdb);
    auto data = (*vdb)->read((folder() / in).string(), name, std::size_t{1} << 30);
    EXPECT_TRUE(data) << data.error().message;
    return data ? *data : volume::GridData{};
  }
  volume::FileInfo info(const std::string& in = "a.vdb") {
    auto head = (*volume::open_vdb())->info((folder() / in).string());
    EXPECT_TRUE(head) << head.error().message;
    return head ? *head : volume::FileInfo{};
  }
  Ended ended;
};

float at(const volume::Volume& grid, float x, float y, float z) {
  std::array<float, 3> value{};
  grid.look_up(x, y, z, value.data());
  return value[0];
}

TEST_F(Bake, VoxelsHoldWhatTheProgramSaysAtTheirCentres) {
  // Sixteenths are exact in 16 bits, so nothing is lost: x + 2 y + 4 z + 8 in a box of 16 voxels.
  bake("density = x + 2 * y + 4 * z + 8\n", {"--res", "16"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const volume::Volume grid(this->grid("density"));
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 16; ++j)
      for (int k = 0; k < 16; ++k) {
        const auto place = [](int n) { return -1.0f + 0.125f * (static_cast<float>(n) + 0.5f); };
        const float x = place(i), y = place(j), z = place(k);
        ASSERT_EQ(at(grid, x, y, z), x + 2 * y + 4 * z + 8) << i << ' ' << j << ' ' << k;
      }
  EXPECT_EQ(at(grid, 1.2f, 0, 0), 0.0f);
}

TEST_F(Bake, HalfPrecisionRoundsOnceAndFloatKeepsAll) {
  const std::string text = "density = 1 + x / 3\n";
  bake(text, {"--res", "8"});
  const volume::Volume half(grid("density"));
  bake(text, {"--res", "8", "--float"});
  const volume::Volume whole(grid("density"));
  for (int i = 0; i < 8; ++i) {
    const float x = -0.875f + 0.25f * static_cast<float>(i);
    EXPECT_EQ(at(whole, x, 0.125f, 0.125f), 1 + x / 3);
    EXPECT_NEAR(at(half, x, 0.125f, 0.125f), 1 + x / 3, 1.0f / 2048);
  }
  EXPECT_NE(at(half, 0.625f, 0.125f, 0.125f), at(whole, 0.625f, 0.125f, 0.125f));
}

TEST_F(Bake, FunctionsAreEnoughAndThePictureIsNotAGrid) {
  bake(
      "function density(p) return clamp(2 - 4 * length(p), 0, 1)\n"
      "function color(p, d)\n    return [d, 0.25, p.y]\n"
      "function temperature(p) return 1000 + 250 * p.x\n"
      "color = [x y 7]\n",
      {"--res", "32"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const volume::Volume density(grid("density")), color(grid("color")), heat(grid("temperature"));
  EXPECT_EQ(density.components(), 1);
  EXPECT_EQ(color.components(), 3);
  const float x = 0.03125f;
  EXPECT_EQ(at(density, x, x, x), 1.0f);
  std::array<float, 3> rgb{};
  color.look_up(x, x, x, rgb.data());
  EXPECT_EQ(rgb, (std::array<float, 3>{1, 0.25f, x}));
  EXPECT_NEAR(at(heat, x, x, x), 1000 + 250 * x, 0.5f);
  // Where there is no density there is no temperature either.
  EXPECT_EQ(at(heat, 0.9f, 0.9f, 0.9f), 0.0f);
}

TEST_F(Bake, EmptySpaceTakesNoRoom) {
  // A ball of radius 1/4 in a box of side 2: 0.8 % of its volume.
  const std::string ball = "density = length(point) < 0.25 ? 0.5 + 0.1 * x : 0\n";
  bake(ball, {"--res", "128"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const volume::GridData small = grid("density");
  const std::size_t stored = small.voxels.size() / volume::block_voxels;
  // Blocks of 1/8: the ball meets at most 6 along each side.
  EXPECT_LE(stored, 6u * 6 * 6);
  EXPECT_GE(stored, 8u);
  const volume::GridInfo head = info().grids.front();
  EXPECT_NEAR(double(head.active), 4.0 / 3 * 3.14159 * std::pow(0.25 * 64, 3), 600);
  // The inside of a solid is one value and takes no voxels.
  bake("density = length(point) < 0.25 ? 1 : 0\n", {"--res", "128"});
  EXPECT_LT(grid("density").voxels.size(), small.voxels.size());
}

TEST_F(Bake, ThreadsAndRepetitionGiveTheSameBytes) {
  const std::string text = "density = max(0, Noise(4 * point))\ncolor = white * density\n";
  bake(text, {"--res", "48", "-t", "1"});
  const std::string one = read("a.vdb");
  bake(text, {"--res", "48", "-t", "3"});
  EXPECT_EQ(read("a.vdb"), one);
  bake(text, {"--res", "48", "--interpret"});
  EXPECT_EQ(read("a.vdb"), one);
  bake(text, {"--res", "48", "--seed", "2"});
  EXPECT_NE(read("a.vdb"), one);
}

TEST_F(Bake, ClassesTypesAndProvenanceAreSet) {
  bake("Size = 0.5\ndistance = length(point) - Size\ndensity = 1 - length(point)\n",
       {"--res", "32", "Size=0.25"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const volume::FileInfo head = info();
  ASSERT_EQ(head.grids.size(), 2u);
  for (const volume::GridInfo& grid : head.grids)
    EXPECT_EQ(grid.kind,
              grid.name == "distance" ? volume::GridKind::level_set : volume::GridKind::fog);
  EXPECT_TRUE(contains(head.attributes.at("pse/program"), "distance = length(point) - Size"));
  EXPECT_EQ(head.attributes.at("pse/knobs"), "Size=0.25\n");
  EXPECT_EQ(head.attributes.at("pse/up"), "y");
  bake("density = 1\n", {"--res", "8", "--no-provenance"});
  EXPECT_TRUE(info().attributes.empty());
}

TEST_F(Bake, LevelSetsAreDistancesInABandAndSignedBeyondIt) {
  bake("distance = length(point) - 0.5\n", {"--res", "64", "--float", "--band", "4"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const volume::Volume grid(this->grid("distance"));
  const float band = 4 * 2.0f / 64;
  for (const float r : {0.42f, 0.5f, 0.57f}) EXPECT_NEAR(at(grid, r, 0, 0), r - 0.5f, 1e-3f) << r;
  EXPECT_FLOAT_EQ(at(grid, 0.9f, 0, 0), band);
  EXPECT_FLOAT_EQ(at(grid, 0, 0, 0), -band);
  EXPECT_FLOAT_EQ(at(grid, 5, 5, 5), band);
}

TEST_F(Bake, ZUpTurnsTheFileAndNotTheProgram) {
  bake("density = y > 0.5 ? 1 : z > 0.5 ? 0.5 : 0\n", {"--res", "16", "--up", "z"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const volume::Volume grid(this->grid("density"));
  // The program's up is the file's z, and what is near the viewer has a negative y.
  EXPECT_EQ(at(grid, 0, 0, 0.8f), 1.0f);
  EXPECT_EQ(at(grid, 0, -0.8f, 0), 0.5f);
  EXPECT_EQ(at(grid, 0, 0.8f, 0), 0.0f);
}

TEST_F(Bake, BoxesMayHaveAnyPlaceAndShape) {
  bake("density = x\n", {"--res", "20", "--bounds", "1,2,3,2,2.5,3.25", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const volume::Volume grid(this->grid("density"));
  EXPECT_FLOAT_EQ(at(grid, 1.525f, 2.225f, 3.125f), 1.525f);
  EXPECT_EQ(at(grid, 1.5f, 2.6f, 3.1f), 0.0f);
  bake("density = 1\n", {"--res", "4x8x16"});
  EXPECT_TRUE(contains(ended.err, "4x8x16 voxels"));
  bake("density = 1\n", {"--bounds", "1,1,1,0,2,2"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_TRUE(contains(ended.err, "empty along x"));
}

TEST_F(Bake, NotANumberIsNothingAndIsSaid) {
  bake("density = x > 0.5 ? sqrt(-x) : 0.5\n", {"--res", "16"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_TRUE(contains(ended.err, "`density` at point [0.5625 -0.9375 -0.9375]")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "1024 values"));
  const volume::Volume grid(this->grid("density"));
  EXPECT_EQ(at(grid, 0.8125f, 0.0625f, 0.0625f), 0.0f);
  std::filesystem::remove(folder() / "a.vdb");
  bake("density = sqrt(x)\n", {"--res", "16", "--nan", "error"});
  EXPECT_EQ(ended.status, 6);
  EXPECT_FALSE(exists("a.vdb"));
}

TEST_F(Bake, MatterThatIsCutOrMissingIsSaid) {
  bake("density = 1\n", {"--res", "8"});
  EXPECT_TRUE(contains(ended.err, "reaches the side of the box"));
  bake("density = length(point) < 0.5 ? 1 : 0\n", {"--res", "8"});
  EXPECT_FALSE(contains(ended.err, "reaches"));
  bake("density = -1\n", {"--res", "8"});
  EXPECT_TRUE(contains(ended.err, "is empty"));
  // A hair between the centres of voxels: these lie at odd eighths.
  bake("density = abs(x) < 0.01 ? 1 : 0\n", {"--res", "8"});
  EXPECT_TRUE(contains(ended.err, "thinner than a voxel (0.25 m) wants a higher --res"))
      << ended.err;
}

TEST_F(Bake, FunctionsAreBlamedAtTheirHeads) {
  bake("Size = 1\n\nfunction density(p)\n    return sqrt(p.x)\n", {"--res", "8"});
  EXPECT_TRUE(contains(ended.err, "a.pse:3:1: warning:")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "   3 | function density(p)\n     | ^~~")) << ended.err;
}

TEST_F(Bake, ADensityOfARayIsNoVolume) {
  const std::string text = "function density(p, t)\n    return t\n";
  bake(text, {"--res", "8"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(contains(ended.err, "`density` wants 2 arguments")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "function density(p, ray = 0)")) << ended.err;
  file("a.pse", text);
  ended = pse({"render", "a.pse", "--slice", "z=0", "-o", "a.png", "--res", "8"});
  EXPECT_TRUE(contains(ended.err, "`density` wants 2 arguments")) << ended.err;
}

TEST_F(Bake, MemoryIsBounded) {
  bake("density = 1 + x\n", {"--res", "128", "--memory", "2"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_TRUE(contains(ended.err, "more than 2.0 MiB"));
  EXPECT_FALSE(exists("a.vdb"));
}

TEST_F(Bake, WhatCannotFitIsRefusedBeforeItTakesMemory) {
  // Four million million voxels, all of them other numbers: some blocks tell.
  bake("density = 1 + 0.1 * x\n", {"--res", "16384"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_TRUE(contains(ended.err, "the volume would take about")) << ended.err;
  EXPECT_TRUE(contains(ended.err, "lower --res, or raise --memory")) << ended.err;
  EXPECT_FALSE(exists("a.vdb"));
  // Even blocks take none.
  bake("density = 1\n", {"--res", "256", "--memory", "1"});
  EXPECT_EQ(ended.status, 0) << ended.err;
}

TEST_F(Bake, InfoTellsOfGrids) {
  bake("density = length(point) < 1 ? 0.5 : 0\n", {"--res", "16"});
  Ended told = pse({"info", "a.vdb"});
  EXPECT_EQ(told.status, 0) << told.err;
  for (const char* part : {"density: float, fog volume", "with values", "values  0 to 0.5"})
    EXPECT_TRUE(contains(told.out, part)) << told.out;
  EXPECT_TRUE(contains(pse({"info", "--json", "a.vdb"}).out, "\"kind\": \"volume\""));
  bake("density = -1\n", {"--res", "8"});
  told = pse({"info", "a.vdb"});
  EXPECT_TRUE(contains(told.out, "none with values")) << told.out;
  bake("density = length(point) < 1 ? 0.5 : 0\n", {"--res", "16"});
  file("cut.vdb", read("a.vdb").substr(0, 700));
  told = pse({"info", "cut.vdb"});
  EXPECT_EQ(told.status, 4);
  EXPECT_TRUE(contains(told.err, "damaged")) << told.err;
}

// Each of the grids that share a name is told of with its own values.
TEST_F(Bake, InfoTellsGridsOfOneNameApart) {
  const auto vdb = volume::open_vdb();
  ASSERT_TRUE(vdb);
  const volume::GridSpec spec{.name = "density"};
  const auto writer = (*vdb)->writer({spec, spec, {.name = "heat"}}, {});
  std::array<std::uint64_t, 8> active{};
  active.fill(~std::uint64_t{0});
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<float, volume::block_voxels> voxels{};
    voxels.front() = 0.25f * static_cast<float>(k + 1);
    const float* const plane = voxels.data();
    writer->add(k, {0, 0, 0}, {&plane, 1}, active);
  }
  ASSERT_TRUE(
      writer->write((folder() / "two.vdb").string(), {}, "00000000-0000-0000-0000-000000000001"));
  const Ended told = pse({"info", "two.vdb"});
  EXPECT_EQ(told.status, 0) << told.err;
  std::size_t from = 0;
  for (const char* part : {"density: float", "values  0 to 0.25", "density: float",
                           "values  0 to 0.5", "heat: float", "values  0 to 0.75"}) {
    from = told.out.find(part, from);
    ASSERT_NE(from, std::string::npos) << part << "\n" << told.out;
    ++from;
  }
}

TEST_F(Bake, SequencesResumeAndRefuseOneName) {
  file("a.pse", "density = max(0, 0.5 + 0.25 * frame - length(point))\n");
  ASSERT_EQ(pse({"bake", "a.pse", "-f", "1-3", "-o", "a.%04d.vdb", "--res", "16"}).status, 0);
  EXPECT_NE(read("a.0001.vdb"), read("a.0003.vdb"));
  std::filesystem::remove(folder() / "a.0002.vdb");
  const Ended again =
      pse({"bake", "a.pse", "-f", "1-3", "-o", "a.%04d.vdb", "--res", "16", "--resume"});
  EXPECT_TRUE(contains(again.err, "kept a.0001.vdb"));
  EXPECT_TRUE(contains(again.err, "wrote a.0002.vdb"));
  EXPECT_EQ(pse({"bake", "a.pse", "-f", "1-3", "-o", "a.vdb"}).status, 2);
}

TEST_F(Bake, ProgramsWithoutMatterAndErrorsHaveTheirExitStatus) {
  bake("color = [x y 0]\n");
  EXPECT_TRUE(contains(ended.err, "wrote a.vdb"));  // a colour alone is a grid
  bake("heat = x\n");
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(contains(ended.err, "function density(p)"));
  bake("density = xyz(\n");
  EXPECT_EQ(ended.status, 3);
  bake("density = [x y]\n");
  EXPECT_EQ(ended.status, 3);
  bake("a = array(4)\na[1] = x\ndensity = a[round(8 * x)]\n", {"--res", "16"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_TRUE(contains(ended.err, "at point [")) << ended.err;
  file("a.pse", "density = 1\n");
  EXPECT_EQ(pse({"bake", "a.pse", "-o", "nowhere/a.vdb", "--res", "8"}).status, 5);
  EXPECT_EQ(pse({"bake", "a.pse", "-o", "a.exr"}).status, 2);
}

// A cube from -1 to 1 with faces of two triangles, outward; `faces` of the six are there.
std::string cube(int faces) {
  std::string text;
  for (const char* v :
       {"-1 -1 -1", "1 -1 -1", "1 1 -1", "-1 1 -1", "-1 -1 1", "1 -1 1", "1 1 1", "-1 1 1"})
    text += std::string("v ") + v + "\n";
  const char* const sides[] = {"1 4 3 2", "5 6 7 8", "1 5 8 4", "2 3 7 6", "4 8 7 3", "1 2 6 5"};
  for (int f = 0; f < faces; ++f) text += std::string("f ") + sides[f] + "\n";
  return text;
}

TEST_F(Bake, MeshesBecomeDistances) {
  for (const int faces : {6, 5}) {
    file("cube.obj", cube(faces));
    const Ended done =
        pse({"bake", "cube.obj", "-o", "cube.vdb", "--res", "40", "--band", "6", "--float"});
    if (contains(done.err, "PSE_SURFACE") || contains(done.err, "was not built"))
      GTEST_SKIP() << "meshes are not built in";
    ASSERT_EQ(done.status, 0) << done.err;
    // Without its lower face the cube is open, and solid all the same.
    EXPECT_EQ(bool(contains(done.err, "is not closed")), faces == 5) << done.err;
    const volume::Volume grid(this->grid("distance", "cube.vdb"));
    EXPECT_NEAR(at(grid, 0.9f, 0, 0), -0.1f, 1e-3f);
    EXPECT_NEAR(at(grid, 1.1f, 0, 0), 0.1f, 1e-3f);
    EXPECT_NEAR(at(grid, 0.3f, 0.85f, 0.2f), -0.15f, 1e-3f);
    EXPECT_NEAR(at(grid, 1.1f, 1.1f, 0), 0.1f * std::sqrt(2.0f), 6e-3f);
    EXPECT_NEAR(at(grid, 0, 0, 0), -0.3f, 1e-3f);  // the band's end, and the inside's sign
    EXPECT_NEAR(at(grid, 2, 2, 2), 0.3f, 1e-3f);
    EXPECT_EQ(info("cube.vdb").grids.front().kind, volume::GridKind::level_set);
  }
}

// A disk of 64 KiB, where the test may mount one.
TEST_F(Bake, AFullDiskIsToldAndLeavesTheOldFile) {
  const std::string disk = (folder() / "disk").string();
  std::filesystem::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=65536") != 0)
    GTEST_SKIP() << "no disk can be mounted";
  file("disk/n.vdb", "old");
  file("a.pse", "density = 1.5 + Noise(9 * point)\n");
  const Ended full = pse({"bake", "a.pse", "-o", "disk/n.vdb", "--res", "64"});
  const Ended fresh = pse({"bake", "a.pse", "-o", "disk/new.vdb", "--res", "64"});
  const std::string old = read("disk/n.vdb");
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(disk))
    left.push_back(entry.path().filename().string());
  ::umount(disk.c_str());
  for (const Ended& one : {full, fresh}) {
    EXPECT_EQ(one.status, 5) << one.err;
    EXPECT_TRUE(contains(one.err, "no room to write disk/n")) << one.err;
  }
  EXPECT_EQ(old, "old");
  EXPECT_EQ(left, std::vector<std::string>{"n.vdb"});
}

TEST_F(Bake, AnOldFileStaysUntilTheNewOneIsWhole) {
  bake("density = 1\n", {"--res", "8"});
  const std::string old = read("a.vdb");
  bake("density = x > 0 ? sqrt(-1) : 1\n", {"--res", "8", "--nan", "error"});
  EXPECT_EQ(ended.status, 6);
  EXPECT_EQ(read("a.vdb"), old);
}

}  // namespace
}  // namespace pse::test
