#include "palpate/live_changes.h"

#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/haptics/prepared_change.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::haptics {
namespace {

LiveNoise noise_of_world(const SimulationWorld& world) {
  const noise::NoiseSettings& settings = world.noise.settings();
  return {settings.enabled, settings.gain, settings.threshold};
}

std::string in_mm(double metres) { return shortest(metres / kMillimetre) + " mm"; }

}  // namespace

PreparedChange prepare_change(const SimulationWorld& world, const LiveChange& values) {
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
  return {values, contact::TissueLaws(tissue, 1.0 / world.rate_Hz)};
}

void apply_change(const SimulationWorld& world, SimulationState& state,
                  const PreparedChange& change) noexcept {
  const LiveChange& values = change.values;
  if ((values.what & kTissueChanged) != 0) {
    contact::change_tissue(world.contact, state.contact, change.laws);
    state.reach = values.tissue.reach;
  }
  if ((values.what & kNoiseChanged) != 0) {
    state.noise_enabled = values.noise.enabled;
    state.noise_crossfade = {values.noise.gain, values.noise.threshold,
                             static_cast<std::uint32_t>(std::ceil(noise::TouchNoise::kFade * world.rate_Hz))};
  }
  state.change = values.number;
}

LiveChanges::LiveChanges(const SimulationWorld& world, const model::TissueParameters& tissue,
                         Warnings warnings)
    : world_(world),
      warnings_(std::move(warnings)),
      tissue_(tissue),
      noise_(noise_of_world(world)),
      slots_(kMostWaiting, prepare_change(world, live_change(tissue, noise_of_world(world), 0))) {}

LiveChanges::~LiveChanges() = default;

void LiveChanges::hand_over(LiveChange values) {
  values.number = offered_ + 1;
  PreparedChange prepared = prepare_change(world_, values);
  const std::uint64_t head = head_.load(std::memory_order_relaxed);
  if (head - tail_.load(std::memory_order_acquire) == kMostWaiting) {
    throw InputError("change of tissue or noise: the loop has not taken the last " +
                     std::to_string(kMostWaiting) + " changes yet; try again when it has");
  }
  slots_[head % kMostWaiting] = prepared;
  offered_ = values.number;
  head_.store(head + 1, std::memory_order_release);
}

LiveChanges::Accepted LiveChanges::offer(const model::TissueParameters& tissue) {
  const std::lock_guard lock(callers_);
  model::validate(tissue);
  Accepted accepted;
  if (warnings_) accepted.warnings = warnings_(tissue);
  hand_over(live_change(tissue, noise_, kTissueChanged));
  tissue_ = tissue;
  accepted.number = offered_;
  return accepted;
}

LiveChanges::Accepted LiveChanges::offer(const LiveNoise& noise) {
  const std::lock_guard lock(callers_);
  hand_over(live_change(tissue_, noise, kNoiseChanged));
  noise_ = noise;
  return {offered_, {}};
}

model::TissueParameters LiveChanges::tissue() const {
  const std::lock_guard lock(callers_);
  return tissue_;
}

LiveNoise LiveChanges::noise() const {
  const std::lock_guard lock(callers_);
  return noise_;
}

const PreparedChange* LiveChanges::waiting() const noexcept {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
  return tail == head_.load(std::memory_order_acquire) ? nullptr : &slots_[tail % kMostWaiting];
}

void LiveChanges::taken() noexcept {
  tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

}  // namespace palpate::haptics
