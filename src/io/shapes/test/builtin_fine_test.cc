#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/signed_distance.h"
#include "io/mesh_io/repair/crossings.h"
#include "io/shapes/test/shape_checks.h"
#include "palpate/builtin.h"

// Tests of the built-in shapes at three resolutions: the paper's counts, about 30,000 and about 300,000
// triangles.
namespace palpate::geometry {
namespace {

constexpr double kFineMm = 1e-3;

/// Each organ is read once per program.
const TriangleMesh& organ(const std::string& name) {
  static std::map<std::string, TriangleMesh> read;
  const auto found = read.find(name);
  return found != read.end() ? found->second : read.emplace(name, make_organ(name)).first->second;
}
const Tool& tool(const std::string& name) {
  static std::map<std::string, Tool> read;
  const auto found = read.find(name);
  return found != read.end() ? found->second : read.emplace(name, make_tool(name)).first->second;
}

std::size_t triangles_of(const Tool& tool) {
  std::size_t count = 0;
  for (const ToolPart& part : tool.parts) count += part.mesh.triangles.size();
  return count;
}

/// The smallest angle [deg] of each triangle, sorted.
std::vector<double> sharpest_angles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  TriangleMesh one;
  one.vertices.resize(3);
  one.triangles.push_back({0, 1, 2});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) one.vertices[k] = test::corner(mesh, t, k);
    angles.push_back(test::smallest_angle(one));
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

void expect_even_triangles(const TriangleMesh& mesh) {
  const std::vector<double> angles = sharpest_angles(mesh);
  EXPECT_GT(angles.front(), 8.0);
  EXPECT_GT(angles[angles.size() / 100], 35.0);
  EXPECT_GT(angles[angles.size() / 2], 50.0);
}

/// The largest distance [m] of every `step`-th vertex of `from` to the surface `to`.
double farthest(const TriangleMesh& from, const SignedDistance& to, std::size_t step) {
  double most = 0.0;
  for (std::size_t v = 0; v < from.vertices.size(); v += step) {
    most = std::max(most, std::abs(to.nearest(from.vertices[v]).distance));
  }
  return most;
}
double apart(const TriangleMesh& a, const SignedDistance& to_a, const TriangleMesh& b,
             const SignedDistance& to_b) {
  const auto step = [](const TriangleMesh& m) { return 1 + m.vertices.size() / 5000; };
  return std::max(farthest(a, to_b, step(a)), farthest(b, to_a, step(b)));
}

void expect_even_closed_shell(const TriangleMesh& mesh, int euler) {
  EXPECT_TRUE(test::is_closed(mesh));
  EXPECT_EQ(test::shells(mesh), 1);
  EXPECT_EQ(test::euler(mesh), euler);
  EXPECT_GT(signed_volume(mesh), 0.0);
  expect_even_triangles(mesh);
}

class FineOrgan : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Each, FineOrgan, ::testing::Values("gallbladder", "heart", "liver", "kidney"),
                         [](const auto& each) { return each.param; });

TEST_P(FineOrgan, IsOneClosedShellOfItsCountOrientedOutwardsWithEvenTriangles) {
  for (const auto& [ending, count] : {std::pair{"-30k", 30000U}, std::pair{"-300k", 300000U}}) {
    SCOPED_TRACE(ending);
    expect_even_closed_shell(organ(GetParam() + ending), 2);
    EXPECT_EQ(organ(GetParam() + ending).triangles.size(), count);
  }
}

TEST_P(FineOrgan, HasNoTriangleThatGoesThroughAnother) {
  EXPECT_EQ(mesh_io::find_crossings(organ(GetParam() + "-30k")).pairs.size(), 0U);
}

// Meshes with the paper's counts lack the duct's lumen and the smaller coronary vessels, and their coarse
// triangles do not reach the bottom of the clefts between the vessels.
TEST_P(FineOrgan, HasOneShapeAtAllResolutions) {
  const TriangleMesh& finest = organ(GetParam() + "-300k");
  const TriangleMesh& fine = organ(GetParam() + "-30k");
  const TriangleMesh& coarse = organ(GetParam());
  const SignedDistance to_finest(finest);
  EXPECT_LT(apart(fine, SignedDistance(fine), finest, to_finest), 0.7 * kFineMm);
  EXPECT_LT(farthest(coarse, to_finest, 1), 1.5 * kFineMm);
  // The liver's coarse triangles are twice as long as those of the other organs.
  EXPECT_LT(apart(coarse, SignedDistance(coarse), finest, to_finest),
            (GetParam() == "liver" ? 3.6 : 2.7) * kFineMm);
}

TEST(FineTool, EveryPartIsOneClosedShellWithEvenTrianglesAndTheShaftHasTwoRings) {
  for (const std::string name : {"curved-forceps", "straight-forceps"}) {
    for (const auto& [ending, count] : {std::pair{"-30k", 30000U}, std::pair{"-300k", 300000U}}) {
      const Tool& whole = tool(name + ending);
      EXPECT_EQ(whole.name, name + ending);
      EXPECT_EQ(triangles_of(whole), count);
      ASSERT_EQ(whole.parts.size(), 3U);
      for (const ToolPart& part : whole.parts) {
        SCOPED_TRACE(whole.name + " " + part.name);
        expect_even_closed_shell(part.mesh, part.is_jaw ? 2 : -2);
      }
    }
  }
}

/// All parts of a tool in one mesh, with the jaws at `gripper`.
TriangleMesh assembled(const Tool& tool, double gripper) {
  TriangleMesh all;
  for (const ToolPart& part : tool.parts) {
    const auto first = static_cast<std::int32_t>(all.vertices.size());
    for (const Triangle& t : part.mesh.triangles) {
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    const Pose pose = part.is_jaw ? part_pose(part, gripper) : Pose{};
    for (const Vec3& v : part.mesh.vertices) all.vertices.push_back(pose * v);
  }
  return all;
}

TEST(FineTool, NoTriangleOfAPartGoesThroughOneOfItsOwnOrAnotherPart) {
  for (const char* name : {"curved-forceps-30k", "straight-forceps-30k"}) {
    for (const double gripper : {0.0, 0.1, 0.3, 0.6, 1.0}) {
      EXPECT_EQ(mesh_io::find_crossings(assembled(tool(name), gripper)).pairs.size(), 0U)
          << name << " " << gripper;
    }
    EXPECT_GT(mesh_io::find_crossings(assembled(tool(name), -0.5)).pairs.size(), 0U)
        << name << ": closed too far";
  }
}

TEST(FineTool, AllResolutionsHaveJawsOfOneShapeAndTheFinerTwoTheShaftToo) {
  for (const std::string name : {"curved-forceps", "straight-forceps"}) {
    const Tool& finest = tool(name + "-300k");
    for (std::size_t k = 0; k < 3; ++k) {
      SCOPED_TRACE(name + " " + finest.parts[k].name);
      const SignedDistance to_finest(finest.parts[k].mesh);
      const auto apart_from_finest = [&](const TriangleMesh& mesh) {
        return apart(mesh, SignedDistance(mesh), finest.parts[k].mesh, to_finest);
      };
      EXPECT_LT(apart_from_finest(tool(name + "-30k").parts[k].mesh), 0.3 * kFineMm);
      if (k < 2) {
        EXPECT_LT(apart_from_finest(tool(name).parts[k].mesh), 1.1 * kFineMm);
      }
    }
  }
}

TEST(FineTool, IsAsLongAsSurgeonsOwn) {
  for (const char* name : {"curved-forceps-30k", "straight-forceps-30k"}) {
    const Tool& whole = tool(name);
    const double length = bounds(whole.parts[0].mesh).high.z() - bounds(whole.parts[2].mesh).low.z();
    EXPECT_NEAR(length, 138.0 * kFineMm, 6.0 * kFineMm);
  }
}

}  // namespace
}  // namespace palpate::geometry
