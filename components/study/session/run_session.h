#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/preparation.h"

#include "study/session/course.h"
#include "study/session/folder.h"
#include "study/session/trial_loop.h"

namespace palpate::study {

/// What both screens show. Nothing in it depends on the condition.
struct ScreenContent {
  TrialView trial;
  std::string sentence;  // what to do in this task
  std::string message;   // "correct", "break: 24 s", ...; empty: none
  std::string task;      // for the experimenter
  int example = 0;       // interval of the answer, which is shown before an example; 0: none
  bool practice = false;
  int session = 1;
  int block = 1;
  CoursePosition position;
  int spoiled = 0;
  int catch_trials = 0;
  int catch_correct = 0;
  std::uint64_t late_ticks = 0;
  double minutes = 0.0;        // since the session began
  double break_left = 0.0;     // s
  double max_force = 0.0;      // N
  std::vector<double> ladder;  // levels of the noise threshold task so far [N], of no other task
};

enum class ScreenInput { kFirst, kSecond, kNext, kPause, kForceOff, kStop, kWithdraw };

/// A question with a few answers, to the participant or the experimenter.
struct Question {
  std::string who;  // participant | experimenter
  std::string text;
  std::vector<std::string> answers;
};

/// A trial of the check whether the noise is heard.
struct AudibleTrial {
  int number = 1;
  int of = 1;
  bool second = false;  // the noise is in the second interval
};

/// The screens and keys of a session with a person. All functions are called on one thread.
class SessionScreens {
 public:
  virtual ~SessionScreens() = default;
  /// Shows the present state; called about 60 times a second.
  virtual void show(const ScreenContent& content) = 0;
  /// The next key; empty: none is waiting.
  virtual std::optional<ScreenInput> take_input() = 0;
  /// A note of the experimenter since the last call; empty: none.
  virtual std::string take_note() = 0;
  /// Asks and waits. @return index of the answer; empty: the window was closed, or stop, withdraw or force
  /// off was pressed, which take_input() then returns
  virtual std::optional<std::size_t> ask(const Question& question) = 0;
  /// Shows two intervals, the hand off the device, and asks which had the noise. @param noise switches the
  /// device's noise @return whether the answer was correct; empty: as for ask()
  virtual std::optional<bool> audible_trial(const AudibleTrial& trial,
                                            const std::function<void(bool)>& noise) = 0;
};

struct SessionOptions {
  std::string participant;
  std::optional<int> session;                       // empty: the first that is not finished
  std::string device;                               // as --device; empty: the scene's
  std::string observer;                             // simulated observer in the chair; empty: a person
  std::optional<std::vector<std::string>> markers;  // as --markers; empty: the study's
  contact::Preparation preparation{};               // of the organ, for each block
  SessionScreens* screens = nullptr;                // of a person, or of an observer in real time
  std::function<void(double, const std::string&)> progress;  // of an observer's session
};

struct SessionOutcome {
  int session = 1;
  int trials = 0;  // of this call, spoiled ones too
  int spoiled = 0;
  int blocks = 0;
  bool complete = false;  // the session
  bool withdrawn = false;
  std::string markers_failure;  // the last one; empty: all markers were sent
  std::uint32_t fault = 0;      // latched haptics::Fault that ended the session
};

/// [setup] What an ethics committee wants of a study with people: a consent text and its approval.
/// @throws InputError that names what is missing; only simulated people may take part then
void require_ethics(const Study& study);

/// [setup] Runs a session, or goes on with an interrupted one. An observer's session without screens runs
/// offline.
/// @throws InputError, ParameterError
SessionOutcome run_session(const StudyFolder& study, SealedKey key, const SessionOptions& options);

}  // namespace palpate::study
