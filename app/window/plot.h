#pragma once
#include <span>
#include <string>

#include <imgui.h>

namespace palpate::app {

/// Range and labels of an axis.
struct Axis {
  double low = 0.0;
  double high = 1.0;
  std::string title;    // with the unit; empty: none
  bool numbers = true;  // at its ticks
};

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
};

/// Range of a quantity within one column of a plot.
struct PlotColumn {
  double x = 0.0;  // left edge
  double least = 0.0;
  double most = 0.0;
};

/// Plot in a window's draw list: frame, grid with round numbers, lines. All members: [setup].
class Plot final {
 public:
  /// Draws frame, grid, numbers and titles within a rectangle [window units]. The y title is above the frame,
  /// on the left.
  Plot(ImDrawList& list, const ImVec2& low, const ImVec2& high, const Axis& x, const Axis& y);

  void line(std::span<const PlotPoint> points, ImU32 colour, float thickness) const;
  /// Draws adjacent columns, each `width` wide. They show a line with many more rows than pixels.
  void columns(std::span<const PlotColumn> columns, double width, ImU32 colour) const;
  void dot(const PlotPoint& point, ImU32 colour, float radius) const;
  /// Draws bars on the x axis, each `width` wide in the units of x.
  void bars(std::span<const PlotPoint> tops, double width, ImU32 colour) const;
  /// Text at the upper right inside the frame.
  void note(const std::string& text, ImU32 colour, int line = 0) const;

 private:
  [[nodiscard]] ImVec2 at(const PlotPoint& point) const;
  void grid() const;

  ImDrawList& list_;
  ImVec2 low_;   // upper left corner of the frame
  ImVec2 high_;  // lower right corner
  Axis x_;
  Axis y_;
};

/// [any] Step of an axis: the smallest of 1, 2, 2.5 and 5 times a power of ten that is at least `value` (>
/// 0).
[[nodiscard]] double round_step(double value);
/// [any] End of an axis: the smallest of 1, 1.2, 1.6, 2, 2.5, 3, 4, 5, 6 and 8 times a power of ten that is
/// at least `value` (> 0).
[[nodiscard]] double round_end(double value);

}  // namespace palpate::app
