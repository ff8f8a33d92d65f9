// The viewer's panels: recording, shown tick, and settings of the picture.
#include "app/window/viewer_panels.h"

#include <algorithm>
#include <array>
#include <ctime>

#include <imgui.h>

#include "view/render/map_legend.h"

#include "app/session.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

constexpr float kViewerSideWidth = 318.0F;  // at scale 1
constexpr float kTimelineHeight = 128.0F;
constexpr float kNarrowTimelineHeight = 158.0F;  // with buttons in two rows
constexpr float kNarrow = 930.0F;
constexpr float kViewerPlotsHeight = 250.0F;
constexpr float kLeastViewerPicture = 240.0F;  // width and height

std::string begun(std::int64_t unix_ns) {
  if (unix_ns == 0) return "not known";
  const auto seconds = static_cast<std::time_t>(unix_ns / 1'000'000'000);
  std::tm parts{};
  localtime_r(&seconds, &parts);
  std::array<char, 64> text{};
  (void)std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M:%S", &parts);
  return text.data();
}

std::string recorded_microseconds(std::int64_t ns) {
  return formatted("%.1f \u00b5s", static_cast<double>(ns) * 1e-3);
}

void recording_rows(const ViewerModel& seen, ViewerState& state) {
  const scene::Scene& scene = seen.view.recording().scene;
  const record::RunFacts& facts = seen.view.recording().facts;
  const Rows rows("recording", 0.30F);
  rows.name("File", "Ctrl + O, or drop another one on the window");
  if (ImGui::Button((seen.view.file().filename().string() + " ...##file").c_str(), ImVec2(-1.0F, 0.0F))) {
    state.files.open(FileUse::kRecording, std::filesystem::absolute(seen.view.file()).parent_path());
  }
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", seen.view.file().c_str());
  rows.text("Begun", begun(facts.started_unix_ns));
  rows.text("Length", formatted("%.3f s, ", seen.view.duration_s()) +
                          formatted("%.0f ticks", static_cast<double>(seen.view.ticks())));
  rows.text("Loop", formatted("%.0f Hz", scene.rate_Hz) + (facts.offline ? ", offline" : ""));
  if (!facts.offline) {
    rows.text("Tick", "p99.9 " + recorded_microseconds(facts.tick_time.p999_ns), "computing time of a tick");
    rows.text("Missed", formatted("%.0f ticks", static_cast<double>(facts.missed_deadlines)),
              "ticks that began a full period or more late");
  }
  rows.name("State", "palpate repair makes one that was cut off open in every tool");
  if (facts.complete) {
    ImGui::TextColored(colour::kGood, "closed in good order");
  } else {
    ImGui::TextColored(colour::kWarning, "cut off, or still being written");
  }
}

void choose_hand(const ViewerModel& seen, const ViewerState& state, ViewerCommands& commands) {
  for (std::uint32_t hand = 0; hand < seen.view.hands(); ++hand) {
    if (hand > 0) ImGui::SameLine();
    if (ImGui::RadioButton(std::to_string(hand).c_str(), state.hand == hand)) commands.hand = hand;
  }
}

void moment_rows(const ViewerModel& seen, const ViewerState& state, ViewerCommands& commands) {
  const haptics::TickRow& row = seen.view.row(seen.tick, state.hand);
  const scene::Scene& scene = seen.view.recording().scene;
  const Rows rows("moment", 0.30F);
  if (seen.view.hands() > 1) {
    rows.name("Hand", "0 to 3");
    choose_hand(seen, state, commands);
  }
  rows.text("Device", scene.devices[state.hand].kind);
  rows.text("Time", formatted("%.3f s, ", row.time) + formatted("tick %.0f", static_cast<double>(row.tick)));
  rows.text("State", moment_text(row, scene.tissue, 2));
  rows.text("Force", formatted("%.3f N", device_force(row)), "what went to the hand, after the gate");
  rows.text("Tissue", formatted("%.3f N", row.tissue_force), "before the gate");
  rows.text("Noise", formatted("%+.1f mN", 1e3 * row.noise_force), "along the normal");
  if (row.cutoff_layer > 0)
    rows.text("Layer", formatted("%.0f", row.cutoff_layer), "the cut-off layer, the last that gives way");
  rows.text(
      "Felt as",
      seen.active_parameters.tissue.name + formatted(", k\u2081 %.2f N/m", seen.active_parameters.tissue.k1),
      "the tissue in force at this moment");
  if (row.fault != 0) {
    rows.name("Fault");
    ImGui::TextColored(colour::kWarning, "%s", haptics::describe(static_cast<haptics::Fault>(row.fault)));
  }
}

void picture_rows(const ViewerModel& seen, ViewerState& state, ViewerCommands& commands) {
  ImGui::Checkbox("Displacement map  (M)", &state.map);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("colours the organ by how far it has moved");
  {
    const Rows rows("map", 0.30F);
    ImGui::BeginDisabled(!state.map);
    rows.number("Up to", state.map_range, 1e-3, 0.05, 1e3 * ViewerState::kLeastMap,
                1e3 * ViewerState::kMaxMap, "%.1f mm", "displacement at the upper end of the colours");
    ImGui::EndDisabled();
  }
  ImGui::Checkbox("Surgical drape  (S)", &state.drape);
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  if (ImGui::Button("First view  (V)", ImVec2(half, 0.0F))) commands.home = true;
  ImGui::SameLine();
  if (ImGui::Button(state.close_up ? "Whole organ  (Z)" : "Close-up  (Z)", ImVec2(half, 0.0F))) {
    state.close_up = !state.close_up;
    commands.home = true;
  }
  if (ImGui::Button("Save picture", ImVec2(half, 0.0F))) commands.save_picture = true;
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip(
        "Ctrl + P: organ and tool alone, as a PNG in the working folder;\nthe same as palpate view "
        "--screenshot --at-s makes");
  }
  ImGui::SameLine();
  if (ImGui::Button("Save window", ImVec2(half, 0.0F))) commands.save_window = true;
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("P: the whole window, as a PNG in the working folder");
  ImGui::TextColored(colour::kFaint, "%s",
                     seen.still ? "full quality" : "moving: quality follows the machine");
}

}  // namespace

ViewerLayout lay_out(float width, float height, float scale, const ViewerState& state) {
  ViewerLayout all;
  all.picture = {0.0F, 0.0F, width, height};
  const float side = kViewerSideWidth * scale;
  const float least = kLeastViewerPicture * scale;
  if (state.hidden || width < least) return all;
  if (width >= side + 2.0F * least && height >= least) {
    all.left = {0.0F, 0.0F, side, height};
    all.picture.x = side;
    all.picture.width -= side;
  }
  const float timeline =
      (all.picture.width < kNarrow * scale ? kNarrowTimelineHeight : kTimelineHeight) * scale;
  if (height < least + timeline) return all;
  all.picture.height -= timeline;
  const bool plots = state.plots && height >= least + timeline + kViewerPlotsHeight * scale;
  if (plots) {
    all.picture.height -= kViewerPlotsHeight * scale;
    all.plots = {all.picture.x, height - kViewerPlotsHeight * scale, all.picture.width,
                 kViewerPlotsHeight * scale};
  }
  all.timeline = {all.picture.x, all.picture.height, all.picture.width, timeline};
  return all;
}

void draw_viewer_panels(const Rectangle& place, const ViewerModel& seen, ViewerState& state,
                        ViewerCommands& commands) {
  begin_column("left", place);
  if (panel_heading("Recording  (F2)###recording", state.open[0])) recording_rows(seen, state);
  if (panel_heading("Moment  (F3)###moment", state.open[1])) moment_rows(seen, state, commands);
  if (panel_heading("Picture  (F4)###picture", state.open[2])) picture_rows(seen, state, commands);
  ImGui::End();
}

void draw_map_scale(const Rectangle& picture, float top, double range) {
  constexpr int kSteps = 48;
  constexpr int kMarks = 5;
  const float text = ImGui::GetFontSize();
  const float height = std::min(12.0F * text, 0.5F * picture.height);
  const ImVec2 high(picture.x + picture.width - 1.2F * text, top + 2.4F * text + height);
  const ImVec2 low(high.x - 4.2F * text, high.y - height);
  if (picture.width < 16.0F * text || height < 4.0F * text) return;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled(ImVec2(low.x - 0.6F * text, low.y - 2.0F * text),
                     ImVec2(high.x + 0.6F * text, high.y + 0.9F * text), packed(colour::kBackground, 0.85F),
                     0.3F * text);
  list.AddText(ImVec2(low.x, low.y - 1.7F * text), packed(colour::kText), "moved by");
  const auto encoded = [](double linear) { return static_cast<float>(render::srgb(linear)); };
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 colour = render::map_colour((i + 0.5) / kSteps);
    const float lower = high.y - height * static_cast<float>(i) / kSteps;
    const float upper = high.y - height * static_cast<float>(i + 1) / kSteps;
    list.AddRectFilled(ImVec2(low.x, upper), ImVec2(low.x + text, lower + 0.5F),
                       packed(ImVec4(encoded(colour.x()), encoded(colour.y()), encoded(colour.z()), 1.0F)));
  }
  for (int mark = 0; mark < kMarks; ++mark) {
    const double share = mark / (kMarks - 1.0);
    const float y = high.y - height * static_cast<float>(share);
    const std::string label = formatted("%.3g", 1e3 * share * range) + (mark + 1 == kMarks ? " mm" : "");
    list.AddText(ImVec2(low.x + 1.4F * text, y - 0.5F * text), packed(colour::kText), label.c_str());
  }
}

void draw_viewer_help(ViewerState& state) {
  static constexpr KeyLine kLines[] = {
      {"F1", "these keys"},
      {"F2 to F4, F7", "recording, moment, picture, plots: open or close"},
      {"F8", "all panels away, or back"},
      {"F11", "full screen"},
      {"Space", "play, or pause"},
      {"left, right", "a picture back, on"},
      {"Shift + left, right", "a tick back, on"},
      {"Ctrl + left, right", "a second back, on"},
      {"Home, End", "to the beginning, to the end"},
      {"down, up", "slower, faster: 1/10, 1/4, 1/2, 1, 2"},
      {"C, D, F", "to the first contact, the deepest place, the next fault"},
      {"0 to 3", "whose hand's numbers are shown"},
      {"M, S", "displacement map, surgical drape: on or off"},
      {"left or right drag, Alt + arrows", "turn the view"},
      {"middle drag, Alt + Shift + arrows", "move the view"},
      {"wheel, + and -", "nearer, farther"},
      {"V, Z", "the first view; close-up or whole organ"},
      {"P, Ctrl + P", "save the window, the picture alone (PNG)"},
      {"Ctrl + O", "open another recording (or drop it here)"},
      {"Ctrl + Tab", "into the panels; arrows, Space and Enter there"},
      {"Esc", "leave"},
  };
  draw_keys(state.help, kLines, [] {});
}

}  // namespace palpate::app
