#include "app/window/panels.h"

#include <algorithm>
#include <cstdio>

#include <fmt/core.h>

#include "app/window/theme.h"

namespace palpate::app {
namespace {

constexpr float kSideWidth = 318.0F;  // at scale 1
constexpr float kPlotsHeight = 290.0F;
constexpr float kLeastPicture = 240.0F;  // width and height

bool is_open(const PanelState& state, Panel panel) { return state.open[static_cast<std::size_t>(panel)]; }

bool heading(const char* text, PanelState& state, Panel panel) {
  return panel_heading(text, state.open[static_cast<std::size_t>(panel)]);
}

}  // namespace

bool panel_heading(const char* text, bool& open) {
  ImGui::SetNextItemOpen(open);
  open = ImGui::CollapsingHeader(text);
  return open;
}

void begin_column(const char* name, const Rectangle& place) {
  ImGui::SetNextWindowPos(ImVec2(place.x, place.y));
  ImGui::SetNextWindowSize(ImVec2(place.width, place.height));
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoBackground);
}

std::string moment_text(const haptics::TickRow& row, const model::TissueParameters& tissue, int decimals) {
  const auto mm = [decimals](double metres) { return fmt::format("{:.{}f} mm", 1e3 * metres, decimals); };
  if (row.phase == static_cast<std::uint32_t>(contact::Phase::kPress))
    return "pressing, " + mm(row.depth) + " deep";
  if (row.phase == static_cast<std::uint32_t>(contact::Phase::kPull))
    return "pulling, stretched " + mm(row.depth);
  if (row.phase == static_cast<std::uint32_t>(contact::Phase::kInsert)) {
    const std::size_t layer = std::min<std::size_t>(row.layer, tissue.layers.size());
    return fmt::format(
        "{:.{}f} mm {}", row.inserted_mm, decimals,
        layer == 0 ? "in, out of the far side" : "inside, in " + tissue.layers[layer - 1].name);
  }
  return mm(row.distance) + " from the tissue";
}

Layout lay_out(float width, float height, float scale, const PanelState& state) {
  Layout all;
  all.picture = {0.0F, 0.0F, width, height};
  if (state.hidden) return all;
  const float side = kSideWidth * scale;
  const float least = kLeastPicture * scale;
  if (is_open(state, Panel::kPlots) && height >= kPlotsHeight * scale + least && width >= side + least) {
    all.picture.height -= kPlotsHeight * scale;
  }
  if (width >= side + least && height >= least) {
    all.left = {0.0F, 0.0F, side, height};
    all.picture.x = side;
    all.picture.width -= side;
  }
  if (width >= 2.0F * side + least && height >= least) {
    all.right = {width - side, 0.0F, side, height};
    all.picture.width -= side;
  }
  if (all.picture.height < height) {
    all.bottom = {all.picture.x, all.picture.height, all.picture.width, height - all.picture.height};
  }
  return all;
}

void draw_left(const Rectangle& place, const PanelModel& shown, PanelState& state, Commands& commands) {
  begin_column("left", place);
  if (heading("Scene  (F2)###scene", state, Panel::kScene)) scene_panel(shown, state, commands);
  if (heading("Tissue  (F3)###tissue", state, Panel::kTissue)) tissue_panel(shown, state, commands);
  if (heading("Touch noise  (F4)###noise", state, Panel::kNoise)) noise_panel(shown, state, commands);
  ImGui::End();
}

void draw_right(const Rectangle& place, const PanelModel& shown, PanelState& state, Commands& commands) {
  begin_column("right", place);
  if (heading("Device and safety  (F5)###device", state, Panel::kDevice)) device_panel(shown, commands);
  if (heading("Timing  (F6)###timing", state, Panel::kTiming)) timing_panel(shown);
  ImGui::End();
}

void draw_leave_dialog(const PanelModel& shown, PanelState& state, Commands& commands) {
  constexpr const char* kTitle = "Leave?";
  if (state.leave == LeaveDialog::kClosed) return;
  if (state.leave == LeaveDialog::kOpening) ImGui::OpenPopup(kTitle);
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5F * all.x, 0.5F * all.y), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  bool stays = true;
  if (ImGui::BeginPopupModal(
          kTitle, nullptr,
          ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings)) {
    if (shown.recording.empty()) {
      ImGui::TextUnformatted("The search has not ended and is not recorded: leaving saves nothing of it.");
    } else {
      ImGui::Text("Recording: %s", shown.recording_note.c_str());
      ImGui::TextUnformatted("Leaving ends the run and completes the recording.");
    }
    ImGui::Spacing();
    if (ImGui::Button("End and leave")) commands.leave = true;
    ImGui::SameLine();
    const bool esc =
        state.leave == LeaveDialog::kOpen && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
    stays = !ImGui::Button("Go on  (Esc)") && !esc;
    ImGui::SetItemDefaultFocus();
    if (!stays) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
  }
  state.leave = stays ? LeaveDialog::kOpen : LeaveDialog::kClosed;
}

void draw_key_lines(const char* name, std::span<const KeyLine> lines) {
  if (!ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingFixedFit)) return;
  ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed, 14.0F * ImGui::GetFontSize());
  for (const KeyLine& line : lines) {
    ImGui::TableNextColumn();
    ImGui::TextColored(colour::kDepth, "%s   ", line.keys);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(line.what);
  }
  ImGui::EndTable();
}

void draw_keys(bool& open, std::span<const KeyLine> lines, const std::function<void()>& more) {
  if (!open) return;
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  const float text = ImGui::GetFontSize();
  ImGui::SetNextWindowPos(ImVec2(0.5F * all.x, 0.5F * all.y), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
  ImGui::SetNextWindowBgAlpha(0.97F);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(1.5F * text, 1.1F * text));
  if (ImGui::Begin("Keys", &open,
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
                       ImGuiWindowFlags_NoSavedSettings)) {
    draw_key_lines("all", lines);
    more();
  }
  ImGui::End();
  ImGui::PopStyleVar();
}

std::string first_hint(const Gestures& gestures) {
  const char* third = "";
  if (gestures.mouse) {
    if (gestures.jaws) third = "   Grip: hold left.";
    if (gestures.search) third = "   Mark: left button.";
    return std::string("Move: mouse.   Press: wheel forward.") + third;
  }
  if (!gestures.gamepad) return {};
  if (gestures.jaws) third = "   Grip: left trigger.";
  if (gestures.search) third = "   Mark: A.";
  return std::string("Move: left stick.   Press: right trigger.") + third;
}

void draw_help(PanelState& state, const Gestures& gestures) {
  static constexpr KeyLine kLines[] = {
      {"F1", "these keys"},
      {"F2 to F7", "scene, tissue, noise, device, timing, plots: open or close"},
      {"F8", "all panels away, or back"},
      {"F11", "full screen"},
      {"Home", "the view of the beginning"},
      {"A, B, X", "force arrow, scale bar, axes: on or off"},
      {"D", "surgical drape under the organ: on or off"},
      {"Space", "hold the picture; the run goes on"},
      {"Enter", "run again from the start"},
      {"R", "reset a fault"},
      {"N", "touch noise on or off"},
      {"H", "choose what holds the organ, by clicks"},
      {"Ctrl + R", "record this run; or end the recording"},
      {"Ctrl + Z, Ctrl + Y", "undo, redo a change of tissue, noise or inclusion"},
      {"V", "look at the recording, in the viewer's window"},
      {"P", "save a picture of the window (PNG)"},
      {"Ctrl + O", "choose an organ's file (or drop any file here)"},
      {"Ctrl + S", "save the tissue"},
      {"Ctrl + Tab", "into the panels; arrows, Space and Enter there"},
      {"Esc", "leave: zero force, recording closed"},
  };
  static constexpr KeyLine kView[] = {{"right or left drag, arrows", "turn the view"},
                                      {"middle drag, Shift + arrows", "move the view"},
                                      {"wheel, + and -", "nearer, farther"}};
  static constexpr KeyLine kViewBesideTool[] = {{"right drag, arrows", "turn the view"},
                                                {"middle drag, Shift + arrows", "move the view"},
                                                {"Ctrl + wheel, + and -", "nearer, farther"}};
  static constexpr KeyLine kPause[] = {{"Ctrl + Space", "pause the run"}};
  static constexpr KeyLine kSearch[] = {{"M", "mark the place under the tool"},
                                        {"T", "map of the felt stiffness"}};
  static constexpr KeyLine kNeedle[] = {
      {"C, I", "section along the needle, needle inside the tissue: on or off"}};
  static constexpr KeyLine kMouse[] = {
      {"mouse", "the tool is under the pointer"},
      {"wheel", "away from you presses, 1 mm a notch (Shift: 0.2 mm)"},
      {"F", "parks the tool above the organ, or brings it back"},
  };
  static constexpr KeyLine kMouseJaws[] = {{"left button", "closes the jaws; then drag to pull"}};
  static constexpr KeyLine kJaws[] = {{"G", "jaws rest open or closed"}};
  static constexpr KeyLine kMouseMark[] = {{"left button", "marks the place under the tool"}};
  static constexpr KeyLine kHands[] = {{"1 to 4", "which hand the mouse holds"}};
  static constexpr KeyLine kPad[] = {{"left stick", "moves the tool sideways"},
                                     {"right stick", "down presses, up lifts"},
                                     {"right trigger", "presses, up to 25 mm"}};
  static constexpr KeyLine kPadJaws[] = {{"left trigger", "closes the jaws"}};
  draw_keys(state.help, kLines, [&] {
    draw_key_lines("view", gestures.mouse ? std::span<const KeyLine>(kViewBesideTool) : kView);
    if (gestures.may_pause) draw_key_lines("pause", kPause);
    if (gestures.search) draw_key_lines("search", kSearch);
    if (gestures.needle) draw_key_lines("needle", kNeedle);
    if (gestures.mouse) {
      ImGui::Separator();
      ImGui::TextUnformatted("The mouse holds the tool");
      draw_key_lines("mouse", kMouse);
      if (gestures.search) {
        draw_key_lines("mark", kMouseMark);
      } else if (gestures.jaws) {
        draw_key_lines("mouse jaws", kMouseJaws);
      }
      if (gestures.hands > 1) draw_key_lines("hands", kHands);
    }
    if (gestures.gamepad) {
      ImGui::Separator();
      ImGui::TextUnformatted("The gamepad holds the tool");
      draw_key_lines("pad", kPad);
      if (gestures.jaws) draw_key_lines("pad jaws", kPadJaws);
    }
    if (gestures.jaws && (gestures.mouse || gestures.gamepad)) draw_key_lines("jaws", kJaws);
  });
}

Rows::Rows(const char* name, float share)
    : drawn_(ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingStretchProp)) {
  if (!drawn_) return;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, share);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 1.0F - share);
}

Rows::~Rows() {
  if (drawn_) ImGui::EndTable();
}

void Rows::name(const char* text, const char* explanation) const {
  if (!drawn_) return;
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text);
  if (explanation != nullptr && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", explanation);
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1.0F);
}

void Rows::text(const char* text, const std::string& value, const char* explanation) const {
  if (!drawn_) return;
  name(text, explanation);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(value.c_str());
  ImGui::PopTextWrapPos();
}

bool Rows::number(const char* text, double& value, double per_unit, double speed, double least, double most,
                  const char* format, const char* explanation) const {
  if (!drawn_) return false;
  name(text, explanation);
  const std::string id = std::string("##") + text;
  double shown = value / per_unit;
  const bool changed = ImGui::DragScalar(id.c_str(), ImGuiDataType_Double, &shown, static_cast<float>(speed),
                                         &least, &most, format, ImGuiSliderFlags_AlwaysClamp);
  if (changed) value = shown * per_unit;
  return changed;
}

std::string formatted(const char* format, double value) {
  std::array<char, 64> text{};
  // The callers' formats are literals.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
  (void)std::snprintf(text.data(), text.size(), format, value);
#pragma GCC diagnostic pop
  return text.data();
}

}  // namespace palpate::app
