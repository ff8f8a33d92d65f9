#include "fit/report/validation_report.h"

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

#include "fit/imaging/validation_fields.h"

namespace palpate::report {
namespace {

/// Labels of one figure.
struct Axes {
  std::string x;
  std::string y;
  std::string unit;
  std::string jnd;  // label for 7 % of the measured value
  std::string key;  // side of the legend: left or right
};

/// Both curves, and their absolute error with 7 % of the measured value. Columns: x, measured, computed.
std::string script(const Axes& axes, double largest_error) {
  const std::string upper =
      fmt::format(R"(set ylabel '{}, {}'; set yrange [*:*<1e9]; set offsets 0,0,graph 0.12,0
plot 'curve.dat' using 1:2 with points pt 7 ps 0.45 lc rgb '{}' title 'measured', \
  '' using 1:3 with lines lw 2 lc rgb '{}' title 'computed')",
                  axes.y, axes.unit, kOrange, kBlue);
  const std::string lower = fmt::format(R"(set xlabel '{}'; set ylabel 'absolute error, {}'
set yrange [0:*]; set offsets 0,0,graph 0.35,0; set ytics {}
plot 'curve.dat' using 1:(abs($3-$2)) with linespoints pt 7 ps 0.3 lw 1 lc rgb '{}' title 'absolute error', \
  '' using 1:({}*abs($2)) with lines lw 1.5 dt 2 lc rgb '#555555' title '{}')",
                                        axes.x, axes.unit, shortest(tic_step(largest_error)), kOrange,
                                        shortest(validate::kForceJnd), axes.jnd);
  return two_panes(620, "top " + axes.key + " Left reverse samplen 2 spacing 1.15 noopaque", 0.4, upper,
                   lower);
}

/// Data of one figure.
struct Curves {
  const std::string& name;
  const std::vector<double>& x;
  double x_unit;
  const std::vector<double>& measured;
  const std::vector<double>& computed;
  double unit;
};

Figure draw(const Curves& curves, bool sorted, const std::string& caption, const Axes& axes,
            const std::filesystem::path& file) {
  constexpr std::size_t kMaxRows = 2000;  // limits the size of the picture
  std::vector<std::vector<double>> all;
  for (std::size_t i = 0; i < curves.x.size(); ++i) {
    all.push_back(
        {curves.x[i] / curves.x_unit, curves.measured[i] / curves.unit, curves.computed[i] / curves.unit});
  }
  if (sorted) sort_by_x(all);
  std::vector<std::vector<double>> rows;
  double largest = 0.0;  // largest value in the lower panel
  for (std::size_t i = 0; i < all.size(); i += all.size() / kMaxRows + 1) {
    rows.push_back(all[i]);
    largest = std::max({largest, std::abs(all[i][2] - all[i][1]), validate::kForceJnd * std::abs(all[i][1])});
  }
  return drawn(
      {file, "Measured and computed curve of " + curves.name + ", and their absolute error", caption},
      script(axes, largest), {{"curve.dat", rows}});
}

Figure draw_force(const ForceSet& set, bool relaxes, const std::filesystem::path& file) {
  const validate::ForceComparison& ours = set.ours;
  const bool over_time = relaxes && !ours.measured.time.empty();
  const Axes axes{over_time ? "time, s" : "displacement, mm", "force", "N",
                  "7 % of the force: what a hand notices", over_time ? "right" : "left"};
  return draw({ours.measured.name, over_time ? ours.measured.time : ours.measured.displacement,
               over_time ? 1.0 : kMillimetre, ours.measured.force, ours.computed, 1.0},
              !over_time, "Measured and computed force, and the absolute error.", axes, file);
}

Figure draw_profile(const ProfileSet& set, const std::filesystem::path& file) {
  const validate::DeformationComparison& ours = set.ours;
  const Axes axes{"distance from the contact along the surface, mm", "displacement", "mm",
                  "7 % of the displacement (a hand notices 7 % of a force)", "right"};
  return draw(
      {ours.measured.name, ours.measured.distance, kMillimetre, ours.measured.displacement, ours.computed,
       kMillimetre},
      true,
      "Measured and computed deformation around the contact, and the absolute error, as in figure 7 of "
      "the paper.",
      axes, file);
}

std::string zeros_of(const validate::ZeroedErrors& with) {
  return fmt::format("first contact {} mm, sensor {} N: RMS {} of the force range",
                     brief(with.zeros.first_contact / kMillimetre, 3), brief(with.zeros.force, 3),
                     percent(with.errors.nrmse));
}

TableRows error_table(const validate::Errors& ours, double cost_ns, const std::string& label,
                      const std::vector<BaselineResult>& baselines, double unit,
                      const std::string& unit_name) {
  TableRows rows = {{"law", "parameters", "RMS, " + unit_name, "largest, " + unit_name, "RMS, relative",
                     "one evaluation, ns"}};
  rows.push_back({"ours", escaped(label), brief(ours.rms / unit, 3), brief(ours.max / unit, 3),
                  percent(ours.nrmse), cost_ns > 0.0 ? brief(cost_ns, 3) : "not measured"});
  for (const BaselineResult& baseline : baselines) {
    const validate::Errors& errors = baseline.fit.errors;
    rows.push_back({validate::to_string(baseline.fit.kind), escaped(baseline.fit.parameters),
                    brief(errors.rms / unit, 3), brief(errors.max / unit, 3), percent(errors.nrmse),
                    brief(baseline.cost_ns, 3)});
  }
  return rows;
}

/// Adds a set's row; the first row gets the headings.
template <typename Set>
void add_row(const Set& set, TableRows& rows) {
  std::vector<std::string> row;
  rows.front().clear();
  for (const identify::ShownField& shown : identify::shown_fields(set, 3)) {
    if (shown.field.column == nullptr) continue;
    rows.front().emplace_back(shown.field.column);
    row.push_back(escaped(shown.text));
  }
  rows.push_back(std::move(row));
}

void write_summary(Page& page, const Validation& validation, const std::string& command) {
  const validate::Law& law = validation.law;
  page.section("summary", "What came out");
  page.code(command);
  page.facts({{"tissue", law.tissue.name},
              {"law", model::to_string(law.tissue.law)},
              {"direction", law.direction == model::Direction::kPull ? "pull" : "press"}});
  TableRows rows(1);
  for (const ForceSet& set : validation.forces) add_row(set, rows);
  for (const ProfileSet& set : validation.profiles) add_row(set, rows);
  page.table(rows);
  if (validation.reach) {
    const model::FalloffRatios& reach = validation.reach->reach;
    page.paragraph(
        fmt::format("The reach was fitted to these profiles: c = {}, a = {}, s = {}, g = {}, p = {}{}",
                    brief(reach.contact_ratio, 3), brief(reach.first_bar_ratio, 3), brief(reach.bar_ratio, 3),
                    brief(reach.weight_ratio, 3), brief(reach.depth_exponent, 3),
                    validation.reach->exponent_kept ? " (as the tissue has it)." : "."));
  }
  std::vector<std::string> missed;
  for (const std::string& goal : validation.missed) missed.push_back("missed: " + goal);
  page.list(missed);
}

void write_set(Page& page, const std::string& name, std::size_t number, const Figure& figure,
               const TableRows& table, bool baselines, const std::string& note) {
  page.section("set-" + std::to_string(number), name);
  page.figures("one", {figure});
  page.table(table);
  if (baselines) {
    page.paragraph("The other laws were each fitted to these very data; ours is the tissue as it was given.");
  }
  if (!note.empty()) page.paragraph(note);
}

void write_sets(Page& page, const Validation& validation, const std::filesystem::path& folder) {
  const model::TissueParameters& tissue = validation.law.tissue;
  std::size_t number = 0;
  const auto file = [&] { return folder / fmt::format("set-{}.svg", ++number); };
  for (const ForceSet& set : validation.forces) {
    const Figure figure = draw_force(set, !tissue.relaxation.empty(), file());
    std::string note = zeros_text(set);
    if (set.ours.beyond > 0) {
      note += std::to_string(set.ours.beyond) +
              " points are deeper than the tissue's layers go: the law holds its largest force there.";
    }
    for (const std::string& doubt : set.ours.measured.preparation.notes) note += " " + doubt + ".";
    const TableRows table =
        error_table(set.ours.errors, set.cost_ns, "tissue " + tissue.name, set.baselines, 1.0, "N");
    write_set(page, set.ours.measured.name, number, figure, table, !set.baselines.empty(), note);
  }
  for (const ProfileSet& set : validation.profiles) {
    const Figure figure = draw_profile(set, file());
    const TableRows table =
        error_table(set.ours.errors, set.cost_ns, "tissue " + tissue.name, set.baselines, kMillimetre, "mm");
    write_set(page, set.ours.measured.name, number, figure, table, !set.baselines.empty(),
              fmt::format("Tip of {} mm radius, {} mm deep.", brief(set.ours.tip_radius / kMillimetre, 3),
                          brief(set.ours.depth / kMillimetre, 3)));
  }
}

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

void write_image_section(Page& page, const ImageSet& set, const std::filesystem::path& folder) {
  const imaging::ImageMeasurement& measured = set.measured;
  page.section("pictures", "Measured in photographs");
  page.figures("one", {photograph(set, false, folder / "image-before.png"),
                       photograph(set, true, folder / "image-after.png"),
                       draw_profile(set, folder / "image-profile.svg")});
  page.facts(
      {{"confidence", fmt::format("{} of 100, {}", measured.confidence, escaped(measured.confidence_text))},
       {"scale", digits(set.settings.pixel / kMillimetre) + " mm a pixel"},
       {"uncertain by (95 %, median)",
        fmt::format("{} mm, {} pixels", digits(measured.uncertainty / kMillimetre),
                    digits(measured.uncertainty / set.settings.pixel))},
       {"of which how far the flanks moved", digits(measured.far_uncertainty / kMillimetre) + " mm"},
       {"line seen on", fmt::format("{} of the width before, {} after", percent(measured.before.coverage, 1),
                                    percent(measured.after.coverage, 1))},
       {"surface's tilt in the picture", digits(measured.tilt / imaging::kRadiansPerDegree) + " degrees"},
       {"second picture against the first, taken out", digits(measured.turn / imaging::kRadiansPerDegree) +
                                                           " degrees, " +
                                                           digits(measured.shift / kMillimetre) + " mm"},
       {"depth",
        digits(set.comparison.depth / kMillimetre) + " mm" +
            (set.depth_fitted ? ", the one that suits the line best: the tool hides the deepest place" : "")},
       {"model within the uncertainty at", percent(set.within_uncertainty, 1) + " of the places"}});
}

}  // namespace

std::string zeros_text(const ForceSet& set) {
  std::string text = fmt::format("  zeros as {}{}); as {}{})\n", set.zeros_fitted ? "fitted (" : "given (",
                                 zeros_of(set.zeros_fitted ? set.fitted : set.given),
                                 set.zeros_fitted ? "given (" : "fitted (",
                                 zeros_of(set.zeros_fitted ? set.given : set.fitted));
  if (set.fitted.at_limit) {
    text +=
        "  ! the fitted zeros lie at a bound of their search: cut off motion without contact, subtract the "
        "sensor's zero\n";
  }
  return text;
}

std::filesystem::path write_validation_report(const Validation& validation, const std::string& command,
                                              const std::filesystem::path& folder) {
  make_report_folder(folder);
  Page page("Validation of " + validation.law.tissue.name, "The model against measurements, by palpate");
  write_summary(page, validation, command);
  if (validation.image) write_image_section(page, *validation.image, folder);
  write_sets(page, validation, folder);
  return page.write(folder);
}

std::string image_text(const ImageSet& set) {
  const imaging::ImageMeasurement& measured = set.measured;
  const double pixel = set.settings.pixel;
  return fmt::format(
      "pictures: {} places, uncertain by {} mm ({} px); confidence {} of 100, {}; the model lies within the "
      "uncertainty at {} of them{}\n",
      measured.points.size(), digits(measured.uncertainty / kMillimetre),
      digits(measured.uncertainty / pixel), measured.confidence, measured.confidence_text,
      percent(set.within_uncertainty, 1),
      set.depth_fitted
          ? "; the tool hides the deepest place: the depth is the one that suits the line best, so only "
            "the shape is compared"
          : "");
}

}  // namespace palpate::report
