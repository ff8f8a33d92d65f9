#pragma once
#include <array>
#include <cstddef>

#include "palpate/model/tissue.h"

namespace palpate::model {

/// Force and tangent at a depth.
struct ContactResponse {
  double force = 0.0;      // [N]
  double stiffness = 0.0;  // dF/dD [N/m], of the layer below at a joint; 0 when saturated
  int cutoff_layer = 1;    // M, 1-based
  bool saturated = false;  // past the last allowed layer: force and deformation hold
};

/// Closed-form law of the equal-ratio layered parallel springs under one contact point.
///
/// Layer i has 4^(i-1) springs of stiffness k_1 exp((i-1)/beta) [N/m] and limit L_1 q^(i-1) [m]; layers fill
/// in order. [Zhang 2011, eq. 3, 4]; the cut-off layer's deformation is eq. 5 with the k_M that the print
/// omits (docs/model.md).
class LayeredSpringLaw final {
 public:
  static constexpr int kMaxLayers = 24;

  /// The paper's own direction: what every layer does under a force.
  struct LayerState {
    double depth = 0.0;      // D = sum of the layers' deformations [m]
    double force = 0.0;      // what the layers carry [N]; less than asked for when saturated
    double stiffness = 0.0;  // as in ContactResponse
    int cutoff_layer = 1;    // entries used in `deformation`
    bool saturated = false;
    // of one spring of each layer [m], 0 past the cut-off layer; the law writes every entry, so clearing them
    // first would only cost its time
    std::array<double, kMaxLayers> deformation;
  };

  /// [setup] Precomputes each layer's start depth [m], start force [N] and slope [N/m].
  /// @param loop_period T [s]: only layers with T_i < T are allowed (eq. 7)
  /// @throws ParameterError naming the field, its value and its unit, as validate(); also when layer 1 alone
  /// would carry no finite force, or the loop period is not finite and > 0.
  LayeredSpringLaw(const TissueParameters& tissue, Direction direction, double loop_period);

  /// [rt] Contact force and tangent stiffness at penetration depth [m]; O(layers).
  /// depth <= 0 gives force 0 and the slope of layer 1; beyond the last layer the force holds and `saturated`
  /// is set. NaN gives NaN.
  [[nodiscard]] ContactResponse force_at(double depth) const noexcept;

  /// [rt] The inverse: deformation of every layer under a contact force [N]; force <= 0 as depth <= 0 above.
  [[nodiscard]] LayerState deformation_under(double force) const noexcept;

  /// [rt] Deformation of every layer at penetration depth [m]; force, stiffness and layer as force_at().
  [[nodiscard]] LayerState deformation_at(double depth) const noexcept;

  /// [rt] Layers that the delay budget allows, at most kMaxLayers; a layer with a number that is not finite
  /// ends the list.
  [[nodiscard]] int layers_allowed() const noexcept { return layers_; }
  /// [rt] Largest depth [m] and force [N] that the layers can take.
  [[nodiscard]] double max_depth() const noexcept { return start_depth_[static_cast<std::size_t>(layers_)]; }
  [[nodiscard]] double max_force() const noexcept { return start_force_[static_cast<std::size_t>(layers_)]; }

 private:
  [[nodiscard]] LayerState layer_state(std::size_t cutoff, double in_cutoff) const noexcept;

  int layers_ = 1;
  std::array<double, kMaxLayers + 1> start_depth_{};  // depth at which layer i+1 starts [m]
  std::array<double, kMaxLayers + 1> start_force_{};  // force at which layer i+1 starts [N]
  std::array<double, kMaxLayers + 1>
      past_depth_{};  // past it layer i is over: its end and a few roundings [m]
  std::array<double, kMaxLayers + 1> past_force_{};                  // the same [N]
  std::array<double, kMaxLayers> slope_{};                           // P_i k_i [N/m]
  std::array<double, kMaxLayers> limit_{};                           // L_i [m]
  std::array<std::array<double, kMaxLayers>, kMaxLayers> filled_{};  // deformations while layer i+1 fills [m]
};

}  // namespace palpate::model
