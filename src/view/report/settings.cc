#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/model/tissue_fields.h"
#include "io/scene/support_reader.h"
#include "palpate/mesh.h"
#include "palpate/support.h"
#include "palpate/surface.h"
#include "view/report/page.h"
#include "view/report/sections.h"

namespace palpate::report {
namespace {

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
  if (scene.support) {
    facts.emplace_back("organ held by", joined(scene::support_phrases(*scene.support), "; ") + "; together " +
                                            percent(geometry::held_share(*scene.support, scene.organ), 1) +
                                            " of the surface");
    facts.emplace_back("cells of its response", deform::describe(deform::response_cells(scene.organ)));
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

/// Where the law ends, or from where on it goes on by its tangent.
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

void write_what_was_run(Page& page, const ExperimentResults& worked) {
  const record::Recording& recording = *worked.experiment->recording;
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
