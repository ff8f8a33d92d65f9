#include "io/scene/instrument.h"

#include <cmath>
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "palpate/mesh.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::HasSubstr;

constexpr double kOpening = 0.25;  // rad

/// A box-shaped jaw, 2 x 2 x 20 mm, from the pivot towards +z, with its centre at (x, y).
geometry::ToolPart jaw_at(double x, double y) {
  geometry::ToolPart jaw;
  jaw.is_jaw = true;
  jaw.open_angle = kOpening;
  jaw.mesh = geometry::make_box({2e-3, 2e-3, 20e-3}, 5e-3);
  geometry::transform(jaw.mesh, {Quat::Identity(), {x, y, 10e-3}});
  return jaw;
}

Vec3 tip(const geometry::ToolPart& jaw, double gripper) {
  const Pose pose = geometry::part_pose(jaw, gripper);
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  for (const Vec3& v : jaw.mesh.vertices) {
    if (v.z() < 19e-3) continue;
    sum += pose * v;
    count += 1.0;
  }
  return sum / count;
}

LocatedString stated(const std::filesystem::path& file) { return {file.string(), "s.toml:4: tool.mesh", {}}; }

const std::string kTetrahedron =
    "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";  // an OBJ file

TEST(OpenApart, TurnsEachJawAwayFromTheOtherWhicheverSideItIsOn) {
  for (const Vec3& side : {Vec3(2e-3, 0, 0), Vec3(-2e-3, 0, 0), Vec3(0, 2e-3, 0), Vec3(0, -2e-3, 0)}) {
    std::vector<geometry::ToolPart> jaws = {jaw_at(side.x(), side.y()), jaw_at(-side.x(), -side.y())};
    open_apart(jaws);
    const double closed = (tip(jaws[0], 0.0) - tip(jaws[1], 0.0)).norm();
    const double open = (tip(jaws[0], 1.0) - tip(jaws[1], 1.0)).norm();
    EXPECT_NEAR(closed, 4e-3, 1e-12);
    EXPECT_NEAR(open, 4e-3 * std::cos(kOpening) + 2.0 * 20e-3 * std::sin(kOpening), 1e-12);
  }
}

TEST(OpenApart, WorksForJawsThatBothLieOnOneSideOfTheirPivot) {
  std::vector<geometry::ToolPart> jaws = {jaw_at(0.0, -3e-3), jaw_at(0.0, -5e-3)};  // both on the side of -y
  open_apart(jaws);
  EXPECT_GT(tip(jaws[0], 1.0).y() - tip(jaws[1], 1.0).y(), 10e-3);
}

TEST(OpenApart, LeavesASingleJawAsItIs) {
  std::vector<geometry::ToolPart> jaws = {jaw_at(2e-3, 0.0)};
  open_apart(jaws);
  EXPECT_EQ(jaws[0].open_angle, kOpening);
  EXPECT_EQ(jaws[0].axis, Vec3(0.0, 1.0, 0.0));
}

TEST(LoadInstrument, MakesABallOfTheRadiusInTheName) {
  ToolTable description;
  description.mesh = LocatedString{"sphere:3.5", "s.toml:4: tool.mesh", {}};
  MeshNotes notes;
  const geometry::Tool tool = load_instrument(description, notes);
  ASSERT_EQ(tool.parts.size(), 1U);
  EXPECT_FALSE(tool.parts[0].is_jaw);
  EXPECT_DOUBLE_EQ(*tool.tip_radius, 3.5e-3);
  for (const Vec3& v : tool.parts[0].mesh.vertices) EXPECT_NEAR(v.norm(), 3.5e-3, 1e-15);
}

TEST(LoadInstrument, RefusesBallsWithoutAGoodRadius) {
  for (const std::string bad : {"", "0", "-3", "nan", "inf", "3mm", "1e9"}) {
    ToolTable description;
    description.mesh = LocatedString{"sphere:" + bad, "s.toml:4: tool.mesh", {}};
    MeshNotes notes;
    EXPECT_THAT(error_of([&] { (void)load_instrument(description, notes); }),
                HasSubstr("s.toml:4: tool.mesh: tool \"sphere:" + bad + "\": the radius"));
  }
}

TEST(LoadInstrument, PlacesMeshesPivotsAndAxesByTheMount) {
  const TemporaryFolder folder;
  ToolTable description;
  description.mesh = stated(folder.write("shaft.obj", kTetrahedron));
  description.unit = LengthUnit::kMillimetre;
  description.mount = {rotation_from_degrees({0.0, 0.0, 90.0}), {0.0, 0.0, 5e-3}};
  description.tip_radius = 2e-3;
  JawTable jaw;
  jaw.mesh = stated(folder.write("jaw.obj", kTetrahedron));
  jaw.pivot = {1e-3, 0.0, 0.0};
  jaw.axis = Vec3::UnitX();
  jaw.open_angle = -0.2;
  description.jaws = {jaw};
  MeshNotes notes;
  const geometry::Tool tool = load_instrument(description, notes);
  ASSERT_EQ(tool.parts.size(), 2U);
  EXPECT_FALSE(tool.parts[0].is_jaw);
  EXPECT_EQ(tool.parts[1].name, "jaw");
  EXPECT_TRUE(tool.parts[1].is_jaw);
  EXPECT_EQ(tool.parts[1].open_angle, -0.2);
  EXPECT_NEAR((tool.parts[1].pivot - Vec3(0.0, 1e-3, 5e-3)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((tool.parts[1].axis - Vec3(0.0, 1.0, 0.0)).norm(), 0.0, 1e-15);
  for (const geometry::ToolPart& part : tool.parts) {
    const geometry::Bounds box = geometry::bounds(part.mesh);
    EXPECT_NEAR((box.low - Vec3(-10e-3, 0.0, 5e-3)).norm(), 0.0, 1e-9);
    EXPECT_NEAR((box.high - Vec3(0.0, 10e-3, 15e-3)).norm(), 0.0, 1e-9);
  }
  EXPECT_EQ(tool.tip_radius, 2e-3);
}

/// A needle as an OBJ file: a square shaft of 1 x 1 x 80 mm with a bevel, along +x, and a hub 6 mm wide
/// behind.
const std::string kNeedle =
    "v 0 2 2\nv 0 3 2\nv 0 3 3\nv 0 2 3\nv 80 2 2\nv 80 3 2\nv 78 3 3\nv 78 2 3\nv 0 -1 -1\nv 0 5 -1\nv -20 "
    "5 5\n"
    "f 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\nf 5 6 7\nf 5 7 8\nf 9 10 11\n";

TEST(LoadInstrument, AMeshWithANeedleTableHasItsTipOnTheShaftsAxisUnderTheMount) {
  const TemporaryFolder folder;
  ToolTable table;
  table.mesh = stated(folder.write("needle.obj", kNeedle));
  table.unit = LengthUnit::kMillimetre;
  table.needle = NeedleTable{"s.toml:6: tool.needle", Vec3::UnitX(), 1e-3, 80e-3};
  table.mount.position = Vec3(0, 0, 10e-3);
  MeshNotes notes;
  const geometry::Tool tool = load_instrument(table, notes);
  ASSERT_TRUE(tool.needle);
  EXPECT_LT((tool.needle->tip - Vec3(80e-3, 2.5e-3, 12.5e-3)).norm(), 1e-9);
  EXPECT_LT((tool.needle->axis - Vec3::UnitX()).norm(), 1e-12);
  EXPECT_EQ(tool.needle->length, 80e-3);

  const auto refusal = [&](const NeedleTable& needle) {
    table.needle = needle;
    return error_of([&] { static_cast<void>(load_instrument(table, notes)); });
  };
  EXPECT_EQ(refusal({"here", Vec3::UnitX(), 1e-3, 120e-3}),
            "here.length_mm: 120 mm is more than the mesh has along the axis, 100 mm");
  EXPECT_THAT(refusal({"here", Vec3::UnitX(), 3e-3, 80e-3}),
              HasSubstr("here.diameter_mm: 3 mm, but the mesh is 1 mm wide within 72 mm of its tip"));
  EXPECT_THAT(refusal({"here", Vec3::UnitX(), 2e-3, 80e-3}), HasSubstr("here.diameter_mm: 2 mm"));
  EXPECT_THAT(refusal({"here", -Vec3::UnitX(), 1e-3, 80e-3}),
              HasSubstr("here.diameter_mm: 1 mm, but the mesh is 6"));
  table.mesh->value = "sphere:3";
  EXPECT_THAT(refusal({"here", Vec3::UnitX(), 1e-3, 80e-3}),
              HasSubstr("here: needs a tool of one mesh file"));
}

TEST(LoadInstrument, ReportsOfAnOpenMeshThatItIsUsedAllTheSame) {
  const TemporaryFolder folder;
  ToolTable description;
  description.unit = LengthUnit::kMillimetre;
  description.mesh = stated(folder.write("open.obj", kTetrahedron.substr(0, kTetrahedron.rfind("f 2 3 4"))));
  MeshNotes notes;
  EXPECT_EQ(load_instrument(description, notes).parts[0].mesh.triangles.size(), 3U);
  EXPECT_THAT(notes.remarks, testing::Contains(HasSubstr("open.obj: not closed, used as it is")));
}

TEST(LoadInstrument, RefusesUnknownNamesMissingUnitsAndTooManyParts) {
  const TemporaryFolder folder;
  MeshNotes notes;
  ToolTable description;
  description.mesh = LocatedString{"scissors", "s.toml:4: tool.mesh", {}};
  EXPECT_THAT(error_of([&] { (void)load_instrument(description, notes); }),
              HasSubstr("s.toml:4: tool.mesh = \"scissors\": must be curved-forceps"));
  description.mesh = stated(folder.write("shaft.obj", kTetrahedron));
  EXPECT_THAT(error_of([&] { (void)load_instrument(description, notes); }),
              HasSubstr("its unit is missing, give tool.unit: mm, cm, m or in"));
  description.mesh->where = "--tool";
  description.mesh->by_flag = true;
  EXPECT_THAT(error_of([&] { (void)load_instrument(description, notes); }),
              HasSubstr("its unit is missing, give --tool-unit: mm, cm, m or in"));
  description.unit = LengthUnit::kMillimetre;
  JawTable jaw;
  jaw.mesh = *description.mesh;
  description.jaws = {jaw, jaw, jaw};
  EXPECT_THAT(error_of([&] { (void)load_instrument(description, notes); }),
              HasSubstr("the tool has 4 parts, must be at most 3"));
  description.jaws[0].mesh.value = "left";
  EXPECT_THAT(error_of([&] { (void)load_instrument(description, notes); }),
              HasSubstr("= \"left\": must be a file"));
}

/// Real instruments, if the environment names a folder of them.
TEST(LoadInstrument, JawsOfRealInstrumentsGivenByFlagsOpenApart) {
  const char* data = std::getenv("PALPATE_DATA");
  if (data == nullptr) return;  // without the files there is nothing to check
  for (const std::string name : {"maryland_dissector", "atraumatic_forceps"}) {
    ToolTable description;
    description.unit = LengthUnit::kMillimetre;
    description.jaws_by_flags = true;
    for (const std::string side : {"left", "right"}) {
      JawTable jaw;
      jaw.mesh = {std::string(data) + "/instruments/" + name + "_jaw_" + side + ".stl", "--tool", {}};
      jaw.open_angle = kOpening;
      description.jaws.push_back(jaw);
    }
    MeshNotes notes;
    const geometry::Tool tool = load_instrument(description, notes);
    const auto gap = [&](double gripper) {
      Vec3 ends[2];
      for (std::size_t i = 0; i < 2; ++i) {
        const geometry::TriangleMesh& mesh = tool.parts[i].mesh;
        const double top = geometry::bounds(mesh).high.z();
        double count = 0.0;
        ends[i] = Vec3::Zero();
        for (const Vec3& v : mesh.vertices) {
          if (v.z() < top - 3e-3) continue;
          ends[i] += geometry::part_pose(tool.parts[i], gripper) * v;
          count += 1.0;
        }
        ends[i] /= count;
      }
      return (ends[0] - ends[1]).norm();
    };
    EXPECT_GT(gap(1.0) - gap(0.0), 7e-3) << name;
  }
}

}  // namespace
}  // namespace palpate::scene
