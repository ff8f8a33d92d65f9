#include "study/session/observer_hand.h"

#include <algorithm>
#include <cmath>

namespace palpate::study {
namespace {

constexpr std::uint64_t kSamplesSeed = 0x7361'6d70'6c65;  // of the internal noise
constexpr double kFirstSample = 90e-3;  // s after the interval's first tick: the fade, and half a spacing

const scene::PathRow& deepest_row(const scene::ToolPath& path) {
  const scene::PathRow& start = path.rows().front();
  return *std::max_element(path.rows().begin(), path.rows().end(), [&](const auto& a, const auto& b) {
    return (a.position - start.position).norm() < (b.position - start.position).norm();
  });
}

devices::HandMassParameters firm_hand() {
  devices::HandMassParameters parameters;
  parameters.grip_stiffness = scene::kFirmGrip.stiffness;
  parameters.grip_damping = scene::kFirmGrip.damping;
  return parameters;
}

// Samples above T with the own noise; the number of an interval.
int above_threshold(const SimulatedPerson& person, const std::vector<double>& samples, Random& random) {
  int count = 0;
  for (const double force : samples) {
    const double seen = force / person.force_unit + person.observer.internal_noise * random.normal();
    count += seen > 1.0 ? 1 : 0;
  }
  return count;
}

}  // namespace

ObserverHand::ObserverHand(const scene::Scene& scene)
    : ObserverHand(scene::default_path(scene, 0), 1.0 / scene.rate_Hz) {}

ObserverHand::ObserverHand(const scene::ToolPath& path, double period)
    : start_(path.rows().front().position),
      line_(deepest_row(path).position - start_),
      target_(path.rows().front(), period),
      hand_(firm_hand(), start_),
      period_(period),
      gripper_(path.rows().front().gripper) {}

haptics::DeviceState ObserverHand::read(std::uint64_t /*tick*/, double /*time*/) noexcept {
  const Vec3 from = target_.position();
  target_.advance(start_ + wanted_.load(std::memory_order_relaxed) * line_, gripper_);
  const Vec3 force = stopped_.load(std::memory_order_relaxed) ? Vec3::Zero() : force_;
  hand_.advance(from, target_.position(), force, period_);
  haptics::DeviceState state = target_.state();
  state.position_D = hand_.position();
  state.velocity_D = hand_.velocity();
  return state;
}

bool ObserverHand::write(const haptics::ForceCommand& command_D) noexcept {
  force_ = command_D.force;
  stopped_.store(false, std::memory_order_relaxed);
  return true;
}

void ObserverAgent::begin(Random random) {
  random_ = random;
  samples_ = {};
  place_ = 0.0;
  pressed_ = false;
  searched_ = false;
  last_state_ = TrialState::kIdle;
}

// White noise through two low-pass filters, with the standard deviation kTremor.
double ObserverAgent::next_tremor() noexcept {
  constexpr double kTremor = 0.2e-3;  // m; about 5 % of a force of 1 N
  constexpr double kTime = 80e-3;     // s, of each filter
  const double share = 1.0 / (kTime * rate_Hz_);
  tremor_[0] += share * (2.0 * kTremor / std::sqrt(share) * random_.normal() - tremor_[0]);
  tremor_[1] += share * (tremor_[0] - tremor_[1]);
  return tremor_[1];
}

void ObserverAgent::follow_force(double wanted, double force) noexcept {
  constexpr double kSpeed = 0.02;  // m/s, in air
  constexpr double kGain = 0.01;   // m/s for each newton of error, in contact
  const double speed = force <= 0.0 ? kSpeed : std::clamp(kGain * (wanted - force), -kSpeed, kSpeed);
  place_ = std::clamp(place_ + speed / rate_Hz_ / hand_.length(), 0.0, 1.2);
}

void ObserverAgent::row(const haptics::TickRow& row, const TrialLoop& loop, const Study& study) {
  const TrialView& view = loop.view();
  const StudyTask& task = study.tasks[loop.trial().task];
  if (view.state == TrialState::kInterval && last_state_ != TrialState::kInterval) {
    interval_began_ = row.tick;
    pressed_ = false;
    searched_ = false;
  }
  last_state_ = view.state;
  switch (view.state) {
    case TrialState::kReach:
      follow_force(0.5 * (view.low + view.high), row.tissue_force);
      break;
    case TrialState::kInterval:
      if (task.leaves_tissue()) {
        const double depth = task.hand() == HandAction::kPress && task.depth > 0.0 ? task.depth : 8e-3;
        pressed_ = pressed_ || row.depth >= 1.02 * depth;
        const double speed = (pressed_ ? -0.04 : 0.02) / rate_Hz_ / hand_.length();
        place_ = std::clamp(place_ + speed, 0.0, 2.0);
        searched_ = task.hand() == HandAction::kSearch && pressed_ && row.depth <= 0.0;
      } else if (task.free) {
        place_ = 0.0;
      } else {
        follow_force(0.5 * (view.low + view.high), row.tissue_force);
      }
      break;
    case TrialState::kGap:
      if (task.leaves_tissue()) place_ = 0.0;
      break;
    case TrialState::kIdle:
    case TrialState::kHome:
    case TrialState::kAnswer:
    case TrialState::kFinished:
      place_ = 0.0;
      break;
  }
  const double tremor = next_tremor();
  hand_.move_to(place_ > 0.0 ? place_ + tremor / hand_.length() : place_);
  if (view.state != TrialState::kInterval || view.interval < 1) return;
  std::vector<double>& samples = samples_[static_cast<std::size_t>(view.interval - 1)];
  const double since = static_cast<double>(row.tick - interval_began_) / rate_Hz_;
  if (samples.size() < kSamples && since >= kFirstSample + kSpacing * static_cast<double>(samples.size())) {
    double along = 0.0;
    for (std::size_t i = 0; i < 3; ++i) along += row.force[i] * row.normal[i];
    const double tissue = row.tissue_force * row.tissue_force - row.friction * row.friction;
    samples.push_back(along - std::sqrt(std::max(tissue, 0.0)));
  }
}

void answer_by_force(const Study& study, SimulatedPerson& person, const Trial& trial,
                     const std::array<std::vector<double>, 2>& samples, double progress,
                     std::uint32_t participant, TrialRecord& record) {
  const StudyTask& task = study.tasks[trial.task];
  const bool detects = task.stimulus() == Stimulus::kForce || task.stimulus() == Stimulus::kNoise;
  const std::array<IntervalCues, 2> measured = record.intervals;
  const double rms_error = record.rms_error;
  const double variation = record.variation;
  Trial seen = trial;
  if (task.comparison()) {
    const std::size_t comparison = trial.second ? 1 : 0;
    const auto stiffness = [&](std::size_t i) {
      return measured[i].peak_force / std::max(measured[i].depth, 1e-6);
    };
    seen.level = std::log(stiffness(comparison) / stiffness(1 - comparison));
  }
  answer_by_formula(study, person, seen, progress, study.seed, participant, record);
  record.intervals = measured;
  record.rms_error = rms_error;
  record.variation = variation;
  if (!detects || person.observer.kind != psychophysics::Observer::Kind::kThreshold) return;
  Random random(study.seed ^ kSamplesSeed, participant, trial.draw);
  const int first = above_threshold(person, samples[0], random);
  const int second = above_threshold(person, samples[1], random);
  const bool coin = random.uniform() < 0.5;
  record.answer = first == second ? (coin ? 1 : 2) : (second > first ? 2 : 1);
  record.counted = counted_answer(trial, record.answer);
}

}  // namespace palpate::study
