#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/core.h>

#include "core/base/normal_distribution.h"
#include "core/base/text.h"
#include "io/scene/make_world.h"
#include "palpate/mesh.h"
#include "view/report/page.h"
#include "view/report/sections.h"

namespace palpate::report {
namespace {

constexpr std::size_t kMaxPoints = 2500;  // per line, to keep the page small
constexpr std::size_t kMaxMarkers = 300;  // per scatter plot, so that the curve beneath stays visible
constexpr std::size_t kLongestSegment = 1024;
constexpr std::size_t kShortestSegment = 64;

constexpr const char* kKey = "top right Left reverse samplen 2 spacing 1.15 noopaque";

std::string rgb(const std::string& colour) { return "rgb '" + colour + "'"; }

std::size_t stride_for(std::size_t count, std::size_t most) {
  return std::max<std::size_t>(1, (count + most - 1) / most);
}

std::string vertical(double at, const std::string& label, const std::string& label_at) {
  const std::string x = shortest(at);
  std::string text =
      fmt::format("set arrow from {},graph 0 to {},graph 1 nohead dt 2 lw 1 lc rgb '#777777' back\n", x, x);
  if (!label.empty()) {
    text +=
        fmt::format("set label '{}' at {},graph {} offset 0.4,0 font ',12' textcolor rgb '#555555' front\n",
                    label, x, label_at);
  }
  return text;
}

double device_force(const haptics::TickRow& row) {
  return std::hypot(row.force[0], row.force[1], row.force[2]);
}

/// Outline of a histogram: x, fraction of all values in a bin.
PlotData steps(const Bins& bins, double scale, const std::string& name) {
  PlotData data{name, {}};
  for (std::size_t i = 0; i < bins.counts.size(); ++i) {
    data.rows.push_back({bins.edges[i], bins.edges[i + 1], static_cast<double>(bins.counts[i]) * scale});
  }
  return data;
}

/// Displacement of the organ from its rest pose, for a plot.
struct OrganMotionPlot {
  PlotData data{"organ.dat", {}};  // s; x, y, z of its centre [mm]; rotation [degrees]
  std::vector<std::size_t> lines;  // columns of `data` that vary, counted from 1
  double turned = 0.0;             // largest rotation [degrees]
  bool turns = false;
};

constexpr std::size_t kTurnColumn = 4;

OrganMotionPlot organ_motion_plot(const HandAnalysis& hand, const scene::Scene& scene, std::size_t stride) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  constexpr std::array<double, 5> kNothing = {0.0, 1e-3, 1e-3, 1e-3, 1e-2};  // mm, degrees: below this a
                                                                             // column is constant
  OrganMotionPlot way;
  const model::OrganMotion motion = scene::organ_motion_of(scene);
  if (!motion.moves()) return way;
  const Vec3 middle_S = geometry::bounds(scene.organ).middle();
  std::array<double, 5> most{};
  for (std::size_t i = 0; i < hand.rows.size(); i += stride) {
    const Pose pose = motion.pose_at(scene.organ_pose, hand.rows[i].tick, scene.rate_Hz);
    const Vec3 moved = (pose * middle_S - scene.organ_pose * middle_S) * kMilli;
    const double turned = pose.rotation.angularDistance(scene.organ_pose.rotation) * kDegrees;
    const std::array<double, 5> row = {hand.rows[i].time, moved.x(), moved.y(), moved.z(), turned};
    for (std::size_t c = 0; c < row.size(); ++c) most[c] = std::max(most[c], std::abs(row[c]));
    way.data.rows.emplace_back(row.begin(), row.end());
  }
  for (std::size_t c = 1; c < most.size(); ++c) {
    if (most[c] > kNothing[c]) way.lines.push_back(c);
  }
  way.turned = most[kTurnColumn];
  way.turns = most[kTurnColumn] > kNothing[kTurnColumn];
  return way;
}

std::string panel(const std::string& bottom, const std::string& top) {
  return fmt::format("set bmargin at screen {}\nset tmargin at screen {}\n", bottom, top);
}

/// Draws the organ's motion; resets the gnuplot settings that it changes.
std::string organ_panel(const OrganMotionPlot& way) {
  static constexpr std::array<const char*, 5> kTitles = {"", "x", "y", "z", "turned (°, right)"};
  static constexpr std::array<const char*, 5> kColours = {"", kOrange, kBlue, kGreen, kGrey};
  // Leaves room above the lines for their names.
  std::string script =
      "set ylabel 'organ (mm)' offset 1\nset yrange [*:*]\nset offsets 0,0,graph 0.25,0\n"
      "set key top right horizontal\n";
  if (way.turns) script += "set y2tics\nset y2range [0:" + shortest(1.35 * way.turned) + "]\n";
  std::vector<std::string> lines;
  for (const std::size_t c : way.lines) {
    lines.push_back(fmt::format("'organ.dat' using 1:{}{} with lines lw 2 lc {} title '{}'", c + 1,
                                c == kTurnColumn ? " axes x1y2" : "", rgb(kColours[c]), kTitles[c]));
  }
  script += plot(lines) + "unset offsets\nset key vertical\n";
  if (way.turns) script += "unset y2tics\n";
  return script;
}

}  // namespace

Figure draw_over_time(const HandAnalysis& hand, const scene::Scene& scene,
                      const std::filesystem::path& file) {
  PlotData data{"rows.dat", {}};
  const std::size_t stride = stride_for(hand.rows.size(), kMaxPoints);
  for (std::size_t i = 0; i < hand.rows.size(); i += stride) {
    const haptics::TickRow& row = hand.rows[i];
    data.rows.push_back({row.time, row.depth * kMilli, row.tissue_force, device_force(row)});
  }
  const OrganMotionPlot way = organ_motion_plot(hand, scene, stride);
  const bool moving = !way.lines.empty();
  const double end = std::max(hand.rows.back().time, 1e-3);
  std::string script = preamble(680, moving ? 640 : 460, kKey);
  script +=
      fmt::format("set multiplot\nset lmargin at screen 0.12\nset rmargin at screen {}\nset xrange [0:{}]\n",
                  way.turns ? "0.925" : "0.985", shortest(end));
  if (hand.key_ticks.contact) {
    script += vertical(hand.rows[hand.key_ticks.touch].time, "contact", "0.95");
    script += vertical(hand.rows[hand.key_ticks.deepest].time, "deepest", "0.95");
  }
  script += moving ? panel("0.71", "0.98") : panel("0.585", "0.975");
  script += "set format x ''\nset ylabel 'depth (mm)' offset 1\nset yrange [0:1<*]\nset key off\n";
  script += "plot 'rows.dat' using 1:2 with lines lw 2 lc " + rgb(kBlue) + "\nunset label\n";
  if (moving) script += panel("0.40", "0.67") + organ_panel(way);
  script += moving ? panel("0.09", "0.36") : panel("0.125", "0.535");
  script +=
      "set format x '%g'\nset xlabel 'time (s)' offset 0,0.4\nset ylabel 'force (N)' offset 1\n"
      "set yrange [0:0.05<*]\nset offsets 0,0,graph 0.2,0\nset key top right horizontal\n";
  script += fmt::format(
      "plot 'rows.dat' using 1:4 with lines lw 1 lc {} title 'to the hand, with noise', '' using 1:3 with "
      "lines lw 2 lc {} title 'tissue'\n"
      "unset multiplot\n",
      rgb(kGrey), rgb(kOrange));
  Figure figure{file, moving ? "Depth, motion of the organ and force over time in seconds"
                             : "Depth in millimetres and force in newtons over time in seconds"};
  figure.caption =
      moving ? "Depth of the contact with the largest force (above), displacement of the organ's centre "
               "(middle) and force (below) over time. Dashed: first contact and deepest tick."
             : "Depth of the contact with the largest force (above) and force (below) over time. Dashed: "
               "first contact and deepest tick.";
  return drawn(figure, script, {data, way.data});
}

bool went_in(const HandAnalysis& hand) {
  return std::any_of(hand.rows.begin(), hand.rows.end(),
                     [](const haptics::TickRow& row) { return row.inserted_mm > 0.0; });
}

Figure draw_needle(const HandAnalysis& hand, const scene::Scene& scene, const std::filesystem::path& file) {
  PlotData in{"in.dat", {}};
  PlotData out{"out.dat", {}};
  PlotData tip{"tip.dat", {}};
  std::string punctures;
  const std::size_t stride = stride_for(hand.rows.size(), kMaxPoints);
  bool turned = false;  // once the shaft has slipped outwards
  std::size_t marks = 0;
  for (std::size_t i = 0; i < hand.rows.size(); ++i) {
    const haptics::TickRow& row = hand.rows[i];
    const auto phase = static_cast<contact::Phase>(row.phase);
    if (phase != contact::Phase::kPress && phase != contact::Phase::kInsert) continue;
    const double way = -row.distance * kMilli;
    turned = turned || row.slip < 0;
    if ((row.events & haptics::kPuncture) != 0 && row.layer > 0 && row.layer <= scene.tissue.layers.size()) {
      punctures += vertical(way, one_line(scene.tissue.layers[row.layer - 1].name),
                            shortest(0.95 - 0.06 * static_cast<double>(marks++ % 4)));
    }
    if (i % stride != 0) continue;
    const double along =
        row.force[0] * row.normal[0] + row.force[1] * row.normal[1] + row.force[2] * row.normal[2];
    (turned ? out : in).rows.push_back({way, along - row.noise_force});
    if (!turned && phase == contact::Phase::kInsert) tip.rows.push_back({way, row.tip_force});
  }
  std::string script = preamble(540, 440, kKey);
  script +=
      "set key outside top center horizontal\nset xlabel 'way of the tip from the entry (mm)' offset 0,0.4\n"
      "set ylabel 'force along the needle (N)' offset 1\nset xzeroaxis lt 1 lw 1 lc rgb '#777777'\n" +
      punctures;
  std::vector<std::string> curves;
  const auto line = [&curves](const PlotData& data, const char* colour, const char* title) {
    if (data.rows.empty()) return;
    curves.push_back("'" + data.name + "' using 1:2 with lines lw 2 lc " + rgb(colour) + " title '" + title +
                     "'");
  };
  line(tip, kGrey, "on the tip");
  line(in, kBlue, "going in");
  line(out, kOrange, "coming out");
  script += plot(curves);
  Figure figure{file, "Force along the needle over the way of its tip"};
  figure.caption =
      "Force of the tissue on the hand along the needle, against the insertion; below zero the tissue holds "
      "the needle back. Dashed: punctures, with the layer that the tip enters. The distance between the "
      "lines is friction on the shaft.";
  return drawn(figure, script, {in, out, tip});
}

Figure draw_law(const HandAnalysis& hand, const record::Recording& recording, model::Direction direction,
                const std::filesystem::path& file) {
  const scene::Scene& scene = recording.scene;
  const model::SpringLaw law = law_of(scene, direction, hand.hand);
  PlotData in{"in.dat", {}};
  PlotData out{"out.dat", {}};
  double deepest = 1e-3;
  const std::size_t stride = stride_for(hand.rows.size(), kMaxMarkers);
  for (std::size_t i = 0; i < hand.rows.size(); i += stride) {
    const haptics::TickRow& row = hand.rows[i];
    if (!in_contact(row, direction)) continue;
    deepest = std::max(deepest, row.depth);
    (i <= hand.key_ticks.deepest ? in : out).rows.push_back({row.depth * kMilli, normal_force(row)});
  }
  PlotData curve{"law.dat", {}};
  constexpr int kCurvePoints = 400;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double depth = 1.08 * deepest * i / kCurvePoints;
    curve.rows.push_back({depth * kMilli, law.force_at(depth).force});
  }
  std::string script = preamble(540, 440, kKey);
  script +=
      "set key top left\nset xlabel 'depth (mm)' offset 0,0.4\nset ylabel 'force (N)' offset 1\n"
      "set xrange [0:" +
      shortest(1.08 * deepest * kMilli) + "]\nset yrange [0:*]\n";
  std::vector<std::string> curves = {
      fmt::format("'law.dat' using 1:2 with lines lw 7 lc rgb '#cfcfcf' title 'law of the model{}'",
                  scene.tissue.relaxation.empty() ? "" : ", before it relaxes")};
  if (!in.rows.empty())
    curves.push_back("'in.dat' using 1:2 with points pt 7 ps 0.45 lc " + rgb(kBlue) + " title 'going in'");
  if (!out.rows.empty())
    curves.push_back("'out.dat' using 1:2 with points pt 6 ps 0.6 lc " + rgb(kOrange) +
                     " title 'coming out'");
  script += plot(curves);
  Figure figure{file, "Measured force over depth beside the law of the model"};
  figure.caption = fmt::format(
      "Force along the contact normal over depth, one tick in {}, on the law of one contact. Several "
      "contacts on one organ share the tissue and lie above that line; damping and the fades at the start "
      "and at letting go part from it for a moment.{}{}{}",
      stride,
      scene.tissue.relaxation.empty()
          ? ""
          : " This tissue relaxes: the longer it is held, the farther its force lies below the line.",
      scene.inclusions.empty() && scene.stiffness.empty()
          ? ""
          : " The line is that of the uniform tissue; the inclusions and the stiffness map make the "
            "difference.",
      recording.changes.empty() ? "" : " The line is the law at the start; it was changed while it ran.");
  return drawn(figure, script, {curve, in, out});
}

Figure draw_noise_spectrum(const HandAnalysis& hand, const scene::Scene& scene,
                           const std::filesystem::path& file) {
  Figure figure{file, "Power spectral density of the touch noise over frequency"};
  const bool contact = hand.contact_noise.size() >= 4 * kShortestSegment;
  const std::vector<double>& samples = contact ? hand.contact_noise : hand.unit_noise;
  std::size_t segment = kLongestSegment;
  while (segment > kShortestSegment && samples.size() < 8 * segment) segment /= 2;
  const double rate = scene.noise.rate_Hz;
  const Spectrum spectrum = welch(samples, rate, segment);
  if (spectrum.density.empty()) {
    figure.missing = scene.noise.enabled ? "The run is too short for a spectrum." : "The noise was off.";
    return figure;
  }
  const double scale = contact ? kMilli * kMilli : 1.0;
  const double sigma = contact ? hand.contact_sigma : 1.0;
  const double flat = 2.0 * sigma * sigma / rate * scale;
  // 95 % band. For half-overlapping Hann segments the variance of the mean is about (1 + 2/36) / segments of
  // that of one segment.
  const double spread = 1.96 * std::sqrt(1.0556 / static_cast<double>(spectrum.segments));
  PlotData data{"spectrum.dat", {}};
  for (std::size_t i = 1; i + 1 < spectrum.density.size(); ++i) {
    data.rows.push_back({spectrum.frequency[i], spectrum.density[i] * scale});
  }
  const PlotData band{"band.dat",
                      {{0.0, flat, flat * std::max(0.0, 1.0 - spread), flat * (1.0 + spread)},
                       {rate / 2.0, flat, flat * std::max(0.0, 1.0 - spread), flat * (1.0 + spread)}}};
  std::string script = preamble(540, 380, kKey);
  script += fmt::format(
      "set xlabel 'frequency (Hz)' offset 0,0.4\n"
      "set ylabel 'power density ({})' offset 1\n"
      "set xrange [0:{}]\n"
      "set yrange [0:{}]\n",
      contact ? "mN²/Hz" : "σ²/Hz", shortest(rate / 2.0), shortest(flat * std::max(2.6, 1.0 + 2.2 * spread)));
  script += fmt::format(
      "plot 'band.dat' using 1:3:4 with filledcurves lc rgb '#e6e6e6' title '95 % band of white noise', "
      "'spectrum.dat' using 1:2 with lines lw 1.2 lc {} title 'measured', 'band.dat' using 1:2 with lines lw "
      "1.5 lc {} title 'white, at the set level'\n",
      rgb(kBlue), rgb(kOrange));
  figure.caption = fmt::format("{}, Welch's estimate, {} segments of {} samples at {} Hz.",
                               contact ? "Spectrum of the noise force while in contact"
                                       : "Spectrum of the noise force in units of its standard deviation",
                               spectrum.segments, segment, fixed(rate, 0));
  return drawn(figure, script, {band, data});
}

Figure draw_noise_histogram(const HandAnalysis& hand, const std::filesystem::path& file) {
  Figure figure{file, "Histogram of the touch noise with the normal curve"};
  if (hand.unit_noise.empty()) {
    figure.missing = "The noise was off.";
    return figure;
  }
  constexpr double kRange = 5.0;  // in standard deviations
  constexpr int kBins = 50;
  const Bins bins = bin_linear(hand.unit_noise, -kRange, kRange, kBins);
  const double scale = kBins / (2.0 * kRange * static_cast<double>(hand.unit_noise.size()));
  PlotData curve{"normal.dat", {}};
  for (int i = -100; i <= 100; ++i)
    curve.rows.push_back({kRange * i / 100, normal_density(kRange * i / 100)});
  std::string script = preamble(540, 380, kKey);
  script +=
      "set xlabel 'noise force / σ' offset 0,0.4\nset ylabel 'density' offset 1\nset yrange [0:*]\n"
      "set xrange [-5:5]\nset style fill solid 0.45 noborder\n";
  script += fmt::format(
      "plot 'bins.dat' using (($1+$2)/2):3:(0.94*($2-$1)) with boxes lc {} title 'measured', 'normal.dat' "
      "using 1:2 with lines lw 2 lc {} title 'standard normal'\n",
      rgb(kBlue), rgb(kOrange));
  figure.caption =
      "Histogram of " + grouped(hand.unit_noise.size()) +
      " noise samples, each divided by the standard deviation that belongs to its distance: K/(d "
      "+ d₀) in approach, K/d₀ in contact.";
  return drawn(figure, script, {steps(bins, scale, "bins.dat"), curve});
}

Figure draw_tick_histogram(const Analysis& analysis, double rate_Hz, TickQuantity quantity,
                           const std::filesystem::path& file) {
  const bool computing = quantity == TickQuantity::kComputing;
  Figure figure{
      file, computing ? "Histogram of the computing time of a tick" : "Histogram of how late a tick began"};
  const TimeAnalysis& time = computing ? analysis.tick_time : analysis.lateness;
  std::vector<double> values;
  std::vector<std::uint64_t> counts;
  for (const haptics::Histogram::Bucket& bucket : time.counts) {
    values.push_back(static_cast<double>(bucket.upper) * 1e-3);
    counts.push_back(bucket.count);
  }
  const Bins bins = bin_logarithmic(values, 20, counts);
  if (bins.counts.empty()) {
    figure.missing = computing ? "The recording holds no tick times."
                               : "The run was offline: no tick has a due time, so none is late.";
    return figure;
  }
  const auto most = static_cast<double>(*std::max_element(bins.counts.begin(), bins.counts.end()));
  const Percentiles& marks = time.figures;
  std::string script = preamble(540, 380, kKey);
  script += fmt::format(
      "set logscale x\n"
      "set logscale y\n"
      "set yrange [0.5:{}]\n"
      "set key off\n"
      "set xlabel '{}' offset 0,0.4\n"
      "set ylabel 'ticks' offset 1\n"
      "set style fill solid 0.55 noborder\n",
      shortest(4.0 * most),
      std::string(computing ? "computing time of a tick (µs)" : "lateness of a tick (µs)"));
  const double period_us = 1e6 / rate_Hz;
  script += fmt::format("set xrange [{}:{}]\n", shortest(bins.edges.front()),
                        shortest(std::max(bins.edges.back(), 1.3 * period_us)));
  const auto mark = [&script](std::int64_t ns, const char* label, const char* height) {
    if (ns > 0) script += vertical(static_cast<double>(ns) * 1e-3, label, height);
  };
  mark(marks.p50, "p50", "0.97");
  mark(marks.p99, "p99", "0.91");
  mark(marks.p999, "p99.9", "0.85");
  mark(marks.max, "max", "0.79");
  script += fmt::format(
      "set arrow from {},graph 0 to {},graph 1 nohead lw 1.5 lc {} back\n"
      "set label 'period' at {},graph 0.5 rotate by 90 center offset -0.8,0 font ',12' textcolor {} front\n",
      shortest(period_us), shortest(period_us), rgb(kOrange), shortest(period_us), rgb(kOrange));
  PlotData data{"bins.dat", {}};
  for (const std::vector<double>& row : steps(bins, 1.0, "bins.dat").rows) {
    if (row[2] > 0.0) data.rows.push_back({row[0], row[1], row[2]});
  }
  script += "plot 'bins.dat' using (sqrt($1*$2)):3:1:2:(0.5):3 with boxxyerror lc " + rgb(kGreen) + "\n";
  figure.caption = std::string(computing ? "Computing time of a tick" : "How late a tick began") +
                   ", both axes logarithmic. Dashed: p50, p99, p99.9 and the largest; solid: the period.";
  return drawn(figure, script, {data});
}

}  // namespace palpate::report
