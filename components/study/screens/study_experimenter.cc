#include "study/screens/study_experimenter.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include <fmt/core.h>
#include <imgui.h>

#include "palpate/device.h"

#include "app/window/theme.h"
#include "study/screens/study_participant.h"

namespace palpate::app {
namespace {

using study::ScreenContent;
using study::ScreenInput;
using study::TrialState;

constexpr std::size_t kNotesShown = 12;

std::string clock_of(double minutes) {
  const int seconds = static_cast<int>(std::max(0.0, 60.0 * minutes));
  return fmt::format("{}:{:02}", seconds / 60, seconds % 60);
}

std::string homing_of(TrialState state) {
  if (state == TrialState::kHome) return "waiting for the hand";
  return state == TrialState::kIdle ? "-" : "at the start";
}

std::string state_of(const study::TrialView& trial) {
  if (trial.state == TrialState::kInterval) return fmt::format("Interval {}", trial.interval);
  std::string state = study::describe(trial.state);
  if (!state.empty()) state[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(state[0])));
  return state;
}

std::string fault_of(const study::TrialView& trial) {
  return haptics::describe(static_cast<haptics::Fault>(trial.fault));
}

/// Number of the trial that runs, from 1.
int trial_number(const study::CoursePosition& at) { return std::min(at.done + 1, at.of); }

std::string catches_of(const ScreenContent& content) {
  return content.catch_trials == 0 ? "none yet"
                                   : fmt::format("{} of {}", content.catch_correct, content.catch_trials);
}

void entry(const char* name, const std::string& value, bool warn = false) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextDisabled("%s", name);
  ImGui::TableNextColumn();
  if (warn) ImGui::PushStyleColor(ImGuiCol_Text, colour::kWarning);
  ImGui::TextWrapped("%s", value.c_str());
  if (warn) ImGui::PopStyleColor();
}

void draw_state(const ScreenContent& content, const ExperimenterView& view) {
  ImGui::PushFont(study_font(StudyFont::kLarge));
  if (content.trial.fault != 0) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour::kWarning);
    ImGui::TextWrapped("Zero force: %s", fault_of(content.trial).c_str());
    ImGui::PopStyleColor();
  } else if (!view.question.empty()) {
    ImGui::TextWrapped("The participant answers a question");
  } else if (content.break_left > 0.0) {
    ImGui::TextWrapped("Break: %.0f s", std::ceil(content.break_left));
  } else {
    ImGui::TextWrapped("%s", state_of(content.trial).c_str());
  }
  ImGui::PopFont();
  ImGui::TextDisabled("%s", view.question.empty() ? view.action.c_str() : view.question.c_str());
}

void draw_table(const ScreenContent& content, const ExperimenterView& view) {
  const float text = ImGui::GetFontSize();
  if (!ImGui::BeginTable("figures", 2)) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthFixed, 10.0F * text);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch);
  const study::CoursePosition& at = content.position;
  entry("task", content.task);
  entry("trial", at.of == 0             ? "-"
                 : content.example != 0 ? "example"
                 : content.practice     ? "practice"
                                        : fmt::format("{} of {}", trial_number(at), at.of));
  entry("part", fmt::format("{} of {}", std::min(at.part + 1, at.parts), at.parts));
  entry("session, block", fmt::format("{}, {}", content.session, content.block));
  entry("session clock", clock_of(content.minutes));
  entry("homing", homing_of(content.trial.state));
  entry("late ticks", std::to_string(content.late_ticks), content.late_ticks > 0);
  entry("spoiled trials", std::to_string(content.spoiled), content.spoiled > 0);
  entry("catch trials right", catches_of(content));
  entry("masking noise", view.sound, view.sound_lost);
  ImGui::EndTable();
}

/// Tissue force against the limit.
void draw_force(const ScreenContent& content) {
  const double limit = content.max_force;
  const double share = limit > 0.0 ? std::clamp(content.trial.force / limit, 0.0, 1.0) : 0.0;
  ImGui::TextDisabled("tissue force");
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram,
                        share > 0.8 ? colour::kFault : ImVec4(0.25F, 0.42F, 0.56F, 1.0F));
  ImGui::ProgressBar(static_cast<float>(share), ImVec2(-1.0F, 1.8F * ImGui::GetFontSize()),
                     fmt::format("{:.2f} N, limit {:.1f} N", content.trial.force, limit).c_str());
  ImGui::PopStyleColor();
}

/// Numbers 1, 2 and 5 times powers of ten in a range.
std::vector<double> log_ticks(double low, double high) {
  std::vector<double> ticks;
  for (double power = std::pow(10.0, std::floor(std::log10(low))); power <= high; power *= 10.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (factor * power >= low && factor * power <= high) ticks.push_back(factor * power);
    }
  }
  return ticks;
}

/// Levels of the noise threshold task over the trials, on a logarithmic axis in mN.
void draw_ladder(const std::vector<double>& levels, const ImVec2& size) {
  ImGui::TextDisabled("noise level [mN] over trials");
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::Dummy(size);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float text = ImGui::GetFontSize();
  const ImVec2 low(corner.x + 2.6F * text, corner.y + 0.4F * text);
  const ImVec2 high(corner.x + size.x, corner.y + size.y - 1.5F * text);
  const auto [least, most] = std::minmax_element(levels.begin(), levels.end());
  const double bottom = std::log10(0.8e3 * std::max(1e-6, *least));
  const double top = std::max(bottom + 0.5, std::log10(1.25e3 * std::max(1e-6, *most)));
  const auto y_of = [&](double milli) {
    return high.y - static_cast<float>((std::log10(milli) - bottom) / (top - bottom)) * (high.y - low.y);
  };
  const float across = (high.x - low.x) / static_cast<float>(std::max<std::size_t>(10, levels.size() + 1));
  list.AddRectFilled(low, high, packed(ImVec4(0.125F, 0.13F, 0.14F, 1.0F)));
  for (const double tick : log_ticks(std::pow(10.0, bottom), std::pow(10.0, top))) {
    list.AddLine(ImVec2(low.x, y_of(tick)), ImVec2(high.x, y_of(tick)), packed(colour::kGrid));
    (void)draw_text(list, StudyFont::kText, ImVec2(low.x - 0.3F * text, y_of(tick) - 0.5F * text),
                    Align::kRight, size.x, packed(colour::kFaint), fmt::format("{:g}", tick));
  }
  list.AddRect(low, high, packed(colour::kGrid));
  ImVec2 before;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const ImVec2 here(low.x + across * static_cast<float>(i + 1), y_of(1e3 * std::max(1e-6, levels[i])));
    if (i > 0) list.AddLine(before, here, packed(colour::kNoise, 0.5F), 0.08F * text);
    before = here;
  }
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const ImVec2 here(low.x + across * static_cast<float>(i + 1), y_of(1e3 * std::max(1e-6, levels[i])));
    list.AddCircleFilled(here, std::min(0.2F * text, 0.35F * across), packed(colour::kNoise));
  }
  (void)draw_text(list, StudyFont::kText, ImVec2(low.x + across, high.y + 0.2F * text), Align::kCentre,
                  size.x, packed(colour::kFaint), "1");
  (void)draw_text(list, StudyFont::kText,
                  ImVec2(low.x + across * static_cast<float>(levels.size()), high.y + 0.2F * text),
                  Align::kCentre, size.x, packed(colour::kFaint),
                  levels.size() > 3 ? std::to_string(levels.size()) : std::string());
}

void draw_notes(ExperimenterControls& controls) {
  ImGui::TextDisabled("note (Enter stores it)");
  ImGui::SetNextItemWidth(-1.0F);
  if (ImGui::InputText("##note", controls.note.data(), controls.note.size(),
                       ImGuiInputTextFlags_EnterReturnsTrue) &&
      controls.note[0] != '\0') {
    controls.stored = controls.note.data();
    controls.notes.emplace_front(controls.note.data());
    if (controls.notes.size() > kNotesShown) controls.notes.pop_back();
    controls.note[0] = '\0';
  }
  controls.typing = ImGui::IsItemActive();
  if (controls.typing) {
    ImGui::TextColored(colour::kWarning, "Keys go to the note now: Enter or Esc ends it.");
  }
  for (const std::string& note : controls.notes) ImGui::TextWrapped("- %s", note.c_str());
}

void draw_buttons(const ScreenContent& content, const ExperimenterView& view,
                  ExperimenterControls& controls) {
  if (content.trial.state == TrialState::kIdle || content.trial.state == TrialState::kFinished) {
    controls.pausing = false;
  }
  const float text = ImGui::GetFontSize();
  const ImVec2 usual(13.0F * text, 2.6F * text);
  if (ImGui::Button("Go on  (Space)", ImVec2(9.0F * text, usual.y)))
    controls.pressed.push_back(ScreenInput::kNext);
  ImGui::SameLine();
  if (ImGui::Button(controls.pausing ? "Pausing after this trial" : "Pause after this trial  (F9)",
                    ImVec2(15.5F * text, usual.y))) {
    controls.pressed.push_back(ScreenInput::kPause);
  }
  ImGui::SameLine();
  if (ImGui::Button(view.asks_to_stop ? "Really stop  (Enter)" : "Stop session  (Esc)",
                    ImVec2(11.5F * text, usual.y)))
    controls.pressed.push_back(ScreenInput::kStop);
  const ImVec2 large(15.0F * text, 3.4F * text);
  ImGui::SetCursorPos(ImVec2(ImGui::GetWindowWidth() - large.x - ImGui::GetStyle().WindowPadding.x,
                             ImGui::GetWindowHeight() - large.y - ImGui::GetStyle().WindowPadding.y));
  ImGui::PushStyleColor(ImGuiCol_Button, colour::kFault);
  ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImVec4(0.80F, 0.18F, 0.17F, 1.0F));
  ImGui::PushStyleColor(ImGuiCol_ButtonActive, ImVec4(0.90F, 0.22F, 0.20F, 1.0F));
  ImGui::PushFont(study_font(StudyFont::kLarge));
  if (ImGui::Button("FORCE OFF  (F10)", large)) controls.pressed.push_back(ScreenInput::kForceOff);
  ImGui::PopFont();
  ImGui::PopStyleColor(3);
}

}  // namespace

std::vector<double> ladder_of(const ScreenContent& content, const study::Study& study) {
  const std::optional<std::size_t> task = study.find_task(content.task);
  if (!task || study.tasks[*task].stimulus() != study::Stimulus::kNoise) return {};
  return content.ladder;
}

std::string status_line(const ScreenContent& content, const ExperimenterView& view) {
  const study::CoursePosition& at = content.position;
  std::string line = fmt::format(
      "{}  {}; task {}; trial {} of {}; part {} of {}; block {}; force {:.2f} of {:.1f} N; late ticks {}; "
      "spoiled {}; catch trials right {}",
      clock_of(content.minutes), state_of(content.trial), content.task, trial_number(at), at.of,
      std::min(at.part + 1, at.parts), at.parts, content.block, content.trial.force, content.max_force,
      content.late_ticks, content.spoiled, catches_of(content));
  if (view.sound_lost) line += "; masking noise: " + view.sound;
  if (content.trial.fault != 0) line += "; zero force: " + fault_of(content.trial);
  return line;
}

void draw_experimenter(const ScreenContent& content, const ExperimenterView& view,
                       ExperimenterControls& controls) {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float text = ImGui::GetFontSize();
  constexpr ImGuiWindowFlags kPlain =
      ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(1.2F * text, text));
  ImGui::SetNextWindowPos(ImVec2(0.0F, 0.0F));
  ImGui::SetNextWindowSize(size);
  ImGui::Begin("experimenter", nullptr, kPlain);
  ImGui::TextDisabled("%s", view.title.c_str());
  ImGui::Spacing();
  const float bottom = 5.2F * text;  // of the buttons
  const float height = size.y - ImGui::GetCursorPosY() - bottom;
  const float left = 0.5F * size.x - 1.2F * text;
  ImGui::BeginChild("left", ImVec2(left, height));
  draw_state(content, view);
  if (content.position.parts > 0) {  // not before the first trial
    ImGui::Dummy(ImVec2(0.0F, 0.6F * text));
    draw_table(content, view);
    ImGui::Dummy(ImVec2(0.0F, 0.6F * text));
    draw_force(content);
  }
  ImGui::EndChild();
  ImGui::SameLine(0.0F, 2.4F * text);
  ImGui::BeginChild("right", ImVec2(0.0F, height));
  if (!view.ladder.empty()) {
    draw_ladder(view.ladder, ImVec2(ImGui::GetContentRegionAvail().x, 0.5F * height));
    ImGui::Dummy(ImVec2(0.0F, 0.6F * text));
  }
  draw_notes(controls);
  ImGui::EndChild();
  ImGui::SetCursorPosY(size.y - 3.6F * text);
  draw_buttons(content, view, controls);
  ImGui::End();
  ImGui::PopStyleVar();
}

}  // namespace palpate::app
