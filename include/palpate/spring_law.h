#pragma once
#include <array>
#include <cstddef>
#include <variant>

#include "palpate/tissue.h"

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

/// The law that a tissue asks for, layered or smooth, as one plain value: no virtual call, no memory of its
/// own, so that a tick can use it and a running loop can be handed another.
class SpringLaw final {
 public:
  using LayerState = LayeredSpringLaw::LayerState;

  /// [setup] The law of `tissue.law`. @param loop_period T [s] @throws ParameterError as that law does.
  SpringLaw(const TissueParameters& tissue, Direction direction, double loop_period)
      : law_(tissue.law == LawKind::kSmooth
                 ? Either(std::in_place_type<SmoothSpringLaw>, tissue, direction, loop_period)
                 : Either(std::in_place_type<LayeredSpringLaw>, tissue, direction, loop_period)) {}

  [[nodiscard]] LawKind kind() const noexcept {
    return smooth() != nullptr ? LawKind::kSmooth : LawKind::kLayered;
  }

  /// [rt] As of the law that it is: force [N], tangent [N/m] and cut-off layer at penetration depth [m].
  [[nodiscard]] ContactResponse force_at(double depth) const noexcept {
    const SmoothSpringLaw* const is_smooth = smooth();
    return is_smooth != nullptr ? is_smooth->force_at(depth) : layered()->force_at(depth);
  }

  /// [rt] The inverse: deformation of every layer [m] under a contact force [N].
  [[nodiscard]] LayerState deformation_under(double force) const noexcept {
    const SmoothSpringLaw* const is_smooth = smooth();
    return is_smooth != nullptr ? is_smooth->deformation_under(force) : layered()->deformation_under(force);
  }

  /// [rt] Layers that the delay budget allows, largest depth [m] and force [N] of the law.
  [[nodiscard]] int layers_allowed() const noexcept {
    return smooth() != nullptr ? smooth()->layers_allowed() : layered()->layers_allowed();
  }
  [[nodiscard]] double max_depth() const noexcept {
    return smooth() != nullptr ? smooth()->max_depth() : layered()->max_depth();
  }
  [[nodiscard]] double max_force() const noexcept {
    return smooth() != nullptr ? smooth()->max_force() : layered()->max_force();
  }

 private:
  using Either = std::variant<LayeredSpringLaw, SmoothSpringLaw>;

  [[nodiscard]] const SmoothSpringLaw* smooth() const noexcept { return std::get_if<SmoothSpringLaw>(&law_); }
  [[nodiscard]] const LayeredSpringLaw* layered() const noexcept {
    return std::get_if<LayeredSpringLaw>(&law_);
  }

  Either law_;
};

}  // namespace palpate::model
