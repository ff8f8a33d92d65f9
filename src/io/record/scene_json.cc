#include "io/record/scene_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/model/tissue_fields.h"
#include "io/scene/device_kinds.h"
#include "io/system/whole_json.h"
#include "palpate/error.h"

namespace palpate::record {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Vec3 vector_from(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json pose_json(const Pose& pose) {
  const Quat& q = pose.rotation;
  return {{"position_m", vector_json(pose.position)},
          {"rotation_wxyz", Json::array({q.w(), q.x(), q.y(), q.z()})}};
}

Pose pose_from(const Json& json) {
  const Json& q = json.at("rotation_wxyz");
  Pose pose;
  pose.position = vector_from(json.at("position_m"));
  pose.rotation =
      Quat(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>());
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

model::OrganMotionParameters motion_from(const Json& json) {
  model::OrganMotionParameters motion;
  const auto kind = json.at("kind").get<std::string>();
  if (kind == model::to_string(model::OrganMotionKind::kHeartbeat)) {
    motion.kind = model::OrganMotionKind::kHeartbeat;
  } else if (kind != model::to_string(model::OrganMotionKind::kBreathing)) {
    throw InputError("motion of kind \"" + kind + "\", want breathing or heartbeat");
  }
  motion.amplitude = json.at("amplitude_m").get<double>();
  motion.direction_W = vector_from(json.at("direction"));
  motion.rotation = json.at("rotation_rad").get<double>();
  motion.axis_W = vector_from(json.at("axis"));
  motion.period = json.at("period_s").get<double>();
  motion.phase = json.at("phase").get<double>();
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

scene::InclusionSetup inclusion_from(const Json& json) {
  scene::InclusionSetup setup;
  setup.name = json.at("name").get<std::string>();
  setup.visible = json.at("visible").get<bool>();
  setup.inclusion.centre_S = vector_from(json.at("centre_m"));
  setup.inclusion.radius = json.at("radius_m").get<double>();
  setup.inclusion.ratio = json.at("stiffness_ratio").get<double>();
  setup.inclusion.pulse = json.at("pulse_m").get<double>();
  setup.inclusion.pulse_period = json.at("pulse_period_s").get<double>();
  return setup;
}

Json stiffness_json(const std::vector<model::StiffnessPoint>& points) {
  Json json = Json::array();
  for (const model::StiffnessPoint& one : points) {
    json.push_back({one.point_S.x(), one.point_S.y(), one.point_S.z(), one.factor});
  }
  return json;
}

std::vector<model::StiffnessPoint> stiffness_from(const Json& json) {
  std::vector<model::StiffnessPoint> points;
  for (const Json& one : json) {
    points.push_back({vector_from(one), one.at(3).get<double>()});
    model::validate(points.back(), "stiffness factor");
  }
  return points;
}

Json optional_json(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

std::optional<double> optional_from(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional<double>(json.get<double>());
}

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

model::TissueParameters tissue_from(const Json& json) {
  model::TissueParameters t;
  t.name = json.at("name").get<std::string>();
  // Older recordings have the layered law of the paper, without relaxation.
  t.law = model::parse_law(json.value("law", model::to_string(model::LawKind::kLayered)));
  for (const Json& term : json.value("relaxation", Json::array())) {
    t.relaxation.push_back({term.at("share").get<double>(), term.at("time_s").get<double>()});
  }
  for (const model::TissueField& field : model::kTissueFields) {
    const Json& table = field.section.empty() ? json : json.at(std::string(field.section));
    if (field.added_later && !table.contains(field.column())) continue;
    const Json& value = table.at(field.column());
    field.at.set(t, field.optional() ? optional_from(value) : value.get<double>());
  }
  if (const Json& source = json.at("source"); !source.is_null()) {
    t.source = model::SourceParameters{source.at("indenter").get<std::string>(),
                                       source.at("radius_m").get<double>()};
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

geometry::Tool tool_from(const Json& json) {
  geometry::Tool tool;
  tool.name = json.at("name").get<std::string>();
  tool.tip_radius = optional_from(json.at("tip_radius_m"));
  for (const Json& entry : json.at("parts")) {
    geometry::ToolPart part;
    part.name = entry.at("name").get<std::string>();
    part.is_jaw = entry.at("is_jaw").get<bool>();
    part.pivot = vector_from(entry.at("pivot_m"));
    part.axis = vector_from(entry.at("axis"));
    part.open_angle = entry.at("open_angle_rad").get<double>();
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

scene::EmulatedHand emulated_from(const Json& json) {
  scene::EmulatedHand hand;
  hand.mass = json.at("mass_kg").get<double>();
  hand.grip = {json.at("grip_N_per_m").get<double>(), json.at("grip_N_s_per_m").get<double>()};
  for (const Json& entry : json.at("faults")) {
    const auto word = entry.at("kind").get<std::string>();
    const std::optional<scene::EmulatedFaultKind> kind = scene::find_emulated_fault(word);
    if (!kind) throw InputError("fault of kind \"" + word + "\" is not known");
    hand.faults.push_back({*kind, entry.at("time_s").get<double>(), entry.at("duration_s").get<double>(),
                           entry.at("age_s").get<double>()});
  }
  return hand;
}

/// A number of a device that may be unknown.
Json known_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double known_from(const Json& json) {
  return json.is_null() ? haptics::DeviceAbilities::kUnknown : json.get<double>();
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

scene::DeviceSetup device_from(const Json& json) {
  scene::DeviceSetup device;
  device.kind = json.at("kind").get<std::string>();
  device.path = json.at("path").get<std::string>();
  const scene::DeviceKind* kind = scene::find_device_kind(device.kind);
  if (kind != nullptr && kind->path == scene::DevicePath::kLibrary) device.path.clear();  // see scene_json.h
  const std::string interpolation = json.value("interpolation", "linear");
  const auto known = scene::interpolation_of(interpolation);
  if (!known) throw InputError("interpolation is " + interpolation + ", want linear or cubic");
  device.interpolation = *known;
  device.path_speed = json.value("path_speed", 1.0);
  if (!(device.path_speed >= 0.01 && device.path_speed <= 100.0)) {
    throw InputError("path_speed is " + shortest(device.path_speed) + ", want >= 0.01 and <= 100");
  }
  device.workspace_scale = json.at("workspace_scale").get<double>();
  device.base = pose_from(json.at("base"));
  device.dynamics.damping = optional_from(json.at("damping_N_s_per_m"));
  device.dynamics.friction = optional_from(json.at("friction_N"));
  device.dynamics.resolution = optional_from(json.at("resolution_m"));
  if (!json.at("clutch_button").is_null()) {
    device.clutch_button = whole_number<std::uint32_t>(json, "clutch_button");
  }
  // Older recordings do not have the abilities of devices.
  device.abilities.model = json.value("model", std::string());
  device.abilities.continuous_force = known_from(json.value("continuous_force_N", Json(nullptr)));
  device.abilities.max_stiffness = known_from(json.value("max_stiffness_N_per_m", Json(nullptr)));
  device.abilities.torque = json.value("torque", true);
  device.force_scale = json.value("force_scale", 1.0);
  if (!(device.force_scale > 0.0 && device.force_scale <= 1.0)) {
    throw InputError("force_scale is " + shortest(device.force_scale) + ", want > 0 and <= 1");
  }
  if (json.contains("emulated")) device.emulated = emulated_from(json.at("emulated"));
  return device;
}

Json noise_json(const noise::NoiseSettings& noise) {
  return {{"enabled", noise.enabled},
          {"gain_N_m", noise.gain},
          {"threshold_m", noise.threshold},
          {"rate_Hz", noise.rate_Hz},
          {"seed", noise.seed}};
}

noise::NoiseSettings noise_from(const Json& json) {
  noise::NoiseSettings noise;
  noise.enabled = json.at("enabled").get<bool>();
  noise.gain = json.at("gain_N_m").get<double>();
  noise.threshold = json.at("threshold_m").get<double>();
  noise.rate_Hz = json.at("rate_Hz").get<double>();
  noise.seed = whole_number<std::uint64_t>(json, "seed");
  return noise;
}

Json safety_json(const scene::SafetySetup& safety) {
  return {{"max_force_N", safety.max_force},
          {"max_slew_N_per_s", safety.max_slew},
          {"max_torque_N_m", safety.max_torque},
          {"max_torque_slew_N_m_per_s", safety.max_torque_slew}};
}

scene::SafetySetup safety_from(const Json& json) {
  scene::SafetySetup safety;
  safety.max_force = json.at("max_force_N").get<double>();
  safety.max_slew = json.at("max_slew_N_per_s").get<double>();
  safety.max_torque = json.at("max_torque_N_m").get<double>();
  safety.max_torque_slew = json.at("max_torque_slew_N_m_per_s").get<double>();
  return safety;
}

scene::Task task_from(const std::string& word) {
  if (const auto task = scene::find_task(word)) return *task;
  throw InputError("task is \"" + word + "\", want press, pull or palpate");
}

scene::SearchSetup search_from(const Json& json) {
  scene::SearchSetup search;
  search.tolerance = json.at("tolerance_m").get<double>();
  search.mark_button = whole_number<std::uint32_t>(json, "mark_button");
  if (search.mark_button > scene::kLastButton) throw InputError("search.mark_button is over 31");
  return search;
}

scene::Scene setup_from(const Json& json) {
  scene::Scene setup;
  setup.name = json.at("name").get<std::string>();
  setup.task = task_from(json.at("task").get<std::string>());
  setup.rate_Hz = json.at("rate_Hz").get<double>();
  setup.seed = whole_number<std::uint64_t>(json, "seed");
  setup.organ_name = json.at("organ").at("name").get<std::string>();
  setup.organ_pose = pose_from(json.at("organ").at("pose"));
  // Older recordings have no organ motion.
  for (const Json& motion : json.at("organ").value("motion", Json::array())) {
    setup.organ_motion.push_back(motion_from(motion));
  }
  // Older recordings have uniform tissue.
  for (const Json& inclusion : json.at("organ").value("inclusions", Json::array())) {
    setup.inclusions.push_back(inclusion_from(inclusion));
  }
  setup.stiffness = stiffness_from(json.at("organ").value("stiffness", Json::array()));
  if (setup.task == scene::Task::kPalpate) setup.search = search_from(json.at("search"));
  setup.tissue = tissue_from(json.at("tissue"));
  for (const Json& tool : json.at("tools")) setup.tools.push_back(tool_from(tool));
  for (const Json& device : json.at("devices")) setup.devices.push_back(device_from(device));
  setup.noise = noise_from(json.at("noise"));
  setup.safety = safety_from(json.at("safety"));
  if (json.contains("repairs")) setup.repairs = json.at("repairs").get<std::vector<std::string>>();
  setup.remarks = json.at("remarks").get<std::vector<std::string>>();
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
    return setup_from(Json::parse(text));
  } catch (const Json::exception& error) {
    throw InputError("scene: " + one_line(error.what()));
  } catch (const InputError& error) {
    throw InputError("scene: " + one_line(error.what()));
  }
}

}  // namespace palpate::record
