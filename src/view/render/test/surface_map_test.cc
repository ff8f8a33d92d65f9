#include "view/render/surface_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/offscreen.h"
#include "view/render/map_legend.h"

namespace palpate::render {
namespace {

constexpr int kMapSide = 300;  // pixels
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
const Vec3 kBoxSize(0.06, 0.05, 0.002);  // m: thinner than SurfaceMap::kReach

Subject thin_box() {
  Subject subject;
  subject.organ = geometry::make_box(kBoxSize, 0.002);
  subject.tissue_name = "liver";
  return subject;
}

// Values on the upper side of the box, 1 mm apart: high for x > 0, low for x < 0.
SurfaceValues values_on_top() {
  SurfaceValues values;
  values.low = 1.0;
  values.high = 3.0;
  for (int i = -29; i <= 29; ++i) {
    for (int j = -24; j <= 24; ++j) {
      values.points_S.emplace_back(1e-3 * i, 1e-3 * j, 0.5 * kBoxSize.z());
      values.values.push_back(i > 0 ? 3.0F : 1.0F);
    }
  }
  return values;
}

// Looks at the box from straight above (side 1) or below (side -1).
Camera camera_at(double side) {
  Camera camera;
  camera.eye = Vec3(0, 0, 0.15 * side);
  camera.up = Vec3::UnitY();
  return camera;
}

// Pixel of a point on the upper side of the box, in camera_at(1).
std::array<int, 2> pixel_of(double x, double y) {
  const double scale =
      0.5 * kMapSide / std::tan(0.5 * 30.0 * 3.14159265358979 / 180.0) / (0.15 - 0.5 * kBoxSize.z());
  return {static_cast<int>(std::lround(0.5 * kMapSide + scale * x)),
          static_cast<int>(std::lround(0.5 * kMapSide - scale * y))};
}

std::array<int, 3> colour_at(const Image& image, double x, double y) {
  const auto [column, row] = pixel_of(x, y);
  const std::size_t i = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                             static_cast<std::size_t>(column));
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}

int brightness(const std::array<int, 3>& colour) { return (colour[0] + colour[1] + colour[2]) / 3; }
bool yellow(const std::array<int, 3>& colour) { return colour[0] > 150 && colour[1] > colour[2] + 80; }

// One renderer for all tests: starting OpenGL takes longer than rendering a small picture.
class SurfaceValuesPicture : public testing::TestWithParam<Quality> {
 protected:
  static void SetUpTestSuite() {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    renderer_ = std::make_unique<OffscreenRenderer>(thin_box(), kMapSide, kMapSide);
  }
  static void TearDownTestSuite() { renderer_.reset(); }
  void SetUp() override { renderer_->hold_quality(GetParam()); }
  void TearDown() override {
    renderer_->show_values({});
    renderer_->show_marks({});
  }
  static Image draw(double side = 1.0) { return renderer_->draw({}, camera_at(side)); }
  static std::unique_ptr<OffscreenRenderer> renderer_;
};
std::unique_ptr<OffscreenRenderer> SurfaceValuesPicture::renderer_;

TEST(SurfaceMap, AVertexTakesTheNearestPointOnItsSideOfAThinBox) {
  const geometry::TriangleMesh box = geometry::make_box(kBoxSize, 0.002);
  const SurfaceValues values = values_on_top();
  const SurfaceMap map(box, values.points_S);
  ASSERT_EQ(map.point_of().size(), box.vertices.size());
  int assigned = 0;
  for (std::size_t v = 0; v < box.vertices.size(); ++v) {
    const Vec3& vertex = box.vertices[v];
    const std::int32_t point = map.point_of()[v];
    if (vertex.z() < 0.0) {
      EXPECT_EQ(point, -1) << vertex.transpose();
    }
    if (point < 0) continue;
    ++assigned;
    double nearest = 1.0;
    for (const Vec3& p : values.points_S) nearest = std::min(nearest, (p - vertex).norm());
    EXPECT_DOUBLE_EQ((values.points_S[static_cast<std::size_t>(point)] - vertex).norm(), nearest);
  }
  EXPECT_GT(assigned, 500);
}

TEST(SurfaceMap, AVertexFartherThan3mmFromEveryPointTakesNone) {
  const geometry::TriangleMesh box = geometry::make_box(kBoxSize, 0.002);
  const Vec3 point(0.0, 0.0, 0.5 * kBoxSize.z());
  const SurfaceMap map(box, std::span(&point, 1));
  int assigned = 0;
  for (std::size_t v = 0; v < box.vertices.size(); ++v) {
    if (map.point_of()[v] < 0) continue;
    ++assigned;
    EXPECT_LE((box.vertices[v] - point).norm(), 3e-3);
  }
  EXPECT_GT(assigned, 0);
}

TEST(SurfaceMap, AValueIsAFractionOfTheRangeAndNotBeyondItsEnds) {
  const geometry::TriangleMesh box = geometry::make_box(kBoxSize, 0.002);
  const SurfaceValues values = values_on_top();
  const SurfaceMap map(box, values.points_S);
  const auto share_of = [&](float value) {
    const std::vector<float> all(values.points_S.size(), value);
    for (const MapVertex& vertex : map.attributes(box.triangles, all, 1.0, 3.0))
      if (vertex.known == 1.0F) return vertex.share;
    return -1.0F;
  };
  EXPECT_FLOAT_EQ(share_of(2.5F), 0.75F);
  EXPECT_FLOAT_EQ(share_of(9.0F), 1.0F);
  EXPECT_FLOAT_EQ(share_of(0.0F), 0.0F);
  EXPECT_EQ(share_of(kUnknown), -1.0F);
}

TEST(SurfaceMap, ASingleUnknownVertexAmongKnownOnesIsFilled) {
  geometry::TriangleMesh fan{{Vec3::Zero()}, {}};
  for (int i = 0; i < 6; ++i) {
    const double a = 3.14159265358979 / 3.0 * i;
    fan.vertices.emplace_back(0.01 * std::cos(a), 0.01 * std::sin(a), 0.0);
    fan.triangles.push_back({0, 1 + i, 1 + (i + 1) % 6});
  }
  std::vector<MapVertex> vertices(7, MapVertex{0.5F, 1.0F});
  vertices[0] = {};
  smooth_outline(fan.triangles, vertices);
  EXPECT_FLOAT_EQ(vertices[0].share, 0.5F);
  EXPECT_FLOAT_EQ(vertices[0].known, 2.0F / 3.0F);  // two of three corners of each triangle
}

TEST_P(SurfaceValuesPicture, ValuesColourTheNearSideAndNotTheFarSideOfAThinBox) {
  const Image plain_below = draw(-1.0);
  SurfaceValues values = values_on_top();
  std::fill(values.values.begin(), values.values.end(), 3.0F);
  renderer_->show_values(values);
  EXPECT_TRUE(yellow(colour_at(draw(), 0.01, 0.0)));
  const Image below = draw(-1.0);
  for (const double x : {-0.02, 0.0, 0.02}) {
    const auto natural = colour_at(plain_below, x, 0.0);
    const auto now = colour_at(below, x, 0.0);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(now[c], natural[c], 25) << x;  // greyed only
  }
}

TEST_P(SurfaceValuesPicture, TheBrightEndIsTheLegendsYellowAndTheDarkEndItsDarkBlue) {
  renderer_->show_values(values_on_top());
  const Image image = draw();
  for (const auto& [x, share] : {std::pair(0.015, 1.0), std::pair(-0.015, 0.0)}) {
    const Vec3 linear = map_colour(share);
    const auto drawn = colour_at(image, x, 0.01);
    Eigen::Index main = 0;
    linear.maxCoeff(&main);
    // Shading: one factor for all channels.
    const double scale = drawn[static_cast<std::size_t>(main)] / (255.0 * srgb(linear[main]));
    EXPECT_GT(scale, 0.6) << share;
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(drawn[static_cast<std::size_t>(c)], scale * 255.0 * srgb(linear[c]), 10.0)
          << share << ' ' << c;
  }
}

TEST_P(SurfaceValuesPicture, WhereTheValueIsNaNTheColourStaysNaturalButGreyed) {
  const Image plain = draw();
  SurfaceValues values = values_on_top();
  for (float& value : values.values) value = value < 2.0F ? kUnknown : value;
  renderer_->show_values(values);
  const Image image = draw();
  EXPECT_TRUE(yellow(colour_at(image, 0.015, 0.0)));
  const auto natural = colour_at(plain, -0.015, 0.0);
  const auto unknown = colour_at(image, -0.015, 0.0);
  EXPECT_GT(unknown[0], unknown[2] + 5) << "still red";
  EXPECT_LT(unknown[0] - unknown[2], natural[0] - natural[2]) << "less red";
  EXPECT_NEAR(brightness(unknown), brightness(natural), 20);
}

TEST_P(SurfaceValuesPicture, AnUpdateDrawsTheNewValuesAtTheSamePoints) {
  const SurfaceValues values = values_on_top();
  renderer_->show_values(values);
  const Image first = draw();
  std::vector<float> swapped = values.values;
  for (float& value : swapped) value = 4.0F - value;
  renderer_->update_values(swapped);
  const Image second = draw();
  EXPECT_TRUE(yellow(colour_at(first, 0.015, 0.0)));
  EXPECT_FALSE(yellow(colour_at(first, -0.015, 0.0)));
  EXPECT_FALSE(yellow(colour_at(second, 0.015, 0.0)));
  EXPECT_TRUE(yellow(colour_at(second, -0.015, 0.0)));
  renderer_->update_values(values.values);
  EXPECT_EQ(draw().rgb, first.rgb);
}

TEST_P(SurfaceValuesPicture, WithoutValuesAndMarksThePictureIsAsBefore) {
  const Image plain = draw();
  renderer_->show_values(values_on_top());
  renderer_->show_marks({{Vec3(0, 0, 0.001), SurfaceMark::Kind::kFound}});
  EXPECT_NE(draw().rgb, plain.rgb);
  renderer_->show_values({});
  renderer_->show_marks({});
  EXPECT_EQ(draw().rgb, plain.rgb);
}

TEST_P(SurfaceValuesPicture, MarksAppearWhereTheyAreInDifferentShapes) {
  // The least radius, 7 pixels. The picture is 2 * 0.15 m * tan 15 degrees = 80.4 mm high.
  constexpr double kRadius = 7.0 / kMapSide * 0.0804;
  const Image plain = draw();
  const double z = 0.5 * kBoxSize.z();
  renderer_->show_marks({{Vec3(-0.015, 0, z), SurfaceMark::Kind::kFound},
                         {Vec3(0, 0, z), SurfaceMark::Kind::kFalse},
                         {Vec3(0.015, 0, z), SurfaceMark::Kind::kLump}});
  const Image image = draw();
  const auto white = [&](double x, double y) {
    return brightness(colour_at(image, x, y)) > brightness(colour_at(plain, x, y)) + 30;
  };
  EXPECT_TRUE(white(-0.015, 0.0)) << "dot";
  EXPECT_TRUE(white(-0.015 + 0.9 * kRadius, 0.0)) << "its ring";
  EXPECT_TRUE(white(0.0, 0.0)) << "middle of the cross";
  EXPECT_TRUE(white(0.6 * kRadius, 0.6 * kRadius)) << "arm of the cross";
  EXPECT_FALSE(white(0.9 * kRadius, 0.0)) << "between its arms";
  EXPECT_FALSE(white(0.015, 0.0)) << "inside the lump's ring";
  EXPECT_TRUE(white(0.015, 1.5 * kRadius)) << "the lump's ring";
  for (const double x : {-0.0225, -0.0075, 0.0075, 0.0225})
    EXPECT_EQ(colour_at(image, x, 0.0), colour_at(plain, x, 0.0)) << "no mark";
}

TEST_P(SurfaceValuesPicture, AMarkIsNotSeenThroughAThinBox) {
  const Image below = draw(-1.0);
  renderer_->show_marks({{Vec3(0, 0, 0.5 * kBoxSize.z()), SurfaceMark::Kind::kFound}});
  EXPECT_EQ(brightness(colour_at(draw(-1.0), 0.0, 0.0)), brightness(colour_at(below, 0.0, 0.0)));
}

TEST_P(SurfaceValuesPicture, ValuesTakeThePlaceOfTheDisplacement) {
  SurfaceValues values = values_on_top();
  values.values.assign(values.values.size(), kUnknown);
  renderer_->show_values(values);
  const Image image = draw();
  renderer_->set_map_range(0.01);
  EXPECT_EQ(draw().rgb, image.rgb);
  renderer_->set_map_range(0.0);
}

INSTANTIATE_TEST_SUITE_P(Each, SurfaceValuesPicture,
                         testing::Values(Quality::kFull, Quality::kBalanced, Quality::kFast));

TEST(SurfaceValues, StayWhereTheyAreWhenAContactRefinesTheMesh) {
  OffscreenRenderer renderer(thin_box(), kMapSide, kMapSide);
  renderer.show_values(values_on_top());
  haptics::Snapshot pressed;
  pressed.hands = 1;
  pressed.results[0].view_count = 1;
  pressed.results[0].views[0] = {
      Vec3(0.0, 0.0, 0.5 * kBoxSize.z()), -Vec3::UnitZ(), 0.5e-3, 0.003, 0.0, -1, false};
  const Image image = renderer.draw(pressed, camera_at(1.0));
  for (const double y : {-0.02, -0.002, 0.002, 0.02}) {
    EXPECT_TRUE(yellow(colour_at(image, 0.02, y))) << y;
    EXPECT_FALSE(yellow(colour_at(image, -0.02, y))) << y;
  }
}

TEST(SurfaceValues, AreDrawnAlsoWhereTheQualityAdaptsToTheFrameTime) {
  OffscreenRenderer renderer(thin_box(), kMapSide, kMapSide, Quality::kBalanced);
  renderer.adapt_to_time();
  renderer.show_values(values_on_top());
  EXPECT_TRUE(yellow(colour_at(renderer.draw({}, camera_at(1.0)), 0.02, 0.0)));
}

TEST(SurfaceValuesInput, WrongCountsAndRangesAreRefused) {
  OffscreenRenderer renderer(thin_box(), 32, 32, Quality::kFast);
  SurfaceValues values = values_on_top();
  values.values.pop_back();
  EXPECT_THROW(renderer.show_values(values), InputError);
  values = values_on_top();
  values.high = values.low;
  EXPECT_THROW(renderer.show_values(values), InputError);
  renderer.show_values(values_on_top());
  EXPECT_THROW(renderer.update_values(std::vector<float>(3)), InputError);
  EXPECT_THROW(renderer.show_marks(std::vector<SurfaceMark>(kMaxMarks + 1)), InputError);
}

}  // namespace
}  // namespace palpate::render
