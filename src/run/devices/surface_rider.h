#pragma once
#include <optional>
#include <vector>

#include "core/contact/organ_surface.h"
#include "core/geometry/ray.h"
#include "palpate/pose.h"
#include "palpate/tool.h"

namespace palpate::devices {

/// Where a hand holds its tool: a point of the tool, and the orientation. World frame.
struct ToolTarget {
  Vec3 tip_W = Vec3::Zero();  // m
  Quat orientation_W = Quat::Identity();
};

/// Holds a tool under a pointer. The tool rides on the organ's rest surface at the first point on the
/// pointer's line of sight, at a set height or depth along the surface's normal. Beside the organ it glides
/// in the air. It moves, presses and turns at limited speeds. A step that would bring any part of the tool to
/// the organ before a press is left out, so the tool goes around the organ, and stays away from places that
/// it cannot reach from its side. All members: [setup], one thread.
///
/// The surface stays in its pose at rest: an organ that breathes moves against the tool.
class SurfaceRider final {
 public:
  static constexpr double kHover = 5e-3;  // m, height over the surface before the first press and in the air
  static constexpr double kParked = 30e-3;       // m, height of a parked tool
  static constexpr double kHighest = 40e-3;      // m, height up to which it rises on its way around the organ
  static constexpr double kMaxDepth = 30e-3;     // m, largest set depth; a needle's is its length
  static constexpr double kHalfPace = 3.0;       // N, resistance at which press() moves a needle half as far
  static constexpr double kMaxSpeed = 0.08;      // m/s over the surface and in the air; a hand has 0.1 m/s
  static constexpr double kPressSpeed = 0.05;    // m/s along the normal
  static constexpr double kMaxTilt = 0.785;      // rad, 45 degrees from the start
  static constexpr double kTurnSpeed = 1.5;      // rad/s
  static constexpr double kLongestStep = 50e-3;  // s, of advance()

  /// @param surface, tool outlive this object @param organ_W at rest @param start_W pose of the tool's handle
  /// @param gripper at the start @param reach largest distance of the tool from its start [m]
  SurfaceRider(const contact::OrganSurface& surface, const geometry::Tool& tool, const Pose& organ_W,
               const Pose& start_W, double gripper, double reach);

  /// The point of the tool that target() places, in the handle's frame: the tip with closed jaws.
  [[nodiscard]] const Vec3& tip() const noexcept { return tip_P_; }

  /// The pointer's line of sight.
  void point_at(const geometry::Ray& ray_W);
  /// The pointer is elsewhere: the tool stays where it is, at its set depth.
  void freeze() noexcept { goal_ = Goal::kNone; }
  /// Changes the set depth [m]; in a drag it moves the tool along the surface's normal.
  void press(double deeper) noexcept { deeper_ += deeper > 0.0 ? pace_ * deeper : deeper; }
  /// For a needle, once a picture. In the tissue it stays on the line of its axis, whatever the pointer does.
  /// press() moves it inwards less far where it meets more resistance, because people take a slower tool for
  /// a larger force (pseudo-haptics). @param inside the tissue @param force_W on the hand [N]
  void feel_needle(bool inside, const Vec3& force_W) noexcept;
  /// Lifts the tool off the surface and leaves it there, or brings it back under the pointer.
  void park(bool parked) noexcept { parked_ = parked; }
  [[nodiscard]] bool parked() const noexcept { return parked_; }
  /// Set depth under the surface [m]; negative: height above it.
  [[nodiscard]] double depth() const noexcept;

  /// Moves on. @param time since the last call [s] @param gripper opening of the jaws, 0 to 1
  /// @param dragging the jaws hold tissue: the tool follows the pointer in a plane that faces the viewer
  /// @param pace factor of the speed, 0 to 1
  void advance(double time, double gripper, bool dragging, double pace);
  [[nodiscard]] ToolTarget target() const;

 private:
  enum class Goal { kNone, kSurface, kAir };

  /// A place in the air and the direction away from the organ there.
  struct AirPlace {
    Vec3 point;
    Vec3 normal;
  };

  void ride(double way, double down, double up);
  void fly(double way);
  void drag(double way, double deeper);
  void turn(double angle);
  void turn_normal(const Vec3& goal, double share);
  /// Smallest distance of the tool's samples from the organ, and the direction away from it there.
  struct Clearance {
    double distance;  // m
    Vec3 away_S;
  };
  [[nodiscard]] Clearance clearance() const;
  /// The part of the state that a step changes.
  struct Stand {
    bool riding;
    contact::SurfacePoint place;
    double over;
    Vec3 normal_S, touch_S, tip_S;
    Quat orientation_S;
  };
  [[nodiscard]] Stand stand() const;
  void return_to(const Stand& stand);
  /// Undoes a step by which the tool came too near to the organ, and moves away by `way` instead.
  void keep_clear(const Stand& before, double way, double gripper);
  /// Walks over the surface towards aim_. @return false: aim_ is not reached that way
  [[nodiscard]] bool walk(double way);
  /// Moves off the surface where the tool is too near to travel. @return false: it is far enough
  [[nodiscard]] bool lift_off(double way);
  /// Direction around the organ to the viewer, from whom all visible places can be reached.
  [[nodiscard]] Vec3 way_to_viewer() const;
  [[nodiscard]] AirPlace goal_in_air() const;
  /// The point of the line of sight that is nearest to the tool.
  [[nodiscard]] Vec3 on_sight() const;
  [[nodiscard]] bool free_between(const Vec3& a, const Vec3& b) const;
  [[nodiscard]] Vec3 within_reach(const Vec3& point_S) const;
  [[nodiscard]] double distance(const Vec3& point_S) const noexcept {
    return surface_.nearest(point_S, -1).distance;
  }
  [[nodiscard]] double wanted_height() const noexcept { return parked_ ? kParked : height_; }
  /// From the tool's tip to its part that is farthest along -normal, for the orientation now.
  [[nodiscard]] Vec3 tip_to_touch(double gripper) const;

  const contact::OrganSurface& surface_;
  const geometry::Tool& tool_;
  Pose organ_W_;
  Quat start_S_;  // orientation at the start
  Vec3 tip_P_;
  std::vector<Vec3> samples_P_;  // of the tool's surface, handle frame
  double length_ = 0.0;          // m, from the tip to the farthest sample
  double clear_ = -1.0;          // m, lower bound of the samples' distance from the organ
  Vec3 reach_from_S_;
  double reach_;
  double max_depth_ = kMaxDepth;  // m

  // The pointer, organ frame.
  Goal goal_ = Goal::kNone;
  geometry::Ray ray_S_;
  contact::SurfacePoint aim_;  // kSurface

  double height_ = kHover;  // set by press()
  double deeper_ = 0.0;     // by press() since the last advance()
  double pace_ = 1.0;       // of press() inwards
  bool inside_ = false;     // a needle in the tissue
  bool parked_ = false;

  // The tool, organ frame.
  bool riding_ = false;
  contact::SurfacePoint place_;    // while it rides
  double over_ = 0.0;              // height over place_ while it rides
  Vec3 normal_S_ = Vec3::UnitZ();  // of the surface where it rode last
  Vec3 touch_S_;                   // its point farthest along -normal
  Vec3 tip_S_;
  Quat orientation_S_;
  double dragged_ = 0.0;               // along the normal by press() since the drag began [m]
  std::optional<Vec3> drag_offset_S_;  // from the pointer's point to touch_S_, in a drag
  Vec3 drag_plane_S_ = Vec3::Zero();   // a point of the drag's plane
};

}  // namespace palpate::devices
