#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "io/shapes/test/shape_checks.h"
#include "palpate/builtin.h"

// Tests anatomical features of liver and kidney on their meshes, in the frames of tools/make_shapes/organs.h
// and kidney.h. The tests of the built-in shapes check that the surfaces are valid.
namespace palpate::geometry {
namespace {

using test::Hit;
using test::hits_from_above;

constexpr double kLiverMm = 1e-3;

/// A built-in organ in the frame of its formula; `middle` [mm] is the centre of its bounding box there.
TriangleMesh moved_organ(const char* name, const Vec3& middle) {
  TriangleMesh mesh = make_organ(name);
  for (Vec3& v : mesh.vertices) v += kLiverMm * middle;
  return mesh;
}
TriangleMesh fine_liver() { return moved_organ("liver-30k", {-0.775274, 4.843998, -5.068860}); }

TriangleMesh turned(TriangleMesh mesh, const Mat3& turn) {
  for (Vec3& v : mesh.vertices) v = turn * v;
  return mesh;
}

class Liver : public ::testing::Test {
 protected:
  /// Height [mm] of the visceral surface at (x, z) [mm].
  [[nodiscard]] double visceral(double x, double z) const {
    const std::vector<Hit> hits = hits_from_above(upright_, x * kLiverMm + 1.3e-5, -z * kLiverMm + 2.7e-5);
    return hits.empty() ? NAN : hits.back().z / kLiverMm;
  }
  /// Distance [mm] from the front wall to the next one behind it at (x, y) [mm]; 0 beside the organ.
  [[nodiscard]] double thickness(double x, double y) const {
    const std::vector<Hit> hits = hits_from_above(mesh_, x * kLiverMm + 1.3e-5, y * kLiverMm + 2.7e-5);
    return hits.empty() ? 0.0 : (hits[0].z - hits.at(1).z) / kLiverMm;
  }
  /// Height [mm] of the lower margin at x [mm], searched from below in steps of 1 mm.
  [[nodiscard]] double margin(double x) const {
    double y = -110.0;
    while (thickness(x, y) <= 0.0 && y < 100.0) y += 1.0;
    return y;
  }

  TriangleMesh mesh_ = moved_organ("liver", {-0.800214, 4.906109, -5.067389});
  TriangleMesh upright_ = turned(mesh_, (Mat3() << 1, 0, 0, 0, 0, -1, 0, 1, 0).finished());  // +y is up
};

// Gray's Anatomy, 41st ed.: greatest breadth 200 to 225 mm, height 150 to 175 mm; about 1,500 ml.
TEST_F(Liver, IsOfAnAdultsSize) {
  const Vec3 size = bounds(mesh_).size() / kLiverMm;
  EXPECT_NEAR(size.x(), 220.0, 10.0);
  EXPECT_NEAR(size.y(), 155.0, 15.0);
  EXPECT_NEAR(size.z(), 135.0, 20.0);
  EXPECT_NEAR(signed_volume(mesh_) * 1e6, 1450.0, 100.0);
}

TEST_F(Liver, RightLobeIsTheLargerAndTheLeftOneEndsInAThinTip) {
  EXPECT_GT(thickness(-50.0, 10.0), 1.3 * thickness(60.0, 35.0));
  EXPECT_GT(thickness(60.0, 35.0), 1.3 * thickness(95.0, 38.0));
  EXPECT_LT(margin(-60.0), margin(45.0) - 30.0);  // the margin rises from right to left
  EXPECT_LT(margin(45.0), margin(85.0) - 10.0);
}

/// Largest angle [deg] between normals of the surface within 7 mm of a point [mm].
double turn_near(const TriangleMesh& mesh, const Vec3& place) {
  std::vector<Vec3> normals;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 middle =
        (test::corner(mesh, t, 0) + test::corner(mesh, t, 1) + test::corner(mesh, t, 2)) / 3.0;
    if ((middle / kLiverMm - place).norm() < 7.0)
      normals.push_back(area_vector_doubled(mesh, mesh.triangles[t]).normalized());
  }
  double least = 1.0;
  for (const Vec3& a : normals) {
    for (const Vec3& b : normals) least = std::min(least, a.dot(b));
  }
  return std::acos(least) * 180.0 / std::numbers::pi;
}

TEST_F(Liver, LowerMarginIsSharpAndTheFrontIsNot) {
  for (const double x : {-60.0, -40.0, 50.0, 70.0}) {
    const double y = margin(x);
    const double z = hits_from_above(mesh_, x * kLiverMm + 1.3e-5, y * kLiverMm + 2.7e-5).at(0).z / kLiverMm;
    EXPECT_GT(turn_near(mesh_, {x, y, z}), 70.0) << x;
    const double above = y + 30.0;
    const double front =
        hits_from_above(mesh_, x * kLiverMm + 1.3e-5, above * kLiverMm + 2.7e-5).at(0).z / kLiverMm;
    EXPECT_LT(turn_near(mesh_, {x, above, front}), 40.0) << x;
  }
}

TEST_F(Liver, FissureOfTheRoundLigamentPartsTheLobesBelow) {
  const double beside = 0.5 * (visceral(13.0, 18.0) + visceral(42.0, 18.0));
  EXPECT_GT(visceral(27.5, 18.0) - beside, 4.0);
}

TEST_F(Liver, RoundLigamentComesOutOfANotchInTheMargin) {
  EXPECT_GT(thickness(27.0, visceral(27.0, 61.0) + 2.0), 4.0);  // the ligament's stump, below the margin
  const double beside = 0.5 * (visceral(14.0, 44.0) + visceral(42.0, 44.0));
  EXPECT_GT(0.5 * (visceral(23.0, 44.0) + visceral(31.0, 44.0)) - beside, 2.0);
}

TEST_F(Liver, GallbladdersFossaIsEmptyAndOpensAtTheMargin) {
  const auto depth = [this](double x, double z) {
    return visceral(x, z) - 0.5 * (visceral(x - 26.0, z) + visceral(x + 22.0, z));
  };
  EXPECT_GT(depth(-16.0, 18.0), 6.0);
  EXPECT_GT(depth(-21.0, 38.0), 2.0);
}

TEST_F(Liver, QuadrateAndCaudateLobeStandOutBeforeAndBehindThePorta) {
  const double porta = visceral(0.0, -4.0) - 0.5 * 4.0;  // minus the slope of the surface along z
  EXPECT_GT(porta - (visceral(8.0, 21.0) + 0.5 * 21.0), 5.0);
  EXPECT_GT(visceral(27.0, -1.0) - (visceral(14.0, -40.0) + 0.5 * -39.0), 15.0);
}

TEST_F(Liver, KidneyAndStomachPressIntoIt) {
  const auto sag = [this](double x, double z, double dx, double dz) {
    return visceral(x, z) - 0.5 * (visceral(x - dx, z - dz) + visceral(x + dx, z + dz));
  };
  EXPECT_GT(sag(-62.0, -25.0, 28.0, 0.0), 5.0);
  EXPECT_GT(sag(72.0, 4.0, 22.0, 0.0), 4.0);
}

TEST(FineLiver, VenaCavaIsOpenAtBothEndsAndPortalVeinBelow) {
  const TriangleMesh mesh = fine_liver();
  // Vertices at the bottom of each lumen: inside the ring of the wall, below it.
  const auto sunk = [&mesh](const Vec3& end_mm, const Vec3& out) {
    double middle = 1.0;
    double ring = -1.0;
    for (const Vec3& v : mesh.vertices) {
      const Vec3 off = v / kLiverMm - end_mm;
      const double along = off.dot(out);
      const double across = (off - along * out).norm();
      if (std::abs(along) > 6.0) continue;
      if (across < 1.5) middle = std::min(middle, along);
      if (across < 12.0) ring = std::max(ring, along);
    }
    return ring - middle;
  };
  EXPECT_GT(sunk({-3.0, 75.0, -40.0}, Vec3(0.0, 0.93, 0.37).normalized()), 3.0);
  EXPECT_GT(sunk({-2.5, -9.0, -53.5}, Vec3(0.04, -0.99, 0.1).normalized()), 3.0);
  EXPECT_GT(sunk({15.0, -30.0, -13.0}, Vec3(0.24, -0.87, -0.42).normalized()), 2.0);
}

TEST(FineLiver, FalciformLigamentsStumpRunsOverTheFront) {
  const TriangleMesh mesh = fine_liver();
  const auto front = [&mesh](double x, double y) {
    return hits_from_above(mesh, x * kLiverMm, y * kLiverMm)[0].z / kLiverMm;
  };
  for (const double y : {0.0, 15.0, 30.0}) {
    const double ridge = 26.0 - 0.06 * y;
    EXPECT_GT(front(ridge, y) - 0.5 * (front(ridge - 5.0, y) + front(ridge + 5.0, y)), 0.9) << y;
  }
}

class Kidney : public ::testing::Test {
 protected:
  /// First hit of a line along x from the middle of the body, at (y, z) [mm].
  [[nodiscard]] Hit from_the_middle(double y, double z) const {
    return hits_from_above(sideways_, -z * kLiverMm + 1.3e-5, y * kLiverMm + 2.7e-5).at(0);
  }
  /// How far the kidney extends outwards (-x) at (y, z) [mm].
  [[nodiscard]] double outer(double y, double z) const {
    return -hits_from_above(sideways_, -z * kLiverMm + 1.3e-5, y * kLiverMm + 2.7e-5).back().z / kLiverMm;
  }

  TriangleMesh mesh_ = moved_organ("kidney", {3.877033, 0.095891, 0.262458});
  TriangleMesh sideways_ = turned(mesh_, (Mat3() << 0, 0, -1, 0, 1, 0, 1, 0, 0).finished());  // +x is up
};

// Gray's Anatomy, 41st ed.: 110 mm long, 60 mm wide, 30 to 40 mm thick; here wider because of the stumps of
// its vessels.
TEST_F(Kidney, IsOfAnAdultsSize) {
  const Vec3 size = bounds(mesh_).size() / kLiverMm;
  EXPECT_NEAR(size.y(), 110.0, 5.0);
  EXPECT_NEAR(size.z(), 41.0, 3.0);
  EXPECT_NEAR(outer(0.0, 0.5) + from_the_middle(28.0, -1.0).z / kLiverMm, 60.0, 5.0);
  EXPECT_NEAR(signed_volume(mesh_) * 1e6, 150.0, 15.0);
}

TEST_F(Kidney, IsABeanWithItsHilumTowardsTheMiddle) {
  const double poles = 0.5 * (from_the_middle(32.0, 0.0).z + from_the_middle(-32.0, 0.0).z) / kLiverMm;
  const double hilum = from_the_middle(-2.0, 12.0).z / kLiverMm;  // the lip in front of the vein
  EXPECT_GT(poles - hilum, 8.0);
  EXPECT_GT(outer(0.0, 0.0) - 0.5 * (outer(36.0, 0.0) + outer(-36.0, 0.0)), 6.0);
}

TEST_F(Kidney, VeinArteryAndUreterAreCutAcrossFromFrontToBack) {
  const auto expect_cut = [this](double y, double z, double radius, double end) {
    // Points of the rim above, below, in front of and behind the lumen.
    for (const Vec3& side : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
      double most = 0.0;
      for (const Vec3& v : mesh_.vertices) {
        const Vec3 off = v / kLiverMm - Vec3(v.x() / kLiverMm, y, z);
        if (off.norm() < radius && off.dot(side) > 0.7 * off.norm()) most = std::max(most, v.x() / kLiverMm);
      }
      EXPECT_NEAR(most, end, 1.2) << y << " " << side.transpose();
    }
    EXPECT_LT(from_the_middle(y, z).z / kLiverMm, end - 0.6);  // the lumen
  };
  expect_cut(4.5, 6.0, 5.5, 37.0);
  expect_cut(14.7, -2.5, 3.4, 37.5);
  double lowest = 0.0;
  for (const Vec3& v : mesh_.vertices) {
    if ((Vec3(v.x(), 0.0, v.z()) - Vec3(0.032, 0.0, -0.0065)).norm() < 0.003)
      lowest = std::min(lowest, v.y());
  }
  EXPECT_NEAR(lowest / kLiverMm, -43.0, 1.5);
}

TEST_F(Kidney, OuterBorderShowsTheLobesItGrewFrom) {
  int dents = 0;
  for (int step = -38; step <= 38; ++step) {
    const double y = step;
    // Below a chord of 12 mm, although the border as a whole is convex.
    if (outer(y, 6.0) < 0.5 * (outer(y - 6.0, 6.0) + outer(y + 6.0, 6.0))) ++dents;
  }
  EXPECT_GE(dents, 4);
}

}  // namespace
}  // namespace palpate::geometry
