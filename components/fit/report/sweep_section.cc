#include "fit/report/sweep_section.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"
#include "view/report/gnuplot.h"
#include "view/report/text_format.h"

namespace palpate::report {
namespace {

struct Line {
  const char* title;
  const char* colour;
};
constexpr Line kLines[identify::kLawParameters] = {
    {"k_1", "#0072B2"}, {"beta", "#D55E00"}, {"q", "#009E73"}, {"L_1", "#CC79A7"}};

std::string axis_name(std::size_t parameter) {
  const char* const names[identify::kLawParameters] = {"k_1, N/m", "beta", "q", "L_1, mm"};
  return names[parameter];
}

/// An axis from `low` to `high`: logarithmic beyond a factor 3, with tics at 1, 2 and 5 times powers of ten.
std::string axis(const std::string& name, double low, double high) {
  constexpr double kLogarithmFrom = 3.0;
  std::string text = fmt::format("set {}range [{}:{}]\n", name, shortest(low), shortest(high));
  if (high < kLogarithmFrom * low)
    return fmt::format("{}unset logscale {}\nset {}tics autofreq\n", text, name, name);
  std::string tics;
  const int last = static_cast<int>(std::floor(std::log10(high)));
  for (int n = static_cast<int>(std::floor(std::log10(low))); n <= last; ++n) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double tic = step * std::pow(10.0, n);
      if (tic >= low && tic <= high) tics += (tics.empty() ? "" : ",") + shortest(tic);
    }
  }
  return fmt::format("{}set logscale {}\nset {}tics ({})\n", text, name, name, tics);
}

std::string where(const identify::Sweep& sweep) {
  return sweep.specimen.empty() ? std::string("all together") : sweep.specimen;
}

/// Plots over the fixed value: the error, and the other parameters relative to the fit. Columns: value, error
/// in percent, error within the confidence set, four ratios.
std::string script(const identify::Sweep& sweep, double most, double lowest, double highest) {
  const double unit = identify::labels(0)[sweep.parameter].unit;
  const std::string upper = fmt::format(
      R"(set rmargin 3
{}set yrange [0:{}]; set ylabel 'error, % of force range'
plot 'sweep.dat' using 1:3 with filledcurves y1=0 lc rgb '#c9dfee' title 'left by the data', \
  '' using 1:2 with linespoints pt 7 ps 0.4 lw 2 lc rgb '{}' title 'error', \
  'best.dat' using 1:2 with points pt 9 ps 1.1 lc rgb '#555555' title 'the fit'
set key outside top center)",
      axis("x", sweep.points.front().value / unit, sweep.points.back().value / unit), shortest(most), kBlue);
  std::string lower = fmt::format(R"(set tmargin 2
{}set xlabel '{}'; set ylabel 'others / their best'
plot 1 with lines lw 1 lc rgb '#555555' notitle)",
                                  axis("y", lowest, highest), axis_name(sweep.parameter));
  for (std::size_t i = 0; i < identify::kLawParameters; ++i) {
    if (i == sweep.parameter) continue;
    lower += fmt::format(", 'sweep.dat' using 1:{} with lines lw 2 lc rgb '{}' title '{}'", 4 + i,
                         kLines[i].colour, kLines[i].title);
  }
  return two_panes(560, "top center horizontal samplen 2 noopaque", 0.49, upper, lower);
}

/// The swept point nearest to the fit, to which the other parameters are related.
const identify::SweepPoint& nearest(const identify::Sweep& sweep) {
  return *std::min_element(sweep.points.begin(), sweep.points.end(),
                           [&sweep](const identify::SweepPoint& a, const identify::SweepPoint& b) {
                             return std::abs(a.value - sweep.best) < std::abs(b.value - sweep.best);
                           });
}

Figure draw(const identify::Sweep& sweep, const std::filesystem::path& file) {
  const identify::ParameterLabel label = identify::labels(0)[sweep.parameter];
  const identify::SweepPoint& centre = nearest(sweep);
  constexpr double kRoom = 1.15;  // margin of an axis, as a factor
  std::vector<std::vector<double>> rows;
  double most = 100.0 * sweep.best_nrmse;
  double lowest = 1.0;
  double highest = 1.0;
  for (const identify::SweepPoint& point : sweep.points) {
    const double error = 100.0 * point.nrmse;
    most = std::max(most, error);
    std::vector<double> row = {point.value / label.unit, error, point.within_95 ? error : std::nan("")};
    for (std::size_t i = 0; i < identify::kLawParameters; ++i) {
      row.push_back(point.others[i] / centre.others[i]);
      if (i == sweep.parameter) continue;
      lowest = std::min(lowest, row.back());
      highest = std::max(highest, row.back());
    }
    rows.push_back(std::move(row));
  }
  return drawn({file, fmt::format("Error over {} of {}, and the other parameters", label.name, where(sweep)),
                fmt::format("{}: {} held at each value and the others fitted again. Shaded: values that the "
                            "data leave at 95 %. Below: where the others go.",
                            where(sweep), label.name)},
               script(sweep, 1.25 * most, lowest / kRoom, highest * kRoom * kRoom),
               {{"sweep.dat", rows}, {"best.dat", {{sweep.best / label.unit, 100.0 * sweep.best_nrmse}}}});
}

std::string verdict(const identify::Sweep& sweep) {
  if (sweep.found_better)
    return "a value fits clearly better than the fit's own: the fit is not the best one";
  if (sweep.open_below && sweep.open_above) return "left open by the data";
  if (sweep.open_below) return "bounded above only";
  if (sweep.open_above) return "bounded below only";
  return "bounded on both sides";
}

}  // namespace

void write_sweeps(Page& page, const std::vector<identify::Sweep>& sweeps,
                  const std::filesystem::path& folder) {
  if (sweeps.empty()) return;
  page.section("sweeps", "Sweeps");
  page.paragraph(
      "A parameter is fixed at a series of values, and all others are fitted again at each. A flat line "
      "means that the data do not determine this parameter: others compensate it.");
  TableRows rows = {{"parameter", "of", "within the swept range"}};
  for (const identify::Sweep& sweep : sweeps) {
    rows.push_back(
        {escaped(identify::labels(0)[sweep.parameter].name), escaped(where(sweep)), verdict(sweep)});
  }
  page.table(rows);
  std::vector<Figure> figures;
  for (const identify::Sweep& sweep : sweeps)
    figures.push_back(draw(sweep, folder / fmt::format("sweep-{}.svg", figures.size() + 1)));
  page.figures("one", figures);
}

}  // namespace palpate::report
