#pragma once
#include <span>
#include <vector>

#include "palpate/tick_observer.h"
#include "palpate/tool.h"
#include "view/render/depth_map.h"

namespace palpate::render {

/// How deep a tool reaches around one press contact: a map over the plane across the contact's direction,
/// within 17 mm of its axis, continued beside the tool by a slope of 2.5 and evened out over 0.8 mm.
///
/// The profile of model.md section 3 knows the tool's radius at one point only; a jaw that lies on the organ
/// would be drawn half buried. So vertices above the imprint are lowered towards it along the contact's
/// direction (all but the last 0.5 mm of the way), never by more than the contact's depth in all, and only
/// where the rest surface faces the tool.
class ToolImprint final {
 public:
  /// [setup] @param triangles corners of the tool's triangles, three each, organ frame [m]
  /// @param depth D [m]: the imprint is never deeper
  ToolImprint(std::span<const Vec3> triangles, const Vec3& point, const Vec3& direction, double depth);

  /// [setup] How far [m] a vertex is to be lowered further along the direction; 0 where the tool is not.
  /// @param now where it is, @param rest where it was, @param rest_normal unit. Organ frame.
  /// @param slope if not null: how that changes with `now`, without unit
  [[nodiscard]] float lowering(const Eigen::Vector3f& now, const Eigen::Vector3f& rest,
                               const Eigen::Vector3f& rest_normal, Eigen::Vector3f* slope = nullptr) const;

  /// [any] Where the contact is and where it goes, organ frame.
  [[nodiscard]] const Vec3& point() const noexcept { return point_; }
  [[nodiscard]] const Vec3& direction() const noexcept { return direction_; }
  /// Vertices farther than this [m] from the contact's axis are left as they are.
  static constexpr double kReach = 17e-3;

 private:
  Vec3 point_;
  Vec3 direction_;
  // The plane across the direction, in the map's cells, and the direction; single precision.
  Eigen::Vector3f origin_;
  Eigen::Vector3f row_;
  Eigen::Vector3f column_;
  Eigen::Vector3f down_;
  float depth_;  // [m]
  DepthMap map_;
};

/// An instrument's triangles in small groups, so that those far from a contact are passed over together.
class ToolShape final {
 public:
  /// [setup] Copies what it needs.
  explicit ToolShape(const geometry::Tool& tool);

  /// [setup] Appends the corners, three a triangle, of the triangles that may come within `radius` [m] of a
  /// point. @param handle_S the handle's pose in the frame of the point and of the corners
  void append_near(const Pose& handle_S, double gripper, const Vec3& point, double radius,
                   std::vector<Vec3>& corners) const;

 private:
  struct Group {
    std::size_t first = 0;  // corner
    std::size_t count = 0;  // corners
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

/// [setup] The imprints of the press contacts of a snapshot; contacts of one hand that are near one another
/// and go the same way share one, about the deepest of them. @param shapes of the hands' tools, in order
[[nodiscard]] std::vector<ToolImprint> imprints_of(const haptics::Snapshot& snapshot,
                                                   std::span<const ToolShape> shapes);

}  // namespace palpate::render
