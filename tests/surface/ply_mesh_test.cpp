// Binary PLY files: what is read, and what damage does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "surface/ply_mesh.h"

namespace pse::surface {
namespace {

namespace fs = std::filesystem;

// The body of a file, number by number.
struct Body {
  bool swap = false;
  std::string text;

  template <class Number>
  Body& add(Number number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    if (swap) std::reverse(bytes, bytes + sizeof number);
    text.append(bytes, sizeof number);
    return *this;
  }
  template <class Index>
  Body& face(std::initializer_list<Index> corners) {
    add(static_cast<unsigned char>(corners.size()));
    for (const Index corner : corners) add(corner);
    return *this;
  }
};

std::string head(const std::string& order, const std::string& vertex, const std::string& face,
                 long vertices, long faces) {
  return "ply\nformat binary_" + order + "_endian 1.0\ncomment by hand\nelement vertex " +
         std::to_string(vertices) + "\n" + vertex + "element face " + std::to_string(faces) + "\n" +
         face + "end_header\n";
}
constexpr const char* xyz = "property float x\nproperty float y\nproperty float z\n";
constexpr const char* corners = "property list uchar int vertex_indices\n";

// A square of four vertices.
Body square() {
  Body body;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) body.add(x);
  return body;
}

class PlyMeshes : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("pse_ply_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::expected<bool, std::string> read(const std::string& text, std::size_t most = 100) {
    const fs::path path = folder_ / "m.ply";
    std::ofstream(path, std::ios::binary) << text;
    mesh_ = {};
    return read_binary_ply(path.string(), most, mesh_);
  }
  std::string error_of(const std::string& text, std::size_t most = 100) {
    const auto done = read(text, most);
    return done ? *done ? "it was taken" : "left to the library" : done.error();
  }

  fs::path folder_;
  Mesh mesh_;
};

TEST_F(PlyMeshes, BothByteOrdersAndAllThatAScannerAdds) {
  for (const bool big : {false, true}) {
    Body body{.swap = big};
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {0.0, 2.0}})
      body.add(x)
          .add(std::uint8_t{7})
          .add(y)
          .add(0.0)
          .add(0.0f)
          .add(0.0f)
          .add(1.0f)
          .add(0.25f)
          .add(0.5f);
    body.add(std::uint8_t{9})
        .add(std::uint8_t{3})
        .add(std::uint16_t{0})
        .add(std::uint16_t{1})
        .add(std::uint16_t{2});
    const auto done =
        read(head(big ? "big" : "little",
                  "property double x\nproperty uchar red\nproperty double y\nproperty double z\n"
                  "property float nx\nproperty float ny\nproperty float nz\n"
                  "property float s\nproperty float t\n",
                  "property uchar flags\nproperty list uchar ushort vertex_index\n", 3, 1) +
             body.text);
    ASSERT_TRUE(done && *done) << (done ? "not taken" : done.error());
    EXPECT_EQ(mesh_.positions, (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 2, 0}));
    EXPECT_EQ(mesh_.normals, (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}));
    EXPECT_EQ(mesh_.uvs, (std::vector<float>{0.25, 0.5, 0.25, 0.5, 0.25, 0.5}));
    EXPECT_EQ(mesh_.triangles, (std::vector<std::uint32_t>{0, 1, 2}));
  }
}

// The square's third corner drawn inwards: cut from there, no triangle lies outside.
TEST_F(PlyMeshes, QuadrilateralsAreCutAtTheirInwardCorner) {
  Body body;
  for (const float x : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.2f, 0.2f, 0.f, 0.f, 1.f, 0.f}) body.add(x);
  body.face({0, 1, 2, 3});
  const auto done = read(head("little", xyz, corners, 4, 1) + body.text);
  ASSERT_TRUE(done && *done);
  EXPECT_EQ(mesh_.triangles, (std::vector<std::uint32_t>{2, 3, 0, 2, 0, 1}));
}

TEST_F(PlyMeshes, WhatIsForTheLibrary) {
  const std::string five = square().add(0.5f).add(2.f).add(0.f).face({0, 1, 2, 4, 3}).text;
  EXPECT_EQ(error_of(head("little", xyz, corners, 5, 1) + five), "left to the library");
  EXPECT_EQ(error_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 1\n"
                     "property list uchar int vertex_indices\nend_header\n0\n3 0 0 0\n"),
            "left to the library");
  EXPECT_EQ(error_of("hello"), "left to the library");
  EXPECT_EQ(error_of(head("little", "property float x\nproperty float y\n", corners, 0, 1)),
            "left to the library");
  EXPECT_EQ(error_of(head("little", xyz, corners, 4, 0) + square().text),
            "the mesh has no faces, only points; export it with faces");
  EXPECT_EQ(error_of(head("little", "property quux x\n", corners, 4, 1)),
            "`property quux x` is no property of PLY");
  EXPECT_TRUE(mesh_.positions.empty());
}

TEST_F(PlyMeshes, FilesThatEndEarlyAndCountsThatLie) {
  const std::string whole =
      head("little", xyz, corners, 4, 2) + square().face({0, 1, 2}).face({0, 2, 3}).text;
  ASSERT_EQ(error_of(whole), "it was taken");
  EXPECT_EQ(error_of(whole.substr(0, whole.size() - 1)),
            "the file ends at face 2 of 2: it is damaged, or was not written to its end");
  EXPECT_EQ(error_of(head("little", xyz, corners, 4, 2) + square().text.substr(0, 40)),
            "the file ends at vertex 4 of 4: it is damaged, or was not written to its end");
  // Refused before anything is set aside for them.
  EXPECT_EQ(
      error_of(head("little", xyz, corners, 4'000'000'000, 2) + square().text),
      "the file ends at vertex 5 of 4000000000: it is damaged, or was not written to its end");
  // More than there are numbers for vertices is no matter for the library either.
  EXPECT_EQ(
      error_of(head("little", xyz, corners, 4'300'000'000, 2) + square().text),
      "the file ends at vertex 5 of 4300000000: it is damaged, or was not written to its end");
  EXPECT_EQ(error_of(head("little", xyz, corners, 4, 101) + square().text),
            "the mesh has 101 faces and at most 100 are taken; make a coarser copy of it first");
  // A list of as many corners as fit into four bytes.
  const std::string endless = square().add(0xfffffff0u).add(1).text;
  EXPECT_EQ(
      error_of(head("little", xyz, "property list uint int vertex_indices\n", 4, 1) + endless),
      "the file ends at face 1 of 1: it is damaged, or was not written to its end");
  // Quadrilaterals count twice.
  Body quads = square();
  for (int i = 0; i < 51; ++i) quads.face({0, 1, 2, 3});
  EXPECT_EQ(error_of(head("little", xyz, corners, 4, 51) + quads.text),
            "the mesh has 102 faces and at most 100 are taken; make a coarser copy of it first");
}

TEST_F(PlyMeshes, IndicesBeyondTheVerticesAndNaNAreLeftOut) {
  Body body = square();
  body.add(std::nanf("")).add(0.f).add(0.f);
  body.face({0, 1, 2}).face({0, 2, 77}).face({-1, 1, 2}).face({0, 1, 4}).face({0, 1});
  const auto done = read(head("little", xyz, corners, 5, 5) + body.text);
  ASSERT_TRUE(done && *done);
  const auto notes = clean_mesh(mesh_);
  ASSERT_TRUE(notes);
  EXPECT_EQ(mesh_.triangles, (std::vector<std::uint32_t>{0, 1, 2}));
  ASSERT_EQ(notes->size(), 2u);
  EXPECT_EQ((*notes)[0], "2 faces name vertices that the file does not have; left out");
  EXPECT_EQ((*notes)[1], "1 face has a corner that is not a number; left out");
}

// Whatever is below 0 names no vertex, however narrow the number, and does not come round to one.
TEST_F(PlyMeshes, IndicesBelowZero) {
  const auto corners_of = [&](const std::string& type, Body body) {
    const auto done = read(head("little", xyz, "property list uchar " + type + " vertex_indices\n",
                                4, 2) +
                           body.text);
    EXPECT_TRUE(done && *done);
    EXPECT_EQ(mesh_.triangles.size(), 6u);
    for (const std::size_t k : {0u, 1u, 2u}) EXPECT_EQ(mesh_.triangles[k], k);
    EXPECT_GE(mesh_.triangles[3], mesh_.vertex_count());
    EXPECT_EQ((*clean_mesh(mesh_))[0],
              "1 face names a vertex that the file does not have; left out");
  };
  const auto bytes = [](std::initializer_list<int> list) {
    Body body;
    body.add(std::uint8_t{3});
    for (const int i : list) body.add(static_cast<std::int8_t>(i));
    return body.text;
  };
  Body narrow = square();
  narrow.text += bytes({0, 1, 2}) + bytes({-3, 1, 2});
  corners_of("char", narrow);
  corners_of("short", square()
                          .face<std::int16_t>({0, 1, 2})
                          .face<std::int16_t>({std::int16_t{-32768}, 1, 2}));
  corners_of("int", square().face({0, 1, 2}).face({-2147483647 - 1, 1, 2}));
}

// Bytes changed at random, in the head and behind it, and cut: something is said, or a mesh comes
// out that can be cleaned.
TEST_F(PlyMeshes, DamageOfAnyKindBreaksNothing) {
  Body body = square();
  for (int i = 0; i < 20; ++i) body.face({i % 4, (i + 1) % 4, (i + 2) % 4});
  const std::string whole = head("little", xyz, corners, 4, 20) + body.text;
  std::minstd_rand random(7);
  int taken = 0, refused = 0, left = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string text = whole;
    for (unsigned k = 0; k <= random() % 4; ++k)
      text[random() % text.size()] = static_cast<char>(random() >> 7);
    if (random() % 4 == 0) text.resize(random() % text.size());
    const auto done = read(text);
    ++(!done ? refused : *done ? taken : left);
    if (done && *done) {
      (void)clean_mesh(mesh_);
      for (const std::uint32_t v : mesh_.triangles) EXPECT_LT(v, mesh_.vertex_count());
    }
  }
  EXPECT_GT(taken, 200);
  EXPECT_GT(refused, 200);
  EXPECT_GT(left, 200);
}

}  // namespace
}  // namespace pse::surface
