#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "view/report/page.h"

#include "study/report/study_report_sections.h"
#include "study/session/analysis_text.h"

namespace palpate::report {
namespace {

using study::ArmResult;
using study::Contrast;
using study::PersonResult;
using study::Study;
using study::StudyAnalysis;
using study::StudyTask;

constexpr int kWidth = 760;
// One for each arm (Okabe and Ito 2008).
constexpr const char* kArmColours[] = {kGrey, kBlue, kOrange, kGreen, "#CC79A7", "#E69F00", "#56B4E9"};

std::string colour_of(std::size_t arm, std::size_t arms) {
  return arms == 1 ? kBlue : kArmColours[arm % std::size(kArmColours)];
}

// The stimulus on the x axis.
double x_of(const StudyTask& task, double level) { return readable_level(task, level).value; }

// Panels of four in a row, below a legend.
struct Panels {
  static constexpr int kColumns = 4;
  static constexpr int kHeight = 160;
  static constexpr int kLegend = 36;
  static constexpr int kFoot = 22;
  std::size_t count;
  [[nodiscard]] int rows() const { return (static_cast<int>(count) + kColumns - 1) / kColumns; }
  [[nodiscard]] int height() const { return kLegend + kFoot + rows() * kHeight; }
};

std::string axes_of(const StudyTask& task) {
  const psychophysics::QuestPlusGrid grid = grid_of(task);
  std::string text = fmt::format("set logscale x\nset xrange [{}:{}]\n",
                                 0.9 * x_of(task, grid.levels.front()), 1.1 * x_of(task, grid.levels.back()));
  const std::string marks = describe(task.kind).marks;
  if (!marks.empty()) text += "set xtics (" + marks + ")\n";
  text += task.comparison() ? "set yrange [-0.05:1.05]\nset ytics (0, 0.5, 1)\n"
                            : "set yrange [-0.05:1.05]\nset ytics (0, 0.5, 0.75, 1)\n";
  return text;
}

// Share of the counted answers: stimulus, share, size of the point.
PlotData points_of(const StudyTask& task, const ArmResult& arm, const std::string& name) {
  PlotData data{name, {}};
  for (const study::Point& point : arm.points) {
    const double share = static_cast<double>(point.count.counted) / point.count.trials;
    data.rows.push_back({x_of(task, point.level), share, 0.18 * std::sqrt(point.count.trials)});
  }
  return data;
}

PlotData function_of(const StudyTask& task, const ArmResult& arm, const std::string& name) {
  constexpr int kSteps = 80;
  const psychophysics::QuestPlusGrid grid = grid_of(task);
  PlotData data{name, {}};
  for (int i = 0; i <= kSteps; ++i) {
    const double level =
        grid.levels.front() + (grid.levels.back() - grid.levels.front()) * static_cast<double>(i) / kSteps;
    data.rows.push_back({x_of(task, level), grid.function(level, arm.fit->function)});
  }
  return data;
}

std::string legend_of(const StudyAnalysis& analysis, std::size_t task, int height) {
  std::string text;
  double x = 0.03;
  const study::TaskResult& of = analysis.tasks[task];
  for (std::size_t arm = 0; arm < of.arms.size(); ++arm) {
    const std::string name = arm_text(of, arm);
    text += fmt::format("set label {} {} at screen {},{} textcolor rgb '{}' font ',14'\n", arm + 1,
                        quoted("● " + name), x, 1.0 - 18.0 / height, colour_of(arm, of.arms.size()));
    x += 0.045 + 0.0105 * static_cast<double>(name.size());
  }
  return text;
}

std::string y_label(const StudyTask& task) {
  return task.comparison() ? "share of answers \"comparison is stiffer\"" : "share of correct answers";
}

// Effects that a figure shows.
std::vector<const Contrast*> shown_effects(const StudyAnalysis& analysis, bool ratios) {
  std::vector<const Contrast*> shown;
  for (const Contrast& contrast : analysis.contrasts) {
    if (contrast.kept && study::is_ratio(contrast.measure) == ratios) shown.push_back(&contrast);
  }
  return shown;
}

std::string effect_name(const Study& study, const StudyAnalysis& analysis, const Contrast& contrast) {
  return fmt::format("{}, {}: {}", study.tasks[contrast.task].name, study::measure_name(contrast.measure),
                     contrast_name(analysis, contrast));
}

}  // namespace

std::string arm_text(const study::TaskResult& task, std::size_t arm) {
  return task.arms[arm].empty() ? "all trials" : task.arms[arm];
}

Figure draw_effects(const Study& study, const StudyAnalysis& analysis, bool ratios,
                    const std::filesystem::path& file) {
  const std::vector<const Contrast*> shown = shown_effects(analysis, ratios);
  Figure figure{file, "effects with 95 % intervals"};
  figure.caption = ratios
                       ? "Ratio of the measure in the first condition to that in the second, with its 95 % "
                         "interval. Left of 1 the first one is smaller: better."
                       : "Difference of d' with its 95 % interval.";
  if (ratios && analysis.unblinded) figure.caption += " Blue: the primary analysis.";
  PlotData primary{"primary", {}};
  PlotData others{"others", {}};
  std::string names;
  std::size_t longest = 0;
  double least = ratios ? 0.8 : -0.2;
  double largest = ratios ? 1.25 : 0.2;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const study::Effect& effect = *shown[i]->kept;
    const auto value = [&](double x) { return ratios ? std::exp(x) : x; };
    const double y = -static_cast<double>(i);
    (shown[i]->primary ? primary : others)
        .rows.push_back({value(effect.effect), y, value(effect.low), value(effect.high)});
    least = std::min(least, value(effect.low));
    largest = std::max(largest, value(effect.high));
    const std::string name = effect_name(study, analysis, *shown[i]);
    longest = std::max(longest, name.size());
    names += fmt::format("{}{} {}", names.empty() ? "" : ", ", quoted(name), y);
  }
  std::string script = preamble(kWidth, 90 + 26 * static_cast<int>(shown.size()), "off");
  script += fmt::format("set lmargin {}\nset ytics ({})\nset yrange [{}:0.7]\nset xrange [{}:{}]\n",
                        0.92 * static_cast<double>(longest), names, 0.3 - static_cast<double>(shown.size()),
                        ratios ? least / 1.05 : least - 0.05, ratios ? largest * 1.05 : largest + 0.05);
  script += ratios ? "set logscale x\nset xtics (0.25, 0.5, 0.6, 0.7, 0.8, 0.9, 1, 1.1, 1.25, 1.5, 2, 4)\n"
                     "set xlabel 'ratio'\n"
                   : "set xlabel \"difference of d'\"\n";
  const double none = ratios ? 1.0 : 0.0;
  script += fmt::format("set arrow from {0}, graph 0 to {0}, graph 1 nohead lc rgb '#555555' lw 1\n", none);
  std::vector<std::string> curves;
  const auto add = [&](const PlotData& data, const char* colour, double width) {
    if (data.rows.empty()) return;
    curves.push_back(fmt::format("'{}' using 1:2:3:4 with xerrorbars pt 7 ps 0.9 lw {} lc rgb '{}'",
                                 data.name, width, colour));
  };
  add(others, "#555555", 1.6);
  add(primary, kBlue, 2.6);
  return drawn(std::move(figure), script + plot(curves), {primary, others});
}

Figure draw_curve(const Study& study, const StudyAnalysis& analysis, const study::Curve& curve,
                  const std::filesystem::path& file) {
  Figure figure{file, "sensitivity against the noise in " + study.tasks[curve.task].name};
  figure.caption =
      "Sensitivity d' of two intervals, log-linear. Thin lines: people; points: mean with its 95 % interval.";
  const study::TaskResult& of = analysis.tasks[curve.task];
  const auto x = [&](std::size_t arm) {
    return analysis.unblinded ? of.shares[arm] : static_cast<double>(arm);
  };
  std::vector<PlotData> data;
  std::vector<std::string> curves;
  for (std::size_t person = 0; person < curve.d_primes.size(); ++person) {
    PlotData one{"p" + std::to_string(person), {}};
    for (std::size_t arm = 0; arm < of.arms.size(); ++arm) {
      one.rows.push_back({x(arm), curve.d_primes[person][arm]});
    }
    sort_by_x(one.rows);
    curves.push_back(fmt::format("'{}' with lines lw 1 lc rgb '#cccccc'", one.name));
    data.push_back(std::move(one));
  }
  PlotData means{"means", {}};
  for (std::size_t arm = 0; arm < of.arms.size(); ++arm) {
    means.rows.push_back({x(arm), curve.levels[arm].mean, curve.levels[arm].low, curve.levels[arm].high});
  }
  sort_by_x(means.rows);
  // While blind the labels have no order, so no line joins them.
  const char* style = analysis.unblinded ? "yerrorlines" : "yerrorbars";
  curves.push_back(fmt::format("'means' using 1:2:3:4 with {} pt 7 ps 1 lw 2.4 lc rgb '{}'", style, kBlue));
  data.push_back(means);
  std::string script = preamble(kWidth, 380, "off") + "set ylabel \"d'\"\n";
  if (analysis.unblinded) {
    const double largest = *std::max_element(of.shares.begin(), of.shares.end());
    script += fmt::format(
        "set xlabel 'noise as a share of the own noise threshold'\nset xrange [{}:{}]\nset xtics {}\n",
        -0.05 * largest, 1.05 * largest, 0.5 * tic_step(largest));
  } else {
    std::string tics;
    for (std::size_t arm = 0; arm < of.arms.size(); ++arm) {
      tics += fmt::format("{}{} {}", arm == 0 ? "" : ", ", quoted(of.arms[arm]), arm);
    }
    script += "set xlabel 'condition, blind'\nset xtics (" + tics + ")\n" +
              fmt::format("set xrange [-0.5:{}]\n", static_cast<double>(of.arms.size()) - 0.5);
  }
  return drawn(std::move(figure), script + plot(curves), data);
}

Figure draw_people(const Study& study, const StudyAnalysis& analysis, std::size_t task,
                   const std::filesystem::path& file) {
  const StudyTask& of = study.tasks[task];
  std::vector<const PersonResult*> people;
  for (const PersonResult& person : analysis.people) {
    if (!person.withdrawn) people.push_back(&person);
  }
  const Panels panels{people.size()};
  Figure figure{file, "answers and fitted functions of each person in " + of.name};
  figure.caption = fmt::format(
      "x: {}; y: {}. Points: answers at a level, larger with more trials. Lines: the posterior mean of the "
      "function; none where the range of stimuli was too small.",
      describe(of.kind).axis, y_label(of));
  std::string script = preamble(kWidth, panels.height(), "off") + axes_of(of) +
                       "set tics font ',11'\nset xtics offset 0,0.5\nset ytics offset 0.5,0\nset title font "
                       "',13' offset 0,-0.6\nset multiplot\n" +
                       "set lmargin 4.6\nset rmargin 0.8\nset tmargin 1.6\nset bmargin 1.8\n" +
                       legend_of(analysis, task, panels.height());
  std::vector<PlotData> data;
  for (std::size_t i = 0; i < people.size(); ++i) {
    const auto row = static_cast<double>(i / Panels::kColumns);
    const double height = static_cast<double>(Panels::kHeight) / panels.height();
    const double top = 1.0 - static_cast<double>(Panels::kLegend) / panels.height() - row * height;
    script += fmt::format("set origin {},{}\nset size {},{}\nset title {}\n",
                          static_cast<double>(i % Panels::kColumns) / Panels::kColumns, top - height,
                          1.0 / Panels::kColumns, height, quoted(people[i]->id));
    std::vector<std::string> curves;
    for (std::size_t arm = 0; arm < people[i]->tasks[task].arms.size(); ++arm) {
      const ArmResult& result = people[i]->tasks[task].arms[arm];
      if (result.points.empty()) continue;
      const std::string name = fmt::format("{}-{}", i, arm);
      data.push_back(points_of(of, result, "points-" + name));
      curves.push_back(fmt::format("'points-{}' using 1:2:3 with points pt 7 ps variable lc rgb '{}'", name,
                                   colour_of(arm, of.arms.size())));
      if (!is_number(result.fit)) continue;
      data.push_back(function_of(of, result, "line-" + name));
      curves.push_back(
          fmt::format("'line-{}' with lines lw 1.8 lc rgb '{}'", name, colour_of(arm, of.arms.size())));
    }
    script += plot(curves);
    if (i == 0) script += "unset label\n";
  }
  return drawn(std::move(figure), script + "unset multiplot\n", data);
}

Figure draw_calibration(const study::Calibration& calibration, const std::filesystem::path& file) {
  PlotData data{"responses.dat", {}};
  for (const study::Response& one : calibration.responses) {
    data.rows.push_back({one.frequency, one.magnitude, one.coherence});
  }
  const study::Band& band = calibration.band;
  const std::string shaded = fmt::format(
      "set object 1 rectangle from {},graph 0 to {},graph 1 fs solid noborder fc rgb '#eef4fa' behind\n",
      band.low, band.high);
  const auto curve = [](int column, const char* colour) {
    return fmt::format("plot 'responses.dat' using 1:{} with lines lw 2 lc rgb '{}' notitle\n", column,
                       colour);
  };
  const std::string script = two_panes(
      420, "off", 0.42,
      shaded + "set logscale x\nset logscale y\nset ylabel '" + calibration.unit + " per N'\n" +
          curve(2, kBlue),
      "unset logscale y\nset yrange [0:1.05]\nset ytics 0.5\nset ylabel 'coherence'\nset xlabel 'frequency "
      "(Hz)'\n" +
          curve(3, kOrange));
  Figure figure{file, "What the grip gets for 1 N, over the frequency, and the coherence"};
  figure.caption = fmt::format(
      "What the sensor measured for a commanded force of 1 N (above), and the share of it that follows the "
      "command (below). Shaded: the band of the gain, {} to {} Hz.",
      shortest(band.low), shortest(band.high));
  return drawn(figure, script, {data});
}

}  // namespace palpate::report
