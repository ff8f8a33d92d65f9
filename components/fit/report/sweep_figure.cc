#include "fit/report/sweep_figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "view/report/gnuplot.h"

namespace palpate::report {
namespace {

using session::kRunQuantities;

constexpr std::array<std::string_view, 4> kShown = {"peak_tissue_force_N", "depth_at_peak_mm",
                                                    "loading_work_mJ", "dissipated_energy_mJ"};
constexpr std::size_t kMaxTraces = 8;
constexpr std::array<const char*, kMaxTraces> kColours = {kBlue,     kOrange,   kGreen,    "#CC79A7",
                                                          "#E69F00", "#56B4E9", "#000000", kGrey};
constexpr std::size_t kNoAxis = static_cast<std::size_t>(-1);

/// What the figure shows of a sweep.
struct View {
  std::size_t x_axis = 0;
  std::size_t trace_axis = kNoAxis;
  std::vector<std::string> trace_values = {""};  // at most kMaxTraces values of its axis, evenly chosen
  std::string held;                              // the other axes with their fixed values
};

View view_of(const sweep::SweepResult& sweep) {
  View view;
  std::vector<std::size_t> several;
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    if (sweep.axes[i].values.size() > 1) several.push_back(i);
  }
  if (!several.empty()) view.x_axis = several[0];
  if (several.size() > 1) {
    view.trace_axis = several[1];
    const std::vector<std::string>& values = sweep.axes[view.trace_axis].values;
    const std::size_t shown = std::min(values.size(), kMaxTraces);
    view.trace_values.clear();
    for (std::size_t k = 0; k < shown; ++k) {
      view.trace_values.push_back(values[k * (values.size() - 1) / (shown - 1)]);
    }
  }
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    if (i == view.x_axis || i == view.trace_axis) continue;
    view.held +=
        (view.held.empty() ? "at " : ", ") + sweep.axes[i].key + " = " + sweep.axes[i].values.front();
  }
  return view;
}

/// Position of a value on the x axis: the number, or the index of a text, counted from 0.
double axis_position(const sweep::Axis& axis, const std::string& value) {
  if (axis.number()) return parse_number(value).value();
  return static_cast<double>(std::find(axis.values.begin(), axis.values.end(), value) - axis.values.begin());
}

const session::RunQuantity& quantity_of(std::string_view name) {
  return *std::find_if(kRunQuantities.begin(), kRunQuantities.end(),
                       [name](const auto& one) { return one.name == name; });
}

std::vector<double> points_of(const sweep::SweepRow& row, double x) {
  std::vector<double> numbers = {x};
  for (const std::string_view name : kShown) {
    numbers.push_back(row.quantities[static_cast<std::size_t>(&quantity_of(name) - kRunQuantities.data())]);
  }
  return numbers;
}

/// Two tables per curve: runs with contact, and runs that missed the organ. Columns: x, then the quantities
/// of kShown.
std::vector<PlotData> tables_of(const sweep::SweepResult& sweep, const View& view) {
  std::vector<PlotData> tables;
  for (const std::string& value : view.trace_values) {
    PlotData touched{"touched" + std::to_string(tables.size()), {}};
    PlotData missed{"missed" + std::to_string(tables.size()), {}};
    for (const sweep::SweepRow& row : sweep.rows) {
      bool shown = !row.failed();
      for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
        const std::string& at = i == view.trace_axis ? value : sweep.axes[i].values.front();
        shown = shown && (i == view.x_axis || row.settings[i] == at);
      }
      if (!shown) continue;
      (row.missed_contact ? missed : touched)
          .rows.push_back(points_of(row, axis_position(sweep.axes[view.x_axis], row.settings[view.x_axis])));
    }
    for (PlotData* table : {&touched, &missed}) {
      std::sort(table->rows.begin(), table->rows.end());
      tables.push_back(std::move(*table));
    }
  }
  return tables;
}

std::string x_axis_script(const sweep::Axis& axis) {
  std::string script = "set xlabel " + quoted(axis.key) + "\nset format x '%g'\nset autoscale xfix\n";
  std::string tics;
  for (std::size_t i = 0; !axis.number() && i < axis.values.size(); ++i) {
    tics += fmt::format("{}{} {}", tics.empty() ? "" : ", ", quoted(axis.values[i]), i);
  }
  if (!axis.number())
    script += fmt::format("set xtics ({})\nset xrange [-0.5:{}.5]\n", tics, axis.values.size() - 1);
  // detect logarithmic steps, as :log makes them
  if (axis.number() && axis.values.size() > 2) {
    const double first = *parse_number(axis.values[0]);
    const double ratio = *parse_number(axis.values[1]) / first;
    const bool logarithmic = first > 0.0 && ratio > 1.01 &&
                             std::abs(*parse_number(axis.values[2]) / (first * ratio * ratio) - 1.0) < 0.01;
    if (logarithmic) script += "set logscale x\n";
  }
  return script;
}

/// One panel per quantity; the values of the curves are at the right, fixed values at the top.
std::string script_of(const std::vector<PlotData>& tables, const View& view,
                      const sweep::SweepResult& sweep) {
  const bool several = view.trace_axis != kNoAxis;
  std::string script = preamble(several ? 1100 : 960, 760, "off") + x_axis_script(sweep.axes[view.x_axis]) +
                       fmt::format(
                           "set label 1 {} at screen 0.5,0.975 center\n"
                           "set multiplot layout 2,2 margins 0.08,{},0.09,0.93 spacing 0.11,0.14\n",
                           quoted(view.held), several ? 0.81 : 0.97);
  for (std::size_t pane = 0; pane < kShown.size(); ++pane) {
    script += fmt::format("set ylabel {}\nset yrange [*<0:*]\n", quoted(quantity_of(kShown[pane]).label));
    if (several && pane == 0) {
      script += fmt::format("set key at screen 0.985,0.93 right top vertical samplen 2 noopaque title {}\n",
                            quoted(sweep.axes[view.trace_axis].key));
    } else {
      script += "set key off\n";
    }
    if (pane > 0) script += "unset label 1\n";
    std::vector<std::string> curves;
    for (std::size_t i = 0; i < tables.size(); ++i) {
      if (tables[i].rows.empty()) continue;
      const bool missed = i % 2 == 1;
      const std::string& value = view.trace_values[i / 2];
      curves.push_back(fmt::format(
          "'{}' using 1:{} {} {} lc rgb '{}'", tables[i].name, pane + 2,
          missed || value.empty() ? "notitle" : "title " + quoted(value),
          missed ? "with points pt 2 ps 0.9 lw 2" : "with linespoints pt 7 ps 0.5 lw 2", kColours[i / 2]));
    }
    script += plot(curves);
  }
  return script + "unset multiplot\n";
}

}  // namespace

std::string draw_sweep(const sweep::SweepResult& sweep, const std::filesystem::path& file) {
  const View view = view_of(sweep);
  const std::vector<PlotData> tables = tables_of(sweep, view);
  std::vector<PlotData> data;
  std::copy_if(tables.begin(), tables.end(), std::back_inserter(data),
               [](const PlotData& table) { return !table.rows.empty(); });
  if (data.empty()) return "every run that it would show failed";
  try {
    run_gnuplot(script_of(tables, view, sweep), data, file);
  } catch (const FigureError& error) {
    return one_line(error.what());
  }
  return {};
}

}  // namespace palpate::report
