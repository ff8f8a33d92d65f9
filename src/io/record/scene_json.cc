#include "io/record/scene_json.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/model/tissue_fields.h"
#include "io/scene/device_kinds.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using Json = nlohmann::ordered_json;

// Ranges of a scene's numbers, as in a scene file.
constexpr double kFarthest = 1e3;         // m
constexpr double kLargestAngle = 3.15;    // rad, 180 degrees and rounding
constexpr double kSlowestPath = 0.01;     // path_speed
constexpr double kFastestPath = 100.0;    // path_speed
constexpr double kLargestScale = 1000.0;  // workspace_scale

Json vector_json(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vec3 vector_from(const JsonField& json) {
  const std::vector<JsonField> numbers = json.exactly(3);
  const auto number = [&](std::size_t i) { return numbers[i].number(-kFarthest, kFarthest); };
  return {number(0), number(1), number(2)};
}

Json pose_json(const Pose& pose) {
  const Quat& q = pose.rotation;
  return {{"position_m", vector_json(pose.position)},
          {"rotation_wxyz", Json::array({q.w(), q.x(), q.y(), q.z()})}};
}

Pose pose_from(const JsonField& json) {
  constexpr double kSlack = 1e-6;  // of the quaternion's norm, for rounding
  Pose pose;
  pose.position = vector_from(json.at("position_m"));
  const JsonField rotation = json.at("rotation_wxyz");
  const std::vector<JsonField> q = rotation.exactly(4);
  pose.rotation = Quat(q[0].number(), q[1].number(), q[2].number(), q[3].number());
  if (!(std::abs(pose.rotation.norm() - 1.0) <= kSlack)) rotation.fail("a unit quaternion");
  return pose;
}

Json motion_json(const model::OrganMotionParameters& motion) {
  return {{"kind", model::to_string(motion.kind)},
          {"amplitude_m", motion.amplitude},
          {"direction", vector_json(motion.direction_W)},
          {"rotation_rad", motion.rotation},
          {"axis", vector_json(motion.axis_W)},
          {"period_s", motion.period},
          {"phase", motion.phase}};
}

model::OrganMotionParameters motion_from(const JsonField& json) {
  model::OrganMotionParameters motion;
  const JsonField kind = json.at("kind");
  if (kind.text() == model::to_string(model::OrganMotionKind::kHeartbeat)) {
    motion.kind = model::OrganMotionKind::kHeartbeat;
  } else if (kind.text() != model::to_string(model::OrganMotionKind::kBreathing)) {
    kind.fail("breathing or heartbeat");
  }
  motion.amplitude = json.at("amplitude_m").number();
  motion.direction_W = vector_from(json.at("direction"));
  motion.rotation = json.at("rotation_rad").number();
  motion.axis_W = vector_from(json.at("axis"));
  motion.period = json.at("period_s").number();
  motion.phase = json.at("phase").number();
  return motion;
}

Json inclusion_json(const scene::InclusionSetup& setup) {
  const model::Inclusion& inclusion = setup.inclusion;
  return {{"name", setup.name},
          {"visible", setup.visible},
          {"centre_m", vector_json(inclusion.centre_S)},
          {"radius_m", inclusion.radius},
          {"stiffness_ratio", inclusion.ratio},
          {"pulse_m", inclusion.pulse},
          {"pulse_period_s", inclusion.pulse_period}};
}

scene::InclusionSetup inclusion_from(const JsonField& json) {
  scene::InclusionSetup setup;
  setup.name = json.at("name").text();
  setup.visible = json.at("visible").flag();
  setup.inclusion.centre_S = vector_from(json.at("centre_m"));
  setup.inclusion.radius = json.at("radius_m").number();
  setup.inclusion.ratio = json.at("stiffness_ratio").number();
  setup.inclusion.pulse = json.at("pulse_m").number();
  setup.inclusion.pulse_period = json.at("pulse_period_s").number();
  return setup;
}

Json stiffness_json(const std::vector<model::StiffnessPoint>& points) {
  Json json = Json::array();
  for (const model::StiffnessPoint& one : points) {
    json.push_back({one.point_S.x(), one.point_S.y(), one.point_S.z(), one.factor});
  }
  return json;
}

std::vector<model::StiffnessPoint> stiffness_from(const JsonField& json) {
  std::vector<model::StiffnessPoint> points;
  for (const JsonField& one : json.elements(model::kMaxStiffnessPoints)) {
    const std::vector<JsonField> n = one.exactly(4);
    points.push_back({{n[0].number(), n[1].number(), n[2].number()}, n[3].number()});
    model::validate(points.back(), "stiffness factor");
  }
  return points;
}

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json relaxation_json(const model::RelaxationTerms& terms) {
  Json json = Json::array();
  for (const model::RelaxationTerm& term : terms) json.push_back({{"share", term.g}, {"time_s", term.tau}});
  return json;
}

Json tissue_json(const model::TissueParameters& t) {
  Json json = {
      {"name", t.name}, {"law", model::to_string(t.law)}, {"relaxation", relaxation_json(t.relaxation)}};
  for (const model::TissueField& field : model::kTissueFields) {
    Json& table = field.section.empty() ? json : json[std::string(field.section)];
    table[field.column()] = optional_json(field.at.get(t));
  }
  json["source"] =
      t.source ? Json{{"indenter", t.source->indenter}, {"radius_m", t.source->radius}} : Json(nullptr);
  return json;
}

model::TissueParameters tissue_from(const JsonField& json) {
  model::TissueParameters t;
  t.name = json.at("name").text();
  // Older recordings have the layered law of the paper, without relaxation.
  if (json.has("law")) t.law = model::parse_law(json.at("law").text());
  for (const JsonField& term : json.at("relaxation").elements(model::kMaxRelaxationTerms)) {
    t.relaxation.push_back({term.at("share").number(), term.at("time_s").number()});
  }
  for (const model::TissueField& field : model::kTissueFields) {
    const JsonField table = field.section.empty() ? json : json.at(std::string(field.section));
    const std::string name = field.column();
    if (field.added_later && !table.has(name)) continue;
    if (!table.has(name)) table.at(name).fail("a number");
    field.at.set(t, field.optional() ? table.at(name).optional_number() : table.at(name).number());
  }
  if (const JsonField source = json.at("source"); source.there()) {
    t.source = model::SourceParameters{source.at("indenter").text(), source.at("radius_m").number()};
  }
  return t;
}

Json tool_json(const geometry::Tool& tool) {
  Json parts = Json::array();
  for (const geometry::ToolPart& part : tool.parts) {
    parts.push_back({{"name", part.name},
                     {"is_jaw", part.is_jaw},
                     {"pivot_m", vector_json(part.pivot)},
                     {"axis", vector_json(part.axis)},
                     {"open_angle_rad", part.open_angle}});
  }
  return {{"name", tool.name}, {"tip_radius_m", optional_json(tool.tip_radius)}, {"parts", parts}};
}

geometry::Tool tool_from(const JsonField& json) {
  geometry::Tool tool;
  tool.name = json.at("name").text();
  tool.tip_radius = json.at("tip_radius_m").optional_number();
  if (tool.tip_radius && !(*tool.tip_radius > 0.0)) json.at("tip_radius_m").fail("a number > 0");
  for (const JsonField& entry : json.at("parts").elements(kMaxParts)) {
    geometry::ToolPart part;
    part.name = entry.at("name").text();
    part.is_jaw = entry.at("is_jaw").flag();
    part.pivot = vector_from(entry.at("pivot_m"));
    part.axis = vector_from(entry.at("axis"));
    part.open_angle = entry.at("open_angle_rad").number(-kLargestAngle, kLargestAngle);
    tool.parts.push_back(std::move(part));
  }
  return tool;
}

Json emulated_json(const scene::EmulatedHand& hand) {
  Json json = {
      {"mass_kg", hand.mass}, {"grip_N_per_m", hand.grip.stiffness}, {"grip_N_s_per_m", hand.grip.damping}};
  json["faults"] = Json::array();
  for (const scene::EmulatedFault& fault : hand.faults) {
    json["faults"].push_back({{"kind", scene::name_of(fault.kind)},
                              {"time_s", fault.time},
                              {"duration_s", fault.duration},
                              {"age_s", fault.age}});
  }
  return json;
}

scene::EmulatedHand emulated_from(const JsonField& json) {
  scene::EmulatedHand hand;
  hand.mass = json.at("mass_kg").number();
  hand.grip = {json.at("grip_N_per_m").number(), json.at("grip_N_s_per_m").number()};
  for (const JsonField& entry : json.at("faults").elements()) {
    const JsonField kind = entry.at("kind");
    const std::optional<scene::EmulatedFaultKind> known = scene::find_emulated_fault(kind.text());
    if (!known) kind.fail("the kind of a simulated fault");
    hand.faults.push_back(
        {*known, entry.at("time_s").number(), entry.at("duration_s").number(), entry.at("age_s").number()});
  }
  return hand;
}

/// A number of a device that may be unknown.
Json known_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double known_from(const JsonField& json) {
  return json.optional_number().value_or(haptics::DeviceAbilities::kUnknown);
}

std::optional<std::uint32_t> button_from(const JsonField& json) {
  return json.there() ? std::optional(json.whole(scene::kLastButton)) : std::nullopt;
}

Json device_json(const scene::DeviceSetup& device) {
  Json json = {{"kind", device.kind},
               {"path", device.path},
               {"workspace_scale", device.workspace_scale},
               {"base", pose_json(device.base)},
               {"damping_N_s_per_m", optional_json(device.dynamics.damping)},
               {"friction_N", optional_json(device.dynamics.friction)},
               {"resolution_m", optional_json(device.dynamics.resolution)},
               {"clutch_button", device.clutch_button ? Json(*device.clutch_button) : Json(nullptr)},
               {"model", device.abilities.model},
               {"continuous_force_N", known_json(device.abilities.continuous_force)},
               {"max_stiffness_N_per_m", known_json(device.abilities.max_stiffness)},
               {"torque", device.abilities.torque},
               {"force_scale", device.force_scale}};
  if (device.interpolation != scene::PathInterpolation::kLinear)
    json["interpolation"] = scene::to_string(device.interpolation);
  if (device.path_speed != 1.0) json["path_speed"] = device.path_speed;
  if (device.kind == "emulated") json["emulated"] = emulated_json(device.emulated);
  return json;
}

/// What older recordings do not have keeps its default.
scene::DeviceSetup device_from(const JsonField& json) {
  scene::DeviceSetup device;
  device.kind = json.at("kind").text();
  device.path = json.at("path").text();
  const scene::DeviceKind* kind = scene::find_device_kind(device.kind);
  if (kind != nullptr && kind->path == scene::DevicePath::kLibrary) device.path.clear();  // see scene_json.h
  if (const JsonField interpolation = json.at("interpolation"); interpolation.there()) {
    const auto known = scene::interpolation_of(interpolation.text());
    if (!known) interpolation.fail("linear or cubic");
    device.interpolation = *known;
  }
  if (const JsonField speed = json.at("path_speed"); speed.there()) {
    device.path_speed = speed.number(kSlowestPath, kFastestPath);
  }
  device.workspace_scale = json.at("workspace_scale").positive(kLargestScale);
  device.base = pose_from(json.at("base"));
  device.dynamics.damping = json.at("damping_N_s_per_m").optional_number();
  device.dynamics.friction = json.at("friction_N").optional_number();
  device.dynamics.resolution = json.at("resolution_m").optional_number();
  device.clutch_button = button_from(json.at("clutch_button"));
  if (json.has("model")) device.abilities.model = json.at("model").text();
  device.abilities.continuous_force = known_from(json.at("continuous_force_N"));
  device.abilities.max_stiffness = known_from(json.at("max_stiffness_N_per_m"));
  if (json.has("torque")) device.abilities.torque = json.at("torque").flag();
  if (json.has("force_scale")) device.force_scale = json.at("force_scale").positive(1.0);
  if (json.has("emulated")) device.emulated = emulated_from(json.at("emulated"));
  return device;
}

Json noise_json(const noise::NoiseSettings& noise) {
  return {{"enabled", noise.enabled},
          {"gain_N_m", noise.gain},
          {"threshold_m", noise.threshold},
          {"rate_Hz", noise.rate_Hz},
          {"seed", noise.seed}};
}

noise::NoiseSettings noise_from(const JsonField& json) {
  noise::NoiseSettings noise;
  noise.enabled = json.at("enabled").flag();
  noise.gain = json.at("gain_N_m").number();
  noise.threshold = json.at("threshold_m").number();
  noise.rate_Hz = json.at("rate_Hz").number();
  noise.seed = json.at("seed").whole<std::uint64_t>();
  return noise;
}

Json safety_json(const scene::SafetySetup& safety) {
  return {{"max_force_N", safety.max_force},
          {"max_slew_N_per_s", safety.max_slew},
          {"max_torque_N_m", safety.max_torque},
          {"max_torque_slew_N_m_per_s", safety.max_torque_slew}};
}

scene::SafetySetup safety_from(const JsonField& json) {
  using Limits = scene::SafetySetup;
  const auto limit = [&json](const char* name, double most) { return json.at(name).number(0.0, most); };
  Limits safety;
  safety.max_force = limit("max_force_N", Limits::kMaxForce);
  safety.max_slew = limit("max_slew_N_per_s", Limits::kMaxSlew);
  safety.max_torque = limit("max_torque_N_m", Limits::kMaxTorque);
  safety.max_torque_slew = limit("max_torque_slew_N_m_per_s", Limits::kMaxTorqueSlew);
  return safety;
}

scene::Task task_from(const JsonField& json) {
  const auto task = scene::find_task(json.text());
  if (!task) json.fail("press, pull or palpate");
  return *task;
}

scene::SearchSetup search_from(const JsonField& json) {
  scene::SearchSetup search;
  search.tolerance = json.at("tolerance_m").number(0.0, kFarthest);
  search.mark_button = json.at("mark_button").whole(scene::kLastButton);
  return search;
}

scene::Scene setup_from(const JsonField& json) {
  scene::Scene setup;
  setup.name = json.at("name").text();
  setup.task = task_from(json.at("task"));
  setup.rate_Hz = json.at("rate_Hz").number(scene::kSlowestRate, scene::kFastestRate);
  setup.seed = json.at("seed").whole<std::uint64_t>();
  const JsonField organ = json.at("organ");
  setup.organ_name = organ.at("name").text();
  setup.organ_pose = pose_from(organ.at("pose"));
  // Older recordings have uniform tissue and no organ motion.
  for (const JsonField& motion : organ.at("motion").elements(model::kMaxOrganMotions)) {
    setup.organ_motion.push_back(motion_from(motion));
  }
  for (const JsonField& inclusion : organ.at("inclusions").elements(model::kMaxInclusions)) {
    setup.inclusions.push_back(inclusion_from(inclusion));
  }
  setup.stiffness = stiffness_from(organ.at("stiffness"));
  if (setup.task == scene::Task::kPalpate) setup.search = search_from(json.at("search"));
  setup.tissue = tissue_from(json.at("tissue"));
  for (const JsonField& tool : json.at("tools").elements(kMaxHands)) {
    setup.tools.push_back(tool_from(tool));
  }
  for (const JsonField& device : json.at("devices").elements(kMaxHands)) {
    setup.devices.push_back(device_from(device));
  }
  setup.noise = noise_from(json.at("noise"));
  setup.safety = safety_from(json.at("safety"));
  setup.repairs = json.at("repairs").texts();
  setup.remarks = json.at("remarks").texts();
  return setup;
}

}  // namespace

std::string setup_to_json(const scene::Scene& setup) {
  Json json = {{"name", setup.name},
               {"task", scene::to_string(setup.task)},
               {"rate_Hz", setup.rate_Hz},
               {"seed", setup.seed},
               {"organ", {{"name", setup.organ_name}, {"pose", pose_json(setup.organ_pose)}}},
               {"tissue", tissue_json(setup.tissue)}};
  json["organ"]["motion"] = Json::array();
  for (const model::OrganMotionParameters& motion : setup.organ_motion) {
    json["organ"]["motion"].push_back(motion_json(motion));
  }
  if (!setup.inclusions.empty()) json["organ"]["inclusions"] = Json::array();
  for (const scene::InclusionSetup& one : setup.inclusions) {
    json["organ"]["inclusions"].push_back(inclusion_json(one));
  }
  if (!setup.stiffness.empty()) json["organ"]["stiffness"] = stiffness_json(setup.stiffness);
  if (setup.task == scene::Task::kPalpate) {
    json["search"] = {{"tolerance_m", setup.search.tolerance}, {"mark_button", setup.search.mark_button}};
  }
  json["tools"] = Json::array();
  for (const geometry::Tool& tool : setup.tools) json["tools"].push_back(tool_json(tool));
  json["devices"] = Json::array();
  for (const scene::DeviceSetup& device : setup.devices) json["devices"].push_back(device_json(device));
  json["noise"] = noise_json(setup.noise);
  json["safety"] = safety_json(setup.safety);
  json["repairs"] = setup.repairs;
  json["remarks"] = setup.remarks;
  // File names need not be UTF-8; invalid bytes become the replacement character.
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

scene::Scene setup_from_json(const std::string& text) {
  try {
    const nlohmann::json json = parse_json(text);
    return setup_from(JsonField(json));
  } catch (const InputError& error) {
    throw InputError("scene: " + one_line(error.what()));
  }
}

}  // namespace palpate::record
