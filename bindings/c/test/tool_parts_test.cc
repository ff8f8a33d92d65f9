// Meshes and poses of the instruments through the C interface.
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/builtin.h"

#include "bindings/c/test/c_session.h"

namespace palpate::tests {
namespace {

using testing::HasSubstr;

/// Message of a call that fails with the expected status.
std::string parts_refusal(palpate_status wanted, palpate_status given) {
  return given == wanted ? palpate_last_error() : "status " + std::to_string(given);
}

TEST(ToolParts, AreTheBuiltInInstrumentsOwn) {
  const Session session(unheld());
  const geometry::Tool tool = geometry::make_tool("curved-forceps");
  ASSERT_EQ(session.info.tool_parts[0], tool.parts.size());
  EXPECT_EQ(session.info.tool_parts[1], 0U) << "there is one hand";
  for (std::uint32_t i = 0; i < tool.parts.size(); ++i) {
    const geometry::ToolPart& wanted = tool.parts[i];
    palpate_part part = fresh<palpate_part>();
    require(palpate_tool_part(session.get(), 0, i, &part));
    EXPECT_EQ(part.name, wanted.name);
    EXPECT_EQ(part.is_jaw != 0, wanted.is_jaw);
    ASSERT_EQ(part.vertices, wanted.mesh.vertices.size());
    ASSERT_EQ(part.triangles, wanted.mesh.triangles.size());
    std::vector<double> xyz(3 * part.vertices);
    std::vector<std::int32_t> corners(3 * part.triangles);
    require(palpate_part_vertices(session.get(), 0, i, xyz.data(), part.vertices));
    require(palpate_part_triangles(session.get(), 0, i, corners.data(), part.triangles));
    EXPECT_EQ(Vec3(xyz[3], xyz[4], xyz[5]), wanted.mesh.vertices[1]);
    EXPECT_EQ(xyz.back(), wanted.mesh.vertices.back().z());
    EXPECT_EQ(corners.back(), wanted.mesh.triangles.back()[2]);
  }
}

TEST(ToolParts, StandWhereTheLibraryPutsThemAtEveryOpening) {
  const Session session(unheld());
  const geometry::Tool tool = geometry::make_tool("curved-forceps");
  for (std::uint32_t i = 0; i < tool.parts.size(); ++i) {
    for (const double gripper : {0.0, 0.3, 1.0}) {
      const Pose wanted = geometry::part_pose(tool.parts[i], gripper);
      double position[3] = {};
      double orientation[4] = {};
      require(palpate_part_pose(session.get(), 0, i, gripper, position, orientation));
      EXPECT_EQ(Vec3(position[0], position[1], position[2]), wanted.position);
      EXPECT_EQ(orientation[0], wanted.rotation.w());
      EXPECT_EQ(orientation[1], wanted.rotation.x());
      EXPECT_EQ(orientation[2], wanted.rotation.y());
      EXPECT_EQ(orientation[3], wanted.rotation.z());
    }
  }
}

TEST(ToolParts, AreRefusedInWordsWhenThereIsNoneOrNoRoom) {
  const Session session(unheld());
  palpate_part part = fresh<palpate_part>();
  double numbers[4] = {};
  std::int32_t corner = 0;
  const auto use = [](palpate_status status) { return parts_refusal(PALPATE_ERROR_USE, status); };
  EXPECT_THAT(use(palpate_tool_part(nullptr, 0, 0, &part)), HasSubstr("simulation"));
  EXPECT_THAT(use(palpate_tool_part(session.get(), 1, 0, &part)), HasSubstr("hand = 1"));
  EXPECT_THAT(use(palpate_tool_part(session.get(), 0, 9, &part)), HasSubstr("part = 9"));
  EXPECT_THAT(use(palpate_tool_part(session.get(), 0, 0, nullptr)), HasSubstr("info"));
  part.struct_size = 0;
  EXPECT_THAT(use(palpate_tool_part(session.get(), 0, 0, &part)), HasSubstr("palpate_part.struct_size"));
  EXPECT_THAT(use(palpate_part_vertices(session.get(), 0, 0, nullptr, 9)), HasSubstr("xyz"));
  EXPECT_THAT(use(palpate_part_vertices(session.get(), 0, 0, numbers, 1)), HasSubstr("capacity = 1"));
  EXPECT_THAT(use(palpate_part_triangles(session.get(), 0, 0, nullptr, 9)), HasSubstr("corners"));
  EXPECT_THAT(use(palpate_part_triangles(session.get(), 0, 0, &corner, 1)), HasSubstr("capacity = 1"));
  EXPECT_THAT(use(palpate_part_pose(session.get(), 0, 0, 0.5, nullptr, numbers)), HasSubstr("position"));
  EXPECT_THAT(use(palpate_part_pose(session.get(), 0, 0, 0.5, numbers, nullptr)), HasSubstr("orientation"));
  for (const double gripper : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THAT(
        parts_refusal(PALPATE_ERROR_INPUT, palpate_part_pose(session.get(), 0, 0, gripper, numbers, numbers)),
        HasSubstr("gripper = "));
  }
}

}  // namespace
}  // namespace palpate::tests
