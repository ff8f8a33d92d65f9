#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/window/viewport.h"
#include "study/screens/study_experimenter.h"
#include "study/screens/study_keys.h"
#include "study/screens/study_participant.h"
#include "study/screens/study_sound.h"
#include "study/session/run_session.h"

namespace palpate::app {

/// Options of a session's windows.
struct StudyScreensOptions {
  std::string title;                        // study and participant, for the experimenter
  std::filesystem::path status_file;        // of `experimenter = "file"`: a line is added every 0.5 s
  std::optional<Display::Size> size;        // of both windows; empty: each fills a display, or half of one
  bool sound = true;                        // masking noise as the study has it
  const std::atomic<bool>* stop = nullptr;  // ends the session as closing a window does, e.g. Ctrl-C
};

/// The two windows, the keys and the masking noise of a session with a person. Keys count in both windows:
/// the study's answer keys; Space: next; F9: pause; F10: force off; F11: full screen; Esc: asks whether to
/// stop. All members: [setup], the constructing thread.
class StudyScreens final : public study::SessionScreens {
 public:
  /// The study must outlive this object. @throws InputError for a key or a sound device, NoWindow
  StudyScreens(const study::Study& study, StudyScreensOptions options);
  ~StudyScreens() override;
  StudyScreens(const StudyScreens&) = delete;
  StudyScreens& operator=(const StudyScreens&) = delete;

  void show(const study::ScreenContent& content) override;
  std::optional<study::ScreenInput> take_input() override;
  std::string take_note() override;
  /// Also empty when stop, withdraw or force off was pressed; take_input() then returns it.
  std::optional<std::size_t> ask(const study::Question& question) override;
  /// Empty as with ask(). The noise is off when it returns.
  std::optional<bool> audible_trial(const study::AudibleTrial& trial,
                                    const std::function<void(bool)>& noise) override;

  /// Whether a window was closed or the display was lost. Then nothing is drawn any more.
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  /// The windows as last drawn.
  [[nodiscard]] render::Image participant_picture() const;
  [[nodiscard]] render::Image experimenter_picture() const;
  [[nodiscard]] std::uint32_t participant_window() const;
  [[nodiscard]] std::uint32_t experimenter_window() const;

 private:
  void open_windows();
  void open_gamepads();
  void next_frame();
  void draw();
  void draw_participants();
  void draw_experimenters();
  void draw_notices(bool experimenters) const;
  [[nodiscard]] ExperimenterView experimenter_view() const;
  void write_status(double now);
  void take_event(const SDL_Event& event);
  void key_down(const SDL_Event& event, Viewport& window);
  void function_key(SDL_Keycode key, Viewport& window);
  void press(study::ScreenInput input);
  void leave();
  void forget_answers();
  [[nodiscard]] bool interrupted() const;
  [[nodiscard]] bool asks_experimenter() const;
  std::optional<int> listen(const study::AudibleTrial& trial, const std::function<void(bool)>& noise);

  const study::Study& study_;
  StudyScreensOptions options_;
  StudyKeys keys_;
  std::unique_ptr<Viewport> participant_;
  std::unique_ptr<Viewport> experimenter_;  // empty: the study has none
  std::unique_ptr<MaskingSound> sound_;
  std::vector<SDL_GameController*> gamepads_;
  std::ofstream status_;
  double status_written_ = -1.0;  // s
  double frame_began_ = 0.0;      // s

  study::ScreenContent content_;
  ParticipantView view_;
  std::optional<study::AudibleTrial> audible_;
  std::optional<study::Question> question_;
  double question_since_ = 0.0;  // s
  std::optional<std::size_t> answer_;
  ExperimenterControls controls_;
  HeldKey withdraw_;
  bool asks_to_stop_ = false;
  bool closed_ = false;
  std::deque<study::ScreenInput> inputs_;
  std::deque<std::string> notes_;
};

}  // namespace palpate::app
