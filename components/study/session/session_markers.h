#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "study/session/markers.h"
#include "study/session/run_session.h"
#include "study/session/trial_log.h"

namespace palpate::study {

/// The markers of a session: opens them, notes in the log what was sent, and asks the experimenter what to do
/// when one fails. [setup], one thread at a time, unless noted.
class SessionMarkers final {
 public:
  /// @param options its markers instead of the study's
  SessionMarkers(const Study& study, const SessionOptions& options, LogWriter& log);

  /// Opens all targets; without any does nothing. @throws InputError as Markers
  void open();
  /// Targets for the log: "serial:/dev/ttyUSB0, tcp:127.0.0.1:5678"; "none" if those of the study are
  /// switched off; empty: the study has none.
  [[nodiscard]] std::string text() const;

  void begin_block(int session, int block, double rate_Hz);
  /// [rt] As Markers::note_tick().
  void note_tick(std::uint64_t tick, std::int64_t due) noexcept {
    if (markers_) markers_->note_tick(tick, due);
  }
  /// [any] A marker of a trial of the block.
  void send(MarkerCode code, std::uint64_t tick, const std::string& task, const Trial& trial);
  /// [any] Whether a target has failed in this block.
  [[nodiscard]] bool failed() const { return markers_ && !markers_->failure().empty(); }
  /// Waits for the last marker. A failure goes to the log. @return values for the log's event "block"
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> finish_block();
  /// After a failure: asks the experimenter until markers work again or are not wanted. @return false: stop
  [[nodiscard]] bool settle();
  /// The last failure; empty: there was none.
  [[nodiscard]] const std::string& failure() const noexcept { return failure_; }

 private:
  void note(const std::string& state, const std::string& reason);

  const Study& study_;
  const SessionOptions& options_;
  LogWriter& log_;
  std::vector<MarkerTarget> targets_;
  std::optional<Markers> markers_;
  std::string failure_;
  int session_ = 1;
  int block_ = 0;
};

}  // namespace palpate::study
