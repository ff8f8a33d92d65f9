#include "study/session/compare_recording.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"

#include "study/session/interval_meter.h"

namespace palpate::study {
namespace {

using haptics::ParameterUpdate;

/// Goes through the trials and the stimuli of one recording in their order.
class BlockComparison final {
 public:
  BlockComparison(const Study& study, const record::Recording& recording)
      : study_(study), recording_(recording) {
    for (const ParameterUpdate& change : recording.changes) {
      if ((change.what & haptics::kStimulusChanged) != 0 && change.stimulus.interval > 0) {
        stimuli_.push_back(&change);
      }
    }
  }

  std::string compare(std::span<const ReplayedTrial> trials) {
    for (std::size_t i = 0; i < trials.size(); ++i) {
      trial_ = &trials[i];
      last_trial_ = i + 1 == trials.size();
      const std::string defect = compare_trial();
      if (!defect.empty()) {
        return fmt::format("trial {} of task {} in the log: {}", trial_->logged.number,
                           excerpt(trial_->logged.task), defect);
      }
    }
    // A trial that was running when the block was stopped is not in the log.
    if (next_ + 2 < stimuli_.size()) return at(stimuli_[next_]) + ", which no trial of the log has";
    return "";
  }

 private:
  static std::string at(const ParameterUpdate* stimulus) {
    return fmt::format("the recording has a stimulus at tick {}", stimulus->tick);
  }
  [[nodiscard]] std::uint64_t ticks(double seconds) const {
    return static_cast<std::uint64_t>(std::llround(seconds * recording_.scene.rate_Hz));
  }
  [[nodiscard]] const StudyTask& task() const { return study_.tasks[trial_->planned.task]; }
  [[nodiscard]] bool signal_in(std::size_t interval) const {
    return interval == (trial_->planned.second ? 1U : 0U);
  }

  std::string compare_trial() {
    for (std::size_t i = 0; i < 2; ++i) {
      const IntervalCues& cues = trial_->logged.intervals[i];
      if (cues.from_tick == 0) continue;  // the interval was not reached
      const std::string defect = compare_interval(i, cues);
      if (!defect.empty()) return fmt::format("interval {}: {}", i + 1, defect);
    }
    if (!trial_->logged.spoiled.empty()) return "";
    const std::size_t last = task().two_intervals() ? 1 : 0;
    if (trial_->logged.intervals[last].to_tick == 0) return "has no ticks";
    if (!trial_->logged.observer.empty()) return "";  // its response time is drawn
    const double answered = trial_->logged.response_time * recording_.scene.rate_Hz;
    if (answered > static_cast<double>(recording_.rows.size() - trial_->logged.intervals[last].to_tick)) {
      return "was answered after the end of the recording";
    }
    return "";
  }

  std::string compare_interval(std::size_t interval, const IntervalCues& cues) {
    const bool spoiled = !trial_->logged.spoiled.empty();
    if (cues.from_tick < last_tick_) return "begins before the interval in the line before it ends";
    // A fault may end the run before the interval begins.
    if (next_ == stimuli_.size() && spoiled && last_trial_) return "";
    constexpr std::uint64_t kMaxWaiting = 4;  // ticks: one update is taken a tick
    const std::uint64_t due = cues.from_tick - std::min(cues.from_tick, ticks(kFade));
    const bool found = next_ < stimuli_.size() && stimuli_[next_]->stimulus.interval == interval + 1 &&
                       stimuli_[next_]->tick >= due &&
                       (spoiled || stimuli_[next_]->tick <= due + kMaxWaiting);
    if (!found) {
      return fmt::format("must have a stimulus at tick {}, {}", due,
                         next_ < stimuli_.size() ? at(stimuli_[next_]) : "the recording has no more");
    }
    const ParameterUpdate& stimulus = *stimuli_[next_++];
    last_tick_ = std::max(cues.from_tick, cues.to_tick);
    if (spoiled) return "";
    if (cues.to_tick <= cues.from_tick || cues.to_tick > recording_.rows.size()) {
      return fmt::format("ticks {} to {} are not in the recording", cues.from_tick, cues.to_tick);
    }
    const std::string defect = compare_commanded(interval, cues.from_tick, stimulus);
    return defect.empty() ? compare_cues(cues) : defect;
  }

  /// Noise, force and tissue that the recording says were commanded.
  [[nodiscard]] std::string compare_commanded(std::size_t interval, std::uint64_t tick,
                                              const ParameterUpdate& stimulus) const {
    const Trial& planned = trial_->planned;
    const IntervalStimulus must = stimulus_of(task(), planned.level, signal_in(interval));
    haptics::LiveNoise noise;
    noise.enabled = recording_.scene.noise.enabled;
    model::TissueNumbers tissue = recording_.scene.tissue;
    double ratio = 1.0;
    for (const ParameterUpdate& change : recording_.changes) {
      if (change.tick > tick) break;
      noise = change.noise;
      tissue = change.tissue;
      if ((change.what & haptics::kInclusionChanged) != 0) ratio = change.inclusion.ratio;
    }
    const bool noisy = planned.noise > 0.0 && must.noise;
    if (noise.enabled != noisy) return noisy ? "has no noise" : "has noise, must have none";
    if (noisy && noise.gain != planned.noise * noise.threshold) return "has another noise than planned";
    if (stimulus.stimulus.force != must.force) return "has another commanded force than planned";
    model::TissueNumbers planned_tissue = tissue;
    must.tissue.apply_to(planned_tissue);
    if (tissue != planned_tissue) return "has another stiffness than planned";
    if (ratio != must.tissue.inclusion.value_or(ratio)) {
      return "has an inclusion of another stiffness than planned";
    }
    return "";
  }

  [[nodiscard]] std::string compare_cues(const IntervalCues& logged) const {
    const bool hold = !task().two_intervals();
    IntervalMeter meter;
    for (std::uint64_t tick = logged.from_tick; tick < logged.to_tick; ++tick) {
      const haptics::TickRow& row = recording_.rows[tick];
      if (row.tick != tick) return fmt::format("row {} of the recording is of tick {}", tick, row.tick);
      meter.add(row, !hold || tick >= logged.from_tick + ticks(kSettle), trial_->planned.level);
    }
    IntervalCues measured = meter.cues();
    measured.from_tick = logged.from_tick;
    measured.to_tick = logged.to_tick;
    const bool same = measured == logged && (!hold || (meter.rms_error() == trial_->logged.rms_error &&
                                                       meter.variation() == trial_->logged.variation));
    return same ? "" : "peak, mean, depth, work or error do not follow from the rows of the recording";
  }

  const Study& study_;
  const record::Recording& recording_;
  std::vector<const ParameterUpdate*> stimuli_;  // that begin an interval
  std::size_t next_ = 0;                         // stimulus
  const ReplayedTrial* trial_ = nullptr;
  bool last_trial_ = false;
  std::uint64_t last_tick_ = 0;  // of the interval before
};

}  // namespace

std::string compare_with_recording(const Study& study, std::span<const ReplayedTrial> trials,
                                   const record::Recording& recording) {
  return BlockComparison(study, recording).compare(trials);
}

}  // namespace palpate::study
