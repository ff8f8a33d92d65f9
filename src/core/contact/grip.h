#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "core/contact/contact.h"
#include "core/contact/organ_surface.h"
#include "core/contact/tissue_laws.h"

namespace palpate::contact {

struct PartState;
struct ToolPoints;

/// The jaws' hold on the tissue (model.md, section 4, "Pull"): closing on it, the stretch and its force, and
/// letting go. A tool without jaws sticks by all its parts. Organ frame S.
///
/// Invariants. While it holds, the force is that of the stretch from the anchor; after letting go both fade
/// to zero in 25 ms; else both are zero. A grip that was torn off takes hold again only once the jaws have
/// opened.
class Grip final {
 public:
  /// [rt] One tick; the parts have been moved. Sets the press level of the parts that hold.
  /// @param tool_S of the handle @return status bits
  std::uint32_t update(const World::Data& world, const TissueLaws& laws, const ToolPoints& points,
                       double gripper, const Pose& tool_S, std::span<PartState> parts) noexcept;

  /// [rt] The tool was placed anew: it holds nothing. What is known of the gripper stays.
  void drop() noexcept;

  /// [rt] The tissue relaxes by `now` from the next tick on.
  void change_relaxation(const model::Relaxation& now, const model::Relaxation& before) noexcept;

  /// [rt] Whether it gives a force, of the hold or fading.
  [[nodiscard]] bool pulls() const noexcept { return held_ || fade_ > 0.0; }
  /// [rt] On the tool [N].
  [[nodiscard]] const Vec3& force() const noexcept { return force_; }
  /// [rt] How far the anchor is carried [m].
  [[nodiscard]] const Vec3& stretch() const noexcept { return stretch_; }
  /// [rt] The rest point that is held, and the surface's normal there.
  [[nodiscard]] const SurfacePoint& anchor() const noexcept { return anchor_; }
  [[nodiscard]] const Vec3& normal() const noexcept { return normal_; }
  /// [rt] Of the tool at the point that took hold [m].
  [[nodiscard]] double tip_radius() const noexcept { return tip_radius_; }
  [[nodiscard]] int cutoff_layer() const noexcept { return cutoff_layer_; }
  [[nodiscard]] bool saturated() const noexcept { return saturated_; }

 private:
  [[nodiscard]] bool follow(double gripper) noexcept;
  void take_hold(const World::Data& world, const ToolPoints& points, const Pose& tool_S,
                 std::span<PartState> parts) noexcept;
  [[nodiscard]] bool pull(const TissueLaws& laws, const Pose& tool_S) noexcept;
  void let_go() noexcept;

  bool open_ = false;     // by the gripper, with hysteresis
  bool closing_ = false;  // the gripper has passed its closing value and closes on
  double last_gripper_ = 0.0;
  bool held_ = false;
  bool torn_off_ = false;         // past the limit; until the jaws open again
  SurfacePoint anchor_;           // on the rest surface
  Vec3 normal_ = Vec3::UnitZ();   // of the surface there
  Vec3 anchor_T_ = Vec3::Zero();  // in the handle's frame at closing
  double tip_radius_ = 0.0;
  std::array<model::RelaxationState, 3> memory_{};  // of the force's components
  Vec3 stretch_ = Vec3::Zero();                     // s [m]
  Vec3 force_ = Vec3::Zero();                       // [N]
  Vec3 released_force_ = Vec3::Zero();              // at the moment of letting go [N]
  Vec3 released_stretch_ = Vec3::Zero();
  double fade_ = 0.0;  // 1 .. 0 after letting go
  int cutoff_layer_ = 0;
  bool saturated_ = false;
};

}  // namespace palpate::contact
