#include "palpate/parameter_updates.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/haptics/prepared_update.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::haptics {
namespace {

constexpr double kShortestRamp = 10e-3;  // s, of a commanded force
constexpr double kLongestRamp = 10.0;    // s
constexpr std::uint32_t kMaxInterval = 2;
constexpr double kMillisecond = 1e-3;  // s

LiveNoise noise_of_world(const SimulationWorld& world) {
  const noise::NoiseSettings& settings = world.noise.settings();
  return {settings.enabled, settings.gain, settings.threshold};
}

/// The inclusion of the world with the numbers that a live update changes. @throws InputError
model::Inclusion inclusion_of(const contact::World& world, const LiveInclusion& live) {
  const std::vector<model::Inclusion> all = world.inclusions();
  if (live.index >= all.size()) {
    throw InputError("inclusion " + std::to_string(live.index + 1) + ": the scene has " +
                     std::to_string(all.size()));
  }
  model::Inclusion changed = all[live.index];
  changed.centre_S = Vec3(live.centre_S[0], live.centre_S[1], live.centre_S[2]);
  changed.ratio = live.ratio;
  return changed;
}

void validate(const LiveStimulus& stimulus, double max_force) {
  if (!(std::abs(stimulus.force) <= max_force)) {
    throw ParameterError(
        "force_N", stimulus.force,
        "between -" + shortest(max_force) + " and " + shortest(max_force) + ", the run's largest force");
  }
  if (!(stimulus.ramp >= kShortestRamp && stimulus.ramp <= kLongestRamp)) {
    throw ParameterError("ramp_ms", stimulus.ramp / kMillisecond, "10 to 10000");
  }
  if (stimulus.interval > kMaxInterval) throw ParameterError("interval", stimulus.interval, "0, 1 or 2");
}

/// Starts the ramp to a new commanded force on every hand.
void change_stimulus(SimulationState& state, const LiveStimulus& stimulus, double rate_Hz) noexcept {
  const double ticks = std::max(1.0, std::round(stimulus.ramp * rate_Hz));
  for (StimulusRamp& ramp : state.stimuli) {
    ramp.from = ramp.force();
    ramp.to = stimulus.force;
    ramp.ticks = ramp.ticks_left = static_cast<std::uint32_t>(ticks);
  }
  if (stimulus.interval == state.interval) return;
  state.interval_events =
      (state.interval != 0 ? kIntervalEnded : 0U) | (stimulus.interval != 0 ? kIntervalBegan : 0U);
  state.interval = stimulus.interval;
}

std::string in_mm(double metres) { return shortest(metres / kMillimetre) + " mm"; }

}  // namespace

PreparedUpdate prepare_update(const SimulationWorld& world, const ParameterUpdate& values) {
  const model::TissueParameters tissue = tissue_of(values);
  model::validate(tissue);
  const double prepared_for = world.contact.tissue().contact.reference_radius;
  if (tissue.contact.reference_radius != prepared_for) {
    throw InputError("contact.reference_radius_mm = " + in_mm(tissue.contact.reference_radius) +
                     ": the organ was prepared for " + in_mm(prepared_for) +
                     ", which cannot change during a run");
  }
  noise::NoiseSettings settings = world.noise.settings();
  settings.gain = values.noise.gain;
  settings.threshold = values.noise.threshold;
  noise::validate(settings, world.rate_Hz, world.limits.max_sigma());
  if ((values.what & kStimulusChanged) != 0) validate(values.stimulus, world.limits.max_force);
  PreparedUpdate prepared{values, contact::TissueLaws(tissue, 1.0 / world.rate_Hz)};
  if ((values.what & kInclusionChanged) != 0) {
    prepared.inclusion = contact::placed_inclusion(world.contact, values.inclusion.index,
                                                   inclusion_of(world.contact, values.inclusion));
  }
  return prepared;
}

void apply_update(const SimulationWorld& world, SimulationState& state,
                  const PreparedUpdate& change) noexcept {
  const ParameterUpdate& values = change.values;
  if ((values.what & kTissueChanged) != 0) {
    contact::change_tissue(world.contact, state.contact, change.laws);
    state.reach = values.tissue.reach;
  }
  if ((values.what & kNoiseChanged) != 0) {
    state.noise_enabled = values.noise.enabled;
    state.noise_crossfade = {values.noise.gain, values.noise.threshold,
                             static_cast<std::uint32_t>(std::ceil(noise::TouchNoise::kFade * world.rate_Hz))};
  }
  if ((values.what & kInclusionChanged) != 0) {
    contact::change_inclusion(state.contact, values.inclusion.index, change.inclusion);
  }
  if ((values.what & kStimulusChanged) != 0) change_stimulus(state, values.stimulus, world.rate_Hz);
  state.change = values.number;
}

ParameterUpdates::ParameterUpdates(const SimulationWorld& world, const model::TissueParameters& tissue,
                                   Warnings warnings)
    : world_(world),
      warnings_(std::move(warnings)),
      tissue_(tissue),
      noise_(noise_of_world(world)),
      inclusions_(world.contact.inclusions()),
      slots_(kMaxWaiting, prepare_update(world, parameter_update(tissue, noise_of_world(world), 0))) {}

ParameterUpdates::~ParameterUpdates() = default;

void ParameterUpdates::hand_over(ParameterUpdate values, std::uint64_t not_before_tick) {
  values.number = offered_ + 1;
  PreparedUpdate prepared = prepare_update(world_, values);
  prepared.not_before_tick = not_before_tick;
  const std::uint64_t head = head_.load(std::memory_order_relaxed);
  if (head - tail_.load(std::memory_order_acquire) == kMaxWaiting) {
    throw InputError("change of tissue or noise: the loop has not taken the last " +
                     std::to_string(kMaxWaiting) + " changes yet; try again when it has");
  }
  slots_[head % kMaxWaiting] = prepared;
  offered_ = values.number;
  head_.store(head + 1, std::memory_order_release);
}

ParameterUpdates::Accepted ParameterUpdates::offer(const model::TissueParameters& tissue,
                                                   std::uint64_t not_before_tick) {
  const std::lock_guard lock(callers_);
  model::validate(tissue);
  if (world_.contact.has_needle() && tissue.layers != world_.contact.tissue().layers) {
    throw InputError(
        "layer: the layers that a needle goes through cannot change during a run; start a new one");
  }
  Accepted accepted;
  if (warnings_) accepted.warnings = warnings_(tissue, inclusions_);
  hand_over(parameter_update(tissue, noise_, kTissueChanged), not_before_tick);
  tissue_ = tissue;
  accepted.number = offered_;
  return accepted;
}

ParameterUpdates::Accepted ParameterUpdates::offer(const LiveNoise& noise, std::uint64_t not_before_tick) {
  const std::lock_guard lock(callers_);
  hand_over(parameter_update(tissue_, noise, kNoiseChanged), not_before_tick);
  noise_ = noise;
  return {offered_, {}};
}

ParameterUpdates::Accepted ParameterUpdates::offer(const LiveInclusion& inclusion,
                                                   std::uint64_t not_before_tick) {
  const std::lock_guard lock(callers_);
  const model::Inclusion changed = inclusion_of(world_.contact, inclusion);
  model::validate(changed);
  std::vector<model::Inclusion> all = inclusions_;
  all[inclusion.index] = changed;
  Accepted accepted;
  if (warnings_) accepted.warnings = warnings_(tissue_, all);
  ParameterUpdate update = parameter_update(tissue_, noise_, kInclusionChanged);
  update.inclusion = inclusion;
  hand_over(update, not_before_tick);
  inclusions_ = std::move(all);
  accepted.number = offered_;
  return accepted;
}

ParameterUpdates::Accepted ParameterUpdates::offer(const LiveStimulus& stimulus,
                                                   std::uint64_t not_before_tick) {
  const std::lock_guard lock(callers_);
  ParameterUpdate update = parameter_update(tissue_, noise_, kStimulusChanged);
  update.stimulus = stimulus;
  hand_over(update, not_before_tick);
  return {offered_, {}};
}

std::vector<model::Inclusion> ParameterUpdates::inclusions() const {
  const std::lock_guard lock(callers_);
  return inclusions_;
}

model::TissueParameters ParameterUpdates::tissue() const {
  const std::lock_guard lock(callers_);
  return tissue_;
}

LiveNoise ParameterUpdates::noise() const {
  const std::lock_guard lock(callers_);
  return noise_;
}

const PreparedUpdate* ParameterUpdates::waiting(std::uint64_t tick) const noexcept {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  if (tail == head_.load(std::memory_order_acquire)) return nullptr;
  const PreparedUpdate& oldest = slots_[tail % kMaxWaiting];
  return tick < oldest.not_before_tick ? nullptr : &oldest;
}

void ParameterUpdates::taken() noexcept {
  tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

}  // namespace palpate::haptics
