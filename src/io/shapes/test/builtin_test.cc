#include "palpate/builtin.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/mesh_io/repair/crossings.h"
#include "io/shapes/test/shape_checks.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

using test::crossings;
using test::Hit;
using test::hits_from_above;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kMm = 1e-3;

const TriangleMesh& gallbladder() {
  static const TriangleMesh mesh = make_organ("gallbladder");
  return mesh;
}
const TriangleMesh& heart() {
  static const TriangleMesh mesh = make_organ("heart");
  return mesh;
}

const TriangleMesh& liver() {
  static const TriangleMesh mesh = make_organ("liver");
  return mesh;
}
const TriangleMesh& kidney() {
  static const TriangleMesh mesh = make_organ("kidney");
  return mesh;
}

// With the paper's counts; builtin_fine_test.cc tests the finer ones.
const std::vector<std::string> kOrgans{"gallbladder", "heart", "liver", "kidney", "ball", "box"};
const std::vector<std::string> kTools{"curved-forceps", "straight-forceps"};

void expect_one_closed_shell_without_handles(const TriangleMesh& mesh) {
  EXPECT_TRUE(test::is_closed(mesh));
  EXPECT_EQ(test::shells(mesh), 1);
  EXPECT_EQ(test::euler(mesh), 2);
  EXPECT_GT(signed_volume(mesh), 0.0);
}

TEST(BuiltinOrgan, GallbladderHasThePapersCounts) {
  EXPECT_EQ(gallbladder().vertices.size(), 1057U);
  EXPECT_EQ(gallbladder().triangles.size(), 2110U);
}

TEST(BuiltinOrgan, HeartHasThePapersTriangles) {
  EXPECT_GE(heart().vertices.size(), 3000U);
  EXPECT_EQ(heart().triangles.size(), 6412U);
}

TEST(BuiltinOrgan, LiverHas7000TrianglesAndKidney6000) {
  EXPECT_EQ(liver().triangles.size(), 7000U);
  EXPECT_EQ(kidney().triangles.size(), 6000U);
}

TEST(BuiltinOrgan, EveryOneIsOneClosedShellOrientedOutwardsAboutTheOrigin) {
  for (const std::string& name : kOrgans) {
    SCOPED_TRACE(name);
    const TriangleMesh mesh = make_organ(name);
    expect_one_closed_shell_without_handles(mesh);
    EXPECT_LT(bounds(mesh).middle().norm(), 1e-12);
  }
}

TEST(BuiltinOrgan, TrianglesAreWellShaped) {
  EXPECT_GT(test::smallest_angle(gallbladder()), 25.0);
  EXPECT_GT(test::smallest_angle(heart()), 15.0);
  EXPECT_GT(test::smallest_angle(liver()), 15.0);
  EXPECT_GT(test::smallest_angle(kidney()), 25.0);
}

TEST(BuiltinOrgan, EdgesAreEven) {
  const test::EdgeLengths small = test::edge_lengths(gallbladder());
  EXPECT_LT(small.longest / small.shortest, 6.0);
  const test::EdgeLengths large = test::edge_lengths(heart());
  EXPECT_LT(large.longest / large.shortest, 12.0);
  EXPECT_LT(large.longest, 10.0 * kMm);
  const test::EdgeLengths largest = test::edge_lengths(liver());
  EXPECT_LT(largest.longest / largest.shortest, 18.0);  // compared with the organ its vessels are thin
  EXPECT_LT(largest.longest, 14.0 * kMm);
  const test::EdgeLengths bean = test::edge_lengths(kidney());
  EXPECT_LT(bean.longest / bean.shortest, 8.0);
  EXPECT_LT(bean.longest, 6.0 * kMm);
}

TEST(BuiltinOrgan, NoTriangleGoesThroughAnother) {
  EXPECT_EQ(crossings(gallbladder(), gallbladder()), 0);
  EXPECT_EQ(crossings(heart(), heart()), 0);
  EXPECT_EQ(crossings(liver(), liver()), 0);
  EXPECT_EQ(crossings(kidney(), kidney()), 0);
}

TEST(BuiltinOrgan, NoFoldAtACommonCornerEither) {  // which the test above does not count
  for (const std::string& name : kOrgans)
    EXPECT_EQ(mesh_io::find_crossings(make_organ(name)).pairs.size(), 0U) << name;
}

TEST(BuiltinOrgan, SizesAndVolumesAreThoseOfTheBody) {
  const Vec3 bile = bounds(gallbladder()).size();
  EXPECT_NEAR(bile.x(), 92.0 * kMm, 6.0 * kMm);
  EXPECT_NEAR(bile.y(), 38.0 * kMm, 2.0 * kMm);
  EXPECT_NEAR(signed_volume(gallbladder()), 45e-6, 10e-6);  // 30 to 50 ml when filled
  const Vec3 beat = bounds(heart()).size();
  EXPECT_NEAR(beat.maxCoeff(), 124.0 * kMm, 8.0 * kMm);
  EXPECT_NEAR(signed_volume(heart()), 330e-6, 60e-6);  // about 300 g of muscle, and solid stumps of vessels
}

/// The default path presses at the centre of the bounding box.
void expect_broad_wall_under_the_tool(const TriangleMesh& mesh, double radius, double least_thickness) {
  for (int i = -2; i <= 2; ++i) {
    for (int j = -2; j <= 2; ++j) {
      // An odd offset from the mesh's edges.
      const double x = 0.5 * radius * i + 1.3e-5;
      const double y = 0.5 * radius * j + 2.7e-5;
      const std::vector<Hit> hits = hits_from_above(mesh, x, y);
      ASSERT_GE(hits.size(), 2U);
      EXPECT_GT(hits[0].normal.z(), 0.6) << x << " " << y;
      EXPECT_GT(hits[0].z - hits[1].z, least_thickness) << x << " " << y;
    }
  }
}

TEST(BuiltinOrgan, GallbladdersBodyIsBroadAndThickUnderTheDefaultPress) {
  expect_broad_wall_under_the_tool(gallbladder(), 8.0 * kMm, 22.0 * kMm);
  const std::vector<Hit> middle = hits_from_above(gallbladder(), 1.3e-5, 2.7e-5);
  EXPECT_GT(middle[0].z - middle[1].z, 28.0 * kMm);
  EXPECT_GT(middle[0].normal.z(), 0.9);
}

TEST(BuiltinOrgan, HeartShowsItsFrontWallToTheDefaultPull) {
  expect_broad_wall_under_the_tool(heart(), 8.0 * kMm, 30.0 * kMm);
  EXPECT_GT(hits_from_above(heart(), 1.3e-5, 2.7e-5)[0].normal.z(), 0.9);
}

TEST(BuiltinOrgan, LiverAndKidneyShowTheirFrontToTheDefaultPress) {
  expect_broad_wall_under_the_tool(liver(), 8.0 * kMm, 30.0 * kMm);
  expect_broad_wall_under_the_tool(kidney(), 8.0 * kMm, 20.0 * kMm);
  EXPECT_GT(hits_from_above(liver(), 1.3e-5, 2.7e-5)[0].normal.z(), 0.9);
  EXPECT_GT(hits_from_above(kidney(), 1.3e-5, 2.7e-5)[0].normal.z(), 0.9);
}

TEST(BuiltinOrgan, FourOrgansAreListedAtThreeResolutions) {
  for (const std::string stem : {"gallbladder", "heart", "liver", "kidney"}) {
    for (const char* ending : {"", "-30k", "-300k"})
      EXPECT_THAT(builtin_organ_names(), ::testing::Contains(stem + ending));
  }
  for (const char* name :
       {"curved-forceps-30k", "curved-forceps-300k", "straight-forceps-30k", "straight-forceps-300k"}) {
    EXPECT_THAT(builtin_tool_names(), ::testing::Contains(name));
  }
}

TEST(BuiltinOrgan, NameWithAnotherEndingIsRefused) {
  EXPECT_THROW((void)make_organ("heart-3k"), InputError);
  EXPECT_THROW((void)make_organ("ball-30k"), InputError);
  EXPECT_THROW((void)make_organ("-30k"), InputError);
  EXPECT_THROW((void)make_tool("sphere:3-30k"), InputError);
}

TEST(BuiltinOrgan, UnknownNameIsRefusedWithTheKnownOnes) {
  EXPECT_THAT([] { (void)make_organ("hart"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("\"hart\""), HasSubstr("did you mean heart"),
                                              HasSubstr("gallbladder, heart, liver, kidney, ball, box"))));
}

void expect_counts_within_a_tenth(const Tool& tool, double vertices, double triangles) {
  std::size_t v = 0;
  std::size_t t = 0;
  for (const ToolPart& part : tool.parts) {
    v += part.mesh.vertices.size();
    t += part.mesh.triangles.size();
  }
  EXPECT_NEAR(static_cast<double>(v), vertices, 0.1 * vertices);
  EXPECT_NEAR(static_cast<double>(t), triangles, 0.1 * triangles);
}

TEST(BuiltinTool, CountsAreThePapersWithinATenth) {
  expect_counts_within_a_tenth(make_tool("curved-forceps"), 461.0, 921.0);
  expect_counts_within_a_tenth(make_tool("straight-forceps"), 612.0, 1207.0);
}

TEST(BuiltinTool, TwoJawsThatOpenApartAndAShaft) {
  for (const std::string& name : kTools) {
    SCOPED_TRACE(name);
    const Tool tool = make_tool(name);
    EXPECT_EQ(tool.name, name);
    ASSERT_EQ(tool.parts.size(), 3U);
    EXPECT_TRUE(tool.parts[0].is_jaw);
    EXPECT_TRUE(tool.parts[1].is_jaw);
    EXPECT_FALSE(tool.parts[2].is_jaw);
    EXPECT_DOUBLE_EQ(tool.parts[0].open_angle, -tool.parts[1].open_angle);
    EXPECT_NEAR(std::abs(tool.parts[0].open_angle), 0.2618, 1e-4);
    for (const ToolPart& part : tool.parts) {
      expect_one_closed_shell_without_handles(part.mesh);
      EXPECT_EQ(crossings(part.mesh, part.mesh), 0);
    }
  }
}

TEST(BuiltinTool, ClosedPartsDoNotGoThroughEachOther) {
  for (const std::string& name : kTools) {
    SCOPED_TRACE(name);
    const Tool tool = make_tool(name);
    EXPECT_EQ(crossings(tool.parts[0].mesh, tool.parts[1].mesh), 0);
    EXPECT_EQ(crossings(tool.parts[0].mesh, tool.parts[2].mesh), 0);
    EXPECT_EQ(crossings(tool.parts[1].mesh, tool.parts[2].mesh), 0);
  }
}

TEST(BuiltinTool, OpeningPartsDoNotGoThroughEachOther) {
  for (const std::string& name : kTools) {
    for (const double gripper : {0.1, 0.3, 0.6, 1.0}) {
      SCOPED_TRACE(name + " " + std::to_string(gripper));
      Tool tool = make_tool(name);
      for (ToolPart& part : tool.parts) {
        if (part.is_jaw) transform(part.mesh, part_pose(part, gripper));
      }
      EXPECT_EQ(crossings(tool.parts[0].mesh, tool.parts[1].mesh), 0);
      EXPECT_EQ(crossings(tool.parts[0].mesh, tool.parts[2].mesh), 0);
      EXPECT_EQ(crossings(tool.parts[1].mesh, tool.parts[2].mesh), 0);
    }
  }
}

/// The smallest distance between vertices of the jaws' inner sides, beyond the hinge.
double gap_between_jaws(const Tool& tool, double from_z) {
  double least = 1.0;
  for (const Vec3& a : tool.parts[0].mesh.vertices) {
    for (const Vec3& b : tool.parts[1].mesh.vertices) {
      if (a.z() > from_z && b.z() > from_z) least = std::min(least, (a - b).norm());
    }
  }
  return least;
}

TEST(BuiltinTool, ClosedJawsFaceEachOtherAcrossLessThanHalfAMillimetre) {
  for (const std::string& name : kTools) {
    const double gap = gap_between_jaws(make_tool(name), 6.0 * kMm);
    EXPECT_GT(gap, 0.0);
    EXPECT_LT(gap, 0.5 * kMm);
  }
}

TEST(BuiltinTool, JawsReachTwoCentimetresAheadAndTheShaftLiesBehind) {
  for (const std::string& name : kTools) {
    const Tool tool = make_tool(name);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(bounds(tool.parts[k].mesh).high.z(), 22.0 * kMm, 4.0 * kMm);
      EXPECT_GT(bounds(tool.parts[k].mesh).low.z(), -3.0 * kMm);
    }
    const Bounds shaft = bounds(tool.parts[2].mesh);
    EXPECT_NEAR(shaft.low.z(), -75.0 * kMm, 1e-9);
    EXPECT_NEAR(shaft.size().x(), 5.0 * kMm, 1e-9);
    EXPECT_LT(shaft.high.z(), 3.0 * kMm);
  }
}

TEST(BuiltinTool, LeftJawOpensToItsOwnSide) {
  for (const std::string& name : kTools) {
    const Tool tool = make_tool(name);
    const auto tip_x = [&tool](std::size_t k, double gripper) {
      TriangleMesh mesh = tool.parts[k].mesh;
      transform(mesh, part_pose(tool.parts[k], gripper));
      Vec3 tip = mesh.vertices.front();
      for (const Vec3& v : mesh.vertices) tip = v.z() > tip.z() ? v : tip;
      return tip.x();
    };
    EXPECT_GT(tip_x(0, 0.0), tip_x(1, 0.0));
    EXPECT_GT(tip_x(0, 1.0) - tip_x(0, 0.0), 3.0 * kMm);
    EXPECT_LT(tip_x(1, 1.0) - tip_x(1, 0.0), -3.0 * kMm);
  }
}

TEST(BuiltinTool, SphereHasTheRadiusInItsName) {
  const Tool tool = make_tool("sphere:2.5");
  ASSERT_EQ(tool.parts.size(), 1U);
  EXPECT_FALSE(tool.parts[0].is_jaw);
  for (const Vec3& v : tool.parts[0].mesh.vertices) EXPECT_NEAR(v.norm(), 2.5 * kMm, 1e-12);
}

TEST(BuiltinTool, SphereWithoutAGoodRadiusIsRefused) {
  for (const char* name : {"sphere:", "sphere:x", "sphere:-1", "sphere:0", "sphere:nan", "sphere:inf",
                           "sphere:3mm", "sphere:201", "sphere:1e9"}) {
    EXPECT_THROW((void)make_tool(name), InputError) << name;
  }
}

TEST(BuiltinTool, UnknownNameIsRefusedWithTheKnownOnes) {
  EXPECT_THAT([] { (void)make_tool("curved-forcep"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("did you mean curved-forceps"),
                                              HasSubstr("straight-forceps-300k, sphere:R"))));
}

}  // namespace
}  // namespace palpate::geometry
