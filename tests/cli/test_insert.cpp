// `pse render --insert`: rows of a table in the picture, table() as an array, and what is refused.
#include "run_pse.h"

namespace pse::test {
namespace {

class Insert : public CommandLine {
 protected:
  float value(const image::Image& image, const std::string& channel, int x, int y) {
    const int index = image.spec.find(channel);
    EXPECT_GE(index, 0) << channel;
    return index < 0 ? 0.0f : image.at(index, x, y);
  }
};

TEST_F(Insert, RowsLandWhereTheyBelong) {
  // The plane's [0.5 0.5] in a picture of 8 x 8 is (6, 2) from the top left: a corner of pixels.
  file("stars.csv", "x,y,light.r,light.g,light.b\n0.5,0.5,64,128,0\n");
  file("a.pse", "color = stars.light\ncovered = stars.coverage\n");
  const std::vector<std::string> common = {"render", "a.pse", "--insert", "stars=stars.csv", "-o",
                                           "a.exr",  "--res", "8x8",      "--float"};
  ASSERT_EQ(pse(common).status, 0) << pse(common).err;
  image::Image made = picture("a.exr");
  // The spline half a pixel from its middle is 23/48.
  const float middle = 23.0f / 48 * 23 / 48;
  for (const auto& [x, y] : {std::pair{5, 1}, {6, 1}, {5, 2}, {6, 2}}) {
    EXPECT_NEAR(value(made, "R", x, y), 64 * middle, 0.01);
    EXPECT_NEAR(value(made, "G", x, y), 128 * middle, 0.01);
    EXPECT_NEAR(value(made, "covered.Y", x, y), middle, 1e-5);
  }
  EXPECT_EQ(value(made, "R", 2, 6), 0);

  // The same place in other coordinates, and under a transform that doubles what the program sees.
  for (const std::string row :
       {"u,v,light.r,light.g,light.b\n0.75,0.75", "px,py,light.r,light.g,light.b\n6,2"}) {
    file("stars.csv", row + ",64,128,0\n");
    ASSERT_EQ(pse(common).status, 0);
    EXPECT_NEAR(value(picture("a.exr"), "R", 6, 2), 64 * middle, 0.01) << row;
  }
  file("stars.csv", "x,y,light.r,light.g,light.b\n1,1,64,128,0\n");
  std::vector<std::string> moved = common;
  moved.insert(moved.end(), {"--xform", "2,0,0,0,2,0"});
  ASSERT_EQ(pse(moved).status, 0);
  EXPECT_NEAR(value(picture("a.exr"), "R", 6, 2), 64 * middle, 0.01);
}

TEST_F(Insert, RulesByTableAndByColumn) {
  file("t.csv", "px,py,z,heat,mark\n4.5,4.5,1,5,1\n4.5,4.5,3,2,2\n");
  file("a.pse", "a = t.heat\nb = t.mark\n");
  const auto run = [&](const std::vector<std::string>& rules) {
    std::vector<std::string> words = {"render", "a.pse", "--insert", "t=t.csv", "-o",
                                      "a.exr",  "--res", "8x8",      "--float"};
    words.insert(words.end(), rules.begin(), rules.end());
    const Ended ended = pse(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    const image::Image made = picture("a.exr");
    return std::pair{value(made, "a.Y", 4, 4), value(made, "b.Y", 4, 4)};
  };
  EXPECT_NEAR(run({}).first, 7 * 4.0 / 9, 1e-5);
  EXPECT_EQ(run({"--rule", "t=nearest"}), (std::pair{2.0f, 2.0f}));  // the greatest z
  EXPECT_EQ(run({"--rule", "t.heat=max", "--rule", "t=nearest"}), (std::pair{5.0f, 2.0f}));
}

TEST_F(Insert, PicturesAreTablesOfTheirPixels) {
  // Each pixel of one picture says where it goes in another: here, up side down.
  file("make.pse", "px = px\npy = 4 - py\nheat = 10 * px + py\n");
  ASSERT_EQ(pse({"render", "make.pse", "-o", "make.exr", "--res", "4x4", "--float"}).status, 0);
  ASSERT_EQ(pse({"render", "make.pse", "-o", "make.csv", "--res", "4x4"}).status, 0);
  file("a.pse", "a = t.heat\n");
  for (const std::string table : {"make.csv"}) {
    const Ended ended = pse({"render", "a.pse", "--insert", "t=" + table, "--rule", "t=nearest",
                             "-o", "a.exr", "--res", "4x4", "--float"});
    ASSERT_EQ(ended.status, 0) << ended.err;
    const image::Image made = picture("a.exr");
    // px and py of the row are what the program set: heat = 10 px + (4 - py).
    EXPECT_EQ(value(made, "a.Y", 1, 0), 15.5f);
    EXPECT_EQ(value(made, "a.Y", 1, 3), 18.5f);
  }
}

TEST_F(Insert, SmallTablesAreArrays) {
  file("t.csv", "x,y,tint.r,tint.g,tint.b\n1,2,3,4,5\n6,7,8,9,10\n11,12,13,14,15\n");
  file("a.pse",
       "if begin_frame\n    xs = table(\"t.csv\", \"x\")\n    tints = table(\"t.csv\", \"tint\")\n"
       "n = count(xs)\nsum = 0\nfor a in xs\n    sum += a\nlast = tints[3]\n"
       "size = texture_size(\"t.csv\")\n");
  const Ended ended = pse({"render", "a.pse", "-o", "a.exr", "--res", "2x2", "--float"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  const image::Image made = picture("a.exr");
  EXPECT_EQ(value(made, "n.Y", 0, 0), 3);
  EXPECT_EQ(value(made, "sum.Y", 1, 1), 18);
  EXPECT_EQ(value(made, "last.Y", 0, 1), 14);
  EXPECT_EQ(value(made, "size.X", 0, 1), 3);
}

TEST_F(Insert, ProgramsMakeTables) {
  file("rows.pse", "row = px + 0.5\nplace = [row -row]\n");
  const Ended ended = pse({"render", "rows.pse", "--res", "3x1", "-o", "rows.csv"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(read("rows.csv"), "row,place.x,place.y\n1,1,-1\n2,2,-2\n3,3,-3\n");
  // And read them: a row is a pixel.
  file("more.pse", "twice = 2 * row\n");
  ASSERT_EQ(pse({"render", "more.pse", "rows.csv", "-o", "more.csv"}).status, 0);
  EXPECT_EQ(read("more.csv"), "twice\n2\n4\n6\n");
}

TEST_F(Insert, WhatIsWrongIsSaid) {
  file("a.pse", "a = t.heat\n");
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "a.pse", "-o", "a.exr", "--res", "8x8"};
    words.insert(words.end(), more.begin(), more.end());
    return pse(words);
  };
  file("t.csv", "left,up,heat\n1,2,3\n");
  Ended ended = run({"--insert", "t=t.csv"});
  EXPECT_EQ(ended.status, 4);
  EXPECT_TRUE(contains(ended.err, "does not say where its rows belong"));
  EXPECT_TRUE(contains(ended.err, "left, up, heat"));
  file("t.csv", "x,y,heat\n1,2,3\n1,2,three\n");
  ended = run({"--insert", "t=t.csv"});
  EXPECT_EQ(ended.status, 4);
  EXPECT_TRUE(contains(ended.err, "t.csv:3: `three` in column `heat` is no number"));
  file("t.csv", "x,y,heat\n1,2,3\n");
  EXPECT_EQ(run({"--insert", "t=nowhere.csv"}).status, 4);
  EXPECT_EQ(run({"--insert", "t=t.csv", "--insert", "t=t.csv"}).status, 2);
  EXPECT_EQ(run({"--insert", "t=t.csv", "--rule", "t=least"}).status, 2);
  EXPECT_EQ(run({"--insert", "t=t.csv", "--rule", "s=max"}).status, 2);
  EXPECT_EQ(run({"--insert", "t=t.csv", "--xform", "1,0,0,1,0,0"}).status, 2);
  // A column that the table does not have is an error of the program.
  file("a.pse", "a = t.haet\n");
  ended = run({"--insert", "t=t.csv"});
  EXPECT_EQ(ended.status, 3);
  EXPECT_TRUE(contains(ended.err, "did you mean `heat`"));
}

}  // namespace
}  // namespace pse::test
