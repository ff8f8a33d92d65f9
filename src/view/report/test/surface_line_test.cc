#include "view/report/surface_line.h"

#include <cmath>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/deform/triangle_search.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "palpate/surface.h"
#include "view/report/report.h"
#include "view/report/sections.h"
#include "view/report/test/synthetic_recording.h"

namespace palpate::report {
namespace {

using palpate::test::TemporaryFolder;
using test::SyntheticRecording;
using ::testing::HasSubstr;
using ::testing::Not;

ReferenceProfile profile_from(const std::string& text) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "side.csv") << text;
  return read_measured_profile(folder.path() / "side.csv");
}

std::string refusal_of(const std::string& text) {
  try {
    static_cast<void>(profile_from(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SurfaceLine, MeasuresDistanceAlongTheRestSurfaceOverAnEdge) {
  // A box 20 mm wide; its top is 10 mm high. Everything moved down by 1 mm.
  const geometry::TriangleMesh box = geometry::make_box(Vec3(20e-3, 20e-3, 20e-3), 2e-3);
  std::vector<Vec3> moved = box.vertices;
  for (Vec3& v : moved) v.z() -= 1e-3;
  const Vec3 point(1e-3, 0.5e-3, 10e-3);
  const auto start = static_cast<std::size_t>(deform::TriangleSearch(box).nearest(point).triangle);
  const std::vector<LinePlace> line =
      follow_section(box, moved, start, point, -Vec3::UnitZ(), Vec3::UnitX(), 15e-3);
  ASSERT_GT(line.size(), 10U);
  // 9 mm to the edge at x = 10 mm, then down the side.
  EXPECT_GE(line.back().distance, 15e-3);
  EXPECT_LE(line.back().distance, 18e-3);
  EXPECT_LE(line.front().distance, -15e-3);
  for (const LinePlace& place : line) EXPECT_NEAR(place.displacement, 1e-3, 1e-9);
  bool edge = false;
  for (const LinePlace& place : line) edge = edge || std::abs(place.distance - 9e-3) < 0.01e-3;
  EXPECT_TRUE(edge);
}

TEST(SurfaceLine, GoesAtMostHalfWayRound) {
  const geometry::TriangleMesh ball = geometry::make_ball(10e-3, 1280);
  const Vec3 point = ball.vertices[static_cast<std::size_t>(ball.triangles[0][0])];
  const Vec3 inwards = -point.normalized();
  const Vec3 across = inwards.unitOrthogonal();
  const std::vector<LinePlace> line = follow_section(ball, ball.vertices, 0, point, inwards, across, 1.0);
  ASSERT_FALSE(line.empty());
  const double half = M_PI * 10e-3;
  EXPECT_NEAR(line.back().distance, half, 0.1 * half);
  EXPECT_NEAR(line.front().distance, -half, 0.1 * half);
}

TEST(SurfaceLine, OfABallOnAFlatFaceIsTheTheory) {
  const record::Recording recording = SyntheticRecording::make(false, 1200);
  const std::vector<haptics::Snapshot> taken = record::snapshots_at(recording, {900});
  const SurfaceLine line = surface_line(recording.scene, taken.front(), 0, Vec3::UnitX());
  const deform::DisplacementProfile theory(recording.scene.tissue.reach, line.depth, line.tip_radius);
  ASSERT_GT(line.places.size(), 20U);
  EXPECT_EQ(line.contacts, 1);
  EXPECT_EQ(line.contacts_of_others, 0);
  EXPECT_NEAR(line.tip_radius, SyntheticRecording::kRadius, 0.3e-3);
  EXPECT_NEAR(line.depth, -SyntheticRecording::height(0.9), 0.05e-3);
  // The drawn profile is rounded by up to 4 % of the depth, and lies on the ball.
  for (const LinePlace& place : line.places) {
    if (std::abs(place.distance) >= 20e-3) continue;
    EXPECT_NEAR(place.displacement, theory.at(std::abs(place.distance)), 0.08 * line.depth) << place.distance;
  }
}

TEST(SurfaceLine, IsEmptyWithoutContact) {
  const record::Recording recording = SyntheticRecording::make(false, 300);
  const std::vector<haptics::Snapshot> taken = record::snapshots_at(recording, {10});
  EXPECT_TRUE(surface_line(recording.scene, taken.front(), 0, Vec3::UnitX()).places.empty());
}

TEST(SurfaceLine, IsInterpolatedBetweenItsPlaces) {
  const std::vector<LinePlace> places = {{-1.0, 0.0}, {1.0, 4.0}};
  EXPECT_DOUBLE_EQ(displacement_at(places, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(displacement_at(places, -1.0), 0.0);
  EXPECT_TRUE(std::isnan(displacement_at(places, 1.1)));
  EXPECT_TRUE(std::isnan(displacement_at(places, -1.1)));
}

TEST(ReferenceProfile, TakesTheRowsOfTheLargestDepthSortedByDistance) {
  const ReferenceProfile profile =
      profile_from("r_mm,u_mm,depth_mm\n0,5,5\n9,1,8\n-3,4,8\n0,8,8\n3,4,8\n6,2,8\n1,4,5\n");
  EXPECT_DOUBLE_EQ(profile.depth, 8e-3);
  ASSERT_EQ(profile.places.size(), 5U);
  EXPECT_DOUBLE_EQ(profile.places.front().distance, -3e-3);
  EXPECT_DOUBLE_EQ(profile.places.back().distance, 9e-3);
  EXPECT_DOUBLE_EQ(profile.places[1].displacement, 8e-3);
}

TEST(ReferenceProfile, TakesItsLargestDisplacementAsDepthWithoutAColumnOfDepths) {
  EXPECT_DOUBLE_EQ(profile_from("r_mm,u_mm\n0,5\n1,4\n2,3\n3,2\n4,1\n").depth, 5e-3);
}

TEST(ReferenceProfile, WithoutUseIsRefusedByReason) {
  EXPECT_THAT(refusal_of("r_mm,u_mm\n0,5\n1,4\n"),
              HasSubstr("has 2 rows of one depth, must have at least 5"));
  EXPECT_THAT(refusal_of("r_mm,u_mm\n0,-5\n1,-4\n2,-3\n3,-2\n4,-1\n"), HasSubstr("no u_mm is positive"));
  EXPECT_THAT(refusal_of("r_mm,u_mm,depth_mm\n0,5,0\n"), HasSubstr("must be > 0"));
  EXPECT_THAT(refusal_of("r_mm,force_N\n0,5\n"), HasSubstr("u_mm"));
}

TEST(ReferenceProfile, IsComparedAtTheFirstTickAsDeep) {
  const record::Recording recording = SyntheticRecording::make(false, 4000);
  const Analysis analysis = analyse(recording);
  ReferenceProfile measured;
  measured.depth = 6e-3;
  const HandAnalysis& hand = analysis.hands.front();
  const std::size_t row = row_of_profile(hand, model::Direction::kPress, &measured);
  EXPECT_GE(hand.rows[row].depth, 6e-3);
  EXPECT_LT(hand.rows[row - 1].depth, 6e-3);
  measured.depth = 50e-3;
  EXPECT_EQ(row_of_profile(hand, model::Direction::kPress, &measured), hand.key_ticks.deepest);
  EXPECT_EQ(row_of_profile(hand, model::Direction::kPress, nullptr), hand.key_ticks.deepest);
}

TEST(ReferenceProfile, IsInTheReportWithTheAbsoluteErrors) {
  const TemporaryFolder folder;
  const record::Recording recording = SyntheticRecording::make(false, 1600);
  Experiment experiment{"t", &recording, "c"};
  experiment.reference = profile_from("r_mm,u_mm\n0,5\n1,4\n2,3\n3,2\n4,1\n");
  static_cast<void>(write_report({experiment}, folder.path(), {}, {false, 0, 0}));
  std::ifstream in(folder.path() / "report.html");
  const std::string html{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  EXPECT_THAT(html, HasSubstr("Measured: side.csv, 5.00 mm deep. Absolute error of the theory: RMS "));
  EXPECT_THAT(html, HasSubstr("; of the run&#39;s surface: RMS "));
}

constexpr double kReferenceDepth = 5e-3;  // m

/// Caption of a flat line from -2 to 2 mm, displaced by 3 mm, beside a reference.
std::string caption_beside(std::vector<LinePlace> places, bool& drawn) {
  const TemporaryFolder folder;
  const record::Recording recording = SyntheticRecording::make(false, 100);
  SurfaceLine line;
  line.places = {{-2e-3, 3e-3}, {0.0, 3e-3}, {2e-3, 3e-3}};
  line.depth = kReferenceDepth;
  line.tip_radius = SyntheticRecording::kRadius;
  line.contacts = 1;
  const ReferenceProfile reference{"measured", "side.csv", kReferenceDepth, std::move(places)};
  const Figure figure = draw_profile(line, recording.scene, recording.scene.tissue.reach, &reference,
                                     folder.path() / "profile.svg");
  drawn = figure.missing.empty() && std::filesystem::exists(figure.file);
  return figure.caption;
}

TEST(ReferenceProfile, ErrorsAreTakenWhereTheoryAndRunBothHaveAPlace) {
  // The run is 1 mm beside each shared place; the theory, 5 mm at r = 0 and about 0 at 90 mm, would have an
  // error of 40 mm at the far place that the run's line does not reach.
  bool drawn = false;
  const std::string caption = caption_beside({{0.0, 4e-3}, {1e-3, 4e-3}, {90e-3, 40e-3}}, drawn);
  EXPECT_TRUE(drawn);
  EXPECT_THAT(caption, HasSubstr("; at 2 of 3 places, those that the run's line reaches"));
  EXPECT_THAT(caption, HasSubstr("of the run's surface: RMS 1.00 mm, largest 1.00 mm"));
  EXPECT_THAT(caption, HasSubstr("of the theory: RMS "));
  EXPECT_THAT(caption, Not(HasSubstr("largest 40")));
  const std::string whole = caption_beside({{0.0, 4e-3}, {1e-3, 4e-3}}, drawn);
  EXPECT_THAT(whole, Not(HasSubstr("places")));
}

TEST(ReferenceProfile, WithNoPlaceInCommonHasNoErrors) {
  bool drawn = false;
  const std::string caption = caption_beside({{50e-3, 1e-3}, {60e-3, 0.5e-3}}, drawn);
  EXPECT_TRUE(drawn);
  EXPECT_THAT(caption, HasSubstr("The run's line reaches no place of it, so there is no absolute error."));
  EXPECT_THAT(caption, Not(HasSubstr("RMS")));
}

}  // namespace
}  // namespace palpate::report
