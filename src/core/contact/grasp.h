#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "core/contact/contact.h"
#include "core/contact/organ_surface.h"
#include "core/contact/tool_tissue.h"

namespace palpate::contact {

struct PartState;
struct ToolPoints;

/// The jaws' grasp of the tissue (docs/model.md, section 4, "Pull"): closing, stretch and force, release. All
/// parts of a tool without jaws grasp. Organ frame S.
///
/// Invariants. While it holds, the force is that of the stretch from the anchor. After release, stretch and
/// force fade to zero within 25 ms. Otherwise both are zero. A grasp that tore off takes hold again only
/// after the jaws have opened.
class Grasp final {
 public:
  /// [rt] One tick, after the parts have moved. Sets the press level of the parts that hold.
  /// @param tool_S pose of the handle @return status bits
  std::uint32_t update(const World::Data& world, const ToolTissue& tissue, const ToolPoints& points,
                       double gripper, const Pose& tool_S, std::span<PartState> parts) noexcept;

  /// [rt] The tool jumped: releases without a fade. The gripper state stays.
  void release_at_once() noexcept;

  /// [rt] Changes the relaxation from the next tick on.
  void change_relaxation(const model::Relaxation& now, const model::Relaxation& before) noexcept;

  /// [rt] Whether there is a force: while holding or fading.
  [[nodiscard]] bool is_active() const noexcept { return held_ || fade_ > 0.0; }
  /// [rt] Force on the tool [N].
  [[nodiscard]] const Vec3& force() const noexcept { return force_; }
  /// [rt] Displacement of the anchor [m].
  [[nodiscard]] const Vec3& stretch() const noexcept { return stretch_; }
  /// [rt] The held point of the rest surface, and the surface normal there.
  [[nodiscard]] const SurfacePoint& anchor() const noexcept { return anchor_; }
  [[nodiscard]] const Vec3& normal() const noexcept { return normal_; }
  /// [rt] Radius of curvature of the tool at the point that grasps [m].
  [[nodiscard]] double tip_radius() const noexcept { return tip_radius_; }
  [[nodiscard]] int cutoff_layer() const noexcept { return cutoff_layer_; }
  [[nodiscard]] bool saturated() const noexcept { return saturated_; }
  [[nodiscard]] bool extrapolated() const noexcept { return extrapolated_; }

 private:
  [[nodiscard]] bool follow(double gripper) noexcept;
  void grasp(const World::Data& world, const ToolPoints& points, const Pose& tool_S,
             std::span<PartState> parts) noexcept;
  [[nodiscard]] bool pull(const ToolTissue& tissue, const Pose& tool_S) noexcept;
  void release() noexcept;

  bool open_ = false;     // state of the gripper, with hysteresis
  bool closing_ = false;  // the gripper has passed kClosedBelow and is still closing
  double last_gripper_ = 0.0;
  bool held_ = false;
  bool torn_off_ = false;         // above the grip limit; until the jaws open
  SurfacePoint anchor_;           // on the rest surface
  Vec3 normal_ = Vec3::UnitZ();   // of the surface at the anchor
  Vec3 anchor_T_ = Vec3::Zero();  // in the handle's frame at closing
  double tip_radius_ = 0.0;
  std::array<model::RelaxationState, 3> memory_{};  // per force component
  Vec3 stretch_ = Vec3::Zero();                     // s [m]
  Vec3 force_ = Vec3::Zero();                       // [N]
  Vec3 released_force_ = Vec3::Zero();              // at the moment of release [N]
  Vec3 released_stretch_ = Vec3::Zero();
  double fade_ = 0.0;  // 1 to 0 after release
  int cutoff_layer_ = 0;
  bool saturated_ = false;
  bool extrapolated_ = false;
};

}  // namespace palpate::contact
