#pragma once
#include <array>
#include <cstddef>

#include "palpate/model/layered_law.h"
#include "palpate/model/tissue.h"

namespace palpate::model {

/// The layered law without its jumps in stiffness: ln K, K = dF/dD, is linear in D between the middles of the
/// layers, m_i = L_1 + ... + L_(i-1) + L_i/2, where K is the layer's slope P_i k_i; its first piece runs on
/// to D = 0 and its last to the last layer's end (one layer: K = k_1). F is the integral of K, in closed form
/// both ways (docs/model.md, "Beyond the paper"). Layers fill by depth as in LayeredSpringLaw, whose results
/// it has.
class SmoothSpringLaw final {
 public:
  static constexpr int kMaxLayers = LayeredSpringLaw::kMaxLayers;
  using LayerState = LayeredSpringLaw::LayerState;

  /// [setup] Precomputes each piece's start depth [m], start force [N], start stiffness [N/m] and growth
  /// [1/m].
  /// @param loop_period T [s], as LayeredSpringLaw. `tissue.law` is not looked at.
  /// @throws ParameterError as LayeredSpringLaw does, and when the last piece's force is not finite.
  SmoothSpringLaw(const TissueParameters& tissue, Direction direction, double loop_period);

  /// [rt] Contact force and tangent stiffness at penetration depth [m]; O(layers). depth <= 0 gives force 0
  /// and the stiffness at 0; beyond the last layer the force holds and `saturated` is set. NaN gives NaN.
  [[nodiscard]] ContactResponse force_at(double depth) const noexcept;

  /// [rt] The inverse: depth and deformation of every layer under a contact force [N]; force <= 0 as depth <=
  /// 0 above.
  [[nodiscard]] LayerState deformation_under(double force) const noexcept;

  /// [rt] Deformation of every layer at penetration depth [m]; force and stiffness as force_at().
  [[nodiscard]] LayerState deformation_at(double depth) const noexcept;

  /// [rt] As LayeredSpringLaw.
  [[nodiscard]] int layers_allowed() const noexcept { return layers_.layers_allowed(); }
  [[nodiscard]] double max_depth() const noexcept { return layers_.max_depth(); }  // m
  [[nodiscard]] double max_force() const noexcept { return max_force_; }           // N

 private:
  struct Piece {
    double depth = 0.0;      // where it begins [m]
    double force = 0.0;      // there [N]
    double stiffness = 0.0;  // there [N/m]
    double growth = 0.0;     // of ln K with depth [1/m]; 0 for one layer
  };

  [[nodiscard]] double force_in(const Piece& piece, double depth) const noexcept;

  LayeredSpringLaw layers_;
  std::size_t pieces_ = 1;
  std::array<Piece, kMaxLayers> piece_{};
  double max_force_ = 0.0;
};

}  // namespace palpate::model
