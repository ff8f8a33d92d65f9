#include "view/report/sections.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/model/tissue_fields.h"
#include "palpate/mesh.h"
#include "view/report/analysis.h"
#include "view/report/page.h"

namespace palpate::report {
namespace {

constexpr double kGoalDepth = 10e-3;   // m, of both experiments of the demo
constexpr double kPaperForceNs = 1e6;  // "under 1 ms a force" [Zhang 2011, section 3.2]

std::string microseconds(std::int64_t ns) { return fixed(static_cast<double>(ns) * 1e-3, 1); }

/// Whether the recording has tick times; an offline one has them when it was closed properly.
bool is_timed(const Analysis& analysis) { return analysis.tick_time.figures.max > 0; }

bool is_pull(const ExperimentResults& worked) { return worked.analysis.direction == model::Direction::kPull; }

/// The hand with the largest depth.
const HandAnalysis& main_hand(const ExperimentResults& worked) {
  return *std::max_element(
      worked.analysis.hands.begin(), worked.analysis.hands.end(),
      [](const HandAnalysis& a, const HandAnalysis& b) { return a.peak_depth < b.peak_depth; });
}

std::string anchor(std::size_t number) { return "experiment-" + std::to_string(number); }

enum class Mark { kMet, kMissed, kInformation };

std::string marked(Mark mark, const std::string& html) {
  switch (mark) {
    case Mark::kMet:
      return "<span class=\"mark met\" aria-label=\"met\">✓</span>" + html;
    case Mark::kMissed:
      return "<span class=\"mark missed\" aria-label=\"missed\">✗</span>" + html;
    case Mark::kInformation:
      break;
  }
  return "<span class=\"mark information\" aria-hidden=\"true\">·</span>" + html;
}

Mark mark_of(bool met) { return met ? Mark::kMet : Mark::kMissed; }

std::string noise_mark(const NormalCheck& check) {
  const double count = static_cast<double>(check.count);
  const double mean_bound = 4.0 / std::sqrt(count);
  const double deviation_bound = 4.0 / std::sqrt(2.0 * count);
  const double ks_bound = 1.95 / std::sqrt(count);  // bound of the Kolmogorov-Smirnov statistic that 999 of
                                                    // 1000 normal samples pass
  const bool met = std::abs(check.mean) <= mean_bound &&
                   std::abs(check.standard_deviation - 1.0) <= deviation_bound &&
                   check.ks_distance <= ks_bound;
  return marked(mark_of(met),
                fmt::format("Noise over its set standard deviation, {} samples: mean {} (bound ±{}), "
                            "standard deviation {} (1 ± {}), Kolmogorov-Smirnov distance {} (bound {}).",
                            grouped(check.count), fixed(check.mean, 4), fixed(mean_bound, 4),
                            fixed(check.standard_deviation, 4), fixed(deviation_bound, 4),
                            fixed(check.ks_distance, 4), fixed(ks_bound, 4)));
}

/// The faults of all hands in one paragraph; empty: none.
std::string all_faults(const Analysis& analysis) {
  constexpr std::size_t kMaxListed = 8;
  std::string text;
  std::size_t listed = 0;
  for (const HandAnalysis& hand : analysis.hands) {
    for (const std::string& fault : faults_text(hand.rows)) {
      if (++listed > kMaxListed) continue;
      text += fmt::format("{}{}: {}", text.empty() ? "Hand " : "; hand ", hand.hand, fault);
    }
  }
  if (listed > kMaxListed) text += fmt::format("; and {} more", listed - kMaxListed);
  return text.empty() ? text : escaped(text + ".");
}

/// The results in sentences, each marked as met or not.
std::vector<std::string> marks_of(const ExperimentResults& worked) {
  const Analysis& analysis = worked.analysis;
  const HandAnalysis& hand = main_hand(worked);
  const record::Recording& recording = *worked.experiment->recording;
  std::vector<std::string> marks;
  marks.push_back(marked(mark_of(hand.peak_depth >= kGoalDepth),
                         fmt::format("{} to {} mm; the goal of both experiments is {} mm.",
                                     is_pull(worked) ? "Pulled" : "Pressed",
                                     fixed(hand.peak_depth * kMilli, 2), fixed(kGoalDepth * kMilli, 0))));
  const bool uniform = recording.scene.inclusions.empty() && recording.scene.stiffness.empty();
  if (hand.law.rows > 0) {
    marks.push_back(marked(Mark::kInformation,
                           fmt::format("Normal force beside the law of {}, over {} ticks: half "
                                       "within {} mN, 95\u00a0% within {} mN; the law's largest is {} N.",
                                       uniform ? "one contact" : "the uniform tissue", grouped(hand.law.rows),
                                       fixed(hand.law.median * kMilli, 2), fixed(hand.law.p95 * kMilli, 2),
                                       fixed(hand.law.peak, 3))));
  }
  if (hand.noise_check.count > 1) marks.push_back(noise_mark(hand.noise_check));
  if (is_timed(analysis)) {
    const bool fast = static_cast<double>(analysis.tick_time.figures.p99) < kPaperForceNs;
    marks.push_back(marked(
        mark_of(fast), fmt::format("A tick took {} µs (p50), {} µs (p99); the paper's force took under 1 ms.",
                                   microseconds(analysis.tick_time.figures.p50),
                                   microseconds(analysis.tick_time.figures.p99))));
  }
  if (!recording.facts.offline) {
    marks.push_back(marked(mark_of(analysis.missed == 0),
                           fmt::format("Missed deadlines: {} of {} ticks began a full period or more late.",
                                       grouped(analysis.missed), grouped(analysis.ticks))));
  }
  const std::string faults = all_faults(analysis);
  marks.push_back(marked(mark_of(faults.empty()), faults.empty() ? "No fault was latched." : faults));
  if (recording.facts.watchdog_stops > 0) {
    marks.push_back(
        marked(Mark::kMissed, "The watchdog stopped the devices, as no tick began for too long: " +
                                  grouped(recording.facts.watchdog_stops) + " times."));
  }
  return marks;
}

void write_pictures(Page& page, const PictureSet& pictures) {
  page.heading("Organ and tool");
  if (!pictures.missing.empty()) {
    page.paragraph("There are no pictures of organ and tool: " + escaped(pictures.missing));
    return;
  }
  page.figures("two", pictures.close_ups);
  page.figures("four", pictures.overviews);
  page.paragraph(
      escaped(fmt::format("Drawn by {}, {} × {} pixels, all from the same two places. A picture of the "
                          "moving contact, 1280 × 720 "
                          "pixels in balanced quality as in the window, takes {} ms (p50), {} ms (p99), "
                          "deformation included; the "
                          "paper: 32 ms. "
                          "Contacts of this tool at its deepest tick: {}.",
                          pictures.driver, pictures.width, pictures.height, fixed(pictures.moving_p50_ms, 1),
                          fixed(pictures.moving_p99_ms, 1), pictures.contacts_at_depth)));
}

void write_hand(Page& page, const HandAnalysis& hand, const HandFigures& figures, std::size_t hands) {
  const std::string suffix = hands > 1 ? ", hand " + std::to_string(hand.hand + 1) : "";
  page.heading("Force and depth over time" + suffix);
  page.figures("one", {figures.over_time});
  page.facts({{"largest depth", fixed(hand.peak_depth * kMilli, 3) + " mm"},
              {"largest tissue force", fixed(hand.peak_tissue_force, 4) + " N"},
              {"largest force to the hand", fixed(hand.peak_device_force, 4) + " N, with noise"},
              {"largest step of force", fixed(hand.largest_step, 4) + " N between two ticks, with noise"}});
  page.heading("Force over depth, on the law" + suffix);
  page.figures("one", {figures.law});
  page.heading("Touch noise" + suffix);
  page.figures("two", {figures.noise_spectrum, figures.noise_histogram});
}

void write_timing(Page& page, const ExperimentResults& worked) {
  const Analysis& analysis = worked.analysis;
  const bool offline = worked.experiment->recording->facts.offline;
  page.heading("Timing");
  page.figures("two", {worked.tick_time, worked.lateness});
  const auto row = [](const std::string& name, const Percentiles& p) {
    return std::vector<std::string>{name, microseconds(p.p50), microseconds(p.p99), microseconds(p.p999),
                                    microseconds(p.max)};
  };
  TableRows rows{{"µs", "p50", "p99", "p99.9", "max"}};
  if (is_timed(analysis)) rows.push_back(row("computing time of a tick", analysis.tick_time.figures));
  if (!offline) rows.push_back(row("lateness of a tick", analysis.lateness.figures));
  if (rows.size() > 1) page.table(rows);
  if (offline) {
    page.paragraph("The run was offline: there are no deadlines to miss.");
    return;
  }
  page.paragraph(
      fmt::format("Missed deadlines (a full period or more late): <strong>{}</strong> of {} ticks. Longest "
                  "gap between two ticks: {} µs.",
                  grouped(analysis.missed), grouped(analysis.ticks),
                  microseconds(worked.experiment->recording->facts.longest_gap_ns)));
}

std::string mesh_count(const geometry::TriangleMesh& mesh) {
  return grouped(mesh.vertices.size()) + " vertices, " + grouped(mesh.triangles.size()) + " triangles";
}

std::string tool_count(const std::vector<geometry::Tool>& tools) {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  for (const geometry::Tool& tool : tools) {
    for (const geometry::ToolPart& part : tool.parts) {
      vertices += part.mesh.vertices.size();
      triangles += part.mesh.triangles.size();
    }
  }
  return fmt::format("{} vertices, {} triangles", grouped(vertices), grouped(triangles));
}

/// Results of the paper beside these, for one experiment. [Zhang 2011, section 3]
TableRows comparison(const ExperimentResults& worked) {
  const bool pull = is_pull(worked);
  const scene::Scene& scene = worked.experiment->recording->scene;
  const Percentiles& tick = worked.analysis.tick_time.figures;
  constexpr double kNewtonPerCentimetre = 1e-2;  // in 1 N/m
  return {
      {"", pull ? "paper: heart pulled, straight clamp" : "paper: gallbladder pressed, curved clamp",
       "ours: " + escaped(scene.organ_name)},
      {"organ", pull ? "3,000 vertices, 6,412 triangles" : "1,057 vertices, 2,110 triangles",
       mesh_count(scene.organ)},
      {"instrument", pull ? "612 vertices, 1,207 triangles" : "461 vertices, 921 triangles",
       tool_count(scene.tools)},
      {"k₁", pull ? "0.15 N/cm" : "0.18 N/cm", fixed(scene.tissue.k1 * kNewtonPerCentimetre, 4) + " N/cm"},
      {"β", pull ? "2.0" : "1.6", fixed(scene.tissue.beta, 3)},
      {"one force", pull ? "not given" : "under 1 ms",
       is_timed(worked.analysis)
           ? fmt::format("{} µs p50, {} µs p99, {} µs max (whole tick: contact, force, noise, gate)",
                         microseconds(tick.p50), microseconds(tick.p99), microseconds(tick.max))
           : "not recorded: the run was offline"},
      {"one picture", pull ? "not given" : "32 ms",
       worked.pictures.missing.empty()
           ? fmt::format("{} ms p50, {} ms p99 (in motion, balanced; {})",
                         fixed(worked.pictures.moving_p50_ms, 1), fixed(worked.pictures.moving_p99_ms, 1),
                         escaped(worked.pictures.driver))
           : "not drawn"},
      {"largest depth", "not given", fixed(main_hand(worked).peak_depth * kMilli, 2) + " mm"},
      {"largest tissue force", "not given", fixed(main_hand(worked).peak_tissue_force, 3) + " N"},
  };
}

using Facts = std::vector<std::pair<std::string, std::string>>;

/// A number and its unit, without rounding errors of the conversion from SI.
std::string mesh_text(const geometry::TriangleMesh& mesh) {
  const Vec3 size = geometry::bounds(mesh).size() * kMilli;
  return fmt::format("{} vertices, {} triangles, {} × {} × {} mm", grouped(mesh.vertices.size()),
                     grouped(mesh.triangles.size()), fixed(size.x(), 1), fixed(size.y(), 1),
                     fixed(size.z(), 1));
}

/// Example: "breathing, 8 mm along 0, 0, 1, every 4 s".
std::string motion_text(const std::vector<model::OrganMotionParameters>& motions) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const auto vector = [](const Vec3& v) {
    return fmt::format("{}, {}, {}", fixed(v.x(), 2), fixed(v.y(), 2), fixed(v.z(), 2));
  };
  std::string text;
  for (const model::OrganMotionParameters& motion : motions) {
    text += (text.empty() ? "" : "; ") + std::string(model::to_string(motion.kind));
    if (motion.amplitude > 0.0) {
      text += fmt::format(", {} along ({})", millimetres(motion.amplitude), vector(motion.direction_W));
    }
    if (motion.rotation != 0.0) {
      text += fmt::format(", {}° about ({})", fixed(motion.rotation * kDegrees, 1), vector(motion.axis_W));
    }
    text += ", every " + fixed(motion.period, 3) + " s";
    if (motion.phase > 0.0) text += ", phase " + fixed(motion.phase, 3);
  }
  return text;
}

Facts scene_facts(const scene::Scene& scene, const Analysis& analysis) {
  Facts facts{
      {"scene", scene.name},
      {"task", scene::to_string(scene.task)},
      {"organ", scene.organ_name + ": " + mesh_text(scene.organ)},
      {"organ's position", point_mm(scene.organ_pose.position)},
  };
  if (!scene.organ_motion.empty()) {
    facts.emplace_back("organ's motion", motion_text(scene.organ_motion));
  }
  for (const scene::InclusionSetup& one : scene.inclusions) {
    const model::Inclusion& inclusion = one.inclusion;
    std::string text =
        fmt::format("{}: sphere of {} radius, {} times as stiff as the tissue, centre at {} in the organ",
                    one.name, millimetres(inclusion.radius), brief(inclusion.ratio, 3),
                    point_mm(Vec3((inclusion.centre_S * 1e5).array().round() * 1e-5)));
    if (inclusion.pulse > 0.0) {
      text += fmt::format(", rises {} every {} s", millimetres(inclusion.pulse),
                          fixed(inclusion.pulse_period, 3));
    }
    facts.emplace_back("inclusion", text);
  }
  if (!scene.stiffness.empty()) {
    facts.emplace_back("stiffness map", fmt::format("{} points on the surface", scene.stiffness.size()));
  }
  for (const geometry::Tool& tool : scene.tools) {
    std::string text = tool.name;
    for (const geometry::ToolPart& part : tool.parts) {
      text += fmt::format("; {}{}: {}", part.is_jaw ? "jaw" : "part",
                          part.name.empty() ? "" : " " + part.name, mesh_text(part.mesh));
    }
    if (tool.tip_radius) text += "; tip radius " + millimetres(*tool.tip_radius);
    facts.emplace_back("tool", text);
  }
  for (const scene::DeviceSetup& device : scene.devices) {
    facts.emplace_back("device", fmt::format("{}{}, workspace scale {}", device.kind,
                                             device.path.empty() ? "" : ", path " + device.path,
                                             shortest(device.workspace_scale)));
    if (device.interpolation == scene::PathInterpolation::kCubic) {
      facts.emplace_back("tool path", "cubic between its rows");
    }
    if (device.force_scale < 1.0) {
      facts.emplace_back("force scale",
                         fmt::format("{}: the hand felt that much of the tissue's force, as much as a {} can "
                                     "render (--fit-device)",
                                     brief(device.force_scale), device.abilities.model));
    }
  }
  facts.emplace_back("rate", number(scene.rate_Hz, "Hz"));
  facts.emplace_back("length", fmt::format("{} ticks, {} s", grouped(analysis.ticks),
                                           fixed(static_cast<double>(analysis.ticks) / scene.rate_Hz, 3)));
  facts.emplace_back("seed", std::to_string(scene.seed));
  return facts;
}

/// Where the law ends, or from where on it has no evidence.
std::string end_of(const model::SpringLaw& law, const model::TissueParameters& tissue) {
  if (std::isfinite(law.max_depth())) {
    return fmt::format("largest {} and {} N", millimetres(law.max_depth()), fixed(law.max_force(), 2));
  }
  const double deepest = *tissue.max_depth;
  return fmt::format("past {} it goes on by its tangent there, {}", millimetres(deepest),
                     number(law.force_at(deepest).stiffness, "N/m"));
}

Facts tissue_facts(const scene::Scene& scene, model::Direction direction) {
  const model::TissueParameters& tissue = scene.tissue;
  const model::SpringLaw law(tissue, direction, 1.0 / scene.rate_Hz);
  Facts facts{
      {"name", tissue.name},
      {"law", fmt::format("{}{}, {} layers at this rate; {}",
                          tissue.law == model::LawKind::kSmooth
                              ? "smooth: parallel springs without jumps of stiffness, "
                              : "layered parallel springs, ",
                          direction == model::Direction::kPull ? "pulled" : "pressed", law.layers_allowed(),
                          end_of(law, tissue))},
  };
  for (const model::TissueField& field : model::kTissueFields) {
    const double value = field.in_force(tissue);
    if (std::isfinite(value)) facts.emplace_back(field.label, number(value / field.unit.si, field.unit.text));
  }
  for (const model::RelaxationTerm& term : tissue.relaxation) {
    facts.emplace_back("relaxation", fmt::format("by {} of the force, time constant {}", shortest(term.g),
                                                 number(term.tau, "s")));
  }
  facts.emplace_back("fitted with",
                     tissue.source && !tissue.source->indenter.empty()
                         ? tissue.source->indenter + ", radius " + millimetres(tissue.source->radius)
                         : "no [tissue.source] names a measurement: illustrative");
  return facts;
}

Facts other_facts(const scene::Scene& scene) {
  const noise::NoiseSettings& noise = scene.noise;
  const scene::SafetySetup& safety = scene.safety;
  return {
      {"touch noise", noise.enabled ? fmt::format("K {}, d₀ {}, σ in contact {} mN, clock {}, seed {}",
                                                  number(noise.gain, "N m"), millimetres(noise.threshold),
                                                  fixed(noise.gain / noise.threshold * kMilli, 3),
                                                  number(noise.rate_Hz, "Hz"), noise.seed)
                                    : "off"},
      {"largest force, its change",
       number(safety.max_force, "N") + ", " + number(safety.max_slew / kMilli, "N/ms")},
      {"largest torque, its change",
       number(safety.max_torque, "N m") + ", " + number(safety.max_torque_slew / kMilli, "N m/ms")},
  };
}

Facts run_facts(const record::RunFacts& facts) {
  const auto granted = [](bool yes) { return std::string(yes ? "granted" : "not granted"); };
  Facts rows{{"palpate", facts.version + ", " + facts.compiler}, {"machine", facts.machine}};
  if (facts.started_unix_ns != 0) rows.emplace_back("started", utc_time(facts.started_unix_ns));
  rows.emplace_back("clock", facts.offline ? "offline, as fast as possible" : "real time");
  if (!facts.offline) {
    rows.emplace_back("real-time priority", granted(facts.realtime_priority));
    rows.emplace_back("memory locked", granted(facts.memory_locked));
    rows.emplace_back("between ticks", facts.polled ? "the loop polled the clock" : "the loop slept");
  }
  if (!facts.complete) rows.emplace_back("recording", "cut off: it ends with the last row that was written");
  return rows;
}

}  // namespace

void write_summary(Page& page, const std::vector<ExperimentResults>& all) {
  page.section("summary", "What came out");
  TableRows rows{{"experiment", "largest depth", "largest tissue force", "tick p50 / p99",
                  "lateness p50 / p99", "missed deadlines"}};
  std::size_t number = 0;
  for (const ExperimentResults& worked : all) {
    const bool offline = worked.experiment->recording->facts.offline;
    const HandAnalysis& hand = main_hand(worked);
    const Analysis& analysis = worked.analysis;
    rows.push_back(
        {fmt::format("<a href=\"#{}\">{}</a>", anchor(++number), escaped(worked.experiment->title)),
         fixed(hand.peak_depth * kMilli, 2) + " mm", fixed(hand.peak_tissue_force, 3) + " N",
         is_timed(analysis) ? fmt::format("{} / {}\u00a0µs", microseconds(analysis.tick_time.figures.p50),
                                          microseconds(analysis.tick_time.figures.p99))
                            : "not recorded",
         offline ? "offline"
                 : fmt::format("{} / {} µs", microseconds(analysis.lateness.figures.p50),
                               microseconds(analysis.lateness.figures.p99)),
         offline ? "offline" : grouped(analysis.missed) + " of " + grouped(analysis.ticks)});
  }
  page.table(rows);
  for (const ExperimentResults& worked : all) {
    if (all.size() > 1) page.heading(worked.experiment->title);
    page.html_list(marks_of(worked), "marks");
  }
}

void write_experiment(Page& page, const ExperimentResults& worked, std::size_t number) {
  page.section(anchor(number), worked.experiment->title);
  write_what_was_run(page, worked);
  write_pictures(page, worked.pictures);
  for (std::size_t i = 0; i < worked.hands.size(); ++i) {
    write_hand(page, worked.analysis.hands[i], worked.hands[i], worked.hands.size());
  }
  write_timing(page, worked);
}

void write_comparison(Page& page, const std::vector<ExperimentResults>& all) {
  page.section("paper", "Beside the paper");
  page.paragraph(
      "X. Zhang, W. Sun, A. Song, J. Li, J. Liu: Enhanced haptic model for real-time "
      "human-computer interaction, 2011. Its figures are of its own machine of that time.");
  for (const ExperimentResults& worked : all) page.table(comparison(worked));
}

void write_what_was_run(Page& page, const ExperimentResults& worked) {
  const record::Recording& recording = *worked.experiment->recording;
  page.heading("What was run");
  page.code(worked.experiment->command);
  page.open_grid("two");
  page.open_grid("column");
  page.facts(scene_facts(recording.scene, worked.analysis));
  page.facts(run_facts(recording.facts));
  page.close_grid();
  page.open_grid("column");
  page.paragraph("<strong>Tissue</strong>");
  page.facts(tissue_facts(recording.scene, worked.analysis.direction));
  page.facts(other_facts(recording.scene));
  page.close_grid();
  page.close_grid();
  const std::vector<std::string>& repairs = recording.scene.repairs;
  if (!repairs.empty()) page.paragraph("<strong>Meshes: what was repaired</strong>");
  page.list(repairs);
  std::vector<std::string> remarks = recording.scene.remarks;
  const auto add = [&remarks](const std::vector<std::string>& more) {
    remarks.insert(remarks.end(), more.begin(), more.end());
  };
  add(recording.facts.remarks);
  add(changes_text(recording));
  for (const HandAnalysis& hand : worked.analysis.hands) add(status_text(hand.rows));
  if (!remarks.empty()) page.paragraph("<strong>Remarks</strong>");
  page.list(remarks);
}

}  // namespace palpate::report
