#include "net/igtl_stream.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "net/test/igtl_received.h"
#include "palpate/mesh.h"

namespace palpate::net {
namespace {

using test::read_all;
using test::Received;
using testing::ElementsAre;
using testing::FloatEq;

constexpr std::int64_t kNow = 1'700'000'000'000'000'000;  // ns

scene::Scene block() {
  scene::Scene scene;
  scene.rate_Hz = 2000.0;
  scene.organ = geometry::make_box(Vec3(0.06, 0.06, 0.04), 0.02);
  return scene;
}

/// Hand 0 presses 3 mm deep, hand 1 is 12.3 mm away.
haptics::Snapshot two_hands() {
  haptics::Snapshot snapshot;
  snapshot.tick = 2468;
  snapshot.hands = 2;
  snapshot.tools[0].pose_W.position = Vec3(0.001, 0.002, 0.003);
  snapshot.results[0].phase = contact::Phase::kPress;
  snapshot.results[0].depth = 0.003;
  snapshot.results[0].contact_W = Vec3(0.004, 0, 0.02);
  snapshot.commands[0].force = Vec3(0, 0.3, 0.4);
  snapshot.commands[0].torque = Vec3(0.01, 0, 0);
  snapshot.tools[1].pose_W.position = Vec3(0, 0, 0.5);
  snapshot.results[1].distance = 0.0123;
  return snapshot;
}

/// Two hands, the first of which presses the middle of the block's top by `depth` [m].
haptics::Snapshot pressed(double depth) {
  haptics::Snapshot snapshot = two_hands();
  contact::ToolResult& result = snapshot.results[0];
  result.view_count = 1;
  result.views[0].point_S = Vec3(0, 0, 0.02);
  result.views[0].direction_S = -Vec3::UnitZ();
  result.views[0].depth = depth;
  result.views[0].tip_radius = 0.003;
  return snapshot;
}

const Received& find(const std::vector<Received>& all, const std::string& type, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Received& received) {
    return received.type == type && received.name == name;
  });
  if (found == all.end()) throw std::runtime_error("there is no " + type + " " + name);
  return *found;
}

TEST(IgtlStream, PosesAndSensorsAreTheSnapshotsInMillimetresAndNewtonsForEachHand) {
  auto all = read_all(IgtlStream(block()).poses(two_hands(), kNow));
  EXPECT_EQ(all.size(), 4u) << "two of each hand";
  for (Received& received : read_all(IgtlStream(block()).sensors(two_hands(), kNow))) all.push_back(received);
  EXPECT_EQ(all.size(), 11u) << "the time, and three of each hand";
  EXPECT_THAT(find(all, "SENSOR", "PalpateTime").values(), ElementsAre(1.234)) << "tick 2468 at 2 kHz";
  EXPECT_THAT(find(all, "TRANSFORM", "PalpateTool").position(),
              ElementsAre(FloatEq(1.0F), FloatEq(2.0F), FloatEq(3.0F)));
  EXPECT_THAT(find(all, "SENSOR", "PalpateForce").values(), ElementsAre(0.0, 0.3, 0.4));
  EXPECT_THAT(find(all, "SENSOR", "PalpateTorque").values(), ElementsAre(0.01, 0.0, 0.0));
  EXPECT_THAT(find(all, "SENSOR", "PalpateDepth").values(), ElementsAre(3.0));
  EXPECT_THAT(find(all, "TRANSFORM", "PalpateTool2").position(),
              ElementsAre(FloatEq(0.0F), FloatEq(0.0F), FloatEq(500.0F)));
  EXPECT_THAT(find(all, "SENSOR", "PalpateForce2").values(), ElementsAre(0.0, 0.0, 0.0));
  for (const Received& received : all) EXPECT_DOUBLE_EQ(received.time, 1.7e9) << received.name;
}

TEST(IgtlStream, AnOrganInLpsIsSentInRasWithItsTool) {
  scene::Scene scene = block();
  for (Vec3& vertex : scene.organ.vertices) vertex += Vec3(-0.06, -0.035, 0.12);  // 90 to 30 mm to the left
  scene.organ_frame = scene::OrganFrame::kLps;
  IgtlStream stream(scene);
  haptics::Snapshot snapshot = two_hands();
  snapshot.tools[0].pose_W.rotation = rotation_about(Vec3::UnitX(), 0.5);
  snapshot.results[0].contact_W = Vec3(-0.06, -0.035, 0.14);
  snapshot.commands[0].force = Vec3(0.2, 0.3, 0.4);

  const auto sent = stream.poses(snapshot, kNow);
  auto all = read_all(sent);
  EXPECT_THAT(find(all, "TRANSFORM", "PalpateTool").position(),
              ElementsAre(FloatEq(-1.0F), FloatEq(-2.0F), FloatEq(3.0F)));
  igtl::Matrix4x4 matrix;
  find(all, "TRANSFORM", "PalpateTool").as<igtl::TransformMessage>()->GetMatrix(matrix);
  const Mat3 turned = rotation_about(Vec3::UnitX(), 0.5).toRotationMatrix();
  for (int column = 0; column < 3; ++column) {
    EXPECT_NEAR(matrix[0][column], -turned(0, column), 1e-6);
    EXPECT_NEAR(matrix[1][column], -turned(1, column), 1e-6);
    EXPECT_NEAR(matrix[2][column], turned(2, column), 1e-6);
  }
  igtl::PointElement::Pointer point;
  find(all, "POINT", "PalpateContact").as<igtl::PointMessage>()->GetPointElement(0, point);
  std::array<float, 3> place{};
  point->GetPosition(place.data());
  EXPECT_THAT(place, ElementsAre(FloatEq(60.0F), FloatEq(35.0F), FloatEq(140.0F)));

  all = read_all(stream.sensors(snapshot, kNow));
  EXPECT_THAT(find(all, "SENSOR", "PalpateForce").values(), ElementsAre(-0.2, -0.3, 0.4));
  EXPECT_THAT(find(all, "SENSOR", "PalpateTorque").values(), ElementsAre(-0.01, 0.0, 0.0));

  all = read_all(stream.surface(snapshot, kNow));
  igtl::PolyDataMessage::Pointer organ = find(all, "POLYDATA", "PalpateOrgan").as<igtl::PolyDataMessage>();
  Vec3 low = Vec3::Constant(1e9);
  Vec3 high = -low;
  for (unsigned i = 0; i < static_cast<unsigned>(organ->GetPoints()->GetNumberOfPoints()); ++i) {
    std::array<igtlFloat32, 3> at{};
    organ->GetPoints()->GetPoint(i, at.data());
    for (int axis = 0; axis < 3; ++axis) {
      const double value = static_cast<double>(at[static_cast<std::size_t>(axis)]);
      low[axis] = std::min(low[axis], value);
      high[axis] = std::max(high[axis], value);
    }
  }
  EXPECT_LT((low - Vec3(30.0, 5.0, 100.0)).norm(), 1e-3) << low.transpose();
  EXPECT_LT((high - Vec3(90.0, 65.0, 140.0)).norm(), 1e-3) << high.transpose();
}

TEST(IgtlStream, TheContactPointIsShownWhileTheToolTouches) {
  const auto all = read_all(IgtlStream(block()).poses(two_hands(), kNow));
  for (const auto& [name, opacity] : {std::pair("PalpateContact", 255), std::pair("PalpateContact2", 0)}) {
    const igtl::PointMessage::Pointer message = find(all, "POINT", name).as<igtl::PointMessage>();
    igtl::PointElement::Pointer point;
    message->GetPointElement(0, point);
    std::array<igtlUint8, 4> colour{};
    point->GetRGBA(colour.data());
    EXPECT_EQ(colour[3], opacity) << name;
  }
  igtl::PointElement::Pointer point;
  find(all, "POINT", "PalpateContact").as<igtl::PointMessage>()->GetPointElement(0, point);
  std::array<float, 3> place{};
  point->GetPosition(place.data());
  EXPECT_THAT(place, ElementsAre(FloatEq(4.0F), FloatEq(0.0F), FloatEq(20.0F)));
}

TEST(IgtlStream, TheWordsSayWhatEachHandDoesAndWhichFaultItHas) {
  haptics::Snapshot snapshot = two_hands();
  snapshot.faults[1] = haptics::Fault::kStale;
  const auto all = read_all(IgtlStream(block()).status(snapshot, kNow));
  const auto text = [&](const char* name) {
    return std::string(find(all, "STRING", name).as<igtl::StringMessage>()->GetString());
  };
  EXPECT_EQ(text("PalpateReading"), "hand 0 at 1.234 s: presses 3 mm deep, 0.5 N");
  EXPECT_EQ(text("PalpateReading2"), "hand 1 at 1.234 s: touches nothing, 12.3 mm away, 0 N");
  const auto status = [&](const char* name) { return find(all, "STATUS", name).as<igtl::StatusMessage>(); };
  EXPECT_EQ(status("PalpateStatus")->GetCode(), 1);
  EXPECT_STREQ(status("PalpateStatus")->GetErrorName(), "none");
  EXPECT_EQ(status("PalpateStatus2")->GetCode(), 7) << "timed out";
  EXPECT_EQ(status("PalpateStatus2")->GetSubCode(), 3);
  EXPECT_STREQ(status("PalpateStatus2")->GetErrorName(), "stale-sample");
  EXPECT_STREQ(status("PalpateStatus2")->GetStatusString(),
               "the device gave no new sample for 5 ms; the force stays zero until it is reset");
}

/// z [mm] of the surface's highest vertex above the middle of the block.
float height_in_the_middle(const Bytes& bytes) {
  const auto all = read_all(bytes);
  if (all.size() != 1) throw std::runtime_error("one POLYDATA is wanted");
  const igtl::PolyDataMessage::Pointer message = all[0].as<igtl::PolyDataMessage>();
  float height = -1e9F;
  for (int i = 0; i < message->GetPoints()->GetNumberOfPoints(); ++i) {
    std::array<float, 3> place{};
    message->GetPoints()->GetPoint(static_cast<unsigned int>(i), place.data());
    if (std::abs(place[0]) < 1e-3F && std::abs(place[1]) < 1e-3F) height = std::max(height, place[2]);
  }
  return height;
}

TEST(IgtlStream, TheSurfaceIsTheDeformedOrganWhereItIsInTheWorld) {
  IgtlStream stream(block());
  haptics::Snapshot snapshot = pressed(0.0035);
  EXPECT_NEAR(height_in_the_middle(stream.surface(snapshot, kNow)), 20.0 - 3.5, 1e-4)
      << "the vertex under the tool is pushed in by the depth";
  snapshot.organ_W.position.z() = 0.1;  // a displacement by breathing
  EXPECT_NEAR(height_in_the_middle(stream.surface(snapshot, kNow)), 120.0 - 3.5, 1e-4);
  snapshot.results[0].views[0].depth = 0.0;
  EXPECT_NEAR(height_in_the_middle(stream.surface(snapshot, kNow)), 120.0, 1e-4) << "let go";
}

TEST(IgtlStream, ASurfaceThatLiesAsBeforeIsNotSentAgain) {
  IgtlStream stream(block());
  EXPECT_FALSE(stream.surface(pressed(0.001), kNow).empty());
  EXPECT_TRUE(stream.surface(pressed(0.001), kNow).empty());
  const haptics::Snapshot snapshot = pressed(0.002);
  EXPECT_FALSE(stream.surface(snapshot, kNow).empty());
  haptics::Snapshot softer = snapshot;
  softer.reach.contact_ratio *= 1.1;
  EXPECT_FALSE(stream.surface(softer, kNow).empty()) << "another tissue gives way otherwise";
}

TEST(IgtlStream, ACoarseOrganIsDividedAndItsVerticesKeepTheirNumbers) {
  IgtlStream stream(block());
  const auto all = read_all(stream.surface(two_hands(), kNow));
  const igtl::PolyDataMessage::Pointer message = all.at(0).as<igtl::PolyDataMessage>();
  EXPECT_GT(message->GetPolygons()->GetNumberOfCells(), IgtlStream::kFewestTriangles);
  const std::vector<Vec3> vertices = block().organ.vertices;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    std::array<float, 3> place{};
    message->GetPoints()->GetPoint(static_cast<unsigned int>(i), place.data());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_FLOAT_EQ(place[axis], static_cast<float>(1e3 * vertices[i][static_cast<int>(axis)])) << i;
    }
  }
}

}  // namespace
}  // namespace palpate::net
