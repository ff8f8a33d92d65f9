#pragma once
#include <array>
#include <cstddef>
#include <limits>
#include <variant>

#include "palpate/tissue.h"

namespace palpate::model {

/// Force and tangent stiffness at a penetration depth.
struct ContactResponse {
  double force = 0.0;         // [N]
  double stiffness = 0.0;     // dF/dD [N/m]; at the end of a layer that of this layer; 0 when saturated
  int cutoff_layer = 1;       // cut-off layer M, 1-based
  bool saturated = false;     // beyond the last allowed layer: force and deformation stay constant
  bool extrapolated = false;  // beyond the tissue's max_depth: the force goes on by its tangent there
};

/// Closed-form law of the equal-ratio layered parallel springs under one contact point.
///
/// Layer i has 4^(i-1) springs of stiffness k_1 exp((i-1)/beta) [N/m] and limit L_1 q^(i-1) [m]
/// [Zhang 2011, eq. 3, 4]. Layers fill in order: a layer deforms once the previous layer is at its limit. The
/// deformation of the cut-off layer is eq. 5 with the factor k_M that the printed equation omits
/// (docs/model.md).
class LayeredSpringLaw final {
 public:
  static constexpr int kMaxLayers = 24;

  /// Deformation of all layers, as the paper computes it from a force.
  struct LayerState {
    double depth = 0.0;         // D = sum of the layers' deformations [m]
    double force = 0.0;         // carried by the layers [N]; less than the applied force when saturated
    double stiffness = 0.0;     // tangent stiffness dF/dD [N/m]; 0 when saturated
    int cutoff_layer = 1;       // M, 1-based; number of entries used in `deformation`
    bool saturated = false;     // beyond the last allowed layer
    bool extrapolated = false;  // beyond the tissue's max_depth
    // Deformation of one spring of each layer [m]; 0 beyond the cut-off layer. The law writes every entry, so
    // no initial value is needed.
    std::array<double, kMaxLayers> deformation;
  };

  /// Continuation of a law by its tangent past D_m, the tissue's `max_depth`: F = F(D_m) + K(D_m) (D - D_m).
  /// A tissue without `max_depth` has an infinite D_m.
  struct Continuation {
    double depth = std::numeric_limits<double>::infinity();  // D_m [m]
    LayerState at{};                                         // at D_m
    double energy = 0.0;                                     // at D_m [J]

    /// [any] Whether the force rises past D_m: it does not where the law is saturated there.
    [[nodiscard]] bool rises() const noexcept {
      return depth < std::numeric_limits<double>::infinity() && !at.saturated;
    }
    /// [rt] Response and energy [J] at a depth [m] > D_m.
    [[nodiscard]] ContactResponse response_at(double deeper) const noexcept {
      return {at.force + at.stiffness * (deeper - depth), at.stiffness, at.cutoff_layer, at.saturated, true};
    }
    [[nodiscard]] double energy_at(double deeper) const noexcept {
      const double past = deeper - depth;
      return energy + (at.force + 0.5 * at.stiffness * past) * past;
    }
    /// [rt] Depth [m] under a force [N] above that at D_m; only where the force rises.
    [[nodiscard]] double depth_under(double force) const noexcept {
      return depth + (force - at.force) / at.stiffness;
    }
    /// [rt] State at a depth [m] > D_m: the cut-off layer deforms on, past its limit.
    [[nodiscard]] LayerState state_at(double deeper) const noexcept {
      LayerState state = at;
      state.depth = deeper;
      state.force = response_at(deeper).force;
      state.extrapolated = true;
      state.deformation[static_cast<std::size_t>(state.cutoff_layer) - 1] += deeper - depth;
      return state;
    }
  };

  /// [setup] Precomputes each layer's start depth [m], start force [N] and slope [N/m].
  /// @param loop_period T [s]: only layers with a delay T_i < T are allowed (eq. 7)
  /// @throws ParameterError as validate(); also when the force of layer 1 is not finite, or the loop period
  /// is not finite and > 0.
  LayeredSpringLaw(const TissueParameters& tissue, Direction direction, double loop_period);

  /// [rt] Contact force [N] and tangent stiffness [N/m] at a penetration depth [m]; O(layers). A depth <= 0
  /// gives force 0 and the slope of layer 1. Beyond the tissue's max_depth the tangent stays what it is there
  /// and `extrapolated` is set. Beyond the last layer the force stays constant and `saturated` is set. NaN
  /// gives NaN.
  [[nodiscard]] ContactResponse force_at(double depth) const noexcept;

  /// [rt] The force of force_at() [N].
  [[nodiscard]] double elastic_force(double depth) const noexcept { return force_at(depth).force; }

  /// [rt] Elastic energy [J] at a penetration depth [m]: the integral of force_at() from 0.
  [[nodiscard]] double energy_at(double depth) const noexcept;

  /// [rt] Inverse of force_at(): deformation of every layer under a contact force [N]. A force <= 0 gives
  /// depth 0 and the slope of layer 1.
  [[nodiscard]] LayerState deformation_under(double force) const noexcept;

  /// [rt] Deformation of every layer at a penetration depth [m]; force, stiffness and cut-off layer are those
  /// of force_at().
  [[nodiscard]] LayerState deformation_at(double depth) const noexcept;

  /// [rt] Number of layers whose delay is below the loop period, at most kMaxLayers. A layer with a value
  /// that is not finite, and all layers after it, are not allowed.
  [[nodiscard]] int layers_allowed() const noexcept { return layers_; }
  /// [rt] Whether a depth [m] is past the end of the last allowed layer by more than rounding.
  [[nodiscard]] bool is_past_end(double depth) const noexcept {
    return depth > past_depth_[static_cast<std::size_t>(layers_)];
  }
  /// [rt] Depth [m] and force [N] at the end of the last allowed layer; infinite when the law goes on by its
  /// tangent from a lesser depth.
  [[nodiscard]] double max_depth() const noexcept {
    return continuation_.rises() ? std::numeric_limits<double>::infinity()
                                 : start_depth_[static_cast<std::size_t>(layers_)];
  }
  [[nodiscard]] double max_force() const noexcept {
    return continuation_.rises() ? std::numeric_limits<double>::infinity()
                                 : start_force_[static_cast<std::size_t>(layers_)];
  }

 private:
  [[nodiscard]] LayerState layer_state(std::size_t cutoff, double in_cutoff) const noexcept;

  int layers_ = 1;
  int reached_ = 1;  // layers up to the continuation
  Continuation continuation_;
  std::array<double, kMaxLayers + 1> start_depth_{};   // depth at which layer i+1 starts [m]
  std::array<double, kMaxLayers + 1> start_force_{};   // force at which layer i+1 starts [N]
  std::array<double, kMaxLayers + 1> start_energy_{};  // energy at which layer i+1 starts [J]
  std::array<double, kMaxLayers + 1> past_depth_{};    // end of layer i and a margin of a few roundings [m]
  std::array<double, kMaxLayers + 1>
      past_force_{};                        // force at the end of layer i and a margin of a few roundings [N]
  std::array<double, kMaxLayers> slope_{};  // P_i k_i [N/m]
  std::array<double, kMaxLayers> limit_{};  // L_i [m]
  std::array<std::array<double, kMaxLayers>, kMaxLayers> filled_{};  // deformations while layer i+1 fills [m]
};

/// The layered law without steps in the tangent stiffness K = dF/dD (docs/model.md, "Beyond the paper").
///
/// At the middle of layer i, m_i = L_1 + ... + L_(i-1) + L_i/2, K is the layer's slope P_i k_i. Between two
/// middles ln K is linear in D. The first piece extends to D = 0, the last piece to the end of the last
/// layer. With one layer K = k_1. F is the integral of K; F(D) and its inverse have a closed form. Layers
/// fill with depth as in LayeredSpringLaw.
class SmoothSpringLaw final {
 public:
  static constexpr int kMaxLayers = LayeredSpringLaw::kMaxLayers;
  using LayerState = LayeredSpringLaw::LayerState;

  /// [setup] Precomputes each piece's start depth [m], start force [N], start stiffness [N/m] and growth of
  /// ln K [1/m]. It ignores `tissue.law`.
  /// @param loop_period T [s]: only layers with a delay T_i < T are allowed
  /// @throws ParameterError as LayeredSpringLaw, and when the force of the last piece is not finite.
  SmoothSpringLaw(const TissueParameters& tissue, Direction direction, double loop_period);

  /// [rt] Contact force [N] and tangent stiffness [N/m] at a penetration depth [m]; O(layers). A depth <= 0
  /// gives force 0 and the stiffness at D = 0. Beyond the tissue's max_depth the tangent stays what it is
  /// there and `extrapolated` is set. Beyond the last layer the force stays constant and `saturated` is set.
  /// NaN gives NaN.
  [[nodiscard]] ContactResponse force_at(double depth) const noexcept;

  /// [rt] The force of force_at() [N], the same bits in half the time.
  [[nodiscard]] double elastic_force(double depth) const noexcept;

  /// [rt] Elastic energy [J] at a penetration depth [m]: the integral of force_at() from 0.
  [[nodiscard]] double energy_at(double depth) const noexcept;

  /// [rt] Inverse of force_at(): depth and deformation of every layer under a contact force [N]. A force <= 0
  /// gives depth 0 and the stiffness at D = 0.
  [[nodiscard]] LayerState deformation_under(double force) const noexcept;

  /// [rt] Deformation of every layer at a penetration depth [m]; force and stiffness are those of force_at().
  [[nodiscard]] LayerState deformation_at(double depth) const noexcept;

  /// [rt] Number of layers whose delay is below the loop period.
  [[nodiscard]] int layers_allowed() const noexcept { return layers_.layers_allowed(); }
  /// [rt] As LayeredSpringLaw::max_depth() and max_force().
  [[nodiscard]] double max_depth() const noexcept {
    return continuation_.rises() ? std::numeric_limits<double>::infinity() : layers_.max_depth();
  }
  [[nodiscard]] double max_force() const noexcept {
    return continuation_.rises() ? std::numeric_limits<double>::infinity() : max_force_;
  }

 private:
  struct Piece {
    double depth = 0.0;      // start of the piece [m]
    double force = 0.0;      // at the start [N]
    double stiffness = 0.0;  // at the start [N/m]
    double growth = 0.0;     // d(ln K)/dD [1/m]; 0 with one layer
    double energy = 0.0;     // at the start [J]
  };

  [[nodiscard]] const Piece& piece_at(double depth) const noexcept;
  [[nodiscard]] double force_in(const Piece& piece, double depth) const noexcept;
  [[nodiscard]] double bounded_force(const Piece& piece, double depth) const noexcept;
  [[nodiscard]] double energy_in(const Piece& piece, double depth) const noexcept;

  LayeredSpringLaw layers_;  // without the continuation
  std::size_t pieces_ = 1;
  std::array<Piece, kMaxLayers> piece_{};
  double max_force_ = 0.0;
  double max_energy_ = 0.0;  // at the end of the last layer [J]
  LayeredSpringLaw::Continuation continuation_;
};

/// The layered or the smooth law, as `tissue.law` selects. It is one value without virtual calls and without
/// memory on the heap, so a tick can use it and a parameter update can copy it into a running loop.
class SpringLaw final {
 public:
  using LayerState = LayeredSpringLaw::LayerState;

  /// [setup] Constructs the law that `tissue.law` selects. @param loop_period T [s] @throws ParameterError as
  /// the constructor of that law.
  SpringLaw(const TissueParameters& tissue, Direction direction, double loop_period)
      : law_(tissue.law == LawKind::kSmooth
                 ? Either(std::in_place_type<SmoothSpringLaw>, tissue, direction, loop_period)
                 : Either(std::in_place_type<LayeredSpringLaw>, tissue, direction, loop_period)) {}

  [[nodiscard]] LawKind kind() const noexcept {
    return smooth() != nullptr ? LawKind::kSmooth : LawKind::kLayered;
  }

  /// [rt] Force [N], tangent stiffness [N/m] and cut-off layer of the law at a penetration depth [m].
  [[nodiscard]] ContactResponse force_at(double depth) const noexcept {
    const SmoothSpringLaw* const is_smooth = smooth();
    return is_smooth != nullptr ? is_smooth->force_at(depth) : layered()->force_at(depth);
  }

  /// [rt] Elastic energy [J] at a penetration depth [m]: the integral of force_at() from 0.
  [[nodiscard]] double energy_at(double depth) const noexcept {
    const SmoothSpringLaw* const is_smooth = smooth();
    return is_smooth != nullptr ? is_smooth->energy_at(depth) : layered()->energy_at(depth);
  }

  /// [rt] Inverse of force_at(): deformation of every layer [m] under a contact force [N].
  [[nodiscard]] LayerState deformation_under(double force) const noexcept {
    const SmoothSpringLaw* const is_smooth = smooth();
    return is_smooth != nullptr ? is_smooth->deformation_under(force) : layered()->deformation_under(force);
  }

  /// [rt] Number of layers whose delay is below the loop period; depth [m] and force [N] at the end of the
  /// last one.
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
