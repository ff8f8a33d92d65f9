#include "run/devices/fault_schedule.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "palpate/error.h"

namespace palpate::devices {
namespace {

using haptics::DeviceState;
using haptics::Fault;
using scene::EmulatedFault;
using scene::EmulatedFaultKind;

constexpr double kLongestTime = 1e9;       // s, about thirty years
constexpr double kThousandTimes = 1000.0;  // gives a position in mm where m are expected

void check(const EmulatedFault& fault) {
  for (const auto& [field, value] :
       {std::pair("fault.time_s", fault.time), std::pair("fault.duration_s", fault.duration)}) {
    if (!(value >= 0.0 && value <= kLongestTime))
      throw ParameterError(field, value, "a number >= 0 and <= 1e9");
  }
  if (!(fault.age > 0.0 && fault.age <= scene::kLongestFaultAge)) {
    throw ParameterError("fault.age_ms", 1e3 * fault.age, "a number > 0 and <= 1000");
  }
}

/// First tick at or after `time` [s]. A time within kRounding of a tick counts as that tick.
std::uint64_t first_tick_from(double time, double rate_Hz) {
  constexpr double kRounding = 1e-6;  // ticks
  return static_cast<std::uint64_t>(std::ceil(std::max(0.0, time * rate_Hz - kRounding)));
}

}  // namespace

FaultSchedule::FaultSchedule(const std::vector<EmulatedFault>& faults, double rate_Hz) : rate_Hz_(rate_Hz) {
  std::uint64_t longest = 0;
  for (const EmulatedFault& fault : faults) {
    check(fault);
    const std::uint64_t begin = first_tick_from(fault.time, rate_Hz);
    const std::uint64_t end = std::max(begin + 1, first_tick_from(fault.time + fault.duration, rate_Hz));
    const bool late = fault.kind == EmulatedFaultKind::kLate;
    spans_.push_back({fault.kind, begin, end, late ? first_tick_from(fault.age, rate_Hz) : 0});
    longest = std::max(longest, spans_.back().delay);
  }
  past_.resize(longest + 1);
}

DeviceState FaultSchedule::delayed(std::uint64_t delay) const noexcept {
  const std::uint64_t back = std::min(delay, kept_ - 1);  // the first sample of the run is the oldest
  DeviceState sample = past_[(kept_ - 1 - back) % past_.size()];
  sample.age = static_cast<double>(delay) / rate_Hz_;
  return sample;
}

void FaultSchedule::apply(const Span& span, std::uint64_t tick, DeviceState& sample) const noexcept {
  switch (span.kind) {
    case EmulatedFaultKind::kFreeze:
      sample = frozen_;
      sample.age += static_cast<double>(tick - frozen_tick_) / rate_Hz_;
      break;
    case EmulatedFaultKind::kDropOut:
      sample.fault = Fault::kDevice;
      break;
    case EmulatedFaultKind::kNotANumber:
      sample.position_D.x() = std::numeric_limits<double>::quiet_NaN();
      break;
    case EmulatedFaultKind::kSpike:
      sample.position_D.z() -= kSpike;
      break;
    case EmulatedFaultKind::kLate:
      sample = delayed(span.delay);
      break;
    case EmulatedFaultKind::kWrongUnits:
      sample.position_D *= kThousandTimes;
      sample.velocity_D *= kThousandTimes;
      break;
    case EmulatedFaultKind::kForceOff:
      sample.fault = Fault::kForceOff;
      break;
    case EmulatedFaultKind::kRefuse:
      break;  // this fault affects commands only
  }
}

DeviceState FaultSchedule::with_faults(std::uint64_t tick, const DeviceState& fresh) noexcept {
  past_[kept_ % past_.size()] = fresh;
  ++kept_;
  if (!is_active(EmulatedFaultKind::kFreeze, tick) || kept_ == 1) {
    frozen_ = fresh;
    frozen_tick_ = tick;
  }
  DeviceState sample = fresh;
  for (const Span& span : spans_) {
    if (span.holds(tick)) apply(span, tick, sample);
  }
  return sample;
}

bool FaultSchedule::is_active(EmulatedFaultKind kind, std::uint64_t tick) const noexcept {
  return std::any_of(spans_.begin(), spans_.end(),
                     [&](const Span& span) { return span.kind == kind && span.holds(tick); });
}

std::optional<EmulatedFaultKind> FaultSchedule::first_active(std::uint64_t tick) const noexcept {
  for (const Span& span : spans_) {
    if (span.holds(tick)) return span.kind;
  }
  return std::nullopt;
}

}  // namespace palpate::devices
