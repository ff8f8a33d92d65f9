// The windows of a study on Xvfb, driven by synthetic events.
#include "study/screens/study_screens.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"

#include "app/window/test/window_fixture.h"
#include "study/screens/study_question.h"
#include "study/screens/test/study_contents.h"

namespace palpate::app {
namespace {

using study::Question;
using study::ScreenContent;
using study::ScreenInput;
using study::Study;
using study::TrialState;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr Display::Size kStudySize{960, 540};
constexpr Display::Size kSmall{240, 135};  // for tests that look at no picture: it is drawn in software

void push_key(SDL_Keycode key, Uint32 window = 0, Uint32 type = SDL_KEYDOWN) {
  SDL_Event event{};
  event.type = type;
  event.key.windowID = window;
  event.key.keysym.sym = key;
  event.key.keysym.scancode = SDL_GetScancodeFromKey(key);
  SDL_PushEvent(&event);
}

void push_text(const std::string& text, Uint32 window) {
  SDL_Event event{};
  event.type = SDL_TEXTINPUT;
  event.text.windowID = window;
  SDL_strlcpy(event.text.text, text.c_str(), sizeof event.text.text);
  SDL_PushEvent(&event);
}

void push_mouse(int x, int y, Uint32 window, Uint32 type) {
  SDL_Event event{};
  event.type = type;
  if (type == SDL_MOUSEMOTION) {
    event.motion.windowID = window;
    event.motion.x = x;
    event.motion.y = y;
  } else {
    event.button.windowID = window;
    event.button.button = SDL_BUTTON_LEFT;
    event.button.x = x;
    event.button.y = y;
  }
  SDL_PushEvent(&event);
}

/// Does something again and again on a thread of its own, while a question waits.
class Meanwhile final {
 public:
  explicit Meanwhile(std::function<void()> action)
      : thread_([this, action = std::move(action)] {
          while (!over_) {
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
            action();
          }
        }) {}
  ~Meanwhile() {
    over_ = true;
    thread_.join();
  }
  Meanwhile(const Meanwhile&) = delete;
  Meanwhile& operator=(const Meanwhile&) = delete;

 private:
  std::atomic<bool> over_{false};
  std::thread thread_;
};

class StudyScreensTest : public WindowTest {
 protected:
  std::unique_ptr<StudyScreens> open(const StudyScreensOptions& wanted = {}, Display::Size size = kSmall) {
    StudyScreensOptions options = wanted;
    options.size = size;
    return std::make_unique<StudyScreens>(study_, options);
  }
  static void show(StudyScreens& screens, const ScreenContent& content) {
    for (int i = 0; i < 3; ++i) screens.show(content);
  }
  static void click(StudyScreens& screens, const ScreenContent& content, int x, int y) {
    push_mouse(x, y, screens.experimenter_window(), SDL_MOUSEMOTION);
    show(screens, content);
    for (const Uint32 type : {SDL_MOUSEBUTTONDOWN, SDL_MOUSEBUTTONUP}) {
      push_mouse(x, y, screens.experimenter_window(), type);
      show(screens, content);
    }
  }
  static std::vector<ScreenInput> inputs(StudyScreens& screens) {
    std::vector<ScreenInput> all;
    while (const std::optional<ScreenInput> input = screens.take_input()) all.push_back(*input);
    return all;
  }

  Study study_ = contents::study();
};

TEST(StudyView, BoxesBarAndKeysAreShownInTheirStates) {
  const Study study = contents::study();
  ScreenContent press = contents::moment(TrialState::kReach);
  press.trial.bar = true;
  EXPECT_TRUE(participant_view(press, study, {}).bar.has_value());
  EXPECT_EQ(participant_view(press, study, {}).lit, 0);
  const ParticipantView interval = participant_view(contents::moment(TrialState::kInterval), study, {});
  EXPECT_FALSE(interval.bar.has_value()) << "the force is not shown during an interval";
  EXPECT_EQ(interval.lit, 1);
  EXPECT_EQ(interval.first, "");
  const ParticipantView answer = participant_view(contents::moment(TrialState::kAnswer), study, {});
  EXPECT_EQ(answer.lit, 0);
  EXPECT_EQ(answer.first, "1, F or left pedal");
  EXPECT_EQ(answer.progress, "part 2 of 5");
  EXPECT_TRUE(answer.boxes);
  EXPECT_FALSE(participant_view(contents::moment(TrialState::kInterval, "hold"), study, {}).boxes)
      << "a task without intervals";
  ScreenContent deep = contents::moment(TrialState::kInterval, "stiffness");
  EXPECT_EQ(participant_view(deep, study, {}).action, "Press");
  deep.trial.deep_enough = true;
  EXPECT_EQ(participant_view(deep, study, {}).action, "Come up");
}

TEST(StudyView, FeedbackIsNotShownBesideTheNextStimuli) {
  const Study study = contents::study();
  ScreenContent content = contents::moment(TrialState::kHome);
  content.message = "correct";
  EXPECT_EQ(participant_view(content, study, {}).message, "correct");
  for (const TrialState state :
       {TrialState::kReach, TrialState::kInterval, TrialState::kGap, TrialState::kAnswer}) {
    content.trial.state = state;
    EXPECT_EQ(participant_view(content, study, {}).message, "");
  }
}

TEST(StudyView, ABreakBeforeAnExampleSaysHowToGoOn) {
  ScreenContent content = contents::moment(TrialState::kIdle, "stiffness");
  content.message = "Press Space or an answer key to go on";
  content.example = 2;
  EXPECT_EQ(participant_view(content, contents::study(), {}).message, content.message);
  EXPECT_EQ(participant_view(content, contents::study(), {}).action, "");
  content.message.clear();
  EXPECT_EQ(participant_view(content, contents::study(), {}).action, "Please wait");
  content.trial.state = TrialState::kHome;
  EXPECT_EQ(participant_view(content, contents::study(), {}).message, "Example: interval 2 is stiffer");
}

TEST(StudyView, LevelsAreShownInANoiseThresholdTaskOnly) {
  const Study study = contents::study();
  EXPECT_EQ(ladder_of(contents::moment(TrialState::kHome, "threshold"), study).size(), 14U);
  EXPECT_TRUE(ladder_of(contents::moment(TrialState::kHome, "stiffness"), study).empty());
  EXPECT_TRUE(ladder_of(contents::moment(TrialState::kHome, "unknown"), study).empty());
}

TEST(StudyView, LinesOfAConsentFormAreJoinedToParagraphs) {
  EXPECT_THAT(
      paragraphs_of("# Consent\nYou press\non tissue.\n\n- You may\n  stop.\n- No device.\n**Bold**\n"),
      ElementsAre(Paragraph{"Consent", true}, Paragraph{"You press on tissue.", false},
                  Paragraph{"• You may stop.", false}, Paragraph{"• No device. **Bold**", false}));
}

TEST_F(StudyScreensTest, KeysOfBothWindowsAreInputs) {
  if (!display_is_there()) return;
  const auto screens = open();
  const ScreenContent content = contents::moment(TrialState::kAnswer);
  show(*screens, content);
  push_key(SDLK_1, screens->participant_window());
  push_key(SDLK_RIGHT, screens->experimenter_window());
  push_key(SDLK_F9);
  push_key(SDLK_F10);
  push_key(SDLK_SPACE);
  show(*screens, content);
  EXPECT_THAT(inputs(*screens), ElementsAre(ScreenInput::kFirst, ScreenInput::kSecond, ScreenInput::kPause,
                                            ScreenInput::kForceOff, ScreenInput::kNext));
}

TEST_F(StudyScreensTest, EscAsksBeforeTheSessionStops) {
  if (!display_is_there()) return;
  const auto screens = open({}, kStudySize);
  const ScreenContent content = contents::moment(TrialState::kHome);
  show(*screens, content);
  const render::Image before = screens->participant_picture();
  const render::Image unasked = screens->experimenter_picture();
  push_key(SDLK_RETURN);
  push_key(SDLK_ESCAPE);
  show(*screens, content);
  EXPECT_NE(screens->experimenter_picture().rgb, unasked.rgb) << "the question is shown";
  EXPECT_EQ(screens->participant_picture().rgb, before.rgb) << "to the experimenter alone, in English";
  push_key(SDLK_ESCAPE);
  show(*screens, content);
  EXPECT_EQ(screens->experimenter_picture().rgb, unasked.rgb);
  EXPECT_TRUE(inputs(*screens).empty());
  push_key(SDLK_ESCAPE);
  push_key(SDLK_RETURN);
  show(*screens, content);
  EXPECT_THAT(inputs(*screens), ElementsAre(ScreenInput::kStop));
}

TEST_F(StudyScreensTest, TheHeldKeyWithdraws) {
  if (!display_is_there()) return;
  const auto screens = open();
  const ScreenContent content = contents::moment(TrialState::kInterval);
  push_key(SDLK_F12);
  show(*screens, content);
  EXPECT_TRUE(inputs(*screens).empty()) << "not yet";
  std::optional<ScreenInput> input;
  for (int i = 0; i < 2000 && !input; ++i) {
    screens->show(content);
    input = screens->take_input();
    SDL_Delay(10);
  }
  EXPECT_EQ(input, ScreenInput::kWithdraw);
}

TEST_F(StudyScreensTest, TheParticipantsPictureShowsNothingOfTheExperimenters) {
  if (!display_is_there()) return;
  const auto screens = open({}, kStudySize);
  const ScreenContent content = contents::moment(TrialState::kInterval);
  ScreenContent other = content;
  other.ladder = {1e-3, 2e-3};
  other.spoiled = 9;
  other.catch_correct = 1;
  other.late_ticks = 77;
  other.trial.force = 2.0;  // no bar is shown in an interval
  show(*screens, content);
  const render::Image participant = screens->participant_picture();
  const render::Image experimenter = screens->experimenter_picture();
  show(*screens, other);
  EXPECT_EQ(screens->participant_picture().rgb, participant.rgb);
  EXPECT_NE(screens->experimenter_picture().rgb, experimenter.rgb);
  ScreenContent unlit = content;
  unlit.trial.interval = 2;
  show(*screens, unlit);
  EXPECT_NE(screens->participant_picture().rgb, participant.rgb);
}

TEST_F(StudyScreensTest, TheExperimentersPictureHasNoLevelsOfATaskWithConditions) {
  if (!display_is_there()) return;
  const auto screens = open({}, kStudySize);
  ScreenContent content = contents::moment(TrialState::kInterval, "stiffness");
  show(*screens, content);
  const render::Image with = screens->experimenter_picture();
  content.ladder.clear();
  show(*screens, content);
  EXPECT_EQ(screens->experimenter_picture().rgb, with.rgb);
}

TEST_F(StudyScreensTest, AQuestionIsAnsweredByItsNumberButNotByAnEarlierKey) {
  if (!display_is_there()) return;
  const auto screens = open();
  show(*screens, contents::moment(TrialState::kAnswer));
  push_key(SDLK_2);  // meant for the trial
  const Meanwhile keys([] { push_key(SDLK_3); });
  EXPECT_EQ(screens->ask(contents::blinding("participant")), 2U);
  EXPECT_EQ(screens->ask(contents::blinding("experimenter")), 2U);
}

TEST_F(StudyScreensTest, SpaceGoesOnWhereThereIsNothingToChoose) {
  if (!display_is_there()) return;
  const auto screens = open();
  {
    const Meanwhile keys([] {
      push_key(SDLK_SPACE);
      push_key(SDLK_2);
    });
    EXPECT_EQ(screens->ask({"participant", "Ready?", {"No", "Yes"}}), 1U) << "Space chooses nothing";
  }
  const Meanwhile space([] { push_key(SDLK_SPACE); });
  EXPECT_EQ(screens->ask({"participant", "Press once.", {"Go on"}}), 0U);
}

TEST_F(StudyScreensTest, AClosedWindowEndsAQuestion) {
  if (!display_is_there()) return;
  const auto screens = open();
  const Meanwhile closes([&] {
    SDL_Event event{};
    event.type = SDL_WINDOWEVENT;
    event.window.event = SDL_WINDOWEVENT_CLOSE;
    SDL_PushEvent(&event);
  });
  EXPECT_EQ(screens->ask(contents::consent()), std::nullopt);
  EXPECT_TRUE(screens->closed());
  EXPECT_EQ(screens->take_input(), ScreenInput::kStop);
}

TEST_F(StudyScreensTest, ASignalEndsAQuestionAndTheSession) {
  if (!display_is_there()) return;
  std::atomic<bool> stop{false};
  StudyScreensOptions options;
  options.stop = &stop;
  const auto screens = open(options);
  const Meanwhile signal([&] { stop = true; });
  EXPECT_EQ(screens->ask({"participant", "Ready?", {"Yes", "No"}}), std::nullopt);
  EXPECT_EQ(inputs(*screens), std::vector<ScreenInput>{ScreenInput::kStop});
  show(*screens, {});
  EXPECT_TRUE(inputs(*screens).empty()) << "once";
}

TEST_F(StudyScreensTest, ForceOffEndsAQuestion) {
  if (!display_is_there()) return;
  const auto screens = open();
  std::optional<std::size_t> answer;
  {
    const Meanwhile keys([] { push_key(SDLK_F10); });
    answer = screens->ask(contents::consent());
  }
  EXPECT_EQ(answer, std::nullopt);
  EXPECT_EQ(screens->ask(contents::ages()), std::nullopt) << "nobody has taken the input yet";
  EXPECT_EQ(screens->take_input(), ScreenInput::kForceOff);
}

TEST_F(StudyScreensTest, TheDeviceSoundsInOneIntervalOfAnAudibleTrial) {
  if (!display_is_there()) return;
  const auto screens = open();
  std::vector<bool> switched;
  const Meanwhile keys([] { push_key(SDLK_2); });
  EXPECT_EQ(screens->audible_trial({3, 20, true}, [&](bool on) { switched.push_back(on); }), true);
  // Pause, interval 1, gap, interval 2, answer, end.
  EXPECT_THAT(switched, ElementsAre(false, false, false, true, false, false));
}

TEST_F(StudyScreensTest, ANoteIsStoredByEnterAndItsLettersAreNoAnswers) {
  if (!display_is_there()) return;
  const auto screens = open({}, kStudySize);
  const ScreenContent content = contents::moment(TrialState::kAnswer, "stiffness");
  const Uint32 window = screens->experimenter_window();
  show(*screens, content);
  click(*screens, content, 700, 63);
  push_key(SDLK_f, window);
  push_text("fine", window);
  show(*screens, content);
  push_key(SDLK_RETURN, window);
  show(*screens, content);
  push_key(SDLK_RETURN, window, SDL_KEYUP);
  show(*screens, content);
  EXPECT_EQ(screens->take_note(), "fine");
  EXPECT_EQ(screens->take_note(), "");
  EXPECT_TRUE(inputs(*screens).empty());
  push_key(SDLK_f, window);
  show(*screens, content);
  EXPECT_THAT(inputs(*screens), ElementsAre(ScreenInput::kFirst)) << "the note is complete";
}

TEST_F(StudyScreensTest, TheRedButtonTurnsTheForceOff) {
  if (!display_is_there()) return;
  const auto screens = open({}, kStudySize);
  const ScreenContent content = contents::moment(TrialState::kInterval);
  show(*screens, content);
  const Rectangle corner{780.0F, 480.0F, 180.0F, 60.0F};
  EXPECT_GT(red_share(screens->experimenter_picture(), corner), 0.4);
  click(*screens, content, 860, 505);
  EXPECT_THAT(inputs(*screens), ElementsAre(ScreenInput::kForceOff));
}

TEST_F(StudyScreensTest, WithoutAnExperimentersWindowAFileHasTheStatus) {
  if (!display_is_there()) return;
  study_.experimenter_screen = "file";
  StudyScreensOptions options;
  options.status_file = file("status.txt");
  const auto screens = open(options);
  show(*screens, contents::moment(TrialState::kReach));
  const Meanwhile keys([] { push_key(SDLK_1); });
  EXPECT_EQ(screens->ask(contents::blinding("experimenter")), 0U) << "in the participant's window";
  std::ifstream in(file("status.txt"));
  std::string line;
  std::getline(in, line);
  EXPECT_THAT(line, HasSubstr("trial 14 of 60; part 2 of 5; block 3; force 0.84 of 6.0 N"));
  options.status_file = folder() / "none" / "status.txt";
  EXPECT_THROW(open(options), InputError);
}

}  // namespace
}  // namespace palpate::app
