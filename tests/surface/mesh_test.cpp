// Meshes as shapes, and their faults.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "rays.h"
#include "surface/mesh.h"

namespace pse::surface {
namespace {

namespace fs = std::filesystem;

class MeshFiles : public testing::Test {
 protected:
  void SetUp() override {
    if (!PSE_HAS_MESHES) GTEST_SKIP() << "built without meshes";
    folder_ = fs::temp_directory_path() / ("pse_mesh_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { if (!folder_.empty()) fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    const fs::path path = folder_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }
  std::string error_of(const std::string& name, const std::string& text) {
    const auto loaded = load_mesh(write(name, text));
    return loaded ? "it was taken" : loaded.error();
  }

  fs::path folder_;
};

#define EXPECT_SAYS(text, part) \
  EXPECT_NE((text).find(part), std::string::npos) << (text)

// A ball of quads with coordinates; `steps` round and half as many up.
std::string ball(int steps) {
  std::string text;
  const int rows = steps / 2;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= steps; ++i) {
      const double a = 2 * 3.14159265358979 * i / steps, b = 3.14159265358979 * j / rows;
      const double r = std::sin(b);
      text += "v " + std::to_string(r * std::cos(a)) + " " + std::to_string(-std::cos(b)) + " " +
              std::to_string(-r * std::sin(a)) + "\nvt " + std::to_string(double(i) / steps) +
              " " + std::to_string(double(j) / rows) + "\n";
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < steps; ++i) {
      const int a = j * (steps + 1) + i + 1, b = a + 1, c = b + steps + 1, d = a + steps + 1;
      text += "f";
      for (const int v : {a, b, c, d}) text += " " + std::to_string(v) + "/" + std::to_string(v);
      text += "\n";
    }
  return text;
}

TEST_F(MeshFiles, ABallOfTrianglesIsNearlyTheBall) {
  const auto loaded = load_mesh(write("ball.obj", ball(128)));
  ASSERT_TRUE(loaded) << loaded.error();
  const auto shape = make_mesh_shape(loaded->mesh);
  ASSERT_TRUE(shape) << shape.error();
  std::size_t hits = 0;
  for (const Ray& ray : rays_inward(3000, 3)) {
    const ShapeHit hit = first_hit(**shape, ray);
    if (!hit.found()) continue;
    ++hits;
    const Vec3 p = ray.origin + hit.t * ray.direction;
    EXPECT_NEAR(length(p), 1, 1e-3);
    EXPECT_GT(dot(normalized(hit.normal), normalized(p)), 0.9995);  // smooth
    // Coordinates follow the angles.
    if (std::abs(p.y) > 0.95) continue;
    double turn = std::atan2(-p.z, p.x) / (2 * 3.14159265358979);
    if (turn < 0) turn += 1;
    const double off = std::abs(turn - hit.u);
    EXPECT_LT(std::min(off, 1 - off), 2e-3);
    EXPECT_NEAR(hit.v, std::acos(-p.y) / 3.14159265358979, 2e-3);
  }
  EXPECT_GT(hits, 1000u);
}

// A cube keeps its edges, though its file has no normals.
TEST_F(MeshFiles, EdgesSharperThanTheCreaseStaySharp) {
  const std::string cube =
      "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
      "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 1 5 8 4\nf 2 3 7 6\n";
  for (const double crease : {60.0, 100.0}) {
    MeshOptions options;
    options.crease = crease;
    const auto loaded = load_mesh(write("cube.obj", cube), options);
    ASSERT_TRUE(loaded) << loaded.error();
    const auto shape = make_mesh_shape(loaded->mesh);
    ASSERT_TRUE(shape);
    const ShapeHit hit = first_hit(**shape, {{0.9, 0.8, 5}, {0, 0, -1}});
    ASSERT_TRUE(hit.found());
    EXPECT_NEAR(hit.t, 4, 1e-6);
    if (crease < 90)
      EXPECT_GT(normalized(hit.normal).z, 0.999999);
    else
      EXPECT_LT(normalized(hit.normal).z, 0.9);
  }
}

TEST_F(MeshFiles, FitCentresAndScales) {
  MeshOptions options;
  options.fit = true;
  const auto loaded = load_mesh(write("t.obj", "v 10 0 0\nv 14 0 0\nv 10 2 0\nf 1 2 3\n"), options);
  ASSERT_TRUE(loaded) << loaded.error();
  const Box box = loaded->mesh->bounds();
  EXPECT_NEAR(box.upper.x, 1, 1e-6);
  EXPECT_NEAR(box.lower.x, -1, 1e-6);
  EXPECT_NEAR(box.upper.y, 0.5, 1e-6);
}

TEST_F(MeshFiles, WhatIsNoMeshIsRefused) {
  EXPECT_SAYS(error_of("a.obj", ""), "empty");
  EXPECT_SAYS(error_of("a.txt", "hello"), "meshes are");
  EXPECT_SAYS(error_of("a.ply", "hello"), "not a mesh");
  EXPECT_SAYS(error_of("a.gltf", "{"), "not a mesh");
  EXPECT_SAYS(error_of("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "a.obj: ");
  EXPECT_SAYS(load_mesh((folder_ / "none.obj").string()).error(), "no such file");
  EXPECT_SAYS(load_mesh(folder_.string()).error(), "not a file");
}

// Counts and lists that a reader should not trust.
TEST_F(MeshFiles, DamagedFilesBreakNothing) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  ASSERT_TRUE(load_mesh(write("good.ply", head + "3 0 1 2\n3 0 2 3\n")));
  for (const char* faces :
       {"3 0 1\n", "3 0 1 99999999\n", "3 0 1 2\n9 0 2 3\n", "3 -1 1 2\n3 0 2 -7\n", "250 0 2 3\n",
        "3 0 1 2", ""}) {
    const auto loaded = load_mesh(write("bad.ply", head + faces));
    if (!loaded) {
      EXPECT_SAYS(loaded.error(), "bad.ply: ");
    }
  }
}

TEST_F(MeshFiles, FaultyFacesAreLeftOutAndCounted) {
  const auto loaded = load_mesh(
      write("f.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n"));
  ASSERT_TRUE(loaded) << loaded.error();
  EXPECT_EQ(loaded->mesh->triangle_count(), 1u);
  ASSERT_EQ(loaded->notes.size(), 2u);
  EXPECT_SAYS(loaded->notes[0], "1 face has a corner that is not a number");
  EXPECT_SAYS(loaded->notes[1], "1 face has no area");
  EXPECT_TRUE(is_finite(loaded->mesh->bounds().upper));
  EXPECT_SAYS(error_of("n.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "no face");
}

TEST_F(MeshFiles, OneBeyondTheReachOfRaysIsRefusedUnlessFitted) {
  const std::string huge = "v 1e30 0 0\nv 1e30 1e30 0\nv 0 1e30 0\nf 1 2 3\n";
  EXPECT_SAYS(error_of("huge.obj", huge), "beyond 1e18");
  const auto fitted = load_mesh(write("huge.obj", huge), {.fit = true});
  ASSERT_TRUE(fitted) << fitted.error();
  EXPECT_NEAR(fitted->mesh->bounds().upper.x, 1, 1e-6);
}

TEST_F(MeshFiles, TooManyFacesAreRefusedByTheirCount) {
  MeshOptions options;
  options.most_triangles = 5;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 6; ++i) text += "f 1 2 3\n";
  const auto loaded = load_mesh(write("m.obj", text), options);
  ASSERT_FALSE(loaded);
  EXPECT_SAYS(loaded.error(), "6 faces and at most 5");
  const auto ply = load_mesh(write("m.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"
                                            "element face 10000000\nend_header\n"));
  ASSERT_FALSE(ply);
  EXPECT_SAYS(ply.error(), "10000000 faces");
}

TEST(CleanMesh, CoordinatesThatAreNoNumbersAreTold) {
  Mesh mesh{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {std::nanf(""), 0, 1, 0, 0, 1}, {0, 1, 2}};
  const auto notes = clean_mesh(mesh);
  ASSERT_TRUE(notes && notes->size() == 1);
  EXPECT_SAYS((*notes)[0], "1 texture coordinate is not a number");
  EXPECT_EQ(mesh.uvs[0], 0);
}

TEST(CleanMesh, IndicesBeyondTheVerticesAreLeftOut) {
  Mesh mesh{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {0, 1, 2, 0, 1, 7}};
  const auto notes = clean_mesh(mesh);
  ASSERT_TRUE(notes);
  EXPECT_EQ(mesh.triangle_count(), 1u);
  EXPECT_EQ(notes->size(), 1u);
}

TEST(RealMeshes, AreRead) {
  if (!PSE_HAS_MESHES) GTEST_SKIP() << "built without meshes";
  const fs::path data = fs::path(PSE_SOURCE_DIR) / "../shared/data";
  if (!fs::exists(data)) GTEST_SKIP() << "no ../shared/data here";
  for (const char* name : {"stanford-bunny.obj", "teapot.obj", "spot.obj", "suzanne.obj"}) {
    const auto loaded = load_mesh((data / name).string(), {.fit = true});
    ASSERT_TRUE(loaded) << loaded.error();
    EXPECT_GT(loaded->mesh->triangle_count(), 900u) << name;
    EXPECT_NEAR(std::max({loaded->mesh->bounds().upper.x, loaded->mesh->bounds().upper.y,
                          loaded->mesh->bounds().upper.z}), 1, 1e-5) << name;
  }
}

}  // namespace
}  // namespace pse::surface
