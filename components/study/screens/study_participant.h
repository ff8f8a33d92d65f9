#pragma once
#include <optional>
#include <string>
#include <vector>

#include <imgui.h>

#include "app/window/theme.h"
#include "study/session/run_session.h"
#include "study/session/study.h"

namespace palpate::app {

/// What the participant's window shows: text, two boxes and bars, never the organ.
struct ParticipantView {
  struct ForceBar {
    double force = 0.0;  // N; the bar ends at 1.5 x high
    double low = 0.0;    // N, band to press into
    double high = 0.0;
  };

  std::string progress;       // "part 2 of 5"; empty: no progress bar
  double part_done = 0.0;     // 0 to 1
  std::string sentence;       // what to do in this task
  bool boxes = false;         // of the two intervals
  int lit = 0;                // 1 or 2 while that interval lasts
  std::string first, second;  // keys of the answers, while an answer is awaited
  std::string action;         // what to do now
  std::string message;        // "correct"
  std::string rest = "Take your hand off the device and rest.";  // in a break
  std::string more = "press more", less = "press less", good = "good";
  std::optional<ForceBar> bar;
  std::optional<double> break_left;  // s
};

/// [any] The participant's view of a moment of a session, in a language.
[[nodiscard]] ParticipantView participant_view(const study::ScreenContent& content, const study::Study& study,
                                               const study::Language& say);

/// Fonts of the study's windows, in the order of ImGui's list.
enum class StudyFont : int { kText, kLarge, kDigits };

/// Extra fonts for Viewport: kLarge and kDigits.
/// @param letters text whose letters the fonts need besides Latin
[[nodiscard]] std::vector<ExtraFont> study_fonts(const std::string& letters);
[[nodiscard]] ImFont* study_font(StudyFont which);

/// [setup] Height of the text of the participant's window in a window of this size: 44 px at 1920 x 1080.
[[nodiscard]] float participant_text(float width, float height);

/// [setup] Draws the participant's view behind all ImGui windows of the current context.
void draw_participant(const ParticipantView& view);

/// [setup] Draws a notice over everything, with a bar that is filled to `part` (0 to 1).
void draw_notice(const std::string& text, std::optional<double> part);

/// Alignment of text lines.
enum class Align { kLeft, kCentre, kRight };

/// [setup] Draws wrapped text. @param at upper end of the left, middle or right of the lines @return height
float draw_text(ImDrawList& list, StudyFont font, ImVec2 at, Align align, float width, ImU32 colour,
                const std::string& text);

}  // namespace palpate::app
