#pragma once
#include <optional>
#include <span>
#include <vector>

#include "palpate/tick_observer.h"
#include "palpate/tool.h"

namespace palpate::render {

/// The fold of tissue between closed jaws.
///
/// The displacement profile draws grasped tissue up to the tips of the jaws: a round peak under them. Jaws
/// that hold tissue hold a fold of it, and do not close on it entirely. So the jaws are drawn open by the
/// fold's thickness, and the surface between them is raised along the jaws, as a ridge
///
///     h(x, y) = H exp(-(x / T)^2 - (y / W)^4),
///
/// x in the direction in which the jaws open, y along the ridge, T half the fold's thickness, W half the
/// jaws' width. H and T grow over the first millimetres of the pull, so that nothing jumps at the grasp. For
/// display alone: force, depth and what the simulation knows of the surface stay as they are.
class GraspedFold final {
 public:
  static constexpr double kReach = 8e-3;  // m from the peak: no vertex farther away is raised

  /// [setup] @param peak between the tips [m] @param up unit, from the tips along the jaws @param opening
  /// unit, perpendicular to it @param height H @param thickness 2 T @param width 2 W [m]
  GraspedFold(const Vec3& peak, const Vec3& up, const Vec3& opening, double height, double thickness,
              double width);

  /// [any] How far a displaced vertex is raised along up() [m], and the gradient of that by its position.
  struct Raise {
    float by = 0.0F;
    Eigen::Vector3f slope = Eigen::Vector3f::Zero();
  };
  [[nodiscard]] Raise raise(const Eigen::Vector3f& now) const noexcept;
  [[nodiscard]] const Vec3& peak() const noexcept { return peak_; }
  [[nodiscard]] const Eigen::Vector3f& up() const noexcept { return up_; }

 private:
  Vec3 peak_;
  Eigen::Vector3f middle_, up_;
  Eigen::Vector3f across_, along_;  // 1/T and 1/W long
  float height_;
};

/// The jaws of an instrument, where they hold tissue. Handle frame.
class Jaws final {
 public:
  /// [setup] Empty for an instrument without jaws.
  [[nodiscard]] static std::optional<Jaws> of(const geometry::Tool& tool);

  /// [any] Opening of the gripper, 0 to 1, at which the tips are `gap` [m] apart.
  [[nodiscard]] double gripper_at(double gap) const noexcept;
  /// [setup] The fold that they hold in a pull by `depth` [m]. @param peak of the drawn surface
  /// @param handle pose of the handle in the frame of the peak
  [[nodiscard]] GraspedFold fold(const Vec3& peak, const Pose& handle, double depth) const;
  /// [any] Thickness of the fold in a pull by `depth` [m].
  [[nodiscard]] static double thickness(double depth) noexcept;

 private:
  Vec3 up_ = Vec3::UnitZ();
  Vec3 opening_ = Vec3::UnitX();
  double width_ = 0.0;    // m, at the tips
  double opening_m_ = 0;  // m between the tips at gripper 1
};

/// [any] A hand's gripper as it is drawn: open by the fold that its jaws hold. @param jaws null: none
[[nodiscard]] double drawn_gripper(const haptics::Snapshot& snapshot, std::size_t hand, const Jaws* jaws);

/// [setup] The folds in a snapshot, organ frame. @param jaws of the hands' tools, in order
[[nodiscard]] std::vector<GraspedFold> folds_of(const haptics::Snapshot& snapshot,
                                                std::span<const std::optional<Jaws>> jaws);

}  // namespace palpate::render
