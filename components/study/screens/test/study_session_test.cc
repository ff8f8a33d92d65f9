// A whole session in the windows, in real time, with a simulated observer in the chair.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "app/window/test/window_fixture.h"
#include "study/screens/test/study_chair.h"
#include "study/session/verify.h"

namespace palpate::app {
namespace {

constexpr const char* kShortStudy = R"(
[study]
name = "short"
scene = "box"
[breaks]
least_s = 0
[sound]
mask = "none"
[[condition]]
name = "off"
share = 0
[[condition]]
name = "on"
share = 0.6
[[task]]
name = "threshold"
kind = "noise-threshold"
sigma_mN = { from = 1, to = 100 }
sets_share_of = "threshold"
examples = 1
practice = 1
trials = 2
[[task]]
name = "stiff"
kind = "stiffness"
ratio = { least = 1.02, largest = 3.3 }
depth_mm = 4
conditions = ["off", "on"]
trials = 1
[[check]]
kind = "blinding"
)";

class StudySession : public WindowTest {};

// Late ticks of a busy machine may spoil trials, which are repeated, but never what the log says of them.
TEST_F(StudySession, RunsThroughTheWindowsAndItsRecordingsFitItsLog) {
  if (!display_is_there()) return;
  std::ofstream(file("short.toml")) << kShortStudy;
  study::prepare_study(file("short.toml"), file("study"), 1);
  study::StudyFolder folder = study::open_study(file("study"));
  study::mark_simulated(folder);
  StudyScreensOptions windows;
  windows.sound = false;
  windows.size = {240, 150};
  StudyScreens screens(folder.study, windows);
  StudyChair chair(screens, {});
  study::SessionOptions options;
  options.participant = folder.ids.front();
  options.observer = "ideal";
  options.screens = &chair;
  const study::SessionOutcome outcome = study::run_session(folder, folder.key, options);
  EXPECT_TRUE(outcome.complete);
  EXPECT_GE(outcome.trials, 5);
  const study::ParticipantLog log = folder.read(options.participant);
  int edges = 0;  // a threshold at the edge of the stimuli is one question more
  for (const study::EventRecord& event : log.events) {
    if (event.event == "threshold" && event.value("edge") != "no") ++edges;
  }
  EXPECT_EQ(chair.questions - edges, 2 + 2 * 2 + 1)
      << "instructions of two tasks, two questions to two people, the end";
  study::VerifyCounts counts;
  study::verify_participant(
      folder, options.participant, [](const auto& /*recording*/) { return ""; }, counts);
  EXPECT_EQ(counts.recordings, static_cast<std::size_t>(outcome.blocks));
  for (const study::TrialRecord& trial : log.trials) {
    EXPECT_EQ(trial.observer, "ideal");
    EXPECT_TRUE(!trial.spoiled.empty() || trial.response_time > 0.2);
  }
}

}  // namespace
}  // namespace palpate::app
