#include "run/realtime/held_play.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/haptics/simulation.h"
#include "io/system/clock.h"
#include "run/realtime/watchdog.h"

namespace palpate::realtime {
namespace {

constexpr double kNs = 1e9;         // ns/s
constexpr double kFallTime = 0.05;  // s of zero force at the end of a part

}  // namespace

PlayClock PlayClock::monotonic() {
  return {[] { return monotonic_ns(); }, [](std::int64_t deadline) { sleep_until_ns(deadline); }, true};
}

HeldPlay::HeldPlay(haptics::Device& device, double rate_Hz, const PlayLimits& limits, PlayClock clock,
                   const std::atomic<bool>* stop)
    : device_(device), rate_Hz_(rate_Hz), limits_(limits), clock_(std::move(clock)), stop_(stop) {
  limits_.max_force = std::min(limits_.max_force, device.abilities().max_force);
  gate_limits_.max_force = limits_.max_force;
  gate_limits_.force_step = limits_.max_slew / rate_Hz;
  gate_limits_.period = 1.0 / rate_Hz;
  gate_limits_.continuous_force = device.abilities().continuous_force;
}

HeldPlay::~HeldPlay() { device_.stop(); }

void HeldPlay::judge(const haptics::DeviceState& sample) noexcept {
  if (ending_ != Ending::kNone) return;
  if (!start_) start_ = sample.position_D;
  const double travel = (sample.position_D - *start_).norm();
  const double speed = sample.velocity_D.norm();
  if (travel > limits_.max_travel) {
    ending_ = Ending::kTravel;
    ending_value_ = travel;
  } else if (speed > limits_.max_speed) {
    ending_ = Ending::kSpeed;
    ending_value_ = speed;
  } else if (stop_ != nullptr && stop_->load()) {
    ending_ = Ending::kStopped;
  }
}

bool HeldPlay::advance(const ForceOf& force_of, PlayedTick& tick) noexcept {
  haptics::GateInput input;
  const haptics::DeviceState sample = device_.read(tick_, static_cast<double>(tick_) / rate_Hz_);
  input.fault = haptics::sample_fault(sample);
  bool goes_on = false;
  if (input.fault == haptics::Fault::kNone) {
    tick.position = sample.position_D;
    tick.age = sample.age;
    judge(sample);
    if (ending_ == Ending::kNone) {
      if (const std::optional<Vec3> wanted = force_of(tick)) {
        input.tissue.force = *wanted;
        goes_on = true;
      }
    }
  }
  const haptics::GateOutput out = haptics::pass_gate(gate_limits_, gate_, input);
  tick.force = out.command.force;
  if (!device_.write(out.command)) gate_.fault = haptics::Fault::kDevice;
  if (gate_.fault != haptics::Fault::kNone && ending_ == Ending::kNone) ending_ = Ending::kFault;
  return goes_on && ending_ == Ending::kNone;
}

std::vector<PlayedTick> HeldPlay::play(double seconds, const ForceOf& force_of) {
  std::vector<PlayedTick> ticks;
  if (!failure_.empty()) return ticks;
  const auto count = static_cast<std::size_t>(std::llround(seconds * rate_Hz_));
  const auto fall = static_cast<std::size_t>(std::ceil(kFallTime * rate_Hz_));
  ticks.reserve(count + fall);
  const std::array<haptics::Device*, 1> devices{&device_};
  Watchdog watchdog(devices,
                    static_cast<std::int64_t>(std::max(haptics::kStalledAfter, 4.0 / rate_Hz_) * kNs));
  const ForceOf zero = [](const PlayedTick&) { return Vec3::Zero().eval(); };
  const std::int64_t begin = clock_.now();
  start_.reset();
  std::size_t ended = count;  // tick at which the part ended
  for (std::size_t i = 0; i < std::min(ended, count) + fall; ++i, ++tick_) {
    clock_.sleep_until(begin + static_cast<std::int64_t>(static_cast<double>(i) / rate_Hz_ * kNs));
    PlayedTick tick;
    tick.time = static_cast<double>(i) / rate_Hz_;
    tick.begin_ns = clock_.now();
    if (clock_.watched) watchdog.beat(tick_, monotonic_ns());
    if (watchdog.stops() > 0 && gate_.fault == haptics::Fault::kNone) {
      gate_.fault = haptics::Fault::kStalled;
      gate_.force = Vec3::Zero();
    }
    const bool playing = i < ended && ending_ == Ending::kNone;
    const bool goes_on = advance(playing ? force_of : zero, tick);
    if (playing && goes_on) ticks.push_back(tick);
    if (playing && !goes_on) ended = i;
  }
  watchdog.rest();
  if (ending_ != Ending::kNone) {
    device_.stop();
    describe_failure();
    ticks.clear();
  }
  return ticks;
}

void HeldPlay::describe_failure() {
  constexpr double kMilli = 1e3;
  const std::string zero = "; the force is zero, and the measurement ended";
  if (ending_ == Ending::kTravel) {
    failure_ = "the device moved " + brief(ending_value_ * kMilli) + " mm, more than " +
               brief(limits_.max_travel * kMilli) + " mm: hold it more firmly, or lower --max-force-N" + zero;
  } else if (ending_ == Ending::kSpeed) {
    failure_ = "the device moved at " + brief(ending_value_) + " m/s, faster than " +
               brief(limits_.max_speed) + " m/s: it ran away" + zero;
  } else if (ending_ == Ending::kStopped) {
    failure_ = "stopped" + zero;
  } else {
    const std::string why = device_.last_error();
    failure_ = std::string(haptics::describe(gate_.fault)) + (why.empty() ? "" : " (" + why + ")") + zero;
  }
}

}  // namespace palpate::realtime
