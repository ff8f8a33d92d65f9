#include "io/igtl/igtl_messages.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "net/test/igtl_received.h"

namespace palpate::net {
namespace {

using test::read_all;
using testing::ElementsAre;
using testing::FloatEq;

constexpr std::int64_t kStamp = 1'700'000'000'250'000'000;  // ns; 0.25 s is exact in binary

TEST(IgtlMessages, ATransformIsThePoseInMillimetresWithItsTimeAndName) {
  IgtlMessages messages(kStamp);
  // A quarter turn about z: x goes to y.
  messages.add_transform("PalpateTool",
                         {rotation_about(Vec3::UnitZ(), std::numbers::pi / 2), Vec3(0.001, -0.02, 0.3)});
  const auto all = read_all(messages.bytes());
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].type, "TRANSFORM");
  EXPECT_EQ(all[0].name, "PalpateTool");
  EXPECT_DOUBLE_EQ(all[0].time, 1'700'000'000.25);
  igtl::Matrix4x4 matrix{};
  all[0].as<igtl::TransformMessage>()->GetMatrix(matrix);
  const float want[4][4] = {{0, -1, 0, 1}, {1, 0, 0, -20}, {0, 0, 1, 300}, {0, 0, 0, 1}};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_NEAR(matrix[row][column], want[row][column], 1e-6F) << row << ' ' << column;
    }
  }
}

TEST(IgtlMessages, AFractionOfASecondIsInUnitsOfTwoToTheMinus32) {
  IgtlMessages messages(1'250'000'000);
  messages.add_transform("Hand", {});
  const Bytes stamp(messages.bytes().begin() + 34, messages.bytes().begin() + 42);
  EXPECT_EQ(stamp, (Bytes{0, 0, 0, 1, 0x40, 0, 0, 0}));
}

TEST(IgtlMessages, APointIsAListOfOneInMillimetresSeenOnlyWhenShown) {
  for (const bool shown : {true, false}) {
    IgtlMessages messages(kStamp);
    messages.add_point("PalpateContact", "contact", Vec3(0.0125, 0, -0.004), shown);
    const auto all = read_all(messages.bytes());
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].type, "POINT");
    const igtl::PointMessage::Pointer message = all[0].as<igtl::PointMessage>();
    ASSERT_EQ(message->GetNumberOfPointElement(), 1);
    igtl::PointElement::Pointer point;
    message->GetPointElement(0, point);
    EXPECT_STREQ(point->GetName(), "contact");
    std::array<float, 3> place{};
    point->GetPosition(place.data());
    EXPECT_THAT(place, ElementsAre(FloatEq(12.5F), FloatEq(0.0F), FloatEq(-4.0F)));
    std::array<igtlUint8, 4> colour{};
    point->GetRGBA(colour.data());
    EXPECT_EQ(colour[3], shown ? 255 : 0);
  }
}

TEST(IgtlMessages, ASensorHasItsValuesInDoublePrecisionAndItsUnit) {
  const std::array<double, 3> values = {1.0 / 3.0, -2.5, 1e-9};
  IgtlMessages messages(kStamp);
  messages.add_sensor("PalpateForce", values, SensorUnit::kNewton);
  messages.add_sensor("PalpateTorque", values, SensorUnit::kNewtonMetre);
  messages.add_sensor("PalpateDepth", std::span(values).first(1), SensorUnit::kMillimetre);
  messages.add_sensor("PalpateTime", std::span(values).first(1), SensorUnit::kSecond);
  const auto all = read_all(messages.bytes());
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].type, "SENSOR");
  EXPECT_THAT(all[0].values(), ElementsAre(1.0 / 3.0, -2.5, 1e-9)) << "bit for bit";
  EXPECT_EQ(all[2].values().size(), 1u);
  // The first 4 of the 64 bits are the prefix. Each unit follows with 6 bits, and its exponent with 4 bits.
  constexpr std::uint64_t kNewtonToThe1 = std::uint64_t{0x0B} << 54U | std::uint64_t{1} << 50U;
  constexpr std::uint64_t kThenMetreToThe1 = std::uint64_t{0x01} << 44U | std::uint64_t{1} << 40U;
  constexpr std::uint64_t kMilliMetre =
      std::uint64_t{0x0B} << 60U | std::uint64_t{0x01} << 54U | std::uint64_t{1} << 50U;
  constexpr std::uint64_t kSecond = std::uint64_t{0x03} << 54U | std::uint64_t{1} << 50U;
  const std::array<std::uint64_t, 4> want = {kNewtonToThe1, kNewtonToThe1 | kThenMetreToThe1, kMilliMetre,
                                             kSecond};
  for (std::size_t i = 0; i < want.size(); ++i) {
    EXPECT_EQ(all[i].as<igtl::SensorMessage>()->GetUnit(), want[i]) << all[i].name;
  }
}

TEST(IgtlMessages, AStringAndAStatusHaveTheirWords) {
  IgtlMessages messages(kStamp);
  messages.add_string("PalpateReading", "hand 1: 2 N");
  messages.add_status("PalpateStatus", StatusCode::kTimeOut, 3, "stale-sample", "no new sample");
  const auto all = read_all(messages.bytes());
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].type, "STRING");
  EXPECT_STREQ(all[0].as<igtl::StringMessage>()->GetString(), "hand 1: 2 N");
  EXPECT_EQ(all[1].type, "STATUS");
  const igtl::StatusMessage::Pointer status = all[1].as<igtl::StatusMessage>();
  EXPECT_EQ(status->GetCode(), 7);
  EXPECT_EQ(status->GetSubCode(), 3);
  EXPECT_STREQ(status->GetErrorName(), "stale-sample");
  EXPECT_STREQ(status->GetStatusString(), "no new sample");
}

TEST(IgtlMessages, ASurfaceKeepsItsTrianglesWhileItsVerticesMove) {
  const std::vector<geometry::Triangle> triangles = {{0, 1, 2}, {2, 1, 3}};
  std::vector<Vec3> vertices = {Vec3(0, 0, 0), Vec3(0.01, 0, 0), Vec3(0, 0.01, 0), Vec3(0.01, 0.01, 0)};
  for (const double height : {0.0, -0.0035}) {
    vertices[3].z() = height;
    IgtlMessages messages(kStamp);
    messages.add_surface("PalpateOrgan", vertices, triangles);
    const auto all = read_all(messages.bytes());
    ASSERT_EQ(all.size(), 1u);
    EXPECT_EQ(all[0].type, "POLYDATA");
    EXPECT_EQ(all[0].name, "PalpateOrgan");
    const igtl::PolyDataMessage::Pointer message = all[0].as<igtl::PolyDataMessage>();
    ASSERT_EQ(message->GetPoints()->GetNumberOfPoints(), 4);
    std::array<float, 3> place{};
    message->GetPoints()->GetPoint(3, place.data());
    EXPECT_THAT(place,
                ElementsAre(FloatEq(10.0F), FloatEq(10.0F), FloatEq(static_cast<float>(1e3 * height))));
    ASSERT_EQ(message->GetPolygons()->GetNumberOfCells(), 2u);
    std::array<igtlUint32, 3> cell{};
    ASSERT_EQ(message->GetPolygons()->GetCellSize(1), 3u);
    message->GetPolygons()->GetCell(1, cell.data());
    EXPECT_THAT(cell, ElementsAre(2u, 1u, 3u));
  }
}

}  // namespace
}  // namespace palpate::net
