#include "fit/report/fit_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"
#include "view/report/gnuplot.h"

#include "fit/identify/fit_fields.h"

namespace palpate::report {
namespace {

/// Upper panel: force; lower panel: residuals. Columns: x, measured, fitted, low, high.
std::string script(bool over_time, double largest_residual) {
  const std::string upper = fmt::format(
      R"(set ylabel 'force, N'; set yrange [*<0:*]; set autoscale yfixmin
plot 'curve.dat' using 1:4:5 with filledcurves lc rgb '#c9dfee' title '95 % band of the curve', \
  '' using 1:2 with points pt 7 ps 0.45 lc rgb '{}' title 'measured', \
  '' using 1:3 with lines lw 2 lc rgb '{}' title 'fitted'
set yrange [*:*]; set autoscale y)",
      kOrange, kBlue);
  const std::string lower = fmt::format(
      R"(set nokey; set xlabel '{}'; set ylabel 'fitted - measured, N'; set ytics {}
plot 'curve.dat' using 1:($3-$2) with impulses lw 1 lc rgb '{}', 0 with lines lw 1 lc rgb '#555555')",
      over_time ? "time, s" : "displacement, mm", shortest(tic_step(largest_residual)), kOrange);
  return two_panes(620, kKeyLeft, 0.36, upper, lower);
}

Figure draw_curve(const identify::SpecimenFit& fit, const std::filesystem::path& file) {
  const bool over_time = fit.terms > 0;
  const identify::Curve& curve = fit.curve;
  std::vector<std::vector<double>> rows;
  double largest = 0.0;
  for (std::size_t i = 0; i < curve.measured.size(); ++i) {
    const double x = over_time ? curve.time[i] : curve.displacement[i] / kMillimetre;
    rows.push_back({x, curve.measured[i], curve.fitted[i], curve.low[i], curve.high[i]});
    largest = std::max(largest, std::abs(curve.fitted[i] - curve.measured[i]));
  }
  if (!over_time) sort_by_x(rows);
  return drawn(
      {file, "Measured and fitted force of " + fit.name + ", and the residuals",
       "Measured force, the fitted curve with the band of curves that the data allow at 95 %, and the "
       "residuals."},
      script(over_time, largest), {{"curve.dat", rows}});
}

std::string range_text(const identify::Interval& interval, double unit) {
  return brief(interval.low / unit) + " to " + brief(interval.high / unit);
}

TableRows estimate_table(const std::vector<identify::Estimate>& estimates, std::size_t terms) {
  const std::vector<identify::ParameterLabel> labels = identify::labels(terms);
  const bool covariance =
      std::any_of(estimates.begin(), estimates.end(),
                  [](const identify::Estimate& estimate) { return estimate.covariance.has_value(); });
  const bool bootstrap = estimates.front().bootstrap.has_value();
  TableRows rows = {{"parameter", "best", "95 % interval"}};
  if (covariance) rows.front().emplace_back("from the covariance alone");
  if (bootstrap) rows.front().emplace_back("from the bootstrap");
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const identify::Estimate& estimate = estimates[i];
    const double unit = labels[i].unit;
    std::vector<std::string> row = {
        escaped(labels[i].name), brief(estimate.value / unit),
        range_text(estimate.interval, unit) + (estimate.determined ? "" : ", not determined")};
    if (covariance) row.push_back(estimate.covariance ? range_text(*estimate.covariance, unit) : "none");
    if (bootstrap) row.push_back(estimate.bootstrap ? range_text(*estimate.bootstrap, unit) : "none");
    rows.push_back(std::move(row));
  }
  return rows;
}

void write_summary(Page& page, const std::vector<identify::SpecimenFit>& fits,
                   const identify::PooledFit& pooled, const identify::Settings& settings,
                   const std::string& command) {
  page.section("summary", "What came out");
  page.code(command);
  page.facts({{"law", model::to_string(settings.law)},
              {"direction", settings.direction == model::Direction::kPull ? "pull" : "press"},
              {"layers", fmt::format("{} allowed, {} reached", pooled.layers_allowed, pooled.layers_reached)},
              {"specimens", std::to_string(fits.size())},
              {"seed", std::to_string(settings.seed)}});
  TableRows rows(1);
  for (const identify::SpecimenFit& fit : fits) {
    std::vector<std::string>& headings = rows.front();
    std::vector<std::string> row;
    headings.clear();
    for (const identify::ShownField& shown : identify::shown_fields(fit)) {
      if (shown.field.column == nullptr) continue;
      headings.emplace_back(shown.field.column);
      row.push_back(escaped(shown.text));
    }
    headings.insert(headings.end(), {"k1, N/m", "beta", "q", "L1, mm"});
    const std::vector<identify::ParameterLabel> labels = identify::labels(0);
    for (std::size_t i = 0; i < identify::kLawParameters; ++i)
      row.push_back(brief(fit.estimates[i].value / labels[i].unit));
    rows.push_back(std::move(row));
  }
  page.table(rows);
  page.paragraph("Errors are root mean squares over each specimen's range of force.");
  if (fits.size() > 1) {
    page.heading("All specimens together");
    page.paragraph(
        "One set of parameters for all, each specimen with its own first contact and sensor offset: error " +
        percent(pooled.nrmse) + ". The intervals come from drawing the specimens again.");
    page.table(estimate_table(pooled.estimates, pooled.terms));
    if (pooled.size) {
      page.paragraph(fmt::format(
          "Size exponent {} ({} to {}): the force grows as (radius / {} mm)^{}.", brief(pooled.size->value),
          brief(pooled.size->interval.low), brief(pooled.size->interval.high),
          brief(pooled.size->reference_radius / kMillimetre), brief(pooled.size->value)));
    }
    page.list(pooled.warnings);
  }
}

void write_specimen(Page& page, const identify::SpecimenFit& fit, const Figure& figure, std::size_t number) {
  page.section("experiment-" + std::to_string(number), fit.name);
  page.figures("one", {figure});
  page.table(estimate_table(fit.estimates, fit.terms));
  page.list(fit.warnings);
}

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

// A section with a figure per sweep: error over the fixed value, the confidence set, and the other
// parameters.
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

}  // namespace

std::filesystem::path write_fit_report(const std::vector<identify::SpecimenFit>& fits,
                                       const identify::PooledFit& pooled,
                                       const std::vector<identify::Sweep>& sweeps,
                                       const identify::Settings& settings, const std::string& command,
                                       const std::filesystem::path& folder) {
  make_report_folder(folder);
  Page page(fmt::format("Fit of {}{}", fits.size(), fits.size() == 1 ? " specimen" : " specimens"),
            "Tissue parameters from measured force over displacement, by palpate");
  write_summary(page, fits, pooled, settings, command);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    write_specimen(page, fits[i], draw_curve(fits[i], folder / ("specimen-" + number + ".svg")), i + 1);
  }
  write_sweeps(page, sweeps, folder);
  return page.write(folder);
}

}  // namespace palpate::report
