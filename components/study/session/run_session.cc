#include "study/session/run_session.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "core/base/random.h"
#include "core/base/spsc_queue.h"
#include "io/record/machine.h"
#include "io/scene/device_kinds.h"
#include "io/system/file_exists.h"
#include "io/system/sha256.h"
#include "palpate/error.h"
#include "palpate/session.h"

#include "study/session/block_scene.h"
#include "study/session/observer_hand.h"
#include "study/session/session_markers.h"
#include "study/session/session_questions.h"
#include "study/session/simulated_person.h"

namespace palpate::study {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kLead = 20e-3;                     // s, of decisions in real time
constexpr std::chrono::milliseconds kRowsEvery{1};  // rows are taken in real time
constexpr std::uint32_t kTremorPart = 0x8000'0000;  // of the random numbers: an observer's hand

std::string text_of(std::uint64_t number) { return std::to_string(number); }

/// One session of one participant: the log, the course, and what a screen shows.
class RunningSession final {
 public:
  RunningSession(const StudyFolder& study, SealedKey key, const SessionOptions& options)
      : study_(study),
        options_(options),
        number_(study.number_of(options.participant)),
        log_(study.log_of(options.participant), study.log_key(options.participant)),
        markers_(study.study, options, log_),
        course_(study.study, key, number_) {
    if (!options.observer.empty()) person_ = make_person(options.observer, study.study.seed, number_);
  }

  SessionOutcome run();

 private:
  class Block;
  friend class Block;

  void require_for_person() const;
  void open_session();
  [[nodiscard]] SessionQuestions questions() { return {study_, options_, number_, log_}; }
  void run_block();
  void attend(session::Session& run, Block& block, const session::RunOptions& run_options);
  bool take_break();
  void take_withdrawal();
  void finish_trial(const TrialLoop& loop, const ObserverAgent* agent);
  void answer_as_person(const TrialLoop& loop, const ObserverAgent& agent, TrialRecord& record);
  /// Only an observer without windows needs no real time.
  [[nodiscard]] bool offline() const noexcept { return options_.screens == nullptr; }
  void show(const TrialView& trial, const std::string& message, double break_left = 0.0);
  [[nodiscard]] ScreenContent content_of(const TrialView& trial, const std::string& message,
                                         double break_left) const;
  void take_inputs(session::Session& run, Block& block);
  void note();
  void withdraw();
  [[nodiscard]] bool note_threshold();
  [[nodiscard]] bool instruct();

  const StudyFolder& study_;
  const SessionOptions& options_;
  std::uint32_t number_;
  LogWriter log_;
  SessionMarkers markers_;
  Course course_;
  std::optional<SimulatedPerson> person_;
  SessionOutcome outcome_;
  int planned_ = 1;
  int block_ = 0;
  bool stop_ = false;
  bool threshold_noted_ = false;  // of this session
  std::optional<std::size_t> instructed_;
  std::uint64_t late_ticks_ = 0;
  std::string message_;
  std::vector<double> ladder_;
  Clock::time_point began_ = Clock::now();
  std::mutex mutex_;  // attend(): its two threads use all of this but the screens
};

/// One block: one haptic run.
class RunningSession::Block final : public haptics::TickObserver {
 public:
  Block(RunningSession& session, session::Session& run, const StudyTask& task, TrialScene scene,
        ObserverHand* hand)
      : session_(session),
        run_(run),
        task_(task),
        loop_(session.study_.study, std::move(scene), run.updates()),
        rate_Hz_(run.scene().rate_Hz) {
    if (hand != nullptr) agent_.emplace(*hand, rate_Hz_);
    loop_.on_marker([this](MarkerCode code, std::uint64_t tick) {
      session_.markers_.send(code, tick, task_.name, loop_.trial());
    });
  }

  void on_row(const haptics::TickRow& row) noexcept override {
    if (row.hand != 0) return;
    late_ns_ = row.late_ns < std::llround(1e9 / rate_Hz_) ? row.late_ns : 0;
    if (session_.offline()) {
      take(row);  // nobody waits for the tick
    } else if (!rows_.push(row)) {
      lost_rows_.store(true, std::memory_order_relaxed);
    }
  }

  void on_tick(const haptics::TickState& now) noexcept override {
    session_.markers_.note_tick(now.tick, now.taken_ns - late_ns_);
  }

  /// A block in real time: takes the rows of the running loop.
  void follow() {
    haptics::TickRow row;
    while (rows_.pop(row)) take(row);
    if (lost_rows_.exchange(false, std::memory_order_relaxed)) loop_.abandon("the screen was too slow");
  }

  [[nodiscard]] TrialLoop& loop() noexcept { return loop_; }
  [[nodiscard]] const std::string& last_code() const noexcept { return last_code_; }
  [[nodiscard]] std::uint32_t fault() const noexcept { return fault_; }
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }
  [[nodiscard]] std::uint64_t late_ticks() const noexcept { return late_ticks_; }
  void end() noexcept { ending_ = true; }

 private:
  void take(const haptics::TickRow& row) noexcept {
    try {
      step(row);
    } catch (const std::exception& error) {
      failure_ = error.what();
      run_.control().stop();
    }
  }
  void step(const haptics::TickRow& row);
  void begin_next();
  void answer_as_observer(std::uint64_t tick);

  RunningSession& session_;
  session::Session& run_;
  const StudyTask& task_;
  TrialLoop loop_;
  double rate_Hz_;
  std::optional<ObserverAgent> agent_;
  struct PlannedAnswer {
    int interval = 0;
    std::uint64_t tick = 0;
  };
  std::optional<PlannedAnswer> answer_;  // of an observer in real time, before it is given
  std::int64_t late_ns_ = 0;  // of the tick against its deadline; a tick that missed a period sets a new one
  SpscQueue<haptics::TickRow> rows_{1U << 14U};
  std::atomic<bool> lost_rows_{false};
  int trials_ = 0;
  bool ending_ = false;
  std::uint32_t fault_ = 0;
  std::uint64_t late_ticks_ = 0;
  std::uint32_t last_buttons_ = 0;
  std::string last_code_;
  std::string failure_;
};

void RunningSession::Block::begin_next() {
  const std::optional<Trial> next = session_.course_.next();
  const Study& study = session_.study_.study;
  const double minutes = static_cast<double>(loop_.view().tick) / rate_Hz_ / 60.0;
  const bool rest = trials_ >= study.break_trials || minutes >= study.break_minutes;
  if (!next || ending_ || rest || &study.tasks[next->task] != &task_) {
    run_.control().stop();
    return;
  }
  loop_.begin(*next);
  if (agent_) agent_->begin(Random(study.seed, session_.number_, kTremorPart + next->draw));
}

// Offline the answer follows after the trial. In real time it is given after the observer's response time.
void RunningSession::Block::answer_as_observer(std::uint64_t tick) {
  if (session_.offline()) return loop_.answer(1);
  if (!answer_) {
    TrialRecord felt =
        record_of(session_.study_.study, loop_.trial(), session_.outcome_.session, session_.block_);
    loop_.fill_in(felt);
    session_.answer_as_person(loop_, *agent_, felt);
    answer_ = {felt.answer, tick + static_cast<std::uint64_t>(felt.response_time * rate_Hz_)};
  }
  if (tick < answer_->tick) return;
  loop_.answer(answer_->interval);
  answer_.reset();
}

void RunningSession::Block::step(const haptics::TickRow& row) {
  if (static_cast<double>(row.late_ns) > 1e9 / rate_Hz_) ++late_ticks_;
  if (loop_.view().state == TrialState::kIdle && !run_.control().stopping()) begin_next();
  loop_.row(row);
  fault_ = row.fault;
  if (agent_) {
    agent_->row(row, loop_, session_.study_.study);
    if (agent_->has_searched()) loop_.next();
    if (loop_.view().state == TrialState::kAnswer) answer_as_observer(row.tick);
  }
  if ((row.buttons & ~last_buttons_ & (1U << session_.study_.study.next_button)) != 0) loop_.next();
  last_buttons_ = row.buttons;
  if (!loop_.finished() || run_.control().stopping()) return;
  session_.finish_trial(loop_, agent_ ? &*agent_ : nullptr);
  last_code_ = loop_.trial().code;
  ++trials_;
  if (fault_ != 0) {
    run_.control().stop();
    return;
  }
  begin_next();
}

void RunningSession::answer_as_person(const TrialLoop& loop, const ObserverAgent& agent,
                                      TrialRecord& record) {
  const double progress = std::min(1.0, static_cast<double>(outcome_.trials) / planned_);
  answer_by_force(study_.study, *person_, loop.trial(), agent.samples(), progress, number_, record);
}

void RunningSession::finish_trial(const TrialLoop& loop, const ObserverAgent* agent) {
  TrialRecord record = record_of(study_.study, loop.trial(), outcome_.session, block_);
  record.time = utc_now();
  loop.fill_in(record);
  const StudyTask& task = study_.study.tasks[loop.trial().task];
  if (agent != nullptr) {
    record.observer = person_->kind;
    if (offline() || !task.two_intervals()) answer_as_person(loop, *agent, record);
  }
  log_.append(record);
  course_.add(record);
  if (const auto practised = practice_event(study_.study, course_, record)) log_.append(*practised);
  ++outcome_.trials;
  outcome_.spoiled += record.spoiled.empty() ? 0 : 1;
  if (task.stimulus() == Stimulus::kNoise && !record.practice && record.spoiled.empty())
    ladder_.push_back(loop.trial().noise);
  message_.clear();
  const bool tells =
      study_.study.feedback == "always" || (study_.study.feedback == "practice" && record.practice);
  if (tells && task.two_intervals() && record.answer != 0) {
    message_ = is_correct(task, record) ? "correct" : "not correct";
  }
  if (options_.progress) {
    const CoursePosition at = course_.position();
    options_.progress(std::min(1.0, static_cast<double>(outcome_.trials) / planned_),
                      task.name + ", part " + std::to_string(std::min(at.part + 1, at.parts)) + " of " +
                          std::to_string(at.parts));
  }
}

void RunningSession::show(const TrialView& trial, const std::string& message, double break_left) {
  if (options_.screens != nullptr) options_.screens->show(content_of(trial, message, break_left));
}

ScreenContent RunningSession::content_of(const TrialView& trial, const std::string& message,
                                         double break_left) const {
  ScreenContent content;
  content.trial = trial;
  content.message = message;
  if (const auto next = course_.next()) {
    content.sentence = describe(study_.study.tasks[next->task].kind).sentence;
    content.task = study_.study.tasks[next->task].name;
    content.practice = next->practice;
    if (next->example && trial.state != TrialState::kFinished) {
      content.example = next->second ? 2 : 1;
      if (study_.study.tasks[next->task].comparison() && next->level < 0.0)
        content.example = 3 - content.example;
    }
  }
  content.session = outcome_.session;
  content.block = block_;
  content.position = course_.position();
  content.spoiled = course_.spoiled();
  content.catch_trials = course_.catch_trials();
  content.catch_correct = course_.catch_correct();
  content.late_ticks = late_ticks_;
  content.minutes = std::chrono::duration<double>(Clock::now() - began_).count() / 60.0;
  content.break_left = break_left;
  content.max_force = study_.study.max_force;
  content.ladder = ladder_;
  return content;
}

// In the log at once, whatever happens to the run.
void RunningSession::withdraw() {
  if (!outcome_.withdrawn) log_.append(event_of("withdrawn", {}));
  outcome_.withdrawn = true;
}

void RunningSession::note() {
  for (std::string text = options_.screens->take_note(); !text.empty();
       text = options_.screens->take_note()) {
    log_.append(event_of("note", {{"text", text}}));
  }
}

// A person consents, and feels a device that a hand holds.
void RunningSession::require_for_person() const {
  require_ethics(study_.study);
  const std::string kind = study_scene(study_.study, options_.device).devices.front().kind;
  const scene::DeviceKind* found = scene::find_device_kind(kind);
  if (found != nullptr && found->held) return;
  throw InputError("--device " + kind + ": no hand holds it; a person needs forcedimension, haply or touch");
}

void RunningSession::open_session() {
  const ParticipantLog& before = log_.opened();
  require_blind(study_);  // the log's writer keeps `unblind` out from now on
  remove_leftovers(study_);
  if (!person_) require_for_person();
  if (before.withdrawn()) throw InputError(options_.participant + ": has withdrawn, no session can be run");
  const int begun = course_.replay(before);
  const bool finished =
      begun == 0 || std::any_of(before.events.begin(), before.events.end(), [&](const auto& event) {
        return event.event == "session-end" && event.value("session") == std::to_string(begun);
      });
  const auto sessions = static_cast<int>(plan_sessions(study_.study, number_).size());
  outcome_.session = options_.session.value_or(finished ? begun + 1 : begun);
  if (outcome_.session > sessions || outcome_.session < std::max(begun, 1) ||
      (finished && outcome_.session == begun)) {
    throw InputError(options_.participant + ": session " + std::to_string(outcome_.session) +
                     " cannot be run: of " + std::to_string(sessions) + " sessions, " +
                     (begun == 0 ? "none was begun"
                                 : std::to_string(begun) + (finished ? " is finished" : " is unfinished")));
  }
  markers_.open();
  const std::string number = std::to_string(outcome_.session);
  const std::optional<Calibration>& calibration = study_.study.calibration;
  const std::string program = "palpate " + record::palpate_version();
  if (!finished && outcome_.session == begun) {
    if (!questions().still_wanted()) {
      stop_ = true;
      return;
    }
    log_.append(
        event_of("resumed", {{"session", number}, {"program", program}, {"markers", markers_.text()}}));
    course_.resume();
  } else {
    course_.begin_session(outcome_.session);
    log_.append(event_of("session", {{"session", number},
                                     {"program", program},
                                     {"device", options_.device},
                                     {"observer", options_.observer},
                                     {"markers", markers_.text()},
                                     {"sound", sound_text(study_.study)},
                                     {"calibration", calibration ? calibration->sha256 : ""},
                                     {"level", options_.observer.empty() ? "" : "force"}}));
  }
  for (const TrialRecord& trial : before.trials) {
    if (trial.session == outcome_.session) block_ = std::max(block_, trial.block);
  }
  planned_ = std::max(course_.trials_left(), 1);
}

void RunningSession::run_block() {
  const Trial next = course_.next().value();
  const StudyTask& task = study_.study.tasks[next.task];
  do {
    ++block_;
  } while (file_exists(study_.recording_of(options_.participant, outcome_.session, block_)));
  const std::filesystem::path file = study_.recording_of(options_.participant, outcome_.session, block_);
  TrialScene trial_scene;
  scene::Scene scene = block_scene(study_.study, task, {number_, outcome_.session, block_}, options_.device,
                                   trial_scene.lumps);
  trial_scene.rate_Hz = scene.rate_Hz;
  trial_scene.tissue = scene.tissue;
  session::SessionOptions session_options;
  session_options.preparation = options_.preparation;
  session_options.duration_s = 60.0 * (study_.study.break_minutes + 5.0);
  ObserverHand* hand = nullptr;
  if (person_) {
    auto owned = std::make_unique<ObserverHand>(scene);
    hand = owned.get();
    session_options.devices.push_back(std::move(owned));
  }
  if (!offline()) trial_scene.lead = static_cast<std::uint64_t>(kLead * scene.rate_Hz);
  session::Session run(std::move(scene), std::move(session_options));
  Block block(*this, run, task, trial_scene, hand);
  markers_.begin_block(outcome_.session, block_, trial_scene.rate_Hz);
  session::RunOptions run_options;
  run_options.recording = file;
  run_options.offline = offline();
  run_options.study = study_.mark();
  if (offline()) {
    run.run(run_options, {&block});
  } else {
    attend(run, block, run_options);
  }
  if (!block.failure().empty()) throw InputError(block.failure());
  late_ticks_ += block.late_ticks();
  outcome_.fault = block.fault();
  ++outcome_.blocks;
  EventRecord event = event_of("block", {{"session", std::to_string(outcome_.session)},
                                         {"block", std::to_string(block_)},
                                         {"recording", file.filename().string()},
                                         {"sha256", sha256_of_file(file)},
                                         {"task", task.name},
                                         {"late_ticks", text_of(block.late_ticks())},
                                         {"faults", block.fault() == 0 ? "0" : "1"}});
  for (auto& sent : markers_.finish_block()) event.values.push_back(std::move(sent));
  outcome_.markers_failure = markers_.failure();
  log_.append(event);
  if (task.arms.size() > 1 && !stop_ && !block.last_code().empty()) {
    questions().blinding({outcome_.session, block_, task.name, block.last_code()});
  }
}

// A block in real time. A picture may take longer than the lead of a decision, so another thread takes the
// rows.
void RunningSession::attend(session::Session& run, Block& block, const session::RunOptions& run_options) {
  const auto background = run.run_in_background(run_options, {&block});
  const auto follow = [&] {
    const std::lock_guard lock(mutex_);
    block.follow();
  };
  std::jthread rows([&](const std::stop_token& end) {
    while (!end.stop_requested() && !background->wait_for(kRowsEvery)) follow();
  });
  while (!background->ended()) {
    ScreenContent content;
    {
      const std::lock_guard lock(mutex_);
      take_inputs(run, block);
      if (markers_.failed()) block.end();
      note();
      content = content_of(block.loop().view(), message_, 0.0);
    }
    options_.screens->show(content);
  }
  rows.join();
  background->wait();
  follow();
  if (!background->failure().empty()) throw InputError(background->failure());
}

void RunningSession::take_inputs(session::Session& run, Block& block) {
  while (const auto input = options_.screens->take_input()) {
    switch (*input) {
      case ScreenInput::kFirst:
      case ScreenInput::kSecond:
        if (!person_) block.loop().answer(*input == ScreenInput::kFirst ? 1 : 2);
        break;
      case ScreenInput::kNext:
        if (!person_) block.loop().next();
        break;
      case ScreenInput::kPause:
        block.end();
        break;
      case ScreenInput::kWithdraw:
        run.control().stop();  // the force first
        withdraw();
        [[fallthrough]];
      case ScreenInput::kForceOff:
      case ScreenInput::kStop:
        stop_ = true;
        run.control().stop();
        break;
    }
  }
}

bool RunningSession::take_break() {
  if (options_.screens == nullptr) return true;
  const auto end = Clock::now() + std::chrono::duration<double>(study_.study.break_least);
  bool ready = false;
  while (!ready || Clock::now() < end) {
    const double left = std::max(0.0, std::chrono::duration<double>(end - Clock::now()).count());
    show({}, left > 0.0 ? "Take a break" : "Press Space or an answer key to go on", left);
    while (const auto input = options_.screens->take_input()) {
      if (*input == ScreenInput::kStop || *input == ScreenInput::kWithdraw ||
          *input == ScreenInput::kForceOff) {
        if (*input == ScreenInput::kWithdraw) withdraw();
        stop_ = true;
        return false;
      }
      ready = Clock::now() >= end;
    }
    note();
    if (ready) break;
  }
  return true;
}

// A question ends without an answer when the participant withdraws.
void RunningSession::take_withdrawal() {
  if (options_.screens == nullptr) return;
  while (const auto input = options_.screens->take_input()) {
    if (*input == ScreenInput::kWithdraw) withdraw();
  }
}

// Before the first block whose noise follows from the threshold. @return false: the session is to stop
bool RunningSession::note_threshold() {
  if (threshold_noted_ || !course_.uses_threshold()) return true;
  const std::optional<Course::Threshold> threshold = course_.threshold();
  if (!threshold) return true;
  threshold_noted_ = true;
  const bool goes_on = !threshold->at_edge || questions().threshold_at_edge(*threshold);
  log_.append(threshold_event(outcome_.session, *threshold,
                              !threshold->at_edge ? ""
                              : goes_on           ? "go on"
                                                  : "stop"));
  return goes_on;
}

// Before the first trial of a task, and of an interrupted session.
bool RunningSession::instruct() {
  const std::size_t task = course_.next()->task;
  if (instructed_ == task) return true;
  instructed_ = task;
  return questions().instruct(study_.study.tasks[task]);
}

SessionOutcome RunningSession::run() {
  open_session();
  if (stop_) return outcome_;
  const bool agreed = options_.screens == nullptr ||
                      (questions().consent_and_bands() && questions().audibility(outcome_.session));
  while (agreed && course_.next() && !stop_) {
    if (!markers_.settle() || !note_threshold() || !instruct()) break;
    run_block();
    if (outcome_.fault != 0 || stop_) break;
    if (course_.next() && !take_break()) break;
  }
  take_withdrawal();
  outcome_.complete = !course_.next();
  if (outcome_.complete)
    log_.append(event_of("session-end", {{"session", std::to_string(outcome_.session)}}));
  if (options_.screens != nullptr && (outcome_.complete || outcome_.withdrawn)) {
    questions().say_goodbye();
    note();
  }
  return outcome_;
}

}  // namespace

void require_ethics(const Study& study) {
  if (study.consent_file.empty() && study.language.consent.empty()) {
    throw InputError(study.file.string() +
                     ": ethics.consent_file: is missing; without it only simulated people take part");
  }
  if (study.approval.find_first_not_of(" \t") == std::string::npos) {
    throw InputError(
        study.file.string() +
        ": ethics.approval: is missing, must be the ethics committee and the number of its approval; without "
        "it only simulated people take part: write it into the study file, and prepare the study again");
  }
}

SessionOutcome run_session(const StudyFolder& study, SealedKey key, const SessionOptions& options) {
  return RunningSession(study, key, options).run();
}

}  // namespace palpate::study
