// Programs on surfaces: --on, scenes, rays inside programs, traced pictures, and what is refused.
#include <cmath>
#include <filesystem>

#include "run_pse.h"

namespace pse::test {
namespace {

class Surfaces : public CommandLine {
 protected:
  // Renders and expects success.
  image::Image render(std::vector<std::string> arguments, const std::string& name = "o.exr") {
    arguments.insert(arguments.begin(), "render");
    arguments.insert(arguments.end(), {"-o", name, "--float", "-q"});
    const Ended ended = pse(arguments);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return picture(name);
  }
  static float at(const image::Image& picture, const char* channel, int x, int y) {
    return picture.at(picture.spec.find(channel), x, y);
  }
  void expect_refused(const std::string& scene, const std::string& part) {
    file("bad.toml", scene);
    file("p.pse", "color = white\n");
    const Ended ended = pse({"render", "p.pse", "--scene", "bad.toml", "-o", "x.png"});
    EXPECT_EQ(ended.status, 4) << scene;
    EXPECT_TRUE(contains(ended.err, part));
    EXPECT_FALSE(exists("x.png"));
  }
  static constexpr const char* everything =
      "color = (point + place + normal + view + direction + [u v id] + depth * pixel_freq +\n"
      "    light_direction + light_color * hit + eye + light_position * light_count + backface)\n"
      "a = turbulence(point)\n";
};

TEST_F(Surfaces, TheMiddleOfASphere) {
  file("p.pse", "P = place\nN = normal\nZ = depth\ncolor = white\nd = direction\nid = id\nw = pixelsize\n");
  const image::Image out = render({"p.pse", "--on", "sphere radius=0.5", "--camera",
                                   "eye=0,0,3 target=0,0,0 fov=40", "--res", "33x33"});
  EXPECT_NEAR(at(out, "P.Z", 16, 16), 0.5, 1e-6);
  EXPECT_NEAR(at(out, "N.Z", 16, 16), 1, 1e-6);
  EXPECT_NEAR(at(out, "Z", 16, 16), 2.5, 1e-6);
  EXPECT_NEAR(at(out, "d.Z", 16, 16), -1, 1e-6);
  // A pixel's width there: the picture's height at that distance, divided by its pixels.
  EXPECT_NEAR(at(out, "w.Y", 16, 16), 2.5 * 2 * std::tan(20 * M_PI / 180) / 33, 1e-6);
  EXPECT_EQ(at(out, "A", 16, 16), 1);
  EXPECT_EQ(at(out, "A", 0, 0), 0);
  EXPECT_EQ(at(out, "R", 0, 0), 0);
  // Up is up, and right is right.
  EXPECT_GT(at(out, "P.Y", 16, 13), 0.05);
  EXPECT_GT(at(out, "P.X", 19, 16), 0.05);
}

TEST_F(Surfaces, SettingsOfAScenesShapeAreKeysOrWords) {
  file("p.pse", "color = white * depth\n");
  const std::string camera = "[camera]\neye = [1, 2, 3]\ntarget = [0, 0, 0]\n[[object]]\n";
  file("keys.toml", camera + "shape = \"torus\"\nmajor = 0.9\nminor = 0.2\n");
  file("words.toml", camera + "shape = \"torus major=0.9 minor=0.2\"\n");
  const image::Image keys = render({"p.pse", "--scene", "keys.toml", "--res", "24x24"}, "k.exr");
  const image::Image words = render({"p.pse", "--scene", "words.toml", "--res", "24x24"}, "w.exr");
  float covered = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      covered += at(keys, "A", x, y);
      EXPECT_EQ(at(keys, "R", x, y), at(words, "R", x, y));
    }
  EXPECT_GT(covered, 20);
  expect_refused(camera + "shape = \"torus minor=wide\"\n", "bad.toml:4: `minor=wide` is no setting");
}

TEST_F(Surfaces, TilesThreadsWidthsAndTheInterpreterAgree) {
  file("p.pse", everything);
  file("mirror.pse",
       "h = trace(place, reflect(direction, normal))\nr = radiance(place, reflect(direction, normal))\n"
       "color = r.rgb * 0.8 + (h.distance < 9 ? h.normal : [0 0 0]) + visible(place, [0 5 0]) * 0.1\n");
  file("s.toml",
       "program = \"p.pse\"\n[[light]]\nposition = [1, 3, 2]\n[[object]]\nshape = \"torus\"\n"
       "turn = [40, 20, 0]\nscale = 0.9\n[[object]]\nshape = \"sphere\"\nprogram = \"mirror.pse\"\n"
       "at = [0.9, 0.6, 0.4]\nradius = 0.5\n[[object]]\nshape = \"vase\"\nat = [-1, 0, -0.5]\n"
       "[[object]]\nshape = \"superquadric\"\nat = [0, -1.2, 0]\nscale = 0.5\n");
  const image::Image first = render({"s.toml", "--res", "61x47"});
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
           {"-t", "1"}, {"--tile", "7"}, {"--width", "4"}, {"--width", "1"}, {"--interpret"}}) {
    std::vector<std::string> arguments = {"s.toml", "--res", "61x47"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const image::Image other = render(arguments);
    EXPECT_EQ(first.planes, other.planes) << options.front();
  }
}

TEST_F(Surfaces, ASolidTextureGoesWithItsObject) {
  file("p.pse", "color = point\n");
  file("a.toml", "[camera]\neye = [0, 0, 5]\ntarget = [0, 0, 0]\n[[object]]\nshape = \"box\"\n");
  file("b.toml",
       "[camera]\neye = [5, 2, 7]\ntarget = [5, 2, 7.5]\n[[object]]\nshape = \"box\"\n"
       "at = [5, 2, 12]\nturn = [0, 180, 0]\n");
  const image::Image a = render({"p.pse", "--scene", "a.toml", "--res", "24x24"}),
                     b = render({"p.pse", "--scene", "b.toml", "--res", "24x24"});
  for (const char* channel : {"R", "G", "B"})
    for (int x = 8; x < 16; ++x) EXPECT_NEAR(at(a, channel, x, 11), at(b, channel, x, 11), 1e-5);
}

// In a closed room whose walls glow by 1 - r and throw back r, all is 1, less what the last
// reflection leaves out: r^6 after six.
TEST_F(Surfaces, AFurnaceIsEvenlyBright) {
  file("wall.pse",
       "r = 0.5\nback = radiance(place, normal + 0.9 * direction(Dnoise(place * 7)))\n"
       "color = (1 - r) * white + r * back.rgb\n");
  for (const char* shape : {"sphere", "box", "torus"}) {
    file("room.toml", std::string("program = \"wall.pse\"\n[camera]\neye = [0.6, 0.05, 0.1]\n"
                                  "target = [0, 0, 0.3]\nfov = 90\n[[object]]\nshape = \"") +
                          shape + "\"\n");
    const image::Image out = render({"room.toml", "--res", "16x16"});
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x)
        ASSERT_EQ(at(out, "G", x, y), 0.984375f) << shape << " " << x << " " << y;
  }
}

TEST_F(Surfaces, RaysMeetOtherObjects) {
  file("p.pse",
       "h = trace(place, [0 1 0])\ncolor = [h.distance h.id h.normal.y]\nlit = visible(place, [0 9 0])\n"
       "seen = radiance(place, [0 1 0])\n");
  file("white.pse", "color = white * 0.25\n");
  file("sky.pse", "color = [0 0 0.5]\n");
  file("s.toml",
       "program = \"p.pse\"\nbackground = \"sky.pse\"\n[camera]\neye = [0, 0.5, 3]\n"
       "target = [0, 0, 0]\n[[object]]\nshape = \"plane\"\n[[object]]\nshape = \"sphere\"\n"
       "radius = 0.5\nat = [0, 2, 0]\nprogram = \"white.pse\"\n");
  // Of the pixels' middles: the rays of the pixels above and below the middle one miss the ball.
  const image::Image out = render({"s.toml", "--res", "33x33", "--antialias", "none"});
  EXPECT_NEAR(at(out, "R", 16, 16), 1.5, 1e-5);
  EXPECT_EQ(at(out, "G", 16, 16), 2);
  EXPECT_NEAR(at(out, "B", 16, 16), -1, 1e-5);
  EXPECT_EQ(at(out, "lit.Y", 16, 16), 0);
  EXPECT_EQ(at(out, "seen.R", 16, 16), 0.25f);
  EXPECT_TRUE(std::isinf(at(out, "R", 2, 24)));
  EXPECT_EQ(at(out, "lit.Y", 2, 24), 1);
  EXPECT_EQ(at(out, "seen.B", 2, 24), 0.5f);
}

TEST_F(Surfaces, ATracedPictureShadesToTheSameBits) {
  file("p.pse", everything);
  for (const char* shape : {"vase", "torus"}) {
    ASSERT_EQ(pse({"trace", shape, "-o", "g.exr", "--res", "50x40"}).status, 0);
    const image::Image direct = render({"p.pse", "--on", shape, "--res", "50x40", "--antialias", "none"},
                                       "a.exr"),
                       again = render({"p.pse", "g.exr", "--antialias", "none"}, "b.exr");
    EXPECT_EQ(direct.planes, again.planes) << shape;
  }
}

// NaN in three pixels' places and one's normal, infinite in another's: those are background, each
// channel is named with its count, and the others are what they were.
TEST_F(Surfaces, BrokenPixelsOfATracedPictureAreBackground) {
  file("nan.pse",
       "nothing = 0 * px\nlost = nothing / nothing\n"
       "row = floor(py) == 20\ni = floor(px)\n"
       "P = row and i > 9 and i < 13 ? [place.x lost place.z] : place\n"
       "N = row and i == 20 ? [lost lost normal.z] : row and i == 22 ? "
       "[normal.x 1 / nothing normal.z] : normal\nid = hit\n");
  file("p.pse", "color = place + normal\n");
  const std::vector<std::string> size = {"--res", "32x40", "--antialias", "none"};
  const auto on_sphere = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"--on", "sphere", "--camera", "eye=0,0,1.5"});
    words.insert(words.end(), size.begin(), size.end());
    return words;
  };
  render(on_sphere({"nan.pse", "--nan", "keep"}), "g.exr");
  const image::Image direct = render(on_sphere({"p.pse"}), "a.exr");
  const Ended ended =
      pse({"render", "p.pse", "g.exr", "-o", "b.exr", "--float", "--antialias", "none"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_TRUE(contains(ended.err, "g.exr: P.Y is NaN or infinite at 3 pixels; they are shown as "
                                  "background"));
  EXPECT_TRUE(contains(ended.err, "N.X is NaN or infinite at 1 pixel; it is shown as background"));
  EXPECT_TRUE(contains(ended.err, "N.Y is NaN or infinite at 2 pixels"));
  EXPECT_FALSE(contains(ended.err, "N.Z is"));
  const image::Image stored = picture("b.exr");
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 32; ++x) {
      const bool broken = y == 20 && ((x > 9 && x < 13) || x == 20 || x == 22);
      EXPECT_EQ(at(stored, "A", x, y), broken ? 0 : at(direct, "A", x, y)) << x << " " << y;
      EXPECT_EQ(at(stored, "G", x, y), broken ? 0 : at(direct, "G", x, y)) << x << " " << y;
    }
}

// What is wrong with a program is told before meshes are read, which may take long.
TEST_F(Surfaces, ProgramsAreCompiledBeforeMeshesAreRead) {
  file("p.pse", "color = whte\n");
  file("bad.obj", "this is no mesh\n");
  const Ended ended = pse({"render", "p.pse", "--on", "bad.obj", "-o", "x.png"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(contains(ended.err, "`whte`"));
  EXPECT_FALSE(contains(ended.err, "bad.obj"));
  const Ended baked = pse({"bake", "p.pse", "bad.obj", "-o", "x.png"});
  EXPECT_EQ(baked.status, 3);
  EXPECT_TRUE(contains(baked.err, "`whte`"));
}

TEST_F(Surfaces, WhatFallsBetweenThePixelsIsNamed) {
  file("p.pse", "color = white\n");
  const auto said = [&](const std::string& words) {
    file("s.toml", "program = \"p.pse\"\n[[object]]\n" + words);
    return pse({"render", "s.toml", "-o", "x.png", "--res", "32x32"}).err;
  };
  EXPECT_TRUE(contains(said("shape = \"torus\"\nminor = 1e-6\n"),
                       "little or nothing is seen of torus: it is 2e-06 m thick where a pixel is"));
  EXPECT_TRUE(contains(said("shape = \"sphere\"\nscale = 1e-20\n"),
                       "little or nothing is seen of sphere: it is 2e-20 m thick"));
  EXPECT_TRUE(contains(said("shape = \"box\"\nscale = 1e20\n"), "box is 1.4e+20 m wide"));
  for (const char* shape : {"torus", "sphere", "box", "plane", "vase"})
    EXPECT_FALSE(contains(said("shape = \"" + std::string(shape) + "\"\n"), "warning")) << shape;
}

// Position and normal by other names, without directions: the rest follows.
TEST_F(Surfaces, AnotherRenderersPictureIsShaded) {
  file("other.pse",
       "view_layer_position = place\nview_layer_normal = normal\n"
       "view_layer_depth = depth\nview_layer_indexob = 4 * hit\n");
  file("p.pse", "color = normal * dot(view, normal)\nnumber = id\nw = pixelsize\n");
  const char* const camera = "eye=0.5,1,4 target=0,0,0";
  render({"other.pse", "--on", "torus", "--res", "64x64", "--camera", camera, "--antialias", "none"},
         "g.exr");
  const image::Image direct =
      render({"p.pse", "--on", "torus", "--res", "64x64", "--camera", camera, "--antialias", "none"},
             "a.exr");
  const image::Image stored = render({"p.pse", "g.exr", "--camera", "eye=0.5,1,4"}, "b.exr");
  const image::Image traced = picture("g.exr");
  int seen = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      EXPECT_EQ(at(direct, "A", x, y), at(stored, "A", x, y));
      if (at(direct, "A", x, y) == 0) continue;
      EXPECT_NEAR(at(direct, "G", x, y), at(stored, "G", x, y), 1e-5);
      EXPECT_EQ(at(stored, "number.Y", x, y), 4);
      ++seen;
    }
  EXPECT_GT(seen, 500);
  EXPECT_NEAR(at(direct, "w.Y", 32, 24), at(stored, "w.Y", 32, 24), 0.3 * at(direct, "w.Y", 32, 24));
  // Without an eye there is no view, and the message says so.
  const Ended ended = pse({"render", "p.pse", "g.exr", "-o", "x.png"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(contains(ended.err, "`view`"));
}

TEST_F(Surfaces, SamplesSmoothTheOutline) {
  file("p.pse", "color = white\n");
  const auto with = [&](std::vector<std::string> how) {
    how.insert(how.begin(), {"p.pse", "--on", "sphere", "--res", "32x32"});
    return render(how);
  };
  const image::Image one = with({"--antialias", "none"}), many = with({"--samples", "16"}),
                     procedural = with({}), truth = with({"--samples", "256"});
  int between = 0;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      EXPECT_TRUE(at(one, "A", x, y) == 0 || at(one, "A", x, y) == 1);
      between += at(many, "A", x, y) > 0.1 && at(many, "A", x, y) < 0.9 ? 1 : 0;
      // 64 samples, spread evenly, miss the share of a straight edge by up to 4.
      EXPECT_NEAR(at(procedural, "A", x, y), at(truth, "A", x, y), 0.07);
    }
  EXPECT_GT(between, 20);
}

TEST_F(Surfaces, FaultyScenesSayWhereAndWhat) {
  const std::string object = "[[object]]\nshape = \"sphere\"\n";
  expect_refused("", "the scene has no objects");
  expect_refused(object + "raduis = 2\n", "bad.toml:3: sphere has no setting `raduis`");
  expect_refused(object + "at = [1, 2]\n", "bad.toml:3: `at` is a list of 3 numbers");
  expect_refused("[camera]\neye = [0, 0, 1]\ntarget = [0, 0, 1]\n" + object, "at its target");
  expect_refused("[camera]\nfow = 3\n" + object, "did you mean `fov`?");
  expect_refused("[[light]]\ncolor = 1\n" + object, "a light has a `direction`");
  expect_refused("[[object]]\nat = [0, 0, 0]\n", "needs a `shape`");
  expect_refused("[object]\nshape = \"sphere\"\n", "write [[object]]");
  expect_refused("[[object]]\nshape = \"spere\"\n", "did you mean `sphere`?");
  expect_refused("[[object]]\nshape = \"no.obj\"\n", "no such file");
  expect_refused(object + "scale = 0\n", "not 0");
  expect_refused("x = = 3\n", "bad.toml:1:");
}

TEST_F(Surfaces, WrongWordsAreRefused) {
  file("p.pse", "color = white\n");
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
           {"--on", "spher"}, {"--on", "sphere radius=0"}, {"--on", "torus minor=a"},
           {"--on", "superquadric north=1e9"},
           {"--on", "sphere", "--camera", "eye=1,2"}, {"--camera", "eye=1,2,3"}}) {
    std::vector<std::string> arguments = {"render", "p.pse", "-o", "x.png"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    EXPECT_EQ(pse(arguments).status, 2) << options.back();
  }
  file("t.pse", "h = trace([0 0 0], [0 0 1])\ncolor = white * h.distance\n");
  const Ended ended = pse({"render", "t.pse", "-o", "x.png"});
  EXPECT_EQ(ended.status, 2);
  EXPECT_TRUE(contains(ended.err, "there is no scene"));
  file("broken.obj", "nothing\n");
  EXPECT_EQ(pse({"render", "p.pse", "--on", "broken.obj", "-o", "x.png"}).status, 4);
}

TEST_F(Surfaces, AnIsosurfaceAroundAllOfItsBoxIsTold) {
  file("p.pse", "color = white\n");
  file("blob.pse", "density = 4 - norm(point)\n");
  const auto told = [&](const std::string& on) {
    const Ended ended = pse({"render", "p.pse", "--on", on, "--res", "9x9", "-o", "o.exr"});
    EXPECT_EQ(ended.status, 0);
    return ended.err;
  };
  EXPECT_TRUE(contains(told("blob.pse"), "is above `level` 0.5 everywhere"));
  EXPECT_EQ(told("blob.pse level=2").find("nothing is seen"), std::string::npos);
  EXPECT_TRUE(contains(told("blob.pse level=5"), "is nowhere above `level` 5"));
}

// Images that are nearly of surfaces: what they lack is named.
TEST_F(Surfaces, WhatAStoredPictureLacksIsTold) {
  file("p.pse", "P = [x y 0]\ncolor = white\n");
  file("n.pse", "N = [x y 1]\ncolor = white\n");
  file("both.pse", "P = [x y 0]\nN = [x y 1]\ncolor = white\n");
  for (const char* name : {"p", "n", "both"})
    ASSERT_EQ(pse({"render", std::string(name) + ".pse", "-o", std::string(name) + ".exr", "--res",
                   "8x8"}).status, 0);
  file("shade.pse", "color = 0.5 + 0.5 * normal\n");
  EXPECT_TRUE(contains(pse({"render", "shade.pse", "p.exr", "-o", "o.exr"}).err,
                       "has a normal too: a layer `N`"));
  EXPECT_TRUE(contains(pse({"render", "shade.pse", "n.exr", "-o", "o.exr"}).err,
                       "has a position too: a layer `P`"));
  file("seen.pse", "color = white * dot(normal, view)\n");
  EXPECT_TRUE(contains(pse({"render", "seen.pse", "both.exr", "-o", "o.exr"}).err,
                       "--camera eye=X,Y,Z"));
}

// An eye so far away that Embree would end the process.
TEST_F(Surfaces, AMeshIsNotSeenFromBeyondTheReachOfRays) {
  file("p.pse", "color = white\n");
  file("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(pse({"render", "p.pse", "--on", "t.obj", "--camera", "eye=1e20,0,0", "--res", "9x9", "-o",
                 "o.exr"}).status, 0);
}

// Settings that a shape's name runs into, and those that are taken for images.
TEST_F(Surfaces, SettingsInAnotherSpellingAreToldHowTheyAreWritten) {
  file("p.pse", "color = white\n");
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"superquadric:north=2"}, {"superquadric", "north=2"}}) {
    std::vector<std::string> arguments = {"render", "p.pse", "-o", "o.exr", "--on"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Ended ended = pse(arguments);
    EXPECT_EQ(ended.status, 2);
    EXPECT_TRUE(contains(ended.err, "\"superquadric north=2\"")) << ended.err;
  }
}

TEST_F(Surfaces, ACameraInsideAnObjectIsTold) {
  file("p.pse", "color = white * backface\n");
  const Ended ended = pse({"render", "p.pse", "--on", "sphere", "--camera",
                           "eye=0,0,0.1 target=0,0,-1", "--res", "9x9", "-o", "o.exr"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_TRUE(contains(ended.err, "inside sphere"));
  EXPECT_EQ(at(picture("o.exr"), "R", 4, 4), 1);
}

TEST_F(Surfaces, ObjectsMoveAndKnobsDiffer) {
  file("p.pse", "Tone = 0.2\ncolor = white * Tone\n");
  file("s.toml",
       "program = \"p.pse\"\n[camera]\neye = [0, 0, 9]\ntarget = [0, 0, 0]\nfov = 40\n[[object]]\n"
       "shape = \"sphere\"\nat = [-2, 0, 0]\nmove = [24, 0, 0]\nknobs = { Tone = 0.7 }\n[[object]]\n"
       "shape = \"sphere\"\nat = [0, -2, 0]\n");
  const image::Image first = render({"s.toml", "--res", "33x33"});
  EXPECT_FLOAT_EQ(at(first, "R", 6, 16), 0.7f);
  EXPECT_FLOAT_EQ(at(first, "R", 16, 26), 0.2f);
  const image::Image later = render({"s.toml", "--res", "33x33", "-f", "2"});
  EXPECT_EQ(at(later, "R", 6, 16), 0);
  EXPECT_FLOAT_EQ(at(later, "R", 16, 16), 0.7f);
  const image::Image set = render({"s.toml", "--res", "33x33", "Tone=0.4"});
  EXPECT_FLOAT_EQ(at(set, "R", 16, 26), 0.4f);
}

}  // namespace
}  // namespace pse::test
