#include "study/session/trial_loop.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/haptics/gate.h"
#include "palpate/device.h"

namespace palpate::study {
namespace {

constexpr double kStill = 5e-3;      // m/s, speed of a hand that holds still
constexpr double kInBand = 0.3;      // s, in the force band before an interval
constexpr double kReachTime = 15.0;  // s, longest wait for the force band, a press or the tool outside
constexpr double kShowTarget = 2.0;  // s, kForceControl: with the bar
constexpr double kHoldTime = 6.0;    // s, kForceControl: without it
constexpr double kGiven = 0.99;      // of a commanded force that the energy limit left
constexpr double kLateTick = 5e-3;   // s
constexpr std::uint32_t kPlacePart = 0x7200'0000;  // of the random numbers: place of an inclusion

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

bool in_contact(const haptics::TickRow& row) { return row.depth > 0.0; }

}  // namespace

const char* describe(TrialState state) noexcept {
  switch (state) {
    case TrialState::kIdle:
      return "wait";
    case TrialState::kHome:
      return "rest";
    case TrialState::kReach:
      return "press";
    case TrialState::kInterval:
      return "interval";
    case TrialState::kGap:
      return "pause";
    case TrialState::kAnswer:
      return "answer";
    case TrialState::kFinished:
      return "done";
  }
  return "";
}

TrialLoop::TrialLoop(const Study& study, TrialScene scene, haptics::ParameterUpdates& updates)
    : study_(study), scene_(std::move(scene)), updates_(updates) {}

std::uint64_t TrialLoop::ticks(double seconds) const noexcept {
  return static_cast<std::uint64_t>(std::llround(seconds * scene_.rate_Hz));
}

void TrialLoop::begin(const Trial& trial) {
  trial_ = trial;
  spoiled_.clear();
  measured_ = {};
  answer_ = 0;
  answered_ = 0;
  view_.interval = 0;
  view_.deep_enough = false;
  still_since_ = view_.tick;
  enter(TrialState::kHome, view_.tick);
}

void TrialLoop::enter(TrialState state, std::uint64_t tick) {
  view_.state = state;
  since_ = tick;
  view_.bar = state == TrialState::kReach && !task().leaves_tissue();
  view_.low = task().band_low;
  view_.high = task().band_high;
  if (!task().two_intervals()) {
    view_.low = 0.9 * trial_.level;
    view_.high = 1.1 * trial_.level;
  }
}

void TrialLoop::spoil(const std::string& reason) {
  if (std::find(spoiled_.begin(), spoiled_.end(), reason) == spoiled_.end()) spoiled_.push_back(reason);
}

void TrialLoop::abandon(const std::string& reason) {
  if (view_.state == TrialState::kIdle || finished()) return;
  spoil(reason);
  finish(view_.tick);
}

void TrialLoop::finish(std::uint64_t tick) {
  if (view_.state == TrialState::kInterval) end_interval(tick);
  if (answer_ == 0 && measured_[0].from_tick != 0) mark(MarkerCode::kNoAnswer, tick);
  view_.interval = 0;
  enter(TrialState::kFinished, tick);
}

void TrialLoop::switch_noise(bool on, std::uint64_t tick) {
  if (trial_.noise <= 0.0 || !stimulus_.noise) return;
  haptics::LiveNoise noise;
  noise.enabled = on;
  const Arm& arm = task().arms[trial_.arm];
  const bool near = arm.profile == NoiseProfile::kProximity;
  noise.threshold = near ? arm.d0 : kFarAway;
  noise.gain = trial_.noise * noise.threshold;
  updates_.offer(noise, tick);
  noise_on_ = on;
  noise_since_ = tick;
}

void TrialLoop::limit_noise(std::uint64_t tick) {
  if (noise_on_ && tick + scene_.lead >= noise_since_ + ticks(study_.max_continuous_noise)) {
    switch_noise(false, tick + scene_.lead);
    noise_again_ = tick + ticks(kNoisePause);
  } else if (noise_again_ != 0 && tick >= noise_again_) {
    switch_noise(true, tick + scene_.lead);
    noise_again_ = 0;
  }
}

void TrialLoop::begin_interval(std::uint64_t tick) {
  const std::uint64_t at = tick + scene_.lead;
  ++view_.interval;
  stimulus_ = stimulus_of(task(), trial_.level, signal_in(view_.interval));
  set_tissue(at);
  haptics::LiveStimulus stimulus;
  stimulus.interval = static_cast<std::uint32_t>(view_.interval);
  stimulus.ramp = kFade;
  stimulus.force = stimulus_.force;
  updates_.offer(stimulus, at);  // first, so that its tick does not depend on the noise
  switch_noise(true, at);
  begins_ = at + ticks(kFade);
  ends_ = begins_ + ticks(task().interval);
  if (!task().two_intervals()) ends_ = begins_ + ticks(kHoldTime);
  if (task().leaves_tissue()) {
    ends_ = begins_ + ticks(task().hand() == HandAction::kSearch ? task().search_time : kReachTime);
  }
  Measured& measured = measured_[static_cast<std::size_t>(view_.interval - 1)];
  measured.from_tick = begins_;
  mark(view_.interval == 1 ? MarkerCode::kFirstInterval : MarkerCode::kSecondInterval, begins_);
  enter(TrialState::kInterval, tick);
}

void TrialLoop::end_interval(std::uint64_t tick) {
  const std::uint64_t at = tick + scene_.lead;
  haptics::LiveStimulus stimulus;
  stimulus.ramp = kFade;
  updates_.offer(stimulus, at);
  if (noise_on_) switch_noise(false, at);
  noise_again_ = 0;
  Measured& measured = measured_[static_cast<std::size_t>(view_.interval - 1)];
  measured.to_tick = tick + 1;
  view_.deep_enough = false;
}

// The tissue of the interval that begins. The tool is outside.
void TrialLoop::set_tissue(std::uint64_t at) {
  model::TissueParameters tissue = scene_.tissue;
  if (stimulus_.tissue.apply_to(tissue)) updates_.offer(tissue, at);
  if (stimulus_.tissue.inclusion && !scene_.lumps.empty()) {
    // The place is drawn for each trial, the same in both intervals.
    Random random(study_.seed, trial_.draw, kPlacePart);
    const model::Inclusion& place = scene_.lumps[random.below(scene_.lumps.size())];
    haptics::LiveInclusion lump;
    for (std::size_t i = 0; i < 3; ++i) lump.centre_S[i] = place.centre_S[static_cast<Eigen::Index>(i)];
    lump.ratio = *stimulus_.tissue.inclusion;
    updates_.offer(lump, at);
  }
}

void TrialLoop::row(const haptics::TickRow& row) {
  view_.tick = row.tick;
  view_.force = row.tissue_force;
  view_.fault = row.fault;
  if (!rest_) {
    rest_ = row.tool;
    last_position_ = row.tool;
  }
  if (row.fault != 0 && view_.state != TrialState::kIdle && !finished()) {
    abandon("fault");
  }
  switch (view_.state) {
    case TrialState::kHome:
      home(row);
      break;
    case TrialState::kReach:
      reach(row);
      break;
    case TrialState::kInterval:
      interval(row);
      break;
    case TrialState::kGap:
      gap(row);
      break;
    case TrialState::kAnswer:
      await_answer(row);
      break;
    case TrialState::kIdle:
    case TrialState::kFinished:
      break;
  }
  last_position_ = row.tool;
}

void TrialLoop::home(const haptics::TickRow& row) {
  const double speed = distance(row.tool, last_position_) * scene_.rate_Hz;
  const bool there = distance(row.tool, *rest_) <= study_.homing_radius && speed <= kStill &&
                     !in_contact(row) && row.engagement >= 1.0;
  if (!there) still_since_ = row.tick;
  if (row.tick < still_since_ + ticks(study_.homing_still)) return;
  if (task().leaves_tissue() || task().free) {
    begin_interval(row.tick);
  } else {
    still_since_ = row.tick;
    enter(TrialState::kReach, row.tick);
  }
}

void TrialLoop::reach(const haptics::TickRow& row) {
  const bool control = !task().two_intervals();
  const bool inside = row.tissue_force >= view_.low && row.tissue_force <= view_.high;
  // Force control: the bar is shown for a time from the first contact on, wherever the force is.
  if (control ? !in_contact(row) : !inside) still_since_ = row.tick;
  if (row.tick >= still_since_ + ticks(control ? kShowTarget : kInBand)) {
    begin_interval(row.tick);
  } else if (row.tick >= since_ + ticks(kReachTime)) {
    spoil("the force was not reached");
    finish(row.tick);
  }
}

void TrialLoop::measure(const haptics::TickRow& row) {
  const bool settled = task().two_intervals() || row.tick >= begins_ + ticks(kSettle);
  measured_[static_cast<std::size_t>(view_.interval - 1)].meter.add(row, settled, trial_.level);
}

void TrialLoop::check(const haptics::TickRow& row) {
  const bool band = !task().leaves_tissue() && !task().free && task().two_intervals();
  if (band && (row.tissue_force < task().band_low || row.tissue_force > task().band_high)) {
    spoil("the force left the band");
  }
  if (stimulus_.force > 0.0 && row.stimulus_force < kGiven * stimulus_.force)
    spoil("the extra force was lowered");
  if ((row.status & haptics::kForceClamped) != 0) spoil("the force was clamped");
  if ((row.status & haptics::kForceSlewed) != 0) spoil("the force's change was limited");
  if ((row.status & haptics::kEnergyDamped) != 0) spoil("the passivity controller acted");
  if (static_cast<double>(row.late_ns) > kLateTick * 1e9) spoil("a tick was late");
}

void TrialLoop::interval(const haptics::TickRow& row) {
  limit_noise(row.tick);
  const bool first = row.tick + ticks(kFade) == begins_;
  if (first && (row.events & haptics::kParameterUpdated) == 0) spoil("the stimulus began late");
  if (row.tick < begins_) return;
  measure(row);
  check(row);
  bool over = row.tick + 1 >= ends_;
  if (task().leaves_tissue()) {
    const IntervalMeter& now = measured_[static_cast<std::size_t>(view_.interval - 1)].meter;
    const bool press = task().hand() == HandAction::kPress;
    view_.deep_enough = press && task().depth > 0.0 && now.depth() >= task().depth;
    const bool pressed = now.touched() && (task().depth <= 0.0 || !press || now.depth() >= task().depth);
    if (press && over && !pressed) spoil("the depth was not reached");
    const bool out = pressed && !in_contact(row);
    over = over || (press && out);
  }
  if (!over) return;
  if (!task().two_intervals()) {
    finish(row.tick);
    return;
  }
  end_interval(row.tick);
  if (view_.interval == 1) {
    still_since_ = row.tick;
    enter(TrialState::kGap, row.tick);
  } else {
    enter(TrialState::kAnswer, row.tick);
  }
}

// A second press begins with the tool outside, so that the tissue can change.
void TrialLoop::gap(const haptics::TickRow& row) {
  const std::uint64_t begins = since_ + ticks(std::max(task().gap, 2.0 * kFade));
  if (!task().leaves_tissue()) {
    if (row.tick >= begins) begin_interval(row.tick);
    return;
  }
  if (in_contact(row)) still_since_ = row.tick;
  if (row.tick >= begins && row.tick >= still_since_ + ticks(0.2)) {
    begin_interval(row.tick);
  } else if (row.tick >= since_ + ticks(kReachTime)) {
    spoil("the tool was not taken out");
    finish(row.tick);
  }
}

void TrialLoop::await_answer(const haptics::TickRow& row) {
  if (answer_ != 0) {
    if (answered_ == 0) answered_ = row.tick;
    finish(row.tick);
  } else if (row.tick >= since_ + ticks(study_.timeout)) {
    spoil("no answer in time");
    finish(row.tick);
  }
}

void TrialLoop::answer(int interval) {
  if (view_.state == TrialState::kInterval || view_.state == TrialState::kGap) {
    spoil("answered too early");
  } else if (view_.state == TrialState::kAnswer && answer_ == 0) {
    answer_ = interval;
    answered_ = view_.tick;
    mark(interval == 1 ? MarkerCode::kFirstAnswer : MarkerCode::kSecondAnswer, answered_);
  }
}

void TrialLoop::next() {
  if (view_.state != TrialState::kInterval || task().hand() != HandAction::kSearch) return;
  if (measured_[static_cast<std::size_t>(view_.interval - 1)].meter.touched())
    ends_ = std::min(ends_, view_.tick + 1);
}

void TrialLoop::fill_in(TrialRecord& record) const {
  record.spoiled = spoiled_;
  record.answer = answer_;
  record.counted = answer_ != 0 && counted_answer(trial_, answer_);
  const std::uint64_t end = measured_[1].to_tick;
  if (answer_ != 0 && answered_ > end)
    record.response_time = static_cast<double>(answered_ - end) / scene_.rate_Hz;
  for (std::size_t i = 0; i < 2; ++i) {
    record.intervals[i] = measured_[i].meter.cues();
    record.intervals[i].from_tick = measured_[i].from_tick;
    record.intervals[i].to_tick = measured_[i].to_tick;
  }
  if (task().two_intervals()) return;
  record.rms_error = measured_[0].meter.rms_error();
  record.variation = measured_[0].meter.variation();
}

}  // namespace palpate::study
