#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/session/course.h"
#include "study/session/folder.h"
#include "study/session/run_session.h"
#include "study/session/trial_log.h"

namespace palpate::study {

/// What a session asks people besides its trials. The answers go to the log. [setup], one thread; the screens
/// of the options must be there.
class SessionQuestions final {
 public:
  SessionQuestions(const StudyFolder& study, const SessionOptions& options, std::uint32_t participant,
                   LogWriter& log)
      : study_(study), options_(options), participant_(participant), log_(log) {}

  /// After more than a day, a question decides whether an interrupted session goes on. Without screens it
  /// does.
  [[nodiscard]] bool still_wanted() const;
  /// Consent until it is given, then [participants] ask, once. @return false: no consent, or the window was
  /// closed
  [[nodiscard]] bool consent_and_bands();
  /// Whether the noise is heard with the hand off the device: 20 trials, once. @return false: the window was
  /// closed
  [[nodiscard]] bool audibility(int session);

  /// Shows the instructions of a task. @return false: the window was closed, or stop or withdraw was pressed
  [[nodiscard]] bool instruct(const StudyTask& task);
  /// Says that the threshold lies at the edge of the stimuli, and asks the experimenter what to do.
  /// @return whether the session goes on
  [[nodiscard]] bool threshold_at_edge(const Course::Threshold& threshold);

  struct LastTrial {
    int session = 1;
    int block = 1;
    std::string task;
    std::string code;
  };
  /// Whether both people believe that the last trial had noise.
  void blinding(const LastTrial& last);
  /// Says that the session is over, until somebody closes the window.
  void say_goodbye();

 private:
  [[nodiscard]] bool has(const std::string& event, const std::string& answer = "") const;

  const StudyFolder& study_;
  const SessionOptions& options_;
  std::uint32_t participant_;
  LogWriter& log_;
};

/// [setup] An event of this moment.
[[nodiscard]] EventRecord event_of(const std::string& name,
                                   std::vector<std::pair<std::string, std::string>> values);

/// [setup] How the practice with a criterion ended. @param last the trial that was added last; empty: it did
/// not end a practice
[[nodiscard]] std::optional<EventRecord> practice_event(const Study& study, const Course& course,
                                                        const TrialRecord& last);

/// [setup] The noise threshold [N] that the session's noise follows from, with its 95 % interval, the session
/// in which it was measured, and whether it lies at the edge of the stimuli: "no", "least" or "largest".
/// @param decision what is done with one at the edge; empty: nothing
[[nodiscard]] EventRecord threshold_event(int session, const Course::Threshold& threshold,
                                          const std::string& decision);

}  // namespace palpate::study
