#include <algorithm>
#include <cmath>

#include "core/base/portable_math.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::model {
namespace {

/// @throws ParameterError as validate()
TissueParameters without_max_depth(TissueParameters tissue) {
  validate(tissue);
  tissue.max_depth.reset();
  return tissue;
}

}  // namespace

SmoothSpringLaw::SmoothSpringLaw(const TissueParameters& tissue, Direction direction, double loop_period)
    : layers_(without_max_depth(tissue), direction, loop_period) {
  constexpr double kLn4 = 1.3862943611198906;
  const auto layers = static_cast<std::size_t>(layers_.layers_allowed());
  const double step = kLn4 + 1.0 / tissue.beta;  // ln(P_(i+1) k_(i+1)) - ln(P_i k_i), eq. 3
  pieces_ = std::max<std::size_t>(1, layers - 1);
  piece_[0].stiffness = tissue.k1;
  double limit = tissue.first_limit(direction);  // L_i
  for (std::size_t i = 0; i < pieces_ && layers > 1; ++i) {
    const double between = 0.5 * (limit + limit * tissue.q);  // m_(i+1) - m_i, eq. 4
    piece_[i].growth = step / between;
    if (i == 0) {  // K(m_1) = k_1, and the first piece extends back to D = 0
      piece_[0].stiffness = tissue.k1 * portable::exp(-0.5 * limit * piece_[0].growth);
    }
    if (i + 1 < pieces_) {
      Piece& next = piece_[i + 1];
      next.depth = (i == 0 ? 0.5 * limit : piece_[i].depth) + between;
      next.force = force_in(piece_[i], next.depth);
      next.energy = energy_in(piece_[i], next.depth);
      next.stiffness = piece_[i].stiffness * portable::exp(piece_[i].growth * (next.depth - piece_[i].depth));
    }
    limit *= tissue.q;
  }
  max_force_ = force_in(piece_[pieces_ - 1], layers_.max_depth());
  max_energy_ = energy_in(piece_[pieces_ - 1], layers_.max_depth());
  if (!std::isfinite(max_force_)) {
    throw ParameterError("beta", tissue.beta, "large enough that the smooth law's force stays finite");
  }
  if (tissue.max_depth) {
    const double deepest = *tissue.max_depth;
    continuation_ = {deepest, deformation_at(deepest), energy_at(deepest)};
  }
}

const SmoothSpringLaw::Piece& SmoothSpringLaw::piece_at(double depth) const noexcept {
  std::size_t last = 0;
  for (std::size_t i = 1; i < pieces_; ++i) last += depth > piece_[i].depth ? 1 : 0;
  return piece_[last];
}

double SmoothSpringLaw::force_in(const Piece& piece, double depth) const noexcept {
  const double in = depth - piece.depth;
  if (piece.growth == 0.0) return piece.force + piece.stiffness * in;
  return piece.force + piece.stiffness * (portable::expm1(piece.growth * in) / piece.growth);
}

/// Integral of force_in() from the start of the piece, plus the energy there.
double SmoothSpringLaw::energy_in(const Piece& piece, double depth) const noexcept {
  const double in = depth - piece.depth;
  const double by_start = piece.energy + piece.force * in;
  if (piece.growth == 0.0) return by_start + 0.5 * piece.stiffness * in * in;
  const double x = piece.growth * in;
  // (e^x - 1 - x) / growth^2; by its series where the difference would cancel
  constexpr double kSmall = 1e-2;
  const double rest = std::abs(x) < kSmall
                          ? x * x * (0.5 + x * (1.0 / 6.0 + x * (1.0 / 24.0 + x * (1.0 / 120.0 + x / 720.0))))
                          : portable::expm1(x) - x;
  return by_start + piece.stiffness * rest / (piece.growth * piece.growth);
}

double SmoothSpringLaw::energy_at(double depth) const noexcept {
  if (depth <= 0.0) return 0.0;
  if (depth > continuation_.depth) return continuation_.energy_at(depth);
  if (depth > layers_.max_depth()) return max_energy_ + max_force_ * (depth - layers_.max_depth());
  return energy_in(piece_at(depth), depth);
}

double SmoothSpringLaw::bounded_force(const Piece& piece, double depth) const noexcept {
  const double force = force_in(piece, depth);
  return force > max_force_ ? max_force_ : force;
}

double SmoothSpringLaw::elastic_force(double depth) const noexcept {
  if (depth <= 0.0) return 0.0;
  if (depth > continuation_.depth) return continuation_.response_at(depth).force;
  if (layers_.is_past_end(depth)) return max_force_;
  return bounded_force(piece_at(depth), depth);
}

ContactResponse SmoothSpringLaw::force_at(double depth) const noexcept {
  if (depth <= 0.0) return {0.0, piece_[0].stiffness, 1, false};
  if (depth > continuation_.depth) return continuation_.response_at(depth);
  const ContactResponse layered = layers_.force_at(depth);
  if (layered.saturated) return {max_force_, 0.0, layered.cutoff_layer, true};
  const Piece& piece = piece_at(depth);
  return {bounded_force(piece, depth), piece.stiffness * portable::exp(piece.growth * (depth - piece.depth)),
          layered.cutoff_layer, false};
}

SmoothSpringLaw::LayerState SmoothSpringLaw::deformation_at(double depth) const noexcept {
  if (depth > continuation_.depth && !continuation_.at.saturated) return continuation_.state_at(depth);
  LayerState state = layers_.deformation_at(depth);
  const ContactResponse response = force_at(depth);
  state.force = response.force;
  state.stiffness = response.stiffness;
  state.extrapolated = response.extrapolated;
  return state;
}

SmoothSpringLaw::LayerState SmoothSpringLaw::deformation_under(double force) const noexcept {
  if (force <= 0.0) return deformation_at(0.0);
  if (continuation_.rises() && force > continuation_.at.force) {
    LayerState state = continuation_.state_at(continuation_.depth_under(force));
    state.force = force;
    return state;
  }
  constexpr double kJustPast = 1.0 + 1e-12;  // rounding of the summed pieces is not saturation
  if (force > max_force_ * kJustPast) return deformation_at(2.0 * layers_.max_depth());
  std::size_t last = 0;
  for (std::size_t i = 1; i < pieces_; ++i) last += force > piece_[i].force ? 1 : 0;
  const Piece& piece = piece_[last];
  const double share = (force - piece.force) / piece.stiffness;  // depth at the piece's initial stiffness
  const double in = piece.growth == 0.0 ? share : portable::log1p(piece.growth * share) / piece.growth;
  LayerState state = deformation_at(std::min(piece.depth + in, layers_.max_depth()));
  state.force = std::min(force, max_force_);
  return state;
}

}  // namespace palpate::model
