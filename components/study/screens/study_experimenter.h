#pragma once
#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "study/session/run_session.h"
#include "study/session/study.h"

namespace palpate::app {

/// What the experimenter's window shows besides the content of the screens.
struct ExperimenterView {
  std::string title;     // study and participant
  std::string action;    // what the participant's screen says, in English: "Press"
  std::string question;  // which the participant is answering; empty: none
  std::string sound;     // state of the masking noise
  bool sound_lost = false;
  bool asks_to_stop = false;   // the stop button was pressed once
  std::vector<double> ladder;  // N
};

/// State of the experimenter's controls.
struct ExperimenterControls {
  std::array<char, 400> note{};             // being typed
  std::deque<std::string> notes;            // stored ones, the last first
  bool pausing = false;                     // a pause was asked for in this trial
  bool typing = false;                      // keys go to the note
  std::vector<study::ScreenInput> pressed;  // buttons of this frame
  std::optional<std::string> stored;        // note that was stored in this frame
};

/// [any] Levels to plot: only those of a noise threshold task.
[[nodiscard]] std::vector<double> ladder_of(const study::ScreenContent& content, const study::Study& study);

/// [any] "trial 14 of 60, part 2 of 5, ..." in one line, for a log.
[[nodiscard]] std::string status_line(const study::ScreenContent& content, const ExperimenterView& view);

/// [setup] Draws the experimenter's window and takes its buttons.
void draw_experimenter(const study::ScreenContent& content, const ExperimenterView& view,
                       ExperimenterControls& controls);

}  // namespace palpate::app
