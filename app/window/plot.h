#pragma once
#include <span>
#include <string>

#include <imgui.h>

namespace palpate::app {

/// What an axis shows.
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

/// What a column of a plot holds of a quantity: from its least to its greatest value.
struct PlotColumn {
  double x = 0.0;  // its left side
  double least = 0.0;
  double most = 0.0;
};

/// A plot in a window's draw list: a frame, a grid with numbers at round places, lines. All members: [setup].
class Plot final {
 public:
  /// Draws frame, grid, numbers and titles within a rectangle [window units]; the y title stands above the
  /// frame, at its left.
  Plot(ImDrawList& list, const ImVec2& low, const ImVec2& high, const Axis& x, const Axis& y);

  void line(std::span<const PlotPoint> points, ImU32 colour, float thickness) const;
  /// Columns side by side, each `width` wide: a line of many more rows than there are pixels.
  void columns(std::span<const PlotColumn> columns, double width, ImU32 colour) const;
  void dot(const PlotPoint& point, ImU32 colour, float radius) const;
  /// Bars from the x axis, each as wide as to the next point's x.
  void bars(std::span<const PlotPoint> tops, double width, ImU32 colour) const;
  /// Words at the upper right, in the frame.
  void note(const std::string& text, ImU32 colour, int line = 0) const;

 private:
  [[nodiscard]] ImVec2 at(const PlotPoint& point) const;
  void grid() const;

  ImDrawList& list_;
  ImVec2 low_;   // of the frame, upper left
  ImVec2 high_;  // lower right
  Axis x_;
  Axis y_;
};

/// [any] The least of 1, 2, 2.5, 5 times a power of ten that is at least `value` (> 0): for the steps of an
/// axis.
[[nodiscard]] double round_step(double value);
/// [any] The same of some more numbers: for the end of an axis.
[[nodiscard]] double round_end(double value);

}  // namespace palpate::app
