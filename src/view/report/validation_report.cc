#include "view/report/validation_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"
#include "view/report/figures.h"
#include "view/report/gnuplot.h"
#include "view/report/page.h"
#include "view/report/text_format.h"

namespace palpate::report {
namespace {

/// Words of one figure.
struct Axes {
  std::string x;
  std::string y;
  std::string unit;
  std::string jnd;  // what 7 % of the measured value are
  std::string key;  // where the legend has room: left or right
};

/// Two panes over one axis: the two curves, then their absolute error with 7 % of the measured value drawn
/// in. Columns: x, measured, computed.
std::string script(const Axes& axes, double largest_error) {
  constexpr const char* kScript = R"({}set lmargin 11
set multiplot; set origin 0,0.40; set size 1,0.60; set bmargin 0.6; set format x ''
set ylabel '{y}, {unit}'; set yrange [*:*<1e9]; set offsets 0,0,graph 0.12,0
plot 'curve.dat' using 1:2 with points pt 7 ps 0.45 lc rgb '#D55E00' title 'measured', \
  '' using 1:3 with lines lw 2 lc rgb '#0072B2' title 'computed'
set origin 0,0; set size 1,0.40; set tmargin 0.8; set bmargin 3.4; set format x '%g'
set xlabel '{x}'; set ylabel 'absolute error, {unit}'
set yrange [0:*]; set offsets 0,0,graph 0.35,0; set ytics {step}
plot 'curve.dat' using 1:(abs($3-$2)) with linespoints pt 7 ps 0.3 lw 1 lc rgb '#D55E00' title 'absolute error', \
  '' using 1:({jnd}*abs($2)) with lines lw 1.5 dt 2 lc rgb '#555555' title '{jnd_title}'
unset multiplot
)";
  return fmt::format(kScript,
                     preamble(760, 620, "top " + axes.key + " Left reverse samplen 2 spacing 1.15 noopaque"),
                     fmt::arg("x", axes.x), fmt::arg("y", axes.y), fmt::arg("unit", axes.unit),
                     fmt::arg("step", shortest(tic_step(largest_error))),
                     fmt::arg("jnd", shortest(validate::kForceJnd)), fmt::arg("jnd_title", axes.jnd));
}

std::vector<std::vector<double>> rows_of(const std::vector<double>& x, double unit_x,
                                         const std::vector<double>& measured,
                                         const std::vector<double>& computed, double unit, bool sorted) {
  std::vector<std::size_t> order(x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (sorted) {
    std::stable_sort(order.begin(), order.end(), [&x](std::size_t a, std::size_t b) { return x[a] < x[b]; });
  }
  std::vector<std::vector<double>> rows;
  constexpr std::size_t kMostRows = 2000;  // more would only make the picture large
  const std::size_t every = order.size() / kMostRows + 1;
  for (std::size_t n = 0; n < order.size(); n += every) {
    const std::size_t i = order[n];
    rows.push_back({x[i] / unit_x, measured[i] / unit, computed[i] / unit});
  }
  return rows;
}

Figure draw(const std::string& name, const std::string& caption, const Axes& axes,
            const std::vector<std::vector<double>>& rows, const std::filesystem::path& file) {
  Figure figure;
  figure.file = file;
  figure.alternative = "Measured and computed curve of " + name + ", and their absolute error";
  figure.caption = caption;
  double largest = 0.0;  // in the lower pane
  for (const std::vector<double>& row : rows) {
    largest = std::max({largest, std::abs(row[2] - row[1]), validate::kForceJnd * std::abs(row[1])});
  }
  try {
    run_gnuplot(script(axes, largest), {{"curve.dat", rows}}, file);
  } catch (const FigureError& error) {
    figure.missing = error.what();
  }
  return figure;
}

Figure draw_force(const ForceSet& set, bool relaxes, const std::filesystem::path& file) {
  const validate::ForceComparison& ours = set.ours;
  const bool over_time = relaxes && !ours.measured.time.empty();
  const Axes axes{over_time ? "time, s" : "displacement, mm", "force", "N",
                  "7 % of the force: what a hand notices", over_time ? "right" : "left"};
  return draw(ours.measured.name, "Measured and computed force, and the absolute error.", axes,
              rows_of(over_time ? ours.measured.time : ours.measured.displacement,
                      over_time ? 1.0 : kMillimetre, ours.measured.force, ours.computed, 1.0, !over_time),
              file);
}

Figure draw_profile(const ProfileSet& set, const std::filesystem::path& file) {
  const validate::DeformationComparison& ours = set.ours;
  const Axes axes{"distance from the contact along the surface, mm", "displacement", "mm",
                  "7 % of the displacement (a hand notices 7 % of a force)", "right"};
  return draw(
      ours.measured.name,
      "Measured and computed deformation around the contact, and the absolute error, as in figure 7 of "
      "the paper.",
      axes,
      rows_of(ours.measured.distance, kMillimetre, ours.measured.displacement, ours.computed, kMillimetre,
              true),
      file);
}

std::string zeros_of(const validate::ZeroedErrors& with) {
  return fmt::format("first contact {} mm, sensor {} N: RMS {} of the force range",
                     brief(with.zeros.first_contact / kMillimetre, 3), brief(with.zeros.force, 3),
                     percent(with.errors.nrmse));
}

TableRows error_table(const validate::Errors& ours, double cost_ns, const std::string& words,
                      const std::vector<RivalResult>& rivals, double unit, const std::string& unit_name) {
  TableRows rows = {{"law", "parameters", "RMS, " + unit_name, "largest, " + unit_name, "RMS, relative",
                     "one evaluation, ns"}};
  rows.push_back({"ours", escaped(words), brief(ours.rms / unit, 3), brief(ours.max / unit, 3),
                  percent(ours.nrmse), cost_ns > 0.0 ? brief(cost_ns, 3) : "not measured"});
  for (const RivalResult& rival : rivals) {
    const validate::Errors& errors = rival.fit.errors;
    rows.push_back({validate::to_string(rival.fit.kind), escaped(rival.fit.parameters),
                    brief(errors.rms / unit, 3), brief(errors.max / unit, 3), percent(errors.nrmse),
                    brief(rival.cost_ns, 3)});
  }
  return rows;
}

void write_summary(Page& page, const Validation& validation, const std::string& command) {
  const validate::Law& law = validation.law;
  page.open_section("summary", "What came out");
  page.code(command);
  page.facts({{"tissue", law.tissue.name},
              {"law", model::to_string(law.tissue.law)},
              {"direction", law.direction == model::Direction::kPull ? "pull" : "press"}});
  TableRows rows = {{"data set", "points", "RMS", "largest", "RMS, relative to", "", "within 7 %"}};
  for (const ForceSet& set : validation.forces) {
    rows.push_back({escaped(set.ours.measured.name), std::to_string(set.ours.measured.size()),
                    brief(set.ours.errors.rms, 3) + " N", brief(set.ours.errors.max, 3) + " N",
                    percent(set.ours.errors.nrmse), "of the force range", percent(set.ours.within_jnd)});
  }
  for (const ProfileSet& set : validation.profiles) {
    rows.push_back({escaped(set.ours.measured.name), std::to_string(set.ours.measured.size()),
                    brief(set.ours.errors.rms / kMillimetre, 3) + " mm",
                    brief(set.ours.errors.max / kMillimetre, 3) + " mm", percent(set.ours.errors.nrmse),
                    "of the depth", ""});
  }
  page.table(rows);
  if (validation.reach) {
    const model::ReachParameters& reach = validation.reach->reach;
    page.paragraph(
        fmt::format("The reach was fitted to these profiles: c = {}, a = {}, s = {}, g = {}, p = {}{}",
                    brief(reach.contact_ratio, 3), brief(reach.first_bar_ratio, 3), brief(reach.bar_ratio, 3),
                    brief(reach.weight_ratio, 3), brief(reach.depth_exponent, 3),
                    validation.reach->exponent_kept ? " (as the tissue has it)." : "."));
  }
  std::vector<std::string> missed;
  for (const std::string& goal : validation.missed) missed.push_back("missed: " + escaped(goal));
  if (!missed.empty()) page.list(missed);
  page.close_section();
}

void write_set(Page& page, const std::string& name, std::size_t number, const Figure& figure,
               const TableRows& table, bool rivals, const std::string& note) {
  page.open_section("set-" + std::to_string(number), name);
  page.open_grid("one");
  page.figure(figure);
  page.close_grid();
  page.table(table);
  if (rivals) {
    page.paragraph("The other laws were each fitted to these very data; ours is the tissue as it was given.");
  }
  if (!note.empty()) page.paragraph(note);
  page.close_section();
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
    const TableRows table =
        error_table(set.ours.errors, set.cost_ns, "tissue " + tissue.name, set.rivals, 1.0, "N");
    write_set(page, set.ours.measured.name, number, figure, table, !set.rivals.empty(), note);
  }
  for (const ProfileSet& set : validation.profiles) {
    const Figure figure = draw_profile(set, file());
    const TableRows table =
        error_table(set.ours.errors, set.cost_ns, "tissue " + tissue.name, set.rivals, kMillimetre, "mm");
    write_set(page, set.ours.measured.name, number, figure, table, !set.rivals.empty(),
              fmt::format("Tip of {} mm radius, {} mm deep.", brief(set.ours.tip_radius / kMillimetre, 3),
                          brief(set.ours.depth / kMillimetre, 3)));
  }
}

}  // namespace

std::string zeros_text(const ForceSet& set) {
  std::string text = fmt::format("  zeros as {}{}); as {}{})\n", set.zeros_fitted ? "fitted (" : "given (",
                                 zeros_of(set.zeros_fitted ? set.fitted : set.given),
                                 set.zeros_fitted ? "given (" : "fitted (",
                                 zeros_of(set.zeros_fitted ? set.given : set.fitted));
  if (set.fitted.at_limit) {
    text +=
        "  ! the fitted zeros lie where their search ends: cut off the way without contact, take off the "
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

}  // namespace palpate::report
