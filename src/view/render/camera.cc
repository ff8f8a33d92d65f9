#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "palpate/offscreen.h"

namespace palpate::render {
namespace {

constexpr double kElevationDeg = 33.0;  // above the tangent plane: looks into an indentation, and along a
                                        // pulled-up surface
constexpr int kAzimuths = 24;           // number of directions tried
constexpr double kAspect = 4.0 / 3.0;   // aspect ratio of the narrowest picture that must contain the whole
                                        // organ
constexpr double kMargin = 1.06;
constexpr double kCloseHeight = 56e-3;  // m: an indentation of 12 mm fills about half of the width
constexpr double kCloseShare = 0.7;     // of a small organ's diagonal
constexpr double kToolRoom = 28e-3;     // m above the contact that must be in the picture
constexpr double kRing = 9e-3;          // m: radius of the points around the contact that should be visible
constexpr double kRingLift = 1.5e-3;    // m above the tangent plane
constexpr double kStanding = 0.25;      // weight of a level horizon, relative to visible points (weight 1)
constexpr double kFront = 0.08;         // weight of the world's front side (-y)
constexpr double kBesideTool = 0.35;    // weight of a view across the tool's axis

// Fraction of the points that the organ does not hide from a distant camera in direction `to_eye`.
double visible_fraction(const geometry::TriangleMesh& organ, const std::vector<Vec3>& points,
                        const Vec3& to_eye) {
  std::size_t hidden = 0;
  for (const Vec3& p : points) {
    const bool hit = std::any_of(organ.triangles.begin(), organ.triangles.end(), [&](const auto& t) {
      const Vec3& a = organ.vertices[static_cast<std::size_t>(t[0])];
      const Vec3 ab = organ.vertices[static_cast<std::size_t>(t[1])] - a;
      const Vec3 ac = organ.vertices[static_cast<std::size_t>(t[2])] - a;
      const Vec3 q = to_eye.cross(ac);
      const double determinant = ab.dot(q);
      if (determinant == 0.0) return false;
      const Vec3 s = p - a;
      const double u = s.dot(q) / determinant;
      if (u < 0.0 || u > 1.0) return false;
      const Vec3 r = s.cross(ab);
      const double v = to_eye.dot(r) / determinant;
      return v >= 0.0 && u + v <= 1.0 && ac.dot(r) / determinant > 0.0;
    });
    if (hit) ++hidden;
  }
  return 1.0 - static_cast<double>(hidden) / static_cast<double>(points.size());
}

// Direction from the contact to the camera, world frame.
Vec3 best_side(const Subject& subject, const haptics::Snapshot& snapshot, const Vec3& focus_W,
               const Vec3& normal_W) {
  const Pose world_S = snapshot.organ_W.inverse();
  const Vec3 u = normal_W.unitOrthogonal();
  const Vec3 v = normal_W.cross(u);
  std::vector<Vec3> points_S;
  for (int i = 0; i < 8; ++i) {
    const double a = std::numbers::pi * i / 4.0;
    points_S.push_back(world_S *
                       (focus_W + kRingLift * normal_W + kRing * (std::cos(a) * u + std::sin(a) * v)));
  }
  const Vec3 tool_axis =
      snapshot.hands > 0 ? Vec3(snapshot.tools[0].pose_W.rotation * Vec3::UnitZ()) : Vec3::Zero();
  const double elevation = kElevationDeg * std::numbers::pi / 180.0;
  // The first direction is the world's front, projected onto the tangent plane.
  Vec3 front = -Vec3::UnitY() + normal_W.y() * normal_W;
  front = front.norm() > 0.1 ? front.normalized() : u;
  const Vec3 side = normal_W.cross(front);
  double best = -std::numeric_limits<double>::infinity();
  Vec3 chosen = normal_W;
  for (int i = 0; i < kAzimuths; ++i) {
    const double a = 2.0 * std::numbers::pi * i / kAzimuths;
    const Vec3 level = std::cos(a) * front + std::sin(a) * side;
    const Vec3 to_eye = std::cos(elevation) * level + std::sin(elevation) * normal_W;
    const double in_front_of_dent = std::abs(tool_axis.dot(level));
    const double score = visible_fraction(subject.organ, points_S, world_S.rotation * to_eye) -
                         kBesideTool * in_front_of_dent + kStanding * std::min(0.5, to_eye.z()) +
                         kFront * std::cos(a);
    if (score > best + 1e-9) {
      best = score;
      chosen = to_eye;
    }
  }
  return chosen;
}

// Sets target and distance so that all points are in a picture of this aspect ratio.
void fit(Camera& camera, const Vec3& to_eye, const std::vector<Vec3>& points, double aspect) {
  const Vec3 right = camera.up.cross(to_eye).normalized();
  const Vec3 up = to_eye.cross(right);
  const double half = std::tan(0.5 * camera.vertical_view_deg * std::numbers::pi / 180.0);
  double distance = 1.0;
  for (int round = 0; round < 8; ++round) {
    // Extents of the projected points for the current camera, in metres at the target's distance.
    const Vec3 eye = camera.target + distance * to_eye;
    Eigen::Array2d low(1e9, 1e9);
    Eigen::Array2d high(-1e9, -1e9);
    for (const Vec3& p : points) {
      const double scale = distance / std::max(1e-3, (eye - p).dot(to_eye));
      const Eigen::Array2d seen(scale * (p - camera.target).dot(right), scale * (p - camera.target).dot(up));
      low = low.min(seen);
      high = high.max(seen);
    }
    const Eigen::Array2d middle = 0.5 * (low + high);
    camera.target += middle.x() * right + middle.y() * up;
    const double height = std::max((high - low).y(), (high - low).x() / aspect);
    distance = std::max(distance * 0.05, kMargin * 0.5 * height / half);
  }
  camera.eye = camera.target + distance * to_eye;
}

}  // namespace

Camera frame_contact(const Subject& subject, const haptics::Snapshot& snapshot, const Vec3& focus_W,
                     const Vec3& normal_W, bool close_up) {
  const Vec3 normal = normal_W.norm() > 0.0 ? Vec3(normal_W.normalized()) : Vec3::UnitZ();
  const geometry::Bounds box = geometry::bounds(subject.organ);
  const Vec3 to_eye = best_side(subject, snapshot, focus_W, normal);
  Camera camera;
  camera.up = normal;
  camera.vertical_view_deg = 28.0;
  if (close_up) {
    const double height = std::min(kCloseHeight, std::max(1e-3, kCloseShare * box.size().norm()));
    const double half = std::tan(0.5 * camera.vertical_view_deg * std::numbers::pi / 180.0);
    camera.target = focus_W;
    camera.eye = focus_W + 0.5 * height / half * to_eye;
    return camera;
  }
  std::vector<Vec3> points;
  for (const Vec3& p : subject.organ.vertices) points.push_back(snapshot.organ_W * p);
  points.emplace_back(focus_W + kToolRoom * normal);
  camera.target = snapshot.organ_W * box.middle();
  fit(camera, to_eye, points, kAspect);
  return camera;
}

Camera frame_from_above(const Subject& subject, const haptics::Snapshot& snapshot, double aspect) {
  Camera camera;
  camera.up = Vec3::UnitY();
  camera.vertical_view_deg = 28.0;
  camera.target = snapshot.organ_W * geometry::bounds(subject.organ).middle();
  std::vector<Vec3> points;
  for (const Vec3& p : subject.organ.vertices) points.push_back(snapshot.organ_W * p);
  fit(camera, Vec3::UnitZ(), points, aspect);
  return camera;
}

}  // namespace palpate::render
