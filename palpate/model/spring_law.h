#pragma once
#include <variant>

#include "palpate/model/layered_law.h"
#include "palpate/model/smooth_law.h"

namespace palpate::model {

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
