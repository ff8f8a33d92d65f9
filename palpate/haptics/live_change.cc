#include "palpate/haptics/live_change.h"

#include <algorithm>

namespace palpate::haptics {

LiveChange live_change(const model::TissueParameters& tissue, const LiveNoise& noise, std::uint32_t what) {
  LiveChange change;
  change.what = what;
  change.law = static_cast<std::uint32_t>(tissue.law);
  change.k1 = tissue.k1;
  change.beta = tissue.beta;
  change.q = tissue.q;
  change.rest_length = tissue.rest_length;
  change.max_length = tissue.max_length;
  change.min_length = tissue.min_length;
  change.t1 = tissue.t1;
  for (std::size_t i = 0; i < std::min(change.share.size(), tissue.relaxation.size()); ++i) {
    change.share[i] = tissue.relaxation[i].share;
    change.time[i] = tissue.relaxation[i].time;
  }
  change.contact_ratio = tissue.reach.contact_ratio;
  change.first_bar_ratio = tissue.reach.first_bar_ratio;
  change.bar_ratio = tissue.reach.bar_ratio;
  change.weight_ratio = tissue.reach.weight_ratio;
  change.depth_exponent = tissue.reach.depth_exponent;
  change.friction = tissue.contact.friction;
  change.tangential_stiffness = tissue.contact.tangential_stiffness.value_or(0.0);
  change.damping = tissue.contact.damping;
  change.reference_radius = tissue.contact.reference_radius;
  change.grip_limit = tissue.contact.grip_limit;
  change.noise_enabled = noise.enabled ? 1 : 0;
  change.noise_gain = noise.gain;
  change.noise_threshold = noise.threshold;
  std::copy_n(tissue.name.begin(), std::min(tissue.name.size(), LiveChange::kNameBytes),
              change.tissue.begin());
  return change;
}

model::TissueParameters tissue_of(const LiveChange& change) {
  model::TissueParameters tissue;
  tissue.name.assign(change.tissue.begin(), std::find(change.tissue.begin(), change.tissue.end(), '\0'));
  tissue.law = static_cast<model::LawKind>(change.law);
  tissue.k1 = change.k1;
  tissue.beta = change.beta;
  tissue.q = change.q;
  tissue.rest_length = change.rest_length;
  tissue.max_length = change.max_length;
  tissue.min_length = change.min_length;
  tissue.t1 = change.t1;
  for (std::size_t i = 0; i < change.share.size() && change.share[i] != 0.0; ++i) {
    tissue.relaxation.push_back({change.share[i], change.time[i]});
  }
  tissue.reach = reach_of(change);
  tissue.contact.friction = change.friction;
  if (change.tangential_stiffness != 0.0) tissue.contact.tangential_stiffness = change.tangential_stiffness;
  tissue.contact.damping = change.damping;
  tissue.contact.reference_radius = change.reference_radius;
  tissue.contact.grip_limit = change.grip_limit;
  return tissue;
}

model::ReachParameters reach_of(const LiveChange& change) noexcept {
  return {change.contact_ratio, change.first_bar_ratio, change.bar_ratio, change.weight_ratio,
          change.depth_exponent};
}

LiveNoise noise_of(const LiveChange& change) noexcept {
  return {change.noise_enabled != 0, change.noise_gain, change.noise_threshold};
}

}  // namespace palpate::haptics
