#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "palpate/session.h"

#include "study/session/observer_hand.h"
#include "study/session/simulated_person.h"
#include "study/session/test/small_study.h"
#include "study/session/trial_loop.h"

namespace palpate::study {
namespace {

constexpr double kSignal = 0.3783249292;        // of the observer's threshold: 65 % correct without noise
constexpr double kOwnThreshold = 0.5817562888;  // own noise threshold, in the same unit

/// Runs trials in one offline run and keeps what was rendered.
class RenderedTrials final : public haptics::TickObserver {
 public:
  RenderedTrials(const Study& study, const std::vector<Trial>& trials, SimulatedPerson person)
      : study_(study), trials_(trials), person_(std::move(person)) {}

  void run() {
    scene::Overrides request;
    request.organ = "gallbladder";
    scene::Scene scene = scene::load(request);
    scene.noise.enabled = false;
    TrialScene trial_scene;
    trial_scene.tissue = scene.tissue;
    session::SessionOptions options;
    options.duration_s = 1e6;
    auto hand = std::make_unique<ObserverHand>(scene);
    ObserverHand& moved = *hand;
    options.devices.push_back(std::move(hand));
    session_ = std::make_unique<session::Session>(std::move(scene), std::move(options));
    loop_ = std::make_unique<TrialLoop>(study_, trial_scene, session_->updates());
    agent_ = std::make_unique<ObserverAgent>(moved, 1000.0);
    session_->run({.offline = true}, {this});
  }

  void on_row(const haptics::TickRow& row) noexcept override {
    if (records.size() == trials_.size()) {
      rows.push_back(row);
      if (rows.size() >= rows_after) session_->control().stop();
      return;
    }
    if (loop_->view().state == TrialState::kIdle) begin();
    loop_->row(row);
    if (loop_->view().interval == 2 && loop_->view().state == TrialState::kInterval &&
        ++in_second_ == abandon_after)
      loop_->abandon("a person's fault");
    agent_->row(row, *loop_, study_);
    if (loop_->view().state == TrialState::kAnswer) loop_->answer(1);
    rows.push_back(row);
    if (!loop_->finished()) return;
    TrialRecord record = record_of(study_, loop_->trial(), 1, 1);
    loop_->fill_in(record);
    answer_by_force(study_, person_, loop_->trial(), agent_->samples(), 0.0, 0, record);
    add_noise(record);
    records.push_back(record);
    rows.clear();
    if (records.size() < trials_.size()) {
      begin();
    } else if (rows_after == 0) {
      session_->control().stop();
    }
  }

  std::vector<TrialRecord> records;
  std::vector<haptics::TickRow> rows;  // of the present trial; at the end, those after the last one
  int abandon_after = 0;               // ticks of the second interval; 0: never
  std::size_t rows_after = 0;
  double noise_square = 0.0;  // sum over the intervals' ticks
  std::uint64_t noise_ticks = 0;
  std::vector<std::uint32_t> events;

 private:
  void begin() {
    loop_->begin(trials_[records.size()]);
    agent_->begin(Random(7, 0, trials_[records.size()].draw));
  }
  void add_noise(const TrialRecord& record) {
    for (const haptics::TickRow& row : rows) {
      for (const IntervalCues& interval : record.intervals) {
        if (row.tick < interval.from_tick || row.tick >= interval.to_tick) continue;
        noise_square += row.noise_force * row.noise_force;
        ++noise_ticks;
      }
    }
  }

  int in_second_ = 0;
  const Study& study_;
  const std::vector<Trial>& trials_;
  SimulatedPerson person_;
  std::unique_ptr<session::Session> session_;
  std::unique_ptr<TrialLoop> loop_;
  std::unique_ptr<ObserverAgent> agent_;
};

Study study_with(const char* task) {
  Study study = small_study();
  study.tasks = {study.tasks[study.find_task(task).value()]};
  return study;
}

SimulatedPerson reference_person() {
  SimulatedPerson person = make_person("sr", 1, 0);
  person.force_unit = 0.05;
  person.lapse = 0.0;
  return person;
}

// Trials of a force of kSignal thresholds with noise of a share of the own noise threshold.
std::vector<Trial> force_trials(const SimulatedPerson& person, double share, int count) {
  std::vector<Trial> trials(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < trials.size(); ++i) {
    trials[i].level = std::log10(kSignal * person.force_unit);
    trials[i].noise = share * kOwnThreshold * person.force_unit;
    trials[i].second = i % 2 == 1;
    trials[i].draw = static_cast<std::uint32_t>(i);
  }
  return trials;
}

// Figure 15: 2,000 trials a level with PALPATE_STUDY_TABLE, else 60 and four standard errors.
TEST(Rendered, TheReferenceObserverFeelsWhatItsFormulaSays) {
  const bool all = std::getenv("PALPATE_STUDY_TABLE") != nullptr;
  const int count = all ? 2000 : 60;
  const Study study = study_with("weak-force");
  const SimulatedPerson person = reference_person();
  for (const double share : {0.0, 0.3, 0.6, 0.9, 1.5, 2.5}) {
    if (!all && (share == 0.3 || share == 0.9 || share == 1.5)) continue;
    const std::vector<Trial> trials = force_trials(person, share, count);
    RenderedTrials rendered(study, trials, person);
    rendered.run();
    int correct = 0;
    int spoiled = 0;
    for (const TrialRecord& record : rendered.records) {
      correct += record.counted ? 1 : 0;
      spoiled += record.spoiled.empty() ? 0 : 1;
    }
    const double exact =
        psychophysics::probability_second(person.observer, {kSignal, share * kOwnThreshold, true});
    const double reached = static_cast<double>(correct) / count;
    const double bound = all ? 0.035 : 4.0 * std::sqrt(exact * (1.0 - exact) / count);
    EXPECT_NEAR(reached, exact, bound) << share;
    EXPECT_LE(spoiled, count / 20) << share;
    const double sigma = std::sqrt(rendered.noise_square / static_cast<double>(rendered.noise_ticks));
    if (share > 0.0) {
      EXPECT_NEAR(sigma / trials[0].noise, 1.0, all ? 0.02 : 0.04) << share;
    }
    if (all) {
      std::cout << "share " << share << ": correct " << reached << ", exact " << exact << "; sigma "
                << (share > 0.0 ? sigma / trials[0].noise : 0.0) << " of what was set; spoiled " << spoiled
                << '\n';
    }
  }
}

TEST(Rendered, NoiseAndForceEndWhenATrialIsAbandonedInItsInterval) {
  const Study study = study_with("weak-force");
  const SimulatedPerson person = reference_person();
  std::vector<Trial> trials = force_trials(person, 2.5, 1);
  trials[0].second = true;
  RenderedTrials rendered(study, trials, person);
  rendered.abandon_after = 400;
  rendered.rows_after = 300;
  rendered.run();
  ASSERT_EQ(rendered.records.size(), 1U);
  EXPECT_EQ(rendered.records[0].spoiled, (std::vector<std::string>{"a person's fault"}));
  ASSERT_EQ(rendered.rows.size(), 300U);
  EXPECT_NE(rendered.rows[0].stimulus_force, 0.0);
  for (const haptics::TickRow& row : rendered.rows) {
    if (row.tick < rendered.rows[0].tick + 100) continue;  // the fade takes 50
    EXPECT_EQ(row.noise_force, 0.0) << row.tick;
    EXPECT_EQ(row.stimulus_force, 0.0) << row.tick;
  }
}

// Area under the ROC curve of scores for noise.
double area(const std::vector<double>& scores, const std::vector<Trial>& trials) {
  double wins = 0.0;
  double pairs = 0.0;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    for (std::size_t j = 0; j < scores.size(); ++j) {
      if (!(trials[i].noise > 0.0 && trials[j].noise == 0.0)) continue;
      pairs += 1.0;
      wins += scores[i] > scores[j] ? 1.0 : scores[i] == scores[j] ? 0.5 : 0.0;
    }
  }
  return wins / pairs;
}

// Distance of each value to the nearest other one of a trial of the same order: 0 where a trial repeats
// itself.
std::vector<double> to_nearest(const std::vector<double>& values, const std::vector<Trial>& trials) {
  std::vector<double> nearest(values.size(), 1e9);
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = 0; j < values.size(); ++j) {
      if (i != j && trials[i].second == trials[j].second)
        nearest[i] = std::min(nearest[i], std::abs(values[i] - values[j]));
    }
  }
  return nearest;
}

// Numbers of a trial's line of the log that could follow the noise.
std::vector<double> numbers_of(const TrialRecord& record) {
  std::vector<double> numbers = {record.response_time, record.spoiled.empty() ? 0.0 : 1.0};
  for (const IntervalCues& cues : record.intervals) {
    for (const double number : {cues.peak_force, cues.mean_force, cues.depth, cues.work,
                                static_cast<double>(cues.to_tick - cues.from_tick)}) {
      numbers.push_back(number);
    }
  }
  return numbers;
}

// Figure 17: 2,000 trials and 0.05 with PALPATE_STUDY_TABLE, else 100 and four standard errors.
TEST(Rendered, TheLogOfATrialDoesNotTellItsNoise) {
  const bool all = std::getenv("PALPATE_STUDY_TABLE") != nullptr;
  const std::size_t count = all ? 2000 : 100;
  const double bound = all ? 0.05 : 4.0 / std::sqrt(3.0 * static_cast<double>(count));
  const SimulatedPerson person = reference_person();
  for (const char* task : {"weak-force", "stiffness"}) {
    std::vector<Trial> trials = force_trials(person, 0.6, static_cast<int>(count));
    for (std::size_t i = 0; i < count; ++i) {
      if (Random(11, 0, static_cast<std::uint32_t>(i)).uniform() < 0.5) trials[i].noise = 0.0;
      if (std::string(task) == "stiffness") trials[i].level = 0.1;
    }
    const Study study = study_with(task);
    RenderedTrials rendered(study, trials, person);
    rendered.run();
    for (std::size_t column = 0; column < numbers_of(rendered.records[0]).size(); ++column) {
      std::vector<double> values;
      for (const TrialRecord& record : rendered.records) values.push_back(numbers_of(record)[column]);
      const double by_value = area(values, trials);
      const double by_repetition = area(to_nearest(values, trials), trials);
      EXPECT_NEAR(by_value, 0.5, bound) << task << ", number " << column;
      EXPECT_NEAR(by_repetition, 0.5, bound) << task << ", number " << column;
      if (all) std::cout << task << ' ' << column << ": " << by_value << ", " << by_repetition << '\n';
    }
  }
}

}  // namespace
}  // namespace palpate::study
