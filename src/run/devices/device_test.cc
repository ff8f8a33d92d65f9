#include "run/devices/device_test.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include <Eigen/Dense>

#include "core/base/statistics.h"
#include "core/base/text.h"

namespace palpate::devices {
namespace {

using realtime::HeldPlay;
using realtime::PlayedTick;

constexpr double kNsPerSecond = 1e9;

Repeated repeated(const std::vector<double>& values) { return {mean(values), standard_deviation(values)}; }

std::vector<double> along(const std::vector<PlayedTick>& ticks, int axis) {
  std::vector<double> positions;
  for (const PlayedTick& tick : ticks) positions.push_back(tick.position[axis]);
  return positions;
}

Vec3 on_axis(double force, int axis) {
  Vec3 vector = Vec3::Zero();
  vector[axis] = force;
  return vector;
}

// --- Rest: rate, jitter, noise ---

void judge_rest(const std::vector<PlayedTick>& ticks, DeviceTest& found) {
  std::vector<double> periods;
  std::size_t fresh = 0;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    periods.push_back(static_cast<double>(ticks[i].begin_ns - ticks[i - 1].begin_ns) / kNsPerSecond);
    // Without a new sample the age grows by the period of the loop.
    if (ticks[i].age < ticks[i - 1].age + 0.5 * periods.back()) ++fresh;
  }
  if (periods.empty()) return;
  const double span = static_cast<double>(ticks.back().begin_ns - ticks.front().begin_ns) / kNsPerSecond;
  found.loop_rate = static_cast<double>(periods.size()) / span;
  found.sample_rate = static_cast<double>(fresh) / span;
  found.jitter_sd = standard_deviation(periods);
  found.longest_period = *std::max_element(periods.begin(), periods.end());
  for (int axis = 0; axis < 3; ++axis) {
    found.noise_at_rest = std::max(found.noise_at_rest, standard_deviation(along(ticks, axis)));
  }
}

// --- Slow pushes: friction and the step of the position ---

/// A triangle of the amplitude 1 that starts at 0 and rises.
double triangle(double time, double period) {
  const double phase = time / period - std::floor(time / period);
  return phase < 0.25 ? 4.0 * phase : phase < 0.75 ? 2.0 - 4.0 * phase : 4.0 * phase - 4.0;
}

/// Friction and viscous drag of one cycle, and its mean speed.
struct Cycle {
  double force = 0.0;  // N, energy lost over the way that the grip moved
  double speed = 0.0;  // m/s
};

/// The energy that a cycle of the force loses is friction times the way: one range there and one back.
std::vector<Cycle> cycles_of(const std::vector<PlayedTick>& ticks, int axis, double period, double rate) {
  std::vector<Cycle> cycles;
  const auto length = static_cast<std::size_t>(period * rate);
  const std::size_t first = length / 4;  // from the largest force on
  for (std::size_t from = first; from + length < ticks.size(); from += length) {
    double energy = 0.0;
    double low = ticks[from].position[axis];
    double high = low;
    for (std::size_t i = from; i < from + length; ++i) {
      const double x = ticks[i].position[axis];
      energy += ticks[i].force[axis] * (ticks[i + 1].position[axis] - x);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (high > low) cycles.push_back({energy / (2.0 * (high - low)), 2.0 * (high - low) / period});
  }
  return cycles;
}

/// The drag that is left at speed zero, from slow and fast cycles.
std::optional<Repeated> friction_of(const std::vector<Cycle>& slow, const std::vector<Cycle>& fast) {
  std::vector<double> values;
  for (std::size_t i = 0; i < std::min(slow.size(), fast.size()); ++i) {
    const double speeds = fast[i].speed - slow[i].speed;
    if (!(speeds > 0.2 * slow[i].speed)) continue;
    values.push_back(slow[i].force - (fast[i].force - slow[i].force) * slow[i].speed / speeds);
  }
  if (values.empty()) return std::nullopt;
  return repeated(values);
}

/// The step of the position: its usual change between samples, if most samples repeat the one before.
std::optional<double> step_of(const std::vector<PlayedTick>& ticks) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < ticks.size(); ++i) {
    const double step = (ticks[i].position - ticks[i - 1].position).norm();
    if (step > 0.0) steps.push_back(step);
  }
  if (steps.empty() || 2 * steps.size() > ticks.size()) return std::nullopt;
  return median(std::move(steps));
}

bool test_friction(HeldPlay& play, const DeviceTestSettings& settings, DeviceTest& found) {
  constexpr double kSlow = 8.0, kFast = 4.0;  // s
  constexpr double kCycles = 3.3;             // a quarter to begin with, three to judge
  const double most = 0.5 * settings.max_force;
  std::vector<Cycle> cycles[2];
  for (const double period : {kSlow, kFast}) {
    const auto ticks = play.play(kCycles * period, [&](const PlayedTick& now) {
      return on_axis(most * triangle(now.time, period), settings.axis);
    });
    if (ticks.empty()) return false;
    cycles[period == kFast ? 1 : 0] = cycles_of(ticks, settings.axis, period, play.rate_Hz());
    if (period == kSlow) found.resolution = step_of(ticks);
  }
  found.friction = friction_of(cycles[0], cycles[1]);
  if (!found.friction) {
    found.unknown.emplace_back("friction: the grip hardly moved under the slow pushes; hold it more loosely");
  } else if (found.friction->mean < 2.0 * found.friction->sd) {
    found.unknown.push_back(
        "friction: " + brief(found.friction->mean) +
        " N is not clear of its spread; the hand moved by itself, or the friction is smaller");
    found.friction.reset();
  }
  if (!found.resolution) {
    found.unknown.emplace_back(
        "position resolution: the position changes at nearly every sample, so that its step is hidden by "
        "noise, filtering or motion");
  }
  return true;
}

// --- Force steps: latency, rise, overshoot, moving mass ---

/// Mass, damper and spring under a force of 1 that begins at a delay.
struct StepModel {
  Eigen::Matrix<double, 5, 1>
      values;  // start [m], gain [m], delay [s], ln of frequency [rad/s] and damping ratio

  [[nodiscard]] double at(double time) const {
    using Complex = std::complex<double>;
    const double since = time - values[2];
    if (since <= 0.0) return values[0];
    const double frequency = std::exp(values[3]);
    const double ratio = std::exp(values[4]);
    const Complex root = std::sqrt(Complex(ratio * ratio - 1.0 + 1e-9));
    const Complex first = frequency * (-ratio + root);
    const Complex second = frequency * (-ratio - root);
    const Complex step =
        1.0 + (second * std::exp(first * since) - first * std::exp(second * since)) / (first - second);
    return values[0] + values[1] * step.real();
  }
};

/// Least squares by Levenberg and Marquardt. @return root mean square error [m]
double fit_step(const std::vector<double>& x, double period, const Eigen::Matrix<double, 5, 1>& scale,
                StepModel& model) {
  constexpr int kMostSteps = 60;
  const auto count = static_cast<Eigen::Index>(x.size());
  const auto errors = [&](const StepModel& of) {
    Eigen::VectorXd result(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      result[i] = of.at(static_cast<double>(i) * period) - x[static_cast<std::size_t>(i)];
    }
    return result;
  };
  double damping = 1e-2;
  Eigen::VectorXd error = errors(model);
  for (int step = 0; step < kMostSteps; ++step) {
    Eigen::MatrixXd slopes(count, 5);
    for (Eigen::Index k = 0; k < 5; ++k) {
      StepModel moved = model;
      moved.values[k] += 1e-5 * scale[k];
      slopes.col(k) = (errors(moved) - error) / 1e-5;  // in units of `scale`
    }
    Eigen::MatrixXd normal = slopes.transpose() * slopes;
    normal.diagonal() *= 1.0 + damping;
    const Eigen::VectorXd change = normal.ldlt().solve(-slopes.transpose() * error);
    StepModel next = model;
    next.values += scale.cwiseProduct(change.cwiseMax(-0.5).cwiseMin(0.5));
    const Eigen::VectorXd next_error = errors(next);
    if (next_error.squaredNorm() < error.squaredNorm()) {
      model = next;
      error = next_error;
      damping *= 0.3;
    } else {
      damping *= 10.0;
    }
  }
  return std::sqrt(error.squaredNorm() / static_cast<double>(count));
}

struct StepResponse {
  double latency = 0.0;  // s
  double mass = 0.0;     // kg for each N of the force that acts
  double rise = 0.0;     // s
  double overshoot = 0.0;
};

/// Fits the motion up to its first turn, where the friction keeps its direction.
std::optional<StepResponse> step_response(const std::vector<double>& x, double period, double noise) {
  if (x.size() < 100) return std::nullopt;
  const double final_x = mean(std::span(x).last(x.size() / 4));
  const auto top = static_cast<std::size_t>(std::max_element(x.begin(), x.end()) - x.begin());
  if (!(final_x > 20.0 * noise) || top < 12) return std::nullopt;
  const auto reach = [&](double share) {
    const auto at = std::find_if(x.begin(), x.end(), [&](double v) { return v >= share * final_x; });
    return static_cast<double>(at - x.begin()) * period;
  };
  StepModel model;
  model.values << 0.0, final_x, period, std::log(3.0 / (static_cast<double>(top) * period)), std::log(0.4);
  const Eigen::Matrix<double, 5, 1> scale{noise, final_x, 5e-3, 1.0, 1.0};
  constexpr double kWorstFit = 0.05;  // of the displacement
  const std::vector<double> rising(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(top));
  if (fit_step(rising, period, scale, model) > kWorstFit * final_x) return std::nullopt;
  StepResponse found;
  found.latency = model.values[2];
  found.mass = std::exp(-2.0 * model.values[3]) / model.values[1];
  found.rise = reach(0.9) - reach(0.1);
  found.overshoot = std::max(0.0, x[top] / final_x - 1.0);
  return found;
}

bool test_steps(HeldPlay& play, const DeviceTestSettings& settings, DeviceTest& found) {
  constexpr int kSteps = 16;
  constexpr double kOn = 0.5, kOff = 0.5;  // s
  const double force = 0.4 * settings.max_force;
  const double noise = std::max({found.noise_at_rest, found.resolution.value_or(0.0), 1e-9});
  const double acting = force - (found.friction ? found.friction->mean : 0.0);
  std::vector<double> latency, mass, rise, overshoot;
  for (int i = 0; i < kSteps; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    const auto ticks = play.play(kOff + kOn, [&](const PlayedTick& now) {
      return on_axis(now.time < kOff - 1e-9 ? 0.0 : sign * force, settings.axis);
    });
    if (ticks.empty()) return false;
    const auto first = static_cast<std::size_t>(std::llround(kOff * play.rate_Hz()));
    std::vector<double> x = along(ticks, settings.axis);
    const double start = mean(std::span(x).subspan(first * 3 / 4, first / 4));
    x.erase(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(first));
    for (double& value : x) value = sign * (value - start);
    const auto one = step_response(x, 1.0 / play.rate_Hz(), noise);
    if (!one) continue;
    latency.push_back(one->latency);
    mass.push_back(one->mass * acting);
    rise.push_back(one->rise);
    overshoot.push_back(one->overshoot);
  }
  if (latency.size() < kSteps / 2) {
    found.unknown.emplace_back(
        "latency and force step: the steps hardly moved the grip; hold it more loosely, or give a larger "
        "--max-force-N");
    return true;
  }
  found.latency = repeated(latency);
  found.mass = repeated(mass);
  found.rise = repeated(rise);
  found.overshoot = repeated(overshoot);
  return true;
}

// --- Virtual wall: the largest stable stiffness ---

/// A second-order high-pass filter, which the hand's own tremor (8 to 12 Hz) hardly passes.
class HighPass {
 public:
  explicit HighPass(double rate) : keep_(1.0 / (1.0 + 2.0 * std::numbers::pi * kCorner / rate)) {}
  double operator()(double value) {
    for (Stage& stage : stages_) {
      if (!stage.begun) stage.last = value;
      stage.begun = true;
      stage.out = keep_ * (stage.out + value - stage.last);
      stage.last = value;
      value = stage.out;
    }
    return value;
  }

 private:
  static constexpr double kCorner = 25.0;  // Hz
  struct Stage {
    bool begun = false;
    double last = 0.0, out = 0.0;
  };
  double keep_;
  Stage stages_[2];
};

enum class WallResult { kStable, kOscillates, kNoContact, kFailed };

/// A one-sided spring comes to the grip until it pushes with a quarter of the largest force, stays, knocks
/// once, and is watched: does the fast part of its force decay?
WallResult try_wall(HeldPlay& play, const DeviceTestSettings& settings, double stiffness, double resolution) {
  constexpr double kRest = 0.5, kApproach = 2.5, kSettle = 0.3, kKnock = 5e-3, kWatch = 0.6;  // s
  constexpr double kCome = 0.01;                                                              // m/s
  constexpr double kSmoothing = 0.05;  // s, of the force that the hand resists with
  const double enough = 0.25 * settings.max_force;
  const double knock = 0.15 * settings.max_force;
  const double wild = 0.5 * settings.max_force;
  HighPass filter(play.rate_Hz());
  std::optional<double> surface, touched;
  std::vector<double> fast;  // N, of the watched ticks
  double smooth = 0.0;
  bool ended_wild = false;
  fast.reserve(static_cast<std::size_t>(kWatch * play.rate_Hz()) + 2);
  const double longest = kRest + kApproach + kSettle + kKnock + kWatch + 0.01;
  static_cast<void>(play.play(longest, [&](const PlayedTick& now) -> std::optional<Vec3> {
    if (now.time < kRest) return Vec3::Zero();
    const double x = now.position[settings.axis];
    if (!surface) surface = x;
    const double force = std::max(0.0, stiffness * (*surface - x));
    const double high = filter(force);
    smooth += (force - smooth) / (kSmoothing * play.rate_Hz());
    if (!touched && smooth >= enough) touched = now.time;
    if (!touched) *surface += kCome / play.rate_Hz();
    if (!touched && now.time > kRest + kApproach) return std::nullopt;
    const double since = touched ? now.time - *touched : 0.0;
    if (std::abs(high) > wild) {
      ended_wild = true;
      return std::nullopt;
    }
    if (since > kSettle + kKnock + kWatch) return std::nullopt;
    if (since > kSettle + kKnock) fast.push_back(high);
    return on_axis(since > kSettle && since <= kSettle + kKnock ? force + knock : force, settings.axis);
  }));
  if (!play.failure().empty()) return WallResult::kFailed;
  if (ended_wild) return WallResult::kOscillates;
  if (!touched || fast.size() < 30) return WallResult::kNoContact;
  const auto rms = [](std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
  };
  constexpr double kFloor = 0.02;  // N, RMS of the smallest oscillation that counts
  constexpr double kOfStep = 0.3;  // of the force of one step of the position, which may come and go once
  const std::span<const double> all(fast);
  const double early = rms(all.first(all.size() / 3));
  const double late = rms(all.last(all.size() / 3));
  const bool lasts = late > 0.9 * early && late > std::max(kFloor, kOfStep * stiffness * resolution);
  return lasts ? WallResult::kOscillates : WallResult::kStable;
}

void test_walls(HeldPlay& play, const DeviceTestSettings& settings, DeviceTest& found) {
  constexpr double kFactor = 1.15;
  constexpr int kHalvings = 2;
  const double resolution = found.resolution.value_or(0.0);
  int halvings = 0;
  double stiffness = settings.least_stiffness;
  for (;;) {
    WallResult result = try_wall(play, settings, stiffness, resolution);
    // Once more: a jerk of the hand is no oscillation.
    if (result == WallResult::kOscillates) result = try_wall(play, settings, stiffness, resolution);
    if (result == WallResult::kFailed) return;
    if (result == WallResult::kNoContact) {
      found.unknown.emplace_back("largest stable stiffness: the hand gave way to the wall of " +
                                 brief(stiffness) + " N/m; hold the grip in one place");
      return;
    }
    if (result == WallResult::kStable) {
      found.largest_stable = stiffness;
    } else {
      found.least_oscillating = stiffness;
      if (!found.largest_stable) return;
    }
    if (found.least_oscillating) {
      if (halvings++ == kHalvings) return;
      stiffness = std::sqrt(*found.largest_stable * *found.least_oscillating);
    } else {
      if (stiffness >= settings.max_stiffness) return;
      stiffness = std::min(stiffness * kFactor, settings.max_stiffness);
    }
  }
}

void add_unknown(DeviceTest& found) {
  found.unknown.emplace_back(
      "true force: without a force sensor nothing shows how many newtons reach the hand; masses and friction "
      "take the commanded force as true");
  found.unknown.emplace_back(
      "position accuracy: without a ruler only the step and the noise of the position are known");
  found.unknown.emplace_back(
      "parts of the latency: only the whole way is seen, from the written force to the sample that shows it");
}

}  // namespace

DeviceTest test_device(HeldPlay& play, const DeviceTestSettings& settings, const Instruct& instruct) {
  DeviceTest found;
  const auto run = [&]() {
    if (!instruct("rest, 5 s", "Lay the grip down, or rest your hand on the table, and do not move.")) return;
    constexpr double kRest = 5.0;  // s
    const auto rest = play.play(kRest, [](const PlayedTick&) { return Vec3::Zero().eval(); });
    if (rest.empty()) return;
    judge_rest(rest, found);
    if (!instruct(
            "slow pushes, 40 s",
            "Rest your hand on the table and hold the grip loosely. It moves slowly to and fro: let it, "
            "neither help nor resist.") ||
        !test_friction(play, settings, found)) {
      return;
    }
    if (!instruct("force steps, 20 s",
                  "Hold the grip lightly, as a pen. It is pushed 16 times: let it move.") ||
        !test_steps(play, settings, found)) {
      return;
    }
    if (!instruct(
            "virtual wall, 1 to 2 min",
            "Hold the grip lightly in one place. A wall pushes against it, again and again, stiffer each "
            "time, until it trembles. Let go at any time: a runaway switches the force off.")) {
      return;
    }
    test_walls(play, settings, found);
  };
  run();
  found.failure = play.failure();
  add_unknown(found);
  return found;
}

}  // namespace palpate::devices
