#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/portable_math.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::model {
namespace {

constexpr double kSpringsPerBar = 4.0;

// A depth or force within this factor of a joint counts as the joint, which belongs to the layer below. Unit
// conversion and summed limits miss the joint by rounding.
constexpr double kJointWidth = 1.0 + 8.0 * std::numeric_limits<double>::epsilon();

}  // namespace

LayeredSpringLaw::LayeredSpringLaw(const TissueParameters& tissue, Direction direction, double loop_period) {
  validate(tissue);
  if (!std::isfinite(loop_period) || !(loop_period > 0.0)) {
    throw ParameterError("loop_period_s", loop_period, "finite and > 0");
  }
  double springs = 1.0;                          // P_i = 4^(i-1)
  double limit = tissue.first_limit(direction);  // L_i
  std::size_t layer = 0;
  for (; layer < kMaxLayers; ++layer) {
    const double delay = tissue.t1 * ((springs - 1.0) / 3.0);  // T_i, eq. 6 and 7
    if (!(delay < loop_period)) break;
    const double stiffness = tissue.k1 * portable::exp(static_cast<double>(layer) / tissue.beta);  // eq. 3
    const double slope = springs * stiffness;
    const double end_depth = start_depth_[layer] + limit;
    const double end_force = start_force_[layer] + slope * limit;
    if (!std::isfinite(slope) || !std::isfinite(end_depth) || !std::isfinite(end_force)) break;
    slope_[layer] = slope;
    limit_[layer] = limit;
    start_depth_[layer + 1] = end_depth;
    start_force_[layer + 1] = end_force;
    start_energy_[layer + 1] = start_energy_[layer] + (start_force_[layer] + 0.5 * slope * limit) * limit;
    past_depth_[layer + 1] = end_depth * kJointWidth;
    past_force_[layer + 1] = end_force * kJointWidth;
    springs *= kSpringsPerBar;
    limit *= tissue.q;  // eq. 4
  }
  if (layer == 0)
    throw ParameterError("k1_N_per_m", tissue.k1, "small enough that k1 x L_1 is a finite force");
  layers_ = static_cast<int>(layer);
  for (std::size_t below = 1; below < layer; ++below) {
    filled_[below] = filled_[below - 1];
    filled_[below][below - 1] = limit_[below - 1];
  }
  reached_ = layers_;
  if (tissue.max_depth) {
    const double deepest = *tissue.max_depth;
    continuation_ = {deepest, deformation_at(deepest), energy_at(deepest)};
    if (!continuation_.at.saturated) reached_ = continuation_.at.cutoff_layer;
  }
}

ContactResponse LayeredSpringLaw::force_at(double depth) const noexcept {
  if (depth <= 0.0) return {0.0, slope_[0], 1, false};
  if (depth > continuation_.depth) return continuation_.response_at(depth);
  const auto layers = static_cast<std::size_t>(reached_);
  // 1-based number of the cut-off layer, which ends at start_depth_[end]. Counted without branches, which
  // changing depths would mispredict.
  std::size_t end = 1;
  for (std::size_t i = 1; i < layers; ++i) end += depth > past_depth_[i] ? 1 : 0;
  if (depth > past_depth_[end]) return {start_force_[end], 0.0, layers_, true};
  const double force = start_force_[end - 1] + slope_[end - 1] * (depth - start_depth_[end - 1]);
  // Never above the force at the joint, so that the inverse finds the same layer; NaN stays NaN.
  const double bounded = force > start_force_[end] ? start_force_[end] : force;
  return {bounded, slope_[end - 1], static_cast<int>(end), false};
}

double LayeredSpringLaw::energy_at(double depth) const noexcept {
  if (depth <= 0.0) return 0.0;
  if (depth > continuation_.depth) return continuation_.energy_at(depth);
  const auto layers = static_cast<std::size_t>(reached_);
  std::size_t end = 1;
  for (std::size_t i = 1; i < layers; ++i) end += depth > past_depth_[i] ? 1 : 0;
  if (depth > past_depth_[end]) {
    return start_energy_[end] + start_force_[end] * (depth - start_depth_[end]);
  }
  const double in = depth - start_depth_[end - 1];
  return start_energy_[end - 1] + (start_force_[end - 1] + 0.5 * slope_[end - 1] * in) * in;
}

LayeredSpringLaw::LayerState LayeredSpringLaw::layer_state(std::size_t cutoff,
                                                           double in_cutoff) const noexcept {
  LayerState state;
  state.cutoff_layer = static_cast<int>(cutoff);
  state.stiffness = slope_[cutoff - 1];
  state.deformation = filled_[cutoff - 1];  // fixed-size copy: no branch to mispredict
  state.deformation[cutoff - 1] = std::min(in_cutoff, limit_[cutoff - 1]);
  return state;
}

LayeredSpringLaw::LayerState LayeredSpringLaw::deformation_under(double force) const noexcept {
  const auto layers = static_cast<std::size_t>(layers_);
  if (force <= 0.0) return layer_state(1, 0.0);
  if (continuation_.rises() && force > continuation_.at.force) {
    LayerState state = continuation_.state_at(continuation_.depth_under(force));
    state.force = force;
    return state;
  }
  std::size_t end = 1;
  for (std::size_t i = 1; i < layers; ++i) end += force > past_force_[i] ? 1 : 0;
  if (force > past_force_[end]) {
    LayerState state = layer_state(end, limit_[end - 1]);
    state.depth = start_depth_[end];
    state.force = start_force_[end];
    state.stiffness = 0.0;
    state.saturated = true;
    return state;
  }
  const double in_cutoff = (force - start_force_[end - 1]) / slope_[end - 1];  // eq. 5, with k_M
  LayerState state = layer_state(end, in_cutoff);
  state.depth = std::min(start_depth_[end - 1] + in_cutoff, start_depth_[end]);
  state.force = std::min(force, start_force_[end]);
  return state;
}

LayeredSpringLaw::LayerState LayeredSpringLaw::deformation_at(double depth) const noexcept {
  if (depth > continuation_.depth && !continuation_.at.saturated) return continuation_.state_at(depth);
  const ContactResponse response = force_at(depth);
  const auto cutoff = static_cast<std::size_t>(response.cutoff_layer);
  const double reached = std::clamp(depth, 0.0, start_depth_[cutoff]);
  LayerState state = layer_state(cutoff, reached - start_depth_[cutoff - 1]);
  state.depth = reached;
  state.force = response.force;
  state.stiffness = response.stiffness;
  state.saturated = response.saturated;
  state.extrapolated = response.extrapolated;
  return state;
}

}  // namespace palpate::model
