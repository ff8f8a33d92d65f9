#include "study/screens/study_screens.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>
#include <imgui.h>

#include "io/system/clock.h"
#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "palpate/error.h"

#include "study/screens/study_question.h"

namespace palpate::app {
namespace {

using study::ScreenInput;

constexpr double kFrameTime = 0.012;            // s, least: for windows that do not wait for their display
constexpr double kStatusPeriod = 0.5;           // s
constexpr std::size_t kMaxInputs = 64;          // waiting
constexpr Display::Size kUsualSize{1280, 720};  // of a window alone

double seconds_now() { return 1e-9 * static_cast<double>(monotonic_ns()); }

/// Shows a window on the whole of a display.
void fill_display(Viewport& window, int display) {
  SDL_SetWindowPosition(window.display().window(), static_cast<int>(SDL_WINDOWPOS_CENTERED_DISPLAY(display)),
                        static_cast<int>(SDL_WINDOWPOS_CENTERED_DISPLAY(display)));
  window.display().toggle_full_screen();
}

/// Shows a window on the left (0) or right half (1) of the display.
void fill_half(Viewport& window, int half) {
  SDL_Rect area{};
  if (SDL_GetDisplayUsableBounds(0, &area) != 0) return;
  SDL_SetWindowSize(window.display().window(), area.w / 2, area.h);
  SDL_SetWindowPosition(window.display().window(), area.x + half * (area.w / 2), area.y);
}

void fit_text(Viewport& window, bool participant) {
  constexpr float kStep = 16.0F;  // fonts are made again only for a visible change
  const Display::Size size = window.display().size();
  const auto width = static_cast<float>(size.width);
  const auto height = static_cast<float>(size.height);
  const float text = participant ? participant_text(width, height)
                                 : kFontHeight * std::min(width / 1040.0F, height / 600.0F);
  const float scale = std::clamp(std::round(kStep * text / kFontHeight) / kStep, 0.25F, 8.0F);
  if (scale != window.scale()) window.set_scale(scale);
}

/// Text whose letters the participant's window shows: sentences and consent.
std::string letters_of(const study::Study& study) {
  constexpr InputKind kConsent{"a consent text", std::uint64_t{1} << 20U};
  std::string letters = study.language.letters();
  const std::filesystem::path consent = study.file.parent_path() / study.consent_file;
  if (!study.consent_file.empty() && file_exists(consent))
    letters += InputFile(consent, kConsent).read_rest();
  return letters;
}

}  // namespace

StudyScreens::StudyScreens(const study::Study& study, StudyScreensOptions options)
    : study_(study), options_(std::move(options)), keys_(study) {
  if (study.experimenter_screen == "file") {
    status_.open(options_.status_file, std::ios::app);
    if (!status_) {
      throw InputError(
          fmt::format("{}: cannot be written; [screen] experimenter = \"none\" needs no such file",
                      options_.status_file.string()));
    }
  }
  if (options_.sound && study.sound_mask != "none") sound_ = std::make_unique<MaskingSound>(study);
  open_windows();
  if (keys_.uses_gamepad()) open_gamepads();
}

StudyScreens::~StudyScreens() {
  for (SDL_GameController* pad : gamepads_) SDL_GameControllerClose(pad);
  if (keys_.uses_gamepad()) SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER);
}

void StudyScreens::open_windows() {
  const Display::Size size = options_.size.value_or(kUsualSize);
  const bool two_windows = study_.experimenter_screen == "second-display";
  const std::string letters = letters_of(study_);
  participant_ = std::make_unique<Viewport>("Palpate study", size, 1.0F, study_fonts(letters));
  participant_->activate();
  if (const std::string missing = letters_without_font(letters); !missing.empty()) {
    throw InputError(fmt::format("{}: screen.language: no font has {}: install fonts-droid-fallback",
                                 study_.file.string(), missing));
  }
  const bool two_displays = SDL_GetNumVideoDisplays() > 1;
  if (two_windows) {
    experimenter_ =
        std::make_unique<Viewport>("Palpate study: experimenter", size, 1.0F, study_fonts(letters));
    SDL_GL_SetSwapInterval(0);  // only the participant's window waits for its display
  }
  if (options_.size) return;
  if (two_displays) {
    fill_display(*participant_, 0);
    if (two_windows) fill_display(*experimenter_, 1);
  } else if (two_windows) {
    fill_half(*participant_, 0);
    fill_half(*experimenter_, 1);
  }
  SDL_RaiseWindow(participant_->display().window());
}

void StudyScreens::open_gamepads() {
  SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");  // also while a note is typed
  if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0) {
    throw InputError(
        fmt::format("{}: response: no gamepad can be used: {}", study_.file.string(), SDL_GetError()));
  }
}

void StudyScreens::show(const study::ScreenContent& content) {
  content_ = content;
  view_ = participant_view(content, study_, study_.language);
  next_frame();
}

std::optional<ScreenInput> StudyScreens::take_input() {
  if (inputs_.empty()) return std::nullopt;
  const ScreenInput first = inputs_.front();
  inputs_.pop_front();
  return first;
}

std::string StudyScreens::take_note() {
  if (notes_.empty()) return {};
  std::string first = std::move(notes_.front());
  notes_.pop_front();
  return first;
}

std::optional<std::size_t> StudyScreens::ask(const study::Question& question) {
  question_ = question;
  question_since_ = seconds_now();
  answer_.reset();
  forget_answers();
  while (!answer_ && !interrupted()) next_frame();
  question_.reset();
  return interrupted() ? std::nullopt : answer_;
}

std::optional<bool> StudyScreens::audible_trial(const study::AudibleTrial& trial,
                                                const std::function<void(bool)>& noise) {
  forget_answers();
  audible_ = trial;
  const std::optional<int> answer = listen(trial, noise);
  audible_.reset();
  noise(false);
  if (!answer) return std::nullopt;
  return (*answer == 2) == trial.second;
}

std::optional<int> StudyScreens::listen(const study::AudibleTrial& trial,
                                        const std::function<void(bool)>& noise) {
  struct Step {
    double until;  // s
    int lit;
  };
  constexpr Step kSteps[] = {{1.0, 0}, {2.0, 1}, {2.5, 0}, {3.5, 2}};  // pause, interval, gap, interval
  view_ = {};
  view_.sentence =
      study_.language("Take your hand off the device. In which interval do you hear the device?");
  view_.progress = fmt::format("{} / {}", trial.number, trial.of);
  view_.part_done = (trial.number - 1.0) / trial.of;
  view_.boxes = true;
  const double began = seconds_now();
  for (const Step& step : kSteps) {
    view_.lit = step.lit;
    view_.action = step.lit == 0 ? study_.language("Wait")
                                 : fmt::format(fmt::runtime(study_.language("Interval {}")), step.lit);
    noise(step.lit == (trial.second ? 2 : 1));
    while (seconds_now() < began + step.until) {
      next_frame();
      if (interrupted()) return std::nullopt;
    }
  }
  noise(false);
  view_.lit = 0;
  view_.action = study_.language("Which one?");
  view_.first = text_of_keys(study_.first_keys, study_.language);
  view_.second = text_of_keys(study_.second_keys, study_.language);
  forget_answers();  // given during the intervals
  while (!interrupted()) {
    next_frame();
    while (const std::optional<ScreenInput> input = interrupted() ? std::nullopt : take_input()) {
      if (*input == ScreenInput::kFirst) return 1;
      if (*input == ScreenInput::kSecond) return 2;
    }
  }
  return std::nullopt;
}

void StudyScreens::forget_answers() {
  std::erase_if(inputs_, [](ScreenInput input) {
    return input == ScreenInput::kFirst || input == ScreenInput::kSecond || input == ScreenInput::kNext;
  });
}

bool StudyScreens::interrupted() const {
  return closed_ || std::any_of(inputs_.begin(), inputs_.end(), [](ScreenInput input) {
           return input == ScreenInput::kStop || input == ScreenInput::kWithdraw ||
                  input == ScreenInput::kForceOff;
         });
}

void StudyScreens::next_frame() {
  const double left = frame_began_ + kFrameTime - seconds_now();
  if (left > 0.0) SDL_Delay(static_cast<Uint32>(1e3 * left));
  frame_began_ = seconds_now();
  if (!closed_ && options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed)) leave();
  if (closed_) return;
  try {
    SDL_Event event;
    while (!closed_ && SDL_PollEvent(&event) != 0) {
      take_event(event);
      if (event.type == SDL_DROPFILE) SDL_free(event.drop.file);
    }
    const double now = seconds_now();
    if (withdraw_.take_completed(now)) press(ScreenInput::kWithdraw);
    if (!closed_) draw();
    write_status(now);
  } catch (const DisplayLost&) {
    leave();
  }
}

void StudyScreens::draw() {
  draw_participants();
  if (experimenter_ == nullptr) return;
  draw_experimenters();
  for (const ScreenInput input : controls_.pressed) {
    if (input != ScreenInput::kStop || asks_to_stop_) press(input);
    asks_to_stop_ = input == ScreenInput::kStop && !asks_to_stop_;
  }
  controls_.pressed.clear();
  if (controls_.stored) notes_.push_back(*controls_.stored);
  controls_.stored.reset();
}

bool StudyScreens::asks_experimenter() const {
  return question_ && question_->who == "experimenter" && experimenter_ != nullptr;
}

void StudyScreens::draw_participants() {
  Viewport& window = *participant_;
  window.activate();
  fit_text(window, true);
  window.begin_panels();
  if (question_ && !asks_experimenter()) {
    study::Question shown = *question_;
    const study::Language& say = study_.language;
    if (shown.who == "experimenter") {
      shown.text = "For the experimenter:\n\n" + shown.text;
    } else {
      shown.text = say(shown.text);
      for (std::string& answer : shown.answers) answer = say(answer);
    }
    if (const auto pressed = draw_question(shown, say("↓  more below: Page Down or wheel")))
      answer_ = pressed;
  } else if (question_) {
    ParticipantView waits;
    waits.action = study_.language("Please wait");
    draw_participant(waits);
  } else {
    draw_participant(view_);
  }
  draw_notices(false);
  Viewport::end_panels();
  window.clear();
  Viewport::draw_panels();
  window.show();
}

void StudyScreens::draw_experimenters() {
  Viewport& window = *experimenter_;
  window.activate();
  fit_text(window, false);
  window.begin_panels();
  if (asks_experimenter()) {
    controls_.typing = false;
    if (const auto pressed = draw_question(*question_)) answer_ = pressed;
  } else {
    draw_experimenter(content_, experimenter_view(), controls_);
  }
  draw_notices(true);
  Viewport::end_panels();
  window.clear();
  Viewport::draw_panels();
  window.show();
}

void StudyScreens::draw_notices(bool experimenters) const {
  const double held = withdraw_.part(seconds_now());
  if (held > 0.0) {
    draw_notice(fmt::format(fmt::runtime(study_.language("Keep holding {} to withdraw from the study")),
                            text_of_keys({study_.withdraw_key}, study_.language)),
                held);
  } else if (asks_to_stop_ && (experimenters || experimenter_ == nullptr)) {
    draw_notice("Stop the session?\nEnter: stop     Esc: go on", std::nullopt);
  }
}

ExperimenterView StudyScreens::experimenter_view() const {
  ExperimenterView view;
  view.asks_to_stop = asks_to_stop_;
  view.title = options_.title;
  const ParticipantView english = participant_view(content_, study_, {});
  view.action =
      english.action + (english.action.empty() || english.message.empty() ? "" : "; ") + english.message;
  view.ladder = ladder_of(content_, study_);
  const std::vector<Paragraph> asked = paragraphs_of(question_ ? question_->text : std::string());
  if (!asked.empty()) view.question = asked.front().text;
  if (audible_) {
    view.question =
        fmt::format("In which interval is the noise heard? Trial {} of {}", audible_->number, audible_->of);
  }
  view.sound_lost = sound_ != nullptr && !sound_->plays();
  view.sound = sound_ == nullptr ? "none"
               : view.sound_lost ? "the sound device has stopped"
                                 : study_.sound_mask;
  return view;
}

void StudyScreens::write_status(double now) {
  if (!status_.is_open() || now < status_written_ + kStatusPeriod) return;
  status_written_ = now;
  status_ << status_line(content_, experimenter_view()) << std::endl;
}

void StudyScreens::press(ScreenInput input) {
  if (input == ScreenInput::kPause) controls_.pausing = true;
  if (inputs_.size() < kMaxInputs) inputs_.push_back(input);
}

void StudyScreens::leave() {
  closed_ = true;
  press(ScreenInput::kStop);
}

render::Image StudyScreens::participant_picture() const {
  participant_->activate();
  participant_->clear();
  Viewport::draw_panels();
  return participant_->picture();
}

render::Image StudyScreens::experimenter_picture() const {
  experimenter_->activate();
  experimenter_->clear();
  Viewport::draw_panels();
  return experimenter_->picture();
}

std::uint32_t StudyScreens::participant_window() const {
  return SDL_GetWindowID(participant_->display().window());
}

std::uint32_t StudyScreens::experimenter_window() const {
  return SDL_GetWindowID(experimenter_->display().window());
}

}  // namespace palpate::app
