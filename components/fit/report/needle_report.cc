#include "fit/report/needle_report.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "palpate/units.h"
#include "view/report/gnuplot.h"
#include "view/report/page.h"

namespace palpate::report {
namespace {

/// Columns: time, depth, measured, fitted.
PlotData rows_of(const identify::NeedleRepeat& repeat) {
  PlotData data{"curve.dat", {}};
  const identify::NeedleRecord& record = repeat.record;
  for (std::size_t i = 0; i < record.size(); ++i) {
    data.rows.push_back({record.time[i], record.depth[i] / kMillimetre, record.force[i] - repeat.zero,
                         repeat.fitted[i] - repeat.zero});
  }
  return data;
}

Figure draw_record(const identify::NeedleRepeat& repeat, const std::filesystem::path& file) {
  PlotData data = rows_of(repeat);
  PlotData punctures{"punctures.dat", {}};
  for (const identify::Puncture& one : repeat.punctures)
    punctures.rows.push_back({one.depth / kMillimetre, one.force});
  double largest = 0.0;
  for (const std::vector<double>& row : data.rows) largest = std::max(largest, std::abs(row[3] - row[2]));
  const std::string upper = fmt::format(
      R"(set ylabel 'force, N'
plot 'curve.dat' using 2:3 with points pt 7 ps 0.3 lc rgb '{}' title 'measured', \
  '' using 2:4 with lines lw 2 lc rgb '{}' title 'simulated needle', \
  'punctures.dat' using 1:2 with points pt 9 ps 1.3 lc rgb '#555555' title 'puncture')",
      kOrange, kBlue);
  const std::string lower = fmt::format(
      R"(set nokey; set xlabel 'depth of the tip, mm'; set ylabel 'simulated - measured, N'; set ytics {}
plot 'curve.dat' using 2:($4-$3) with points pt 7 ps 0.3 lc rgb '{}', 0 with lines lw 1 lc rgb '#555555')",
      shortest(tic_step(largest)), kOrange);
  return drawn(
      {file, "Force over depth of " + repeat.name + ", measured and simulated, and the residuals",
       "Force over the depth of the tip during insertion, hold and withdrawal. Below: the residuals."},
      two_panes(680, kKeyLeft, 0.36, upper, lower), {std::move(data), std::move(punctures)});
}

TableRows value_table(const std::vector<identify::NeedleValue>& values) {
  TableRows rows = {{"parameter", "layer", "best", "95 % interval"}};
  for (const identify::NeedleValue& value : values) {
    const auto [best, interval] = shown(value);
    rows.push_back({escaped(value.name), value.layer > 0 ? std::to_string(value.layer) : "", best, interval});
  }
  return rows;
}

TableRows record_table(const identify::NeedleFit& fit) {
  TableRows rows = {{"record", "error", "predicted by the others", "punctures, mm", "puncture forces, N"}};
  for (const identify::NeedleRepeat& repeat : fit.repeats) {
    std::vector<std::string> depths;
    std::vector<std::string> forces;
    for (const identify::Puncture& one : repeat.punctures) {
      depths.push_back(brief(one.depth / kMillimetre, 3));
      forces.push_back(brief(one.tip, 3));
    }
    rows.push_back({escaped(repeat.name), percent(repeat.nrmse),
                    repeat.predicted_nrmse ? percent(*repeat.predicted_nrmse) : "", joined(depths),
                    joined(forces)});
  }
  return rows;
}

}  // namespace

std::filesystem::path write_needle_report(const identify::NeedleFit& fit, const std::string& command,
                                          const std::filesystem::path& folder) {
  make_report_folder(folder);
  Page page(fmt::format("Fit of {}", counted(fit.repeats.size(), "insertion", "insertions")),
            "Layers from measured forces on a needle, by palpate");
  page.section("summary", "What came out");
  page.code(command);
  page.facts({{"layers", std::to_string(fit.layers)},
              {"law", model::to_string(fit.tissue.law)},
              {"error of one tissue for all", percent(fit.nrmse)}});
  page.table(record_table(fit));
  page.paragraph(
      "Errors are root mean squares over each record's range of force. A record's own error is that of a fit "
      "to it alone.");
  page.list(fit.warnings);
  page.section("tissue", "The tissue");
  page.table(value_table(fit.values));
  TableRows evidence = {{"layers", "error", "records that show this number"}};
  for (const identify::LayerEvidence& one : fit.evidence)
    evidence.push_back(
        {std::to_string(one.layers), percent(one.nrmse), fmt::format("{} of {}", one.votes, one.records)});
  page.heading("How many layers");
  page.table(evidence);
  for (std::size_t i = 0; i < fit.repeats.size(); ++i) {
    const std::string number = std::to_string(i + 1);
    page.section("record-" + number, fit.repeats[i].name);
    page.figures("one", {draw_record(fit.repeats[i], folder / ("insertion-" + number + ".svg"))});
  }
  return page.write(folder);
}

}  // namespace palpate::report
