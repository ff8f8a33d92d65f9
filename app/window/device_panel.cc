// The panels "Device and safety" and "Timing".
#include <algorithm>
#include <array>
#include <cmath>

#include <imgui.h>

#include "io/scene/device_kinds.h"

#include "app/window/panels.h"
#include "app/window/plot.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

/// Draws a bar of a hand's force, relative to the largest force.
void force_bar(double force, double most) {
  ImGui::PushStyleColor(ImGuiCol_PlotHistogram, colour::kForce);
  const std::string text = formatted("%.2f N", force) + formatted(" of %.0f N", most);
  ImGui::ProgressBar(static_cast<float>(std::clamp(force / most, 0.0, 1.0)), ImVec2(-1.0F, 0.0F),
                     text.c_str());
  ImGui::PopStyleColor();
}

void choose_device(const PanelModel& shown, Commands& commands) {
  const std::string& now = shown.scene.devices.front().kind;
  if (!ImGui::BeginCombo("##device", now.c_str())) return;
  for (const scene::DeviceKind& kind : scene::device_kinds()) {
    if (kind.path == scene::DevicePath::kRecording || kind.path == scene::DevicePath::kClient)
      continue;  // need it
    const std::string name(kind.name);
    if (!ImGui::Selectable(name.c_str(), name == now)) continue;
    scene::Overrides request = shown.request;
    request.device = name;
    commands.request = std::move(request);
    commands.keep = Keep::all();
  }
  ImGui::EndCombo();
}

void hand_rows(const PanelModel& shown, std::size_t hand, Commands& commands) {
  const HandStatus& status = shown.hands[hand];
  const haptics::TickRow& newest = shown.traces.newest(static_cast<std::uint32_t>(hand));
  {
    const Rows rows("hand", 0.30F);
    if (shown.hands.size() > 1) {
      rows.text("Device", status.device);
    } else {
      rows.name("Device", "what moves the tool; another device starts a new session");
      choose_device(shown, commands);
    }
    rows.text("State", status.state);
    rows.name("Force", "what goes to the hand, after the gate");
    force_bar(shown.ended ? 0.0 : device_force(newest), shown.scene.safety.max_force);
    rows.text("Let through", formatted("%.0f %%", 100.0 * status.engagement),
              "a held device gets force after it was still outside the tissue for 0.25 s, then within 0.5 s");
    rows.name("Gate", "limits of force and of its change");
    if (status.limited) {
      ImGui::TextColored(colour::kWarning, "shortens the force");
    } else {
      ImGui::TextColored(colour::kGood, "lets all through");
    }
    rows.name("Fault", "latched until it is reset");
    if (status.fault.empty()) ImGui::TextColored(colour::kGood, "none");
  }
  if (status.fault.empty()) return;
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextColored(colour::kWarning, "Zero force: %s.", status.fault.c_str());
  ImGui::TextUnformatted(status.advice.c_str());
  ImGui::PopTextWrapPos();
  if (ImGui::Button("Reset the fault  (R)", ImVec2(-1.0F, 0.0F))) commands.reset_faults = true;
}

std::string microseconds_text(std::int64_t ns) {
  return formatted("%.1f \u00b5s", static_cast<double>(ns) * 1e-3);
}

/// Draws a histogram of times in bars of half an octave, from 1 us to 16 ms.
void histogram(const haptics::Histogram& times, const char* title, const ImVec4& bar_colour,
               double period_ns) {
  constexpr double kFirst = 1e3;  // ns
  constexpr std::size_t kBars = 28;
  std::array<PlotPoint, kBars> bars{};
  for (std::size_t i = 0; i < kBars; ++i) bars[i].x = 0.5 * static_cast<double>(i);
  for (const haptics::Histogram::Bucket& bucket : times.buckets()) {
    const double octaves = std::log2(std::max(1.0, static_cast<double>(bucket.upper) / kFirst));
    const auto bar = std::min(kBars - 1, static_cast<std::size_t>(2.0 * octaves));
    bars[bar].y += static_cast<double>(bucket.count);
  }
  for (PlotPoint& bar : bars) bar.y = bar.y > 0.0 ? 1.0 + std::log10(bar.y) : 0.0;
  const float text = ImGui::GetFontSize();
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 high(low.x + ImGui::GetContentRegionAvail().x, low.y + 6.0F * text);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const Plot plot(list, low, ImVec2(high.x, high.y - 1.25F * text), {0.0, 14.0, "", false},
                  {0.0, 8.0, title, false});
  plot.bars(bars, 0.5, packed(bar_colour));
  // Labels of the time axis, a factor of sixteen apart.
  const std::array<const char*, 4> names = {"1 \u00b5s", "16 \u00b5s", "0.25 ms", "4 ms"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const float x = low.x + static_cast<float>(i) * 4.0F / 14.0F * (high.x - low.x);
    list.AddText(ImVec2(x, high.y - 1.2F * text), packed(colour::kFaint), names[i]);
  }
  const double octaves = std::log2(period_ns / kFirst);
  if (octaves > 0.0 && octaves < 14.0) {
    const std::array<PlotPoint, 2> line = {PlotPoint{octaves, 0.0}, PlotPoint{octaves, 8.0}};
    plot.line(line, packed(colour::kWarning), 1.0F);
  }
  ImGui::Dummy(ImVec2(high.x - low.x, high.y - low.y));
}

}  // namespace

void device_panel(const PanelModel& shown, Commands& commands) {
  for (std::size_t hand = 0; hand < shown.hands.size(); ++hand) {
    ImGui::PushID(static_cast<int>(hand));
    if (shown.hands.size() > 1) ImGui::TextColored(colour::kFaint, "Hand %d", static_cast<int>(hand));
    hand_rows(shown, hand, commands);
    ImGui::PopID();
  }
  ImGui::Spacing();
}

void timing_panel(const PanelModel& shown) {
  const Traces& traces = shown.traces;
  const double period_ns = 1e9 / shown.scene.rate_Hz;
  {
    const Rows rows("timing", 0.40F);
    rows.text("Loop", formatted("%.0f Hz", shown.scene.rate_Hz));
    const auto two = [](const haptics::Histogram& times) {
      return microseconds_text(times.percentile(0.5)) + ", " + microseconds_text(times.percentile(0.999));
    };
    rows.text("Tick p50, p99.9", two(traces.tick_time()), "computing time of a tick");
    rows.text("Late p50, p99.9", two(traces.lateness()), "how late ticks begin");
    rows.name("Missed", "ticks that began a full period or more late");
    const ImVec4 missed_colour = traces.missed() == 0 ? colour::kGood : colour::kWarning;
    ImGui::TextColored(missed_colour, "%llu of %llu", static_cast<unsigned long long>(traces.missed()),
                       static_cast<unsigned long long>(traces.lateness().count()));
    rows.text("Picture",
              formatted("%.0f frames/s, ", shown.frames_a_second) +
                  formatted("each %.0f ms", 1e3 * shown.frame_time),
              "the window's frames, and its own work for one");
    rows.name("Age shown", "from the tick until its picture is shown; to be under 50 ms");
    const bool young = shown.largest_age < 0.05;
    ImGui::TextColored(young ? colour::kGood : colour::kWarning, "%.0f ms, at most %.0f ms", 1e3 * shown.age,
                       1e3 * shown.largest_age);
    if (shown.rows_left_out > 0) {
      rows.text("Not plotted", formatted("%.0f rows", static_cast<double>(shown.rows_left_out)),
                "the window did not keep up; the recording has them all");
    }
  }
  histogram(traces.tick_time(), "Ticks by computing time", colour::kDepth, period_ns);
  histogram(traces.lateness(), "Ticks by lateness", colour::kLaw, period_ns);
  ImGui::TextColored(colour::kFaint, "line: the period; heights logarithmic");
}

}  // namespace palpate::app
