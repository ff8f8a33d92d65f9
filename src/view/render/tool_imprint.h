#pragma once
#include <span>
#include <vector>

#include "palpate/tick_observer.h"
#include "palpate/tool.h"
#include "view/render/depth_map.h"

namespace palpate::render {

/// Imprint of a tool around one press contact: a depth map over the plane perpendicular to the contact's
/// direction, within 17 mm of its axis, continued beside the tool by a slope of 2.5 and smoothed over 0.8 mm.
///
/// The displacement profile of model.md section 3 uses the tool's radius at one point only, so a jaw that
/// lies on the organ would be drawn half buried. Vertices above the imprint are therefore lowered onto it
/// along the contact's direction (except for the last 0.5 mm), by at most the contact's depth in total, and
/// only where the rest surface faces the tool.
class ToolImprint final {
 public:
  /// [setup] @param triangles corners of the tool's triangles, three each, organ frame [m]
  /// @param depth D [m], the largest depth of the imprint
  ToolImprint(std::span<const Vec3> triangles, const Vec3& point, const Vec3& direction, double depth);

  /// [setup] Additional displacement [m] of a vertex along the direction; 0 outside the imprint. Organ frame.
  /// @param now displaced position @param rest rest position @param rest_normal unit normal at rest
  /// @param slope if not null: receives the gradient of the result by `now`, dimensionless
  [[nodiscard]] float lowering(const Eigen::Vector3f& now, const Eigen::Vector3f& rest,
                               const Eigen::Vector3f& rest_normal, Eigen::Vector3f* slope = nullptr) const;

  /// [any] Position and direction of the contact, organ frame.
  [[nodiscard]] const Vec3& point() const noexcept { return point_; }
  [[nodiscard]] const Vec3& direction() const noexcept { return direction_; }
  /// Range of the effect: distance [m] from the contact's axis.
  static constexpr double kReach = 17e-3;

 private:
  Vec3 point_;
  Vec3 direction_;
  // The plane in cells of the map, and the direction; single precision.
  Eigen::Vector3f origin_;
  Eigen::Vector3f row_;
  Eigen::Vector3f column_;
  Eigen::Vector3f down_;
  float depth_;  // [m]
  DepthMap map_;
};

/// An instrument's triangles in small groups with bounding balls, so that distant groups are skipped.
class ToolShape final {
 public:
  /// [setup] Copies the tool's triangles.
  explicit ToolShape(const geometry::Tool& tool);

  /// [setup] Appends the corners (three per triangle) of the triangles that may lie within `radius` [m] of a
  /// point.
  /// @param handle_S pose of the handle in the frame of the point and of the corners
  void append_near(const Pose& handle_S, double gripper, const Vec3& point, double radius,
                   std::vector<Vec3>& corners) const;

 private:
  struct Group {
    std::size_t first = 0;  // first corner
    std::size_t count = 0;  // number of corners
    Vec3 middle = Vec3::Zero();
    double radius = 0.0;  // m
  };
  struct Part {
    geometry::ToolPart pose;  // without its mesh
    std::vector<Vec3> corners;
    std::vector<Group> groups;
  };
  std::vector<Part> parts_;
};

/// [setup] Imprints of the press contacts of a snapshot. Contacts of one hand that are close together and
/// have similar directions share the imprint of the deepest one. @param shapes of the hands' tools, in order
[[nodiscard]] std::vector<ToolImprint> imprints_of(const haptics::Snapshot& snapshot,
                                                   std::span<const ToolShape> shapes);

}  // namespace palpate::render
