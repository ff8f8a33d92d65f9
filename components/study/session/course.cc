#include "study/session/course.h"

#include <algorithm>
#include <cmath>

#include "core/base/random.h"
#include "core/base/text.h"
#include "palpate/error.h"

#include "study/psychophysics/comparisons.h"

namespace palpate::study {
namespace {

// Parts of the random numbers of a participant.
enum Part : std::uint32_t {
  kArmsPart = 0x1000'0000,
  kIntervalPart = 0x2000'0000,
  kCatchPart = 0x3000'0000,
  kLevelPart = 0x4000'0000,
  kLaterPart = 0x5000'0000,
  kPracticePart = 0x6000'0000
};

// Runs at the start of a session have numbers of another key, see key_of().
std::uint32_t part_of(Part kind, std::size_t task, int run, std::uint32_t number) {
  return kind + (static_cast<std::uint32_t>(task * 2 + (run == kRunAtEnd ? 1 : 0)) << 20U) + number;
}

std::uint64_t mixed(std::uint64_t key, int run) {
  constexpr std::uint64_t kOdd = 0x9e37'79b9'7f4a'7c15U;
  return run <= kRunAtEnd ? key : key + static_cast<std::uint64_t>(run) * kOdd;
}

double log10_of(double value) { return std::log10(value); }

/// The number of the session that begins with this event. @throws InputError when it is no whole number
int session_of(const EventRecord& event) {
  constexpr double kMax = 1e6;
  const std::string text = event.value("session");
  const double number = parse_number(text).value_or(0.0);
  if (number >= 1.0 && number <= kMax && number == std::floor(number)) return static_cast<int>(number);
  throw InputError("a session of the log: session = \"" + excerpt(text) +
                   "\": must be a whole number from 1");
}

}  // namespace

bool counted_answer(const Trial& trial, int answer) noexcept { return answer == (trial.second ? 2 : 1); }

bool is_correct(const StudyTask& task, const TrialRecord& trial) noexcept {
  if (!task.comparison()) return trial.counted;
  return trial.counted == (trial.level > 0.0);
}

TrialRecord record_of(const Study& study, const Trial& trial, int session, int block) {
  TrialRecord record;
  record.session = session;
  record.block = block;
  record.task = study.tasks[trial.task].name;
  record.repeat = trial.run != kFirstRun;
  record.practice = trial.practice;
  record.catch_trial = trial.catch_trial;
  record.number = trial.number;
  record.code = trial.code;
  record.level = trial.level;
  record.second = trial.second;
  return record;
}

/// The levels of one task in one arm, by its method.
class Course::Levels final {
 public:
  // The key, since an order that followed from the arm and the study's seed would reveal the arm.
  Levels(const StudyTask& task, SealedKey key, std::uint32_t participant, std::uint32_t part)
      : task_(task), key_(key), participant_(participant), part_(part), quest_(grid_of(task)) {
    if (task.method != Method::kStaircase) return;
    psychophysics::StaircaseSetup setup;
    setup.start = magnitude(levels().back());
    setup.largest = setup.start;
    setup.least = task.comparison() ? magnitude(levels()[levels().size() / 2]) : levels().front();
    setup.steps = {0.2, 0.1, 0.05};  // decades
    staircase_.emplace(setup);
  }

  [[nodiscard]] const std::vector<double>& levels() const { return quest_.grid().levels; }
  [[nodiscard]] const psychophysics::QuestPlus& quest() const { return quest_; }
  [[nodiscard]] int answers() const noexcept { return answers_; }

  [[nodiscard]] std::size_t next(int number) const {
    if (staircase_) return nearest(staircase_level(number));
    if (task_.method == Method::kQuestPlus) return quest_.next();
    // Constant stimuli: each level once a round, in random order.
    const auto round = static_cast<std::uint32_t>(static_cast<std::size_t>(trials_) / levels().size());
    return Random(key_, participant_, part_ + round)
        .permutation(levels().size())[static_cast<std::size_t>(trials_) % levels().size()];
  }

  void add(double level, bool counted, bool correct, bool catch_trial) {
    quest_.update(nearest(level), counted);
    ++answers_;
    if (staircase_ && !catch_trial) staircase_->update(correct);
    if (!catch_trial) ++trials_;
  }

 private:
  // log10 of the amplitude, or of the logarithm of a ratio.
  [[nodiscard]] double magnitude(double level) const {
    return task_.comparison() ? log10_of(std::fabs(level)) : level;
  }
  [[nodiscard]] std::size_t nearest(double level) const {
    const auto found = std::min_element(levels().begin(), levels().end(), [&](double a, double b) {
      return std::fabs(a - level) < std::fabs(b - level);
    });
    return static_cast<std::size_t>(found - levels().begin());
  }
  [[nodiscard]] double staircase_level(int number) const {
    double wanted = staircase_->level();
    if (task_.comparison()) {
      const bool negative =
          Random(key_, participant_, part_ + 0x8000U + static_cast<std::uint32_t>(number)).uniform() < 0.5;
      wanted = std::pow(10.0, wanted) * (negative ? -1.0 : 1.0);
    }
    return wanted;
  }

  const StudyTask& task_;
  SealedKey key_;
  std::uint32_t participant_;
  std::uint32_t part_;
  psychophysics::QuestPlus quest_;
  std::optional<psychophysics::Staircase> staircase_;
  int trials_ = 0;  // without catch trials
  int answers_ = 0;
};

Course::Course(const Study& study, SealedKey key, std::uint32_t participant)
    : study_(study), key_(key), participant_(participant), plan_(plan_sessions(study, participant)) {
  for (std::size_t task = 0; task < study.tasks.size(); ++task) {
    arms_of_code_.push_back(arms_of_codes(key, participant, task, study.tasks[task].arms.size()));
  }
}

Course::~Course() = default;

SealedKey Course::key_of(int run) const noexcept { return mixed(key_, run); }
std::uint64_t Course::seed_of(int run) const noexcept { return mixed(study_.seed, run); }

Course::Levels& Course::levels_of(std::size_t task, int run, std::size_t arm) const {
  std::unique_ptr<Levels>& levels = levels_[{task, run, arm}];
  if (!levels) {
    const auto part = part_of(kLevelPart, task, run, static_cast<std::uint32_t>(arm) << 16U);
    levels = std::make_unique<Levels>(study_.tasks[task], key_of(run), participant_, part);
  }
  return *levels;
}

void Course::begin_session(int session) {
  if (session < 1 || static_cast<std::size_t>(session) > plan_.size()) {
    throw InputError("session: " + std::to_string(session) + " does not exist, must be 1 to " +
                     std::to_string(plan_.size()));
  }
  require_measured(static_cast<std::size_t>(session));
  session_ = static_cast<std::size_t>(session);
  part_ = 0;
  begin_part();
}

// A session that was skipped leaves noise or force without its measured value.
void Course::require_measured(std::size_t session) const {
  const std::vector<PlannedPart>& parts = plan_[session - 1].parts;
  const auto require = [&](const StudyTask& task, std::size_t source) {
    const bool here =
        std::any_of(parts.begin(), parts.end(), [&](const PlannedPart& part) { return part.task == source; });
    const StudyTask& of = study_.tasks[source];
    const int answers = levels_of(source, kFirstRun, 0).answers();
    if (here || 2 * answers >= of.trials) return;
    throw InputError("session " + std::to_string(session) + ": task " + task.name + " follows from task " +
                     of.name + ", of which " + std::to_string(answers) + " of " + std::to_string(of.trials) +
                     " trials were done: run the sessions before it first");
  };
  for (const PlannedPart& part : parts) {
    const StudyTask& task = task_of(part);
    const auto threshold = study_.threshold_task();
    if (task.has_noise() && threshold) require(task, *threshold);
    if (task.signal) require(task, study_.find_task(task.signal->task).value());
  }
}

void Course::begin_part() {
  next_.reset();
  waiting_.clear();
  done_ = 0;
  practice_left_ = 0;
  practice_done_ = 0;
  training_ = false;
  training_ended_ = false;
  practised_.clear();
  const std::vector<PlannedPart>& parts = plan_[session_ - 1].parts;
  if (part_ >= parts.size()) return;
  const PlannedPart& part = parts[part_];
  for (int i = 0; i < part.trials; ++i) waiting_.push_back({part.first_trial + i, 1});
  if (part.first_trial != 0 || part.run != kFirstRun) return;
  practice_left_ = task_of(part).practice;
  training_ = task_of(part).practice_until.has_value();
  if (training_) practice_left_ = std::max(practice_left_, task_of(part).practice_until->of);
}

void Course::resume() {
  next_.reset();
  practice_left_ = std::max(practice_left_, kPracticeAgain);
}

// Interleaved arms: each once a round, in random order. Force control has one arm after the other, in the
// order of a Williams square.
std::size_t Course::arm_of(const PlannedPart& part, int number) const {
  const StudyTask& task = task_of(part);
  const std::size_t arms = task.arms.size();
  if (!task.two_intervals()) {
    const auto rows = psychophysics::williams_square(static_cast<int>(arms));
    // The key deals the rows to each group of people, and names the arm behind each number of the square.
    const auto people = static_cast<std::uint32_t>(rows.size());
    const auto dealt =
        Random(key_, participant_ / people, part_of(kArmsPart, part.task, kRunAtEnd, 0)).permutation(people);
    const std::vector<int>& row = rows[dealt[participant_ % people]];
    const auto names =
        Random(key_, 0xffff'ffffU, part_of(kArmsPart, part.task, kFirstRun, 0)).permutation(arms);
    return names[static_cast<std::size_t>(row[static_cast<std::size_t>(number / task.trials)])];
  }
  const auto round = static_cast<std::uint32_t>(static_cast<std::size_t>(number) / arms);
  const auto order = Random(key_of(part.run), participant_, part_of(kArmsPart, part.task, part.run, round))
                         .permutation(arms);
  return order[static_cast<std::size_t>(number) % arms];
}

double Course::signal_level(const StudyTask& task) const {
  const std::size_t source = study_.find_task(task.signal->task).value();
  const double correct = task.signal->correct;
  const double from_location = log10_of(-std::log(2.0 * (1.0 - correct)));
  return levels_of(source, kFirstRun, 0)
      .quest()
      .estimate([&](const psychophysics::Parameters& at) { return at.location + from_location / at.spread; })
      .mean;
}

// Above the level of about 65 %, and at most the largest force of the task that the level comes from.
double Course::easy_signal(const StudyTask& task) const {
  const StudyTask& source = study_.tasks[study_.find_task(task.signal->task).value()];
  return std::min(signal_level(task) + log10_of(3.0), std::max(signal_level(task), log10_of(source.largest)));
}

std::optional<Course::Threshold> Course::threshold() const {
  constexpr double kEdge = 0.01;  // of the probability at an end of the range
  const auto task = study_.threshold_task();
  if (!task) return std::nullopt;
  int run = study_.tasks[*task].each_session ? static_cast<int>(session_) : kFirstRun;
  const auto measured = [&](int number) {
    const auto run_of = levels_.find({*task, number, 0});
    return run_of != levels_.end() && run_of->second->answers() > 0;
  };
  if (run <= kRunAtEnd || !measured(run)) run = kFirstRun;
  const auto found = levels_.find({*task, run, 0});
  if (found == levels_.end() || found->second->answers() == 0) return std::nullopt;
  const psychophysics::QuestPlus& quest = found->second->quest();
  Threshold threshold;
  threshold.log10 = quest.estimate(psychophysics::threshold_of);
  threshold.session = std::max(1, run);
  threshold.at_edge = quest.edge_probability() > kEdge;
  const std::vector<double>& levels = quest.grid().levels;
  threshold.above = threshold.log10.mean > 0.5 * (levels.front() + levels.back());
  return threshold;
}

bool Course::uses_threshold() const {
  const std::optional<Trial> trial = next();
  if (!trial || study_.tasks[trial->task].stimulus() == Stimulus::kNoise) return false;
  return study_.tasks[trial->task].has_noise();
}

Course::Practice Course::practice() const {
  Practice practice;
  if (session_ == 0 || part_ >= plan_[session_ - 1].parts.size()) return practice;
  const std::optional<PracticeCriterion>& until = task_of(plan_[session_ - 1].parts[part_]).practice_until;
  practice.trials = static_cast<int>(practised_.size());
  if (!until) return practice;
  const auto last = std::min(practised_.size(), static_cast<std::size_t>(until->of));
  practice.correct = static_cast<int>(
      std::count(practised_.end() - static_cast<std::ptrdiff_t>(last), practised_.end(), true));
  practice.met = practice.trials >= until->of && practice.correct >= until->correct;
  return practice;
}

void Course::fill_in(Trial& trial) const {
  const StudyTask& task = study_.tasks[trial.task];
  const auto code = std::find(arms_of_code_[trial.task].begin(), arms_of_code_[trial.task].end(), trial.arm);
  trial.code = "c" + std::to_string(code - arms_of_code_[trial.task].begin() + 1);
  const auto session = static_cast<std::uint32_t>(trial.run <= kRunAtEnd ? 0 : trial.run);
  trial.draw = session << 27U |
               static_cast<std::uint32_t>(trial.task * 2 + (trial.run == kRunAtEnd ? 1 : 0)) << 20U |
               (trial.practice ? 4U + resumed_ % 4U : static_cast<std::uint32_t>(trial.attempt)) << 16U |
               (static_cast<std::uint32_t>(trial.number) & 0xffffU);
  if (task.stimulus() == Stimulus::kNoise) {
    trial.noise = std::min(std::pow(10.0, trial.level), study_.max_noise);
    return;
  }
  const double share = task.arms[trial.arm].share;
  if (share == 0.0) return;
  const std::optional<Threshold> own = threshold();
  if (own) trial.noise = std::min(share * std::pow(10.0, own->log10.mean), study_.max_noise);
}

Trial Course::practice_trial() const {
  const PlannedPart& part = plan_[session_ - 1].parts[part_];
  const StudyTask& task = task_of(part);
  Random random(key_of(part.run), participant_,
                part_of(kPracticePart, part.task, part.run, static_cast<std::uint32_t>(practice_done_)));
  Trial trial;
  trial.task = part.task;
  trial.run = part.run;
  trial.practice = true;
  trial.example = practice_done_ < task.examples;
  trial.number = practice_done_;
  trial.arm = random.below(task.arms.size());
  trial.second = random.uniform() < 0.5;
  if (!task.two_intervals()) {
    trial.level = task.targets[random.below(task.targets.size())];
  } else if (task.signal) {
    trial.level = easy_signal(task);
  } else {
    const std::vector<double>& levels = levels_of(part.task, part.run, trial.arm).levels();
    const bool low = task.comparison() && random.uniform() < 0.5;
    trial.level = low ? levels.front() : levels.back();
  }
  fill_in(trial);
  return trial;
}

Trial Course::trial_of(const Slot& slot) const {
  const PlannedPart& part = plan_[session_ - 1].parts[part_];
  const StudyTask& task = task_of(part);
  const auto number = static_cast<std::uint32_t>(slot.number);
  Trial trial;
  trial.task = part.task;
  trial.run = part.run;
  trial.number = slot.number;
  trial.attempt = slot.attempt;
  trial.arm = arm_of(part, slot.number);
  trial.second =
      Random(seed_of(part.run), participant_, part_of(kIntervalPart, part.task, part.run, number)).uniform() <
      0.5;
  if (!task.two_intervals()) {
    const std::size_t targets = task.targets.size();
    const auto round = number / static_cast<std::uint32_t>(targets);
    const auto order = Random(study_.seed, participant_, part_of(kLevelPart, part.task, kFirstRun, round))
                           .permutation(targets);
    trial.level = task.targets[order[number % targets]];
  } else if (task.signal) {
    Random random(study_.seed, participant_, part_of(kCatchPart, part.task, part.run, number));
    trial.catch_trial = random.uniform() < task.catch_share;
    trial.level = trial.catch_trial ? easy_signal(task) : signal_level(task);
  } else {
    Random random(seed_of(part.run), participant_, part_of(kCatchPart, part.task, part.run, number));
    trial.catch_trial = random.uniform() < task.catch_share;
    const Levels& levels = levels_of(part.task, part.run, trial.arm);
    std::size_t level = levels.levels().size() - 1;
    if (!trial.catch_trial) {
      level = levels.next(slot.number);
    } else if (task.comparison() && random.uniform() < 0.5) {
      level = 0;
    }
    trial.level = levels.levels()[level];
  }
  fill_in(trial);
  return trial;
}

std::optional<Trial> Course::next() const {
  if (session_ == 0 || waiting_.empty()) return std::nullopt;
  if (!next_) next_ = practice_left_ > 0 ? practice_trial() : trial_of(waiting_.front());
  return next_;
}

void Course::count(const TrialRecord& trial, const Trial& expected) {
  const StudyTask& task = study_.tasks[expected.task];
  if (!task.two_intervals()) return;
  const bool correct = is_correct(task, trial);
  if (!task.signal) {
    levels_of(expected.task, expected.run, expected.arm)
        .add(trial.level, trial.counted, correct, trial.catch_trial);
  }
  if (!trial.catch_trial) return;
  ++catch_trials_;
  catch_correct_ += correct ? 1 : 0;
}

void Course::count_practice(const TrialRecord& trial, const Trial& expected) {
  --practice_left_;
  ++practice_done_;
  const StudyTask& task = study_.tasks[expected.task];
  if (!expected.example && trial.spoiled.empty() && task.two_intervals()) {
    practised_.push_back(is_correct(task, trial));
  }
  training_ended_ = false;
  if (!training_ || practice_left_ > 0) return;
  training_ended_ = practice().met || practice_done_ >= task.practice_until->most;
  training_ = !training_ended_;
  if (training_) practice_left_ = 1;
}

void Course::add(const TrialRecord& trial) {
  const std::optional<Trial> expected = next();
  next_.reset();
  const auto same = [&] {
    return expected && trial.task == study_.tasks[expected->task].name &&
           trial.repeat == (expected->run != kFirstRun) && trial.practice == expected->practice &&
           trial.number == expected->number && trial.code == expected->code &&
           trial.second == expected->second && std::fabs(trial.level - expected->level) < 1e-9;
  };
  if (!same()) {
    throw InputError(
        "a trial of the log (" + trial.task + ", number " + std::to_string(trial.number) +
        ") does not follow from the trials before it: another study or another version of palpate wrote it");
  }
  const bool spoiled = !trial.spoiled.empty();
  spoiled_ += spoiled ? 1 : 0;
  if (trial.practice) {
    count_practice(trial, *expected);
    return;
  }
  ++attempts_;
  Slot slot = waiting_.front();
  waiting_.erase(waiting_.begin());
  if (!spoiled) {
    count(trial, *expected);
    ++done_;
  } else if (++slot.attempt > kMaxAttempts) {
    ++lost_;
    ++done_;
  } else {
    Random random(study_.seed, participant_, kLaterPart + attempts_);
    const std::size_t places = waiting_.size();  // not at once, unless it is the last
    const std::size_t place = places == 0 ? 0 : 1 + random.below(places);
    waiting_.insert(waiting_.begin() + static_cast<std::ptrdiff_t>(place), slot);
  }
  if (waiting_.empty()) {
    ++part_;
    begin_part();
  }
}

int Course::replay(const ParticipantLog& log,
                   const std::function<void(const Trial&, const TrialRecord&)>& each) {
  int sessions = 0;
  std::size_t trial = 0;
  const auto add_next = [&] {
    const TrialRecord& record = log.trials[trial++];
    const std::optional<Trial> planned = next();
    add(record);
    if (each) each(planned.value(), record);
  };
  // Events and trials are in one order of the file: an event's place says after how many trials it was.
  for (const EventRecord& event : log.events) {
    while (trial < log.trials.size() && trial < event.after_trials) add_next();
    if (event.event == "session") {
      sessions = session_of(event);
      begin_session(sessions);
    } else if (event.event == "resumed") {
      resume();
    }
  }
  while (trial < log.trials.size()) add_next();
  return sessions;
}

CoursePosition Course::position() const {
  if (session_ == 0) return {};
  const std::vector<PlannedPart>& parts = plan_[session_ - 1].parts;
  if (part_ >= parts.size()) return {parts.size(), parts.size(), 0, 0};
  return {part_, parts.size(), done_, parts[part_].trials};
}

int Course::trials_left() const {
  if (session_ == 0) return 0;
  int left = static_cast<int>(waiting_.size());
  const std::vector<PlannedPart>& parts = plan_[session_ - 1].parts;
  for (std::size_t part = part_ + 1; part < parts.size(); ++part) left += parts[part].trials;
  return left;
}

}  // namespace palpate::study
