// The viewer's timeline: an overview of the run, and the playback controls.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <imgui.h>

#include "core/base/text.h"

#include "app/window/panels.h"
#include "app/window/theme.h"
#include "app/window/viewer_panels.h"

namespace palpate::app {
namespace {

constexpr std::array<const char*, Playback::kSpeeds.size()> kSpeedNames = {"1/10", "1/4", "1/2", "1\u00d7",
                                                                           "2\u00d7"};

/// Draws a button; the next one is drawn beside it. @return whether it was pressed
bool button(const char* text, const char* explanation, float width = 0.0F) {
  const bool pressed = ImGui::Button(text, ImVec2(width * ImGui::GetFontSize(), 0.0F));
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", explanation);
  ImGui::SameLine();
  return pressed;
}

void play_buttons(const ViewerModel& seen, ViewerCommands& commands) {
  if (button("|\u25c0", "Home: to the beginning")) commands.go_to = 0;
  if (button("\u25c0 tick", "Shift + left: a tick back")) commands.ticks = -1;
  if (button("\u25c0 picture", "left: a picture back, as far as pictures are apart at this speed"))
    commands.pictures = -1;
  if (button(seen.playback.playing() ? "Pause" : "Play", "Space", 4.6F)) commands.play = true;
  if (button("picture \u25b6", "right: a picture on")) commands.pictures = 1;
  if (button("tick \u25b6", "Shift + right: a tick on")) commands.ticks = 1;
  if (button("\u25b6|", "End: to the end")) commands.go_to = seen.playback.last();
}

void speed_buttons(const ViewerModel& seen, ViewerCommands& commands) {
  for (std::size_t i = 0; i < kSpeedNames.size(); ++i) {
    const bool now = i == seen.playback.speed();
    if (now) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (button(kSpeedNames[i], "of the recording's speed; down: slower, up: faster")) commands.speed = i;
    if (now) ImGui::PopStyleColor();
  }
}

void jump_buttons(const ViewerModel& seen, const HandOverview& hand, ViewerCommands& commands) {
  ImGui::BeginDisabled(hand.contacts.empty());
  if (button("First contact", "C: where this hand first touches the tissue"))
    commands.go_to = hand.contacts.front().first;
  ImGui::EndDisabled();
  if (button("Deepest", "D: where this hand is deepest (without contact: nearest)"))
    commands.go_to = hand.deepest;
  ImGui::BeginDisabled(hand.faults.empty());
  if (button("Fault", "F: where a fault is latched; again: the next one"))
    commands.go_to = next_fault(hand, seen.tick);
  ImGui::EndDisabled();
}

/// Maps times to positions in the strip.
struct TimelineStrip {
  ImVec2 low;
  ImVec2 high;
  double duration = 1.0;  // s

  [[nodiscard]] float x(double time) const {
    return low.x + static_cast<float>(time / duration) * (high.x - low.x);
  }
  [[nodiscard]] double time(float place) const {
    return duration * std::clamp(static_cast<double>((place - low.x) / (high.x - low.x)), 0.0, 1.0);
  }
};

/// Draws contacts, depth, faults and parameter updates of the whole run.
void draw_run(const TimelineStrip& strip, const ViewerModel& seen, const HandOverview& hand) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const RecordedView& view = seen.view;
  const float text = ImGui::GetFontSize();
  list.AddRectFilled(strip.low, strip.high, packed(ImVec4(0.125F, 0.13F, 0.14F, 1.0F)));
  for (const HandOverview::Contact& contact : hand.contacts) {
    list.AddRectFilled(ImVec2(strip.x(view.time_of(contact.first)), strip.low.y),
                       ImVec2(strip.x(view.time_of(contact.last + 1)), strip.high.y),
                       packed(colour::kDepth, 0.10F));
  }
  const double most = std::max(1.0, hand.deepest_mm);
  const auto height = [&](double depth_mm) {
    return strip.low.y + 2.0F + static_cast<float>(depth_mm / most) * (strip.high.y - strip.low.y - 4.0F);
  };
  for (const PlotColumn& column : hand.depth) {        // downwards, as the tool moves
    const float left = std::floor(strip.x(column.x));  // whole pixels: overlaps would show as stripes
    const float right = std::floor(strip.x(column.x + seen.overview.column_width));
    if (right <= left) continue;
    list.AddRectFilled(ImVec2(left, height(0.0)), ImVec2(right, height(column.most)),
                       packed(colour::kDepth, 0.28F));
    list.AddRectFilled(ImVec2(left, height(column.least) - 1.0F), ImVec2(right, height(column.most) + 1.0F),
                       packed(colour::kDepth, 0.9F));
  }
  for (const std::uint64_t change : seen.overview.changes) {
    const ImVec2 at(strip.x(view.time_of(change)), strip.high.y - 0.3F * text);
    list.AddTriangleFilled(ImVec2(at.x, at.y - 0.35F * text), ImVec2(at.x - 0.25F * text, at.y),
                           ImVec2(at.x + 0.25F * text, at.y), packed(colour::kNoise, 0.9F));
  }
  for (const std::uint64_t fault : hand.faults) {
    const float x = strip.x(view.time_of(fault));
    list.AddLine(ImVec2(x, strip.low.y), ImVec2(x, strip.high.y), packed(colour::kFault), 0.15F * text);
    list.AddRectFilled(ImVec2(x, strip.low.y), ImVec2(x + 0.5F * text, strip.low.y + 0.4F * text),
                       packed(colour::kFault));
  }
}

/// Draws the shown tick, and the requested tick if it differs.
void draw_cursor(const TimelineStrip& strip, const ViewerModel& seen) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float text = ImGui::GetFontSize();
  const float x = strip.x(seen.view.time_of(seen.tick));
  if (!seen.there) {
    const float to = strip.x(seen.view.time_of(seen.playback.tick()));
    list.AddRectFilled(ImVec2(std::min(x, to), strip.high.y - 0.2F * text),
                       ImVec2(std::max(x, to), strip.high.y), packed(colour::kWarning, 0.8F));
    list.AddLine(ImVec2(to, strip.low.y), ImVec2(to, strip.high.y), packed(colour::kWarning), 0.08F * text);
  }
  list.AddLine(ImVec2(x, strip.low.y - 0.2F * text), ImVec2(x, strip.high.y), packed(colour::kText),
               0.13F * text);
  list.AddTriangleFilled(ImVec2(x - 0.4F * text, strip.low.y - 0.45F * text),
                         ImVec2(x + 0.4F * text, strip.low.y - 0.45F * text),
                         ImVec2(x, strip.low.y + 0.15F * text), packed(colour::kText));
}

/// Draws the times below the strip.
void draw_times(const TimelineStrip& strip) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float text = ImGui::GetFontSize();
  const float room = std::max(1.0F, strip.high.x - strip.low.x);
  const double step = round_step(strip.duration * std::min(1.0, static_cast<double>(6.0F * text / room)));
  const std::string format = "%." + std::to_string(decimals_of_step(step)) + "f s";
  for (int i = 0; i * step <= strip.duration * (1.0 + 1e-9); ++i) {
    const std::string label = formatted(format.c_str(), i * step);
    const float width = ImGui::CalcTextSize(label.c_str()).x;
    const float x = strip.x(i * step);
    list.AddLine(ImVec2(x, strip.high.y), ImVec2(x, strip.high.y + 0.2F * text), packed(colour::kFaint));
    list.AddText(
        ImVec2(std::clamp(x - 0.5F * width, strip.low.x, strip.high.x - width), strip.high.y + 0.2F * text),
        packed(colour::kFaint), label.c_str());
  }
}

void scrub(const TimelineStrip& strip, const ViewerModel& seen, const HandOverview& hand,
           ViewerCommands& commands) {
  ImGui::SetCursorScreenPos(strip.low);
  ImGui::InvisibleButton("strip", ImVec2(strip.high.x - strip.low.x, strip.high.y - strip.low.y));
  const double time = strip.time(ImGui::GetIO().MousePos.x);
  if (ImGui::IsItemActive()) commands.go_to = seen.view.tick_at(time);
  if (!ImGui::IsItemHovered() || hand.depth.empty()) return;
  const auto column =
      static_cast<std::size_t>(time / strip.duration * static_cast<double>(hand.depth.size()));
  ImGui::SetTooltip("%.3f s   %.1f mm", time, hand.depth[std::min(column, hand.depth.size() - 1)].most);
}

}  // namespace

void draw_timeline(const Rectangle& place, const ViewerModel& seen, const ViewerState& state,
                   ViewerCommands& commands) {
  begin_column("timeline", place);
  const HandOverview& hand = seen.overview.hands[state.hand];
  const float text = ImGui::GetFontSize();
  const bool two_rows = place.width < 62.0F * text;
  play_buttons(seen, commands);
  ImGui::Dummy(ImVec2(0.4F * text, 0.0F));
  ImGui::SameLine();
  if (two_rows) ImGui::NewLine();
  speed_buttons(seen, commands);
  ImGui::Dummy(ImVec2(0.4F * text, 0.0F));
  ImGui::SameLine();
  jump_buttons(seen, hand, commands);
  ImGui::NewLine();
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const TimelineStrip strip{ImVec2(low.x, low.y + 0.35F * text),
                            ImVec2(low.x + room.x, low.y + room.y - 1.3F * text), seen.view.duration_s()};
  if (strip.high.y > strip.low.y && strip.high.x > strip.low.x) {
    draw_run(strip, seen, hand);
    draw_times(strip);
    draw_cursor(strip, seen);
    scrub(strip, seen, hand, commands);
  }
  ImGui::End();
}

}  // namespace palpate::app
