#include "fit/report/image_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/offscreen.h"
#include "palpate/units.h"
#include "view/report/gnuplot.h"
#include "view/report/text_format.h"

namespace palpate::report {
namespace {

using Colour = std::array<double, 3>;

constexpr Colour kLineBefore = {0.0, 114.0, 178.0};  // equal to kBlue
constexpr Colour kLineAfter = {213.0, 94.0, 0.0};    // equal to kOrange
constexpr Colour kWhite = {255.0, 255.0, 255.0};
constexpr int kWidest = 1200;  // pixels: largest width of a figure

std::string digits(double value) { return brief(value, 3); }

/// Downsamples a photograph to the size of a figure; `factor` gets the number of pixels per pixel.
render::Image as_figure(const imaging::Picture& picture, int& factor) {
  factor = (picture.width + kWidest - 1) / kWidest;
  render::Image image;
  image.width = picture.width / factor;
  image.height = picture.height / factor;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(factor);
      const std::size_t column = static_cast<std::size_t>(x) * static_cast<std::size_t>(factor);
      const std::size_t from = 3 * (row * static_cast<std::size_t>(picture.width) + column);
      for (std::size_t c = 0; c < 3; ++c) image.rgb.push_back(picture.rgb[from + c]);
    }
  }
  return image;
}

/// Draws one column of a line that extends `half` pixels up and down, with antialiased edges.
void draw_column(render::Image& image, double x, double y, double half, const Colour& colour,
                 double strength) {
  const auto column = static_cast<int>(std::lround(x));
  if (column < 0 || column >= image.width || !std::isfinite(y)) return;
  const int first = std::max(0, static_cast<int>(std::floor(y - half - 1.0)));
  const int last = std::min(image.height - 1, static_cast<int>(std::ceil(y + half + 1.0)));
  for (int row = first; row <= last; ++row) {
    const double cover = strength * std::clamp(half + 0.5 - std::abs(row - y), 0.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint8_t& value = image.rgb[3 * static_cast<std::size_t>(row * image.width + column) + c];
      value = static_cast<std::uint8_t>(std::lround(value + cover * (colour[c] - value)));
    }
  }
}

/// Draws a line with a light border, visible on dark and bright. `dash`: columns on and off, 0: solid.
void draw_line(render::Image& image, const std::vector<std::pair<double, double>>& points,
               const Colour& colour, int dash) {
  for (const bool rim : {true, false}) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [x, y] = points[i];
      if (dash > 0 && static_cast<int>(x) / dash % 2 == 1) continue;
      double steep = 0.0;  // keeps the width of a steep line constant
      if (i > 0 && points[i].first - points[i - 1].first < 2.5) steep = std::abs(y - points[i - 1].second);
      const double half = (rim ? 2.2 : 1.1) + 0.5 * std::min(steep, 6.0);
      draw_column(image, x, y, half, rim ? kWhite : colour, rim ? 0.55 : 1.0);
    }
  }
}

std::vector<std::pair<double, double>> seen(const imaging::SurfaceLine& line, int factor) {
  std::vector<std::pair<double, double>> points;
  for (const imaging::LinePoint& point : line.points) {
    if (point.trusted) points.emplace_back(point.x / factor, point.y / factor);
  }
  return points;
}

Figure photograph(const ImageSet& set, bool second, const std::filesystem::path& file) {
  int factor = 1;
  render::Image image = as_figure(second ? set.after : set.before, factor);
  const imaging::SurfaceLine& line = second ? set.measured.after : set.measured.before;
  if (second) {
    std::vector<std::pair<double, double>> rest;
    for (const imaging::ImagePoint& point : set.measured.points) {
      rest.emplace_back(point.x / factor, point.rest_y / factor);
    }
    draw_line(image, rest, kLineBefore, 8);
  }
  draw_line(image, seen(line, factor), second ? kLineAfter : kLineBefore, 0);
  render::write_png(image, file);
  if (!second) {
    return {file, "The first photograph with the line that was found",
            "Undisturbed: the line found (blue). Where nothing is drawn the edge cannot be trusted."};
  }
  return {file, "The second photograph with the line that was found and the undisturbed one",
          "Pressed or pulled: the line found (orange) and where it would be had it not moved (blue, dashed). "
          "Where nothing is drawn the edge cannot be trusted."};
}

/// r [mm] (negative left of the centre), u, uncertainty, computed.
std::vector<std::vector<double>> rows_of(const ImageSet& set) {
  std::vector<std::vector<double>> rows;
  std::vector<imaging::ImagePoint> points = set.measured.points;
  std::stable_sort(points.begin(), points.end(),
                   [](const imaging::ImagePoint& a, const imaging::ImagePoint& b) { return a.r < b.r; });
  for (std::size_t i = 0; i < points.size() && i < set.comparison.computed.size(); ++i) {
    const double side = points[i].right ? 1.0 : -1.0;
    rows.push_back({side * points[i].r / kMillimetre, points[i].u / kMillimetre,
                    points[i].uncertainty / kMillimetre, set.comparison.computed[i] / kMillimetre});
  }
  sort_by_x(rows);
  // a row of NaN interrupts the line where a stretch is hidden
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double gap = 8.0 * set.settings.pixel / kMillimetre;
  std::vector<std::vector<double>> broken;
  for (const std::vector<double>& row : rows) {
    if (!broken.empty() && row[0] - broken.back()[0] > gap) broken.push_back({row[0], kNone, kNone, kNone});
    broken.push_back(row);
  }
  return broken;
}

Figure draw_profile(const ImageSet& set, const std::filesystem::path& file) {
  const std::string upper = fmt::format(
      R"(set ylabel 'displacement, mm'; set yrange [] reverse; set key bottom left
plot 'profile.dat' using 1:($2-$3):($2+$3) with filledcurves lc rgb '#f6d9c4' title '95 % uncertain', \
  '' using 1:2 with points pt 7 ps 0.35 lc rgb '{}' title 'measured', \
  '' using 1:4 with lines lw 2 lc rgb '{}' title 'computed')",
      kOrange, kBlue);
  const std::string lower = fmt::format(
      R"(set nokey; set yrange [*:*] noreverse
set xlabel 'distance from the contact along the surface, mm'; set ylabel 'computed - measured, mm'
plot 'profile.dat' using 1:(-$3):3 with filledcurves lc rgb '#f6d9c4', \
  '' using 1:($4-$2) with points pt 7 ps 0.35 lc rgb '{}', 0 with lines lw 1 lc rgb '#555555')",
      kOrange);
  return drawn({file, "Displacement measured in the photographs, its uncertainty, and the computed one",
                "Measured along the line with its 95 % uncertainty, computed by the model at " +
                    digits(set.comparison.depth / kMillimetre) + " mm, and the difference."},
               two_panes(620, kKeyLeft, 0.36, upper, lower), {{"profile.dat", rows_of(set)}});
}

}  // namespace

std::string image_text(const ImageSet& set) {
  const imaging::ImageMeasurement& measured = set.measured;
  const double pixel = set.settings.pixel;
  return fmt::format(
      "pictures: {} places, uncertain by {} mm ({} px); confidence {} of 100, {}; the model lies within the "
      "uncertainty at {} of them{}\n",
      measured.points.size(), digits(measured.uncertainty / kMillimetre),
      digits(measured.uncertainty / pixel), measured.confidence, measured.confidence_text,
      percent(set.within_uncertainty, 1),
      set.depth_fitted ? "; the tool hides the deepest place: the depth is the one that suits the line best"
                       : "");
}

void write_image_section(Page& page, const ImageSet& set, const std::filesystem::path& folder) {
  const imaging::ImageMeasurement& measured = set.measured;
  page.section("pictures", "Measured in photographs");
  page.figures("one", {photograph(set, false, folder / "image-before.png"),
                       photograph(set, true, folder / "image-after.png"),
                       draw_profile(set, folder / "image-profile.svg")});
  constexpr double kDegree = 0.017453292519943295;
  page.facts(
      {{"confidence", fmt::format("{} of 100, {}", measured.confidence, escaped(measured.confidence_text))},
       {"scale", digits(set.settings.pixel / kMillimetre) + " mm a pixel"},
       {"uncertain by (95 %, median)",
        fmt::format("{} mm, {} pixels", digits(measured.uncertainty / kMillimetre),
                    digits(measured.uncertainty / set.settings.pixel))},
       {"of which how far the flanks moved", digits(measured.far_uncertainty / kMillimetre) + " mm"},
       {"line seen on", fmt::format("{} of the width before, {} after", percent(measured.before.coverage, 1),
                                    percent(measured.after.coverage, 1))},
       {"surface's tilt in the picture", digits(measured.tilt / kDegree) + " degrees"},
       {"second picture against the first, taken out",
        digits(measured.turn / kDegree) + " degrees, " + digits(measured.shift / kMillimetre) + " mm"},
       {"depth",
        digits(set.comparison.depth / kMillimetre) + " mm" +
            (set.depth_fitted ? ", the one that suits the line best: the tool hides the deepest place" : "")},
       {"model within the uncertainty at", percent(set.within_uncertainty, 1) + " of the places"}});
}

}  // namespace palpate::report
