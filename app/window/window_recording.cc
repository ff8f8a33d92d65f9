// Recordings that begin and end during a run.
#include <fmt/core.h>

#include "palpate/error.h"

#include "app/messages.h"
#include "app/window/window.h"

namespace palpate::app {

namespace fs = std::filesystem;

bool Window::recording() const {
  return tape_ != nullptr ? tape_->writing() : run_->started() && !run_->ended();
}

/// The run's newest recording; empty: it has none.
fs::path Window::recording_now() const { return tape_ != nullptr ? tape_->file() : run_->recording(); }

/// Begins or ends a recording. The run goes on.
void Window::record(bool on) {
  if (tape_ == nullptr) {
    viewport_.show_message(
        "the program records whole runs (--record): " + run_->recording().filename().string() +
        (run_->ended() ? " is complete" : " ends with its run"));
    return;
  }
  if (!on) {
    end_recording();
    return;
  }
  try {
    tape_->begin(free_name(named_by_time(".h5"), true), run_->observer().started_unix_ns());
    last_recording_ = tape_->file();
    if (!run_->ended()) {
      viewport_.show_message(
          fmt::format("recording to {}, from the run's start {:.1f} s ago, so that it can be replayed",
                      tape_->file().filename().string(), traces_->newest_time()));
    }
  } catch (const InputError& error) {
    viewport_.show_message(error.what());
  }
}

/// Passes new rows to the recording, which ends with its run.
void Window::poll_recording() {
  if (tape_ == nullptr || !tape_->writing()) return;
  const bool ended = run_->ended();
  const bool all = tape_->feed();
  if ((ended && all) || !tape_->failure().empty()) end_recording();
}

void Window::end_recording() {
  if (tape_ == nullptr || !tape_->writing()) return;
  take_rows();
  const std::string name = tape_->file().filename().string();
  std::string message = "the recording is in " + name + ": V opens it";
  try {
    const std::optional<RunResult> result = run_->ended() ? run_->result() : std::nullopt;
    tape_->end(result ? &result->loop : nullptr);
  } catch (const InputError& error) {
    message = error.what();
    report_message(message);
  }
  viewport_.show_message(std::move(message));
}

std::string Window::recording_note() const {
  const std::string name = recording_now().filename().string();
  if (recording()) return fmt::format("{:.0f} s in {}", traces_->newest_time(), name);
  return name.empty() ? "not recorded" : "recorded: " + name;
}

}  // namespace palpate::app
