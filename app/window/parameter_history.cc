#include "app/window/parameter_history.h"

#include <utility>

namespace palpate::app {

bool equal(const LiveParameters& a, const LiveParameters& b) {
  const auto same_noise = [](const noise::NoiseSettings& x, const noise::NoiseSettings& y) {
    return x.enabled == y.enabled && x.gain == y.gain && x.threshold == y.threshold;
  };
  return a.tissue == b.tissue && same_noise(a.noise, b.noise) && a.inclusions == b.inclusions;
}

void ParameterHistory::add(const LiveParameters& before, bool held) {
  future_.clear();
  if (held && std::exchange(one_step_, true)) return;
  one_step_ = held;
  if (past_.size() == kMaxSteps) past_.erase(past_.begin());
  past_.push_back(before);
}

std::optional<LiveParameters> ParameterHistory::move(const LiveParameters& now, Steps& from, Steps& to) {
  one_step_ = false;
  while (!from.empty() && equal(from.back(), now)) from.pop_back();  // refused changes
  if (from.empty()) return std::nullopt;
  LiveParameters wanted = std::move(from.back());
  from.pop_back();
  to.push_back(now);
  return wanted;
}

void ParameterHistory::clear() {
  past_.clear();
  future_.clear();
  one_step_ = false;
}

}  // namespace palpate::app
