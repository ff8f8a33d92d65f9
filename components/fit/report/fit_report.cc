#include "fit/report/fit_report.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"
#include "view/report/gnuplot.h"
#include "view/report/page.h"
#include "view/report/text_format.h"

#include "fit/identify/fit_fields.h"
#include "fit/report/sweep_section.h"

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
      {file, "Measured and fitted force of " + fit.name + ", and what is left",
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
    page.list(pooled.warnings);
  }
}

void write_specimen(Page& page, const identify::SpecimenFit& fit, const Figure& figure, std::size_t number) {
  page.section("experiment-" + std::to_string(number), fit.name);
  page.figures("one", {figure});
  page.table(estimate_table(fit.estimates, fit.terms));
  page.list(fit.warnings);
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
