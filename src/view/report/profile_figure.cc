// Figure 7 of the paper for a run: the deformation along a line through the contact, and absolute errors.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/surface.h"
#include "view/report/page.h"
#include "view/report/sections.h"
#include "view/report/surface_line.h"

namespace palpate::report {
namespace {

constexpr int kTheoryPoints = 240;

/// Differences of two curves, for a plot and in numbers.
struct LineErrors {
  PlotData data;         // distance, absolute error [mm]
  double largest = 0.0;  // mm
  double rms = 0.0;      // mm

  LineErrors(std::string name) : data{std::move(name), {}} {}
  void add(double distance, double error) {
    if (!std::isfinite(error)) return;
    data.rows.push_back({distance * kMilli, std::abs(error) * kMilli});
    largest = std::max(largest, data.rows.back()[1]);
  }
  void finish() {
    double sum = 0.0;
    for (const std::vector<double>& row : data.rows) sum += row[1] * row[1];
    if (!data.rows.empty()) rms = std::sqrt(sum / static_cast<double>(data.rows.size()));
  }
  [[nodiscard]] std::string text(double depth) const {
    return fmt::format("RMS {} mm, largest {} mm ({} of the depth)", fixed(rms, 2), fixed(largest, 2),
                       percent(largest / (depth * kMilli), 0));
  }
};

PlotData table_of(const char* name, const std::vector<LinePlace>& places) {
  PlotData data{name, {}};
  for (const LinePlace& place : places)
    data.rows.push_back({place.distance * kMilli, place.displacement * kMilli});
  return data;
}

// @param source of the reference; empty: there is none @param shared whether there is any error to draw
std::string profile_script(const std::string& source, bool shared, double largest_error, double from,
                           double to) {
  const bool measured = !source.empty();
  std::vector<std::string> curves = {
      fmt::format("'theory.dat' using 1:2 with lines lw 6 lc rgb '#a9cbe4' title 'theory'"),
      fmt::format("'shown.dat' using 1:2 with lines lw 2 lc rgb '{}' title 'surface of this run'", kGreen)};
  std::vector<std::string> errors;
  if (measured) {
    curves.push_back(fmt::format("'measured.dat' using 1:2 with points pt 7 ps 0.5 lc rgb '{}' title '{}'",
                                 kOrange, source));
    errors = {
        fmt::format("'theory-error.dat' using 1:2 with linespoints pt 7 ps 0.3 lw 1.5 lc rgb '{}' title "
                    "'theory - {}'",
                    kBlue, source),
        fmt::format("'shown-error.dat' using 1:2 with lines lw 1.5 lc rgb '{}' title 'run - {}'", kGreen,
                    source)};
  } else {
    errors = {fmt::format("'shown-error.dat' using 1:2 with lines lw 1.5 lc rgb '{}' notitle", kOrange)};
  }
  const std::string upper =
      fmt::format("set xrange [{}:{}]\n", shortest(from * kMilli), shortest(to * kMilli)) +
      "set ylabel 'displacement (mm)'; set yrange [*<0:*]; set offsets 0,0,graph 0.22,0\n" + plot(curves);
  const std::string lower = fmt::format(
      "set xlabel 'distance from the contact along the surface (mm)'; set ylabel 'error (mm)'\n"
      "set yrange [0:*]; set offsets 0,0,graph {},0; set ytics {}\n",
      measured ? "0.5" : "0.15", shortest(tic_step(largest_error)));
  const std::string none =  // gnuplot refuses a pane without a point
      "set yrange [0:1]; unset ytics; set label 'no place in common' at graph 0.5,0.5 center\nplot NaN "
      "notitle\n";
  constexpr int kWidth = 540;
  return two_panes(440, kKeyLeft, 0.36, upper, lower + (shared ? plot(errors) : none), kWidth);
}

// Example: "y" of (0, 1, 0).
std::string axis_text(const Vec3& axis) {
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k)
    if (axis == Vec3::Unit(static_cast<Eigen::Index>(k))) return kNames[k];
  return fmt::format("({}, {}, {})", fixed(axis.x(), 2), fixed(axis.y(), 2), fixed(axis.z(), 2));
}

// Both errors, and of how many places of the reference they are.
std::string errors_text(const ReferenceProfile& reference, const LineErrors& theory,
                        const LineErrors& shown) {
  const std::size_t shared = shown.data.rows.size();
  const std::size_t all = reference.places.size();
  if (shared == 0) return "The run's line reaches no place of it, so there is no absolute error.";
  const std::string where =
      shared == all ? ""
                    : fmt::format("; at {} of {} places, those that the run's line reaches", shared, all);
  return fmt::format("Absolute error of the theory: {}; of the run's surface: {}{}.",
                     theory.text(reference.depth), shown.text(reference.depth), where);
}

std::string profile_caption(const SurfaceLine& line, const scene::Scene& scene,
                            const ReferenceProfile* reference, const LineErrors& theory,
                            const LineErrors& shown) {
  std::string text = fmt::format(
      "As figure 7 of the paper: deformation along the line through the contact, {} mm deep, {}. Theory: "
      "u(r) of the model for a tip of {} mm radius.",
      fixed(line.depth * kMilli, 2),
      reference != nullptr && reference->across_S
          ? "along " + axis_text(*reference->across_S) + " of the organ"
          : "from left to right in the pictures",
      fixed(line.tip_radius * kMilli, 1));
  if (reference == nullptr) {
    text += " Absolute error of the run's surface beside the theory: " + shown.text(line.depth) + ".";
  } else {
    text += fmt::format(" {}: {}, {} mm deep. {}",
                        reference->source == "measured" ? "Measured" : "Finite elements", reference->origin,
                        fixed(reference->depth * kMilli, 2), errors_text(*reference, theory, shown));
    constexpr double kSameDepth = 0.02;
    if (std::abs(line.depth - reference->depth) > kSameDepth * reference->depth)
      text += " The depths differ: this run has no tick as deep as the reference.";
  }
  if (line.contacts > 1) {
    text += fmt::format(
        " The tool has {} contacts there, and the run's surface lies on all of it; the theory is of the "
        "deepest contact alone.",
        line.contacts);
  }
  if (line.contacts_of_others > 0)
    text += " Another hand moves the surface too, which the theory leaves out.";
  if (scene.support) text += " The organ gives way as a whole, which the theory leaves out.";
  return text;
}

}  // namespace

Figure draw_profile(const SurfaceLine& line, const scene::Scene& scene, const model::FalloffRatios& reach,
                    const ReferenceProfile* reference, const std::filesystem::path& file) {
  Figure figure{file, "Deformation along the line through the contact, and absolute errors"};
  if (line.places.size() < 2) {
    figure.missing = "The tool did not touch the organ.";
    return figure;
  }
  const deform::DisplacementProfile theory(reach, line.depth, line.tip_radius);
  double from = line.places.front().distance;
  double to = line.places.back().distance;
  LineErrors theory_error("theory-error.dat");
  LineErrors shown_error("shown-error.dat");
  if (reference != nullptr) {
    from = std::min(from, reference->places.front().distance);
    to = std::max(to, reference->places.back().distance);
    for (const LinePlace& place : reference->places) {
      const double of_theory = theory.at(std::abs(place.distance)) - place.displacement;
      const double of_run = displacement_at(line.places, place.distance) - place.displacement;
      if (!std::isfinite(of_theory) || !std::isfinite(of_run)) continue;  // both at the same places
      theory_error.add(place.distance, of_theory);
      shown_error.add(place.distance, of_run);
    }
  } else {
    for (const LinePlace& place : line.places)
      shown_error.add(place.distance, place.displacement - theory.at(std::abs(place.distance)));
  }
  theory_error.finish();
  shown_error.finish();
  std::vector<LinePlace> curve;
  for (int i = 0; i <= kTheoryPoints; ++i) {
    const double r = from + (to - from) * i / kTheoryPoints;
    curve.push_back({r, theory.at(std::abs(r))});
  }
  std::vector<PlotData> tables = {table_of("theory.dat", curve), table_of("shown.dat", line.places),
                                  theory_error.data, shown_error.data};
  if (reference != nullptr) tables.push_back(table_of("measured.dat", reference->places));
  figure.caption = profile_caption(line, scene, reference, theory_error, shown_error);
  return drawn(figure,
               profile_script(reference != nullptr ? reference->source : "", !shown_error.data.rows.empty(),
                              std::max(theory_error.largest, shown_error.largest), from, to),
               tables);
}

}  // namespace palpate::report
