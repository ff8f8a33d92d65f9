#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/rotation.h"
#include "palpate/mesh.h"
#include "palpate/offscreen.h"

namespace palpate::render {
namespace {

Subject subject_of(const geometry::TriangleMesh& organ) {
  Subject subject;
  subject.organ = organ;
  return subject;
}

double elevation_deg(const Camera& camera, const Vec3& normal) {
  return std::asin((camera.eye - camera.target).normalized().dot(normal)) * 180.0 / 3.14159265358979;
}

TEST(FrameContact, LooksFromTheSideAbove) {
  const Subject subject = subject_of(geometry::make_ball(0.04, 1280));
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0.3, -0.6, -0.5)}) {
    const Vec3 n = normal.normalized();
    for (const bool close_up : {false, true}) {
      const Camera camera = frame_contact(subject, {}, 0.04 * n, n, close_up);
      EXPECT_NEAR(elevation_deg(camera, n), 33.0, 0.01);
      EXPECT_GT(camera.up.dot(n), 0.5);
    }
  }
}

TEST(FrameContact, HoldsTheWholeOrganAndRoomForTheTool) {
  const Subject subject = subject_of(geometry::make_box(Vec3(0.12, 0.05, 0.08), 0.02));
  haptics::Snapshot snapshot;
  snapshot.organ_W.position = Vec3(0.5, -0.2, 0.1);
  const Vec3 focus = snapshot.organ_W * Vec3(0.03, 0, 0.04);
  const Camera camera = frame_contact(subject, snapshot, focus, Vec3::UnitZ(), false);
  const Vec3 back = (camera.eye - camera.target).normalized();
  const Vec3 right = camera.up.cross(back).normalized();
  const Vec3 up = back.cross(right);
  const double half = std::tan(0.5 * camera.vertical_view_deg * 3.14159265358979 / 180.0);
  std::vector<Vec3> points = {focus + Vec3(0, 0, 0.02)};
  for (const Vec3& v : subject.organ.vertices) points.push_back(snapshot.organ_W * v);
  double fullest = 0.0;
  for (const Vec3& p : points) {
    const double depth = (camera.eye - p).dot(back);
    const double x = std::abs((p - camera.eye).dot(right)) / depth / half / (4.0 / 3.0);
    const double y = std::abs((p - camera.eye).dot(up)) / depth / half;
    EXPECT_LT(x, 1.0);
    EXPECT_LT(y, 1.0);
    fullest = std::max({fullest, x, y});
  }
  EXPECT_GT(fullest, 0.85);
}

TEST(FrameContact, ACloseUpPutsTheContactInTheMiddle) {
  const Subject subject = subject_of(geometry::make_ball(0.06, 1280));
  const Vec3 focus(0, 0, 0.06);
  const Camera close = frame_contact(subject, {}, focus, Vec3::UnitZ(), true);
  const Camera wide = frame_contact(subject, {}, focus, Vec3::UnitZ(), false);
  EXPECT_LT((close.target - focus).norm(), 1e-12);
  EXPECT_LT((close.eye - focus).norm(), (wide.eye - focus).norm());
  const double height =
      2.0 * (close.eye - focus).norm() * std::tan(0.5 * close.vertical_view_deg / 57.29577951);
  EXPECT_NEAR(height, 0.056, 1e-6);
}

TEST(FrameContact, LooksAtTheToolFromTheSide) {
  const Subject subject = subject_of(geometry::make_ball(0.04, 1280));
  for (const Vec3& lean : {Vec3(0, 1, -1), Vec3(1, 0, -1), Vec3(1, 1, -1)}) {
    haptics::Snapshot snapshot;
    snapshot.hands = 1;
    snapshot.tools[0].pose_W.rotation = rotation_between(Vec3::UnitZ(), lean);
    const Camera camera = frame_contact(subject, snapshot, Vec3(0, 0, 0.04), Vec3::UnitZ(), true);
    const Vec3 level = Vec3(camera.eye.x(), camera.eye.y(), 0).normalized();
    EXPECT_LT(std::abs(level.dot(Vec3(lean.x(), lean.y(), 0).normalized())), 0.4);
  }
}

TEST(FrameContact, DoesNotLookThroughTheOrgan) {
  // A step: the contact lies behind a wall that stands towards -y, the preferred direction of view.
  geometry::TriangleMesh step = geometry::make_box(Vec3(0.1, 0.1, 0.02), 0.02);
  geometry::TriangleMesh wall = geometry::make_box(Vec3(0.1, 0.02, 0.06), 0.02);
  const auto offset = static_cast<std::int32_t>(step.vertices.size());
  for (const Vec3& v : wall.vertices) step.vertices.emplace_back(v + Vec3(0, -0.03, 0.03));
  for (const geometry::Triangle& t : wall.triangles)
    step.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  const Camera camera = frame_contact(subject_of(step), {}, Vec3(0, 0, 0.01), Vec3::UnitZ(), true);
  EXPECT_GT(camera.eye.y(), -0.03);
}

TEST(FrameContact, IsTheSameForTheSameFocus) {
  const Subject subject = subject_of(geometry::make_ball(0.04, 320));
  haptics::Snapshot rest;
  rest.hands = 1;
  haptics::Snapshot deep = rest;
  deep.tools[0].pose_W.position = Vec3(0, 0, -0.01);
  deep.results[0].depth = 0.01;
  const Camera a = frame_contact(subject, rest, Vec3(0, 0, 0.04), Vec3::UnitZ(), false);
  const Camera b = frame_contact(subject, deep, Vec3(0, 0, 0.04), Vec3::UnitZ(), false);
  EXPECT_EQ(a.eye, b.eye);
  EXPECT_EQ(a.target, b.target);
}

TEST(FrameFromAbove, LooksDownAndHoldsTheWholeOrganInPicturesOfAnyShape) {
  const Subject subject = subject_of(geometry::make_box(Vec3(0.12, 0.05, 0.08), 0.02));
  haptics::Snapshot snapshot;
  snapshot.organ_W.position = Vec3(0.5, -0.2, 0.1);
  for (const double aspect : {0.5, 1.0, 2.5}) {
    const Camera camera = frame_from_above(subject, snapshot, aspect);
    EXPECT_TRUE((camera.eye - camera.target).normalized().isApprox(Vec3(Vec3::UnitZ())));
    const double half = std::tan(0.5 * camera.vertical_view_deg * 3.14159265358979 / 180.0);
    double fullest = 0.0;
    for (const Vec3& v : subject.organ.vertices) {
      const Vec3 p = snapshot.organ_W * v;
      const double depth = camera.eye.z() - p.z();
      const double x = std::abs(p.x() - camera.eye.x()) / depth / half / aspect;
      const double y = std::abs(p.y() - camera.eye.y()) / depth / half;
      fullest = std::max({fullest, x, y});
    }
    EXPECT_LT(fullest, 1.0) << aspect;
    EXPECT_GT(fullest, 0.85) << aspect;
  }
}

}  // namespace
}  // namespace palpate::render
