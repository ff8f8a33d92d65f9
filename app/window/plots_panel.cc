// Plots: force, depth and noise over the last seconds, and force over depth with the force law.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <imgui.h>

#include "palpate/spring_law.h"

#include "app/window/panels.h"
#include "app/window/plot.h"
#include "app/window/theme.h"

namespace palpate::app {
namespace {

using Quantity = std::function<double(const haptics::TickRow&)>;

/// Ranges of a quantity in columns of `width` [s]. Each column also covers the last value of the previous
/// one, so that the columns form a line.
std::vector<PlotColumn> in_columns(const std::deque<haptics::TickRow>& rows, const Quantity& quantity,
                                   double from, double width) {
  std::vector<PlotColumn> columns;
  double last = 0.0;
  for (const haptics::TickRow& row : rows) {
    if (row.time < from) continue;
    const double value = quantity(row);
    const double x = from + width * std::floor((row.time - from) / width);
    if (columns.empty()) last = value;
    if (columns.empty() || columns.back().x != x)
      columns.push_back({x, std::min(last, value), std::max(last, value)});
    PlotColumn& column = columns.back();
    column.least = std::min(column.least, value);
    column.most = std::max(column.most, value);
    last = value;
  }
  return columns;
}

double largest(const std::deque<haptics::TickRow>& rows, const Quantity& quantity) {
  double most = 0.0;
  for (const haptics::TickRow& row : rows) most = std::max(most, std::abs(quantity(row)));
  return most;
}

struct Strip {
  const char* title;
  ImVec4 colour;
  Quantity quantity;
  double least_range;
  bool both_signs;
};

void strips(const ImVec2& low, const ImVec2& high, const Plotted& shown) {
  static const std::vector<Strip> kStrips = {
      {"Force to the hand [N]", colour::kForce, [](const haptics::TickRow& row) { return device_force(row); },
       0.5, false},
      {"Depth, or stretch [mm]", colour::kDepth, [](const haptics::TickRow& row) { return 1e3 * row.depth; },
       2.0, false},
      {"Touch noise [mN]", colour::kNoise, [](const haptics::TickRow& row) { return 1e3 * row.noise_force; },
       10.0, true}};
  const double from = shown.from;
  const double to = shown.to;
  const float text = ImGui::GetFontSize();
  const float last = 2.0F * text;  // numbers and title of the time axis
  const float each = (high.y - low.y - last) / static_cast<float>(kStrips.size());
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < kStrips.size(); ++i) {
    const Strip& strip = kStrips[i];
    const bool bottom = i + 1 == kStrips.size();
    double most = strip.least_range;
    for (const Plotted::Hand& hand : shown.hands) most = std::max(most, largest(hand.rows, strip.quantity));
    most = strip.both_signs ? round_step(most * 1.02) : round_end(most * 1.02);
    const float top = low.y + static_cast<float>(i) * each;
    const Plot plot(list, ImVec2(low.x, top), ImVec2(high.x, top + each + (bottom ? last : 0.0F)),
                    {from, to, bottom ? "time [s]" : "", bottom},
                    {strip.both_signs ? -most : 0.0, most, strip.title, true});
    for (std::size_t hand = 0; hand < shown.hands.size(); ++hand) {
      const double width = (to - from) / std::max(1.0, static_cast<double>(high.x - low.x));
      plot.columns(in_columns(shown.hands[hand].rows, strip.quantity, from, width), width,
                   packed(strip.colour, hand == shown.strong ? 1.0F : 0.5F));
    }
    if (!shown.cursor) continue;
    const double level = strip.both_signs ? -most : 0.0;
    const std::array<PlotPoint, 2> line = {PlotPoint{*shown.cursor, level}, PlotPoint{*shown.cursor, most}};
    plot.line(line, packed(colour::kText, 0.8F), 1.2F);
  }
}

/// The force law in force, in N over mm.
std::vector<PlotPoint> law_curve(const Plotted& shown, double deepest_mm) {
  constexpr int kPoints = 120;
  const model::SpringLaw law(shown.tissue, shown.direction, 1.0 / shown.rate_Hz);
  std::vector<PlotPoint> points;
  for (int i = 0; i <= kPoints; ++i) {
    const double depth_mm = deepest_mm * i / kPoints;
    points.push_back({depth_mm, law.force_at(1e-3 * depth_mm).force});
  }
  return points;
}

/// Tissue force over depth at 200 points per second, between two times [s].
std::vector<PlotPoint> felt(const std::deque<haptics::TickRow>& rows, double rate_Hz, double from,
                            double to) {
  std::vector<PlotPoint> path;
  std::uint64_t next = 0;
  const auto every = static_cast<std::uint64_t>(std::max(1.0, rate_Hz / 200.0));
  for (const haptics::TickRow& row : rows) {
    if (row.tick < next || row.phase == 0 || row.time < from || row.time > to) continue;
    path.push_back({1e3 * row.depth, row.tissue_force});
    next = row.tick + every;
  }
  return path;
}

void force_over_depth(const ImVec2& low, const ImVec2& high, const Plotted& shown) {
  double deepest = 2.0;
  double strongest = 0.5;
  for (const Plotted::Hand& hand : shown.hands) {
    for (const haptics::TickRow& row : hand.rows) {
      deepest = std::max(deepest, 1e3 * row.depth);
      strongest = std::max(strongest, row.tissue_force);
    }
  }
  deepest = std::max(15.0, 5.0 * std::ceil(1.02 * deepest / 5.0));
  const std::vector<PlotPoint> law = law_curve(shown, deepest);
  strongest = round_end(std::max(1.02 * strongest, law.back().y));
  const Plot plot(*ImGui::GetWindowDrawList(), low, high, {0.0, deepest, "depth, or stretch [mm]", true},
                  {0.0, strongest, "Tissue force [N]", true});
  plot.line(law, packed(colour::kLaw), 4.0F);
  const double now = shown.cursor.value_or(shown.to);
  for (std::size_t hand = 0; hand < shown.hands.size(); ++hand) {
    const float strength = hand == shown.strong ? 0.9F : 0.5F;
    const std::deque<haptics::TickRow>& rows = shown.hands[hand].rows;
    if (shown.cursor) {
      plot.line(felt(rows, shown.rate_Hz, now, shown.to), packed(colour::kForce, 0.35F * strength), 1.2F);
    }
    plot.line(felt(rows, shown.rate_Hz, shown.from, now), packed(colour::kForce, strength), 1.2F);
    const haptics::TickRow& at = shown.hands[hand].now;
    if (at.phase != 0) plot.dot({1e3 * at.depth, at.tissue_force}, packed(colour::kText), 4.0F);
  }
  plot.note(shown.tissue.size_exponent == 0.0 ? "wide: the law; fine: felt"
                                              : "wide: the law for the source's radius; fine: felt",
            packed(colour::kFaint));
}

}  // namespace

Plotted plotted(const PanelModel& shown) {
  const bool pull = shown.scene.task == scene::Task::kPull;
  Plotted all{shown.tissue, pull ? model::Direction::kPull : model::Direction::kPress, shown.scene.rate_Hz};
  for (std::uint32_t hand = 0; hand < shown.hands.size(); ++hand) {
    all.hands.push_back({shown.traces.of_hand(hand), shown.traces.newest(hand)});
  }
  const std::deque<haptics::TickRow>& first = shown.traces.of_hand(0);
  all.to = std::max(first.empty() ? 0.0 : first.back().time, Traces::kKept);
  all.from = all.to - Traces::kKept;
  return all;
}

void draw_plots(const Rectangle& place, const Plotted& shown) {
  ImGui::SetNextWindowPos(ImVec2(place.x, place.y));
  ImGui::SetNextWindowSize(ImVec2(place.width, place.height));
  ImGui::Begin("plots", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoNav |
                   ImGuiWindowFlags_NoBackground);
  const ImVec2 low = ImGui::GetCursorScreenPos();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float gap = 1.2F * ImGui::GetFontSize();
  const float left = 0.58F * room.x;
  strips(low, ImVec2(low.x + left, low.y + room.y), shown);
  force_over_depth(ImVec2(low.x + left + gap, low.y), ImVec2(low.x + room.x, low.y + room.y), shown);
  ImGui::End();
}

}  // namespace palpate::app
