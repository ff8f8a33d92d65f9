#include "app/window/plot.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <vector>

#include <fmt/core.h>

#include "app/window/theme.h"

namespace palpate::app {
namespace {

constexpr double kTickSpacingX = 80.0;  // window units, smallest spacing at the usual font size
constexpr double kTickSpacingY = 19.0;
constexpr float kLineThickness = 1.6F;  // window units, of columns without height

/// Tick positions of an axis of this length.
std::vector<double> ticks(const Axis& axis, double length, double spacing) {
  const double range = axis.high - axis.low;
  if (!(range > 0.0) || !(length > 0.0)) return {};
  const double step = round_step(range * std::min(1.0, spacing / length));
  std::vector<double> places;
  for (double i = std::ceil(axis.low / step - 1e-9); i * step <= axis.high + 1e-9 * range; i += 1.0) {
    places.push_back(i * step);
  }
  return places;
}

std::string number(double value, double step) {
  int digits = 0;  // decimals of the step
  for (double whole = step; digits < 6 && std::abs(whole - std::round(whole)) > 1e-6 * whole; whole *= 10.0)
    ++digits;
  return fmt::format("{:.{}f}", value == 0.0 ? 0.0 : value, digits);
}

double round_up_to(double value, std::initializer_list<double> factors) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : factors) {
    if (value <= factor * power * (1.0 + 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

}  // namespace

double round_step(double value) { return round_up_to(value, {1.0, 2.0, 2.5, 5.0}); }

double round_end(double value) {
  return round_up_to(value, {1.0, 1.2, 1.6, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0});
}

Plot::Plot(ImDrawList& list, const ImVec2& low, const ImVec2& high, const Axis& x, const Axis& y)
    : list_(list), x_(x), y_(y) {
  const float text = ImGui::GetFontSize();
  low_ = ImVec2(low.x + (y.numbers ? 3.0F * text : 0.0F),
                low.y + (y.title.empty() ? 0.3F * text : 1.25F * text));
  high_ = ImVec2(high.x, high.y - (x.numbers ? 1.25F * text : 0.0F) - (x.title.empty() ? 0.0F : 1.1F * text));
  if (!y.title.empty()) list_.AddText(ImVec2(low_.x, low.y), packed(colour::kText), y.title.c_str());
  if (!x.title.empty()) {
    const ImVec2 size = ImGui::CalcTextSize(x.title.c_str());
    list_.AddText(ImVec2(0.5F * (low_.x + high_.x - size.x), high.y - size.y), packed(colour::kFaint),
                  x.title.c_str());
  }
  if (high_.x > low_.x && high_.y > low_.y) grid();
}

ImVec2 Plot::at(const PlotPoint& point) const {
  const double u = (point.x - x_.low) / (x_.high - x_.low);
  const double v = (point.y - y_.low) / (y_.high - y_.low);
  return {low_.x + static_cast<float>(u) * (high_.x - low_.x),
          high_.y - static_cast<float>(v) * (high_.y - low_.y)};
}

void Plot::grid() const {
  const ImU32 faint = packed(colour::kFaint);
  const ImU32 line = packed(colour::kGrid);
  const double share = ImGui::GetFontSize() / 15.0;
  list_.AddRectFilled(low_, high_, packed(ImVec4(0.125F, 0.13F, 0.14F, 1.0F)));
  const std::vector<double> across = ticks(x_, high_.x - low_.x, kTickSpacingX * share);
  for (const double place : across) {
    const float x = at({place, y_.low}).x;
    list_.AddLine(ImVec2(x, low_.y), ImVec2(x, high_.y), line);
    if (!x_.numbers) continue;
    const std::string text = number(place, across.size() > 1 ? across[1] - across[0] : 1.0);
    const float width = ImGui::CalcTextSize(text.c_str()).x;
    const float left = std::min(x - 0.5F * width, high_.x - width);
    list_.AddText(ImVec2(left, high_.y + 1.0F), faint, text.c_str());
  }
  const std::vector<double> up = ticks(y_, high_.y - low_.y, kTickSpacingY * share);
  for (const double place : up) {
    const float y = at({x_.low, place}).y;
    list_.AddLine(ImVec2(low_.x, y), ImVec2(high_.x, y), line);
    if (!y_.numbers) continue;
    const std::string text = number(place, up.size() > 1 ? up[1] - up[0] : 1.0);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    list_.AddText(ImVec2(low_.x - size.x - 5.0F, y - 0.5F * size.y), faint, text.c_str());
  }
  list_.AddRect(low_, high_, line);
}

void Plot::line(std::span<const PlotPoint> points, ImU32 colour, float thickness) const {
  if (high_.x <= low_.x || high_.y <= low_.y || points.size() < 2) return;
  list_.PushClipRect(low_, high_, true);
  for (const PlotPoint& point : points) list_.PathLineTo(at(point));
  list_.PathStroke(colour, 0, thickness);
  list_.PopClipRect();
}

void Plot::columns(std::span<const PlotColumn> columns, double width, ImU32 colour) const {
  if (high_.x <= low_.x || high_.y <= low_.y) return;
  const float thick = 0.5F * kLineThickness;
  list_.PushClipRect(low_, high_, true);
  for (const PlotColumn& column : columns) {
    const ImVec2 top = at({column.x, column.most});
    const ImVec2 bottom = at({column.x + width, column.least});
    list_.AddRectFilled(ImVec2(top.x, top.y - thick), ImVec2(bottom.x, bottom.y + thick), colour);
  }
  list_.PopClipRect();
}

void Plot::dot(const PlotPoint& point, ImU32 colour, float radius) const {
  if (high_.x <= low_.x || high_.y <= low_.y) return;
  list_.PushClipRect(ImVec2(low_.x - radius, low_.y - radius), ImVec2(high_.x + radius, high_.y + radius),
                     true);
  list_.AddCircleFilled(at(point), radius, colour);
  list_.PopClipRect();
}

void Plot::bars(std::span<const PlotPoint> tops, double width, ImU32 colour) const {
  if (high_.x <= low_.x || high_.y <= low_.y) return;
  list_.PushClipRect(low_, high_, true);
  for (const PlotPoint& top : tops) {
    if (top.y <= y_.low) continue;
    const ImVec2 from = at(top);
    const ImVec2 to = at({top.x + width, y_.low});
    list_.AddRectFilled(from, ImVec2(std::max(from.x + 1.0F, to.x - 1.0F), to.y), colour);
  }
  list_.PopClipRect();
}

void Plot::note(const std::string& text, ImU32 colour, int line) const {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  if (high_.x - low_.x < size.x || high_.y - low_.y < static_cast<float>(line + 1) * size.y) return;
  list_.AddText(ImVec2(high_.x - size.x - 6.0F, low_.y + 2.0F + static_cast<float>(line) * size.y), colour,
                text.c_str());
}

}  // namespace palpate::app
