#include "io/record/scene_json.h"

#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/model/layer_fields.h"
#include "core/model/tissue_fields.h"
#include "io/scene/device_kinds.h"
#include "io/system/json_field.h"
#include "io/system/json_text.h"
#include "palpate/error.h"

// Each struct of a scene has one function fields(io, value), which lists its JSON keys in the order of the
// file. SceneWriter passes through it to write the struct, SceneReader to read it.

namespace palpate::record {
namespace {

using Json = nlohmann::ordered_json;

// Ranges of a scene's numbers, as in a scene file.
constexpr double kFarthest = 1e3;         // m
constexpr double kLargestAngle = 3.15;    // rad, 180 degrees and rounding
constexpr double kSlowestPath = 0.01;     // path_speed
constexpr double kFastestPath = 100.0;    // path_speed
constexpr double kLargestScale = 1000.0;  // workspace_scale
constexpr std::size_t kAnyNumber = std::numeric_limits<std::size_t>::max();

/// A struct that is written, then const, or read.
template <class T, class Struct>
concept Is = std::same_as<std::remove_const_t<T>, Struct>;

template <class Enum>
requires std::is_enum_v<Enum> Json json_of(Enum value) { return to_string(value); }
Json json_of(scene::EmulatedFaultKind kind) { return scene::name_of(kind); }
Json json_of(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }
Json json_of(const Quat& q) { return Json::array({q.w(), q.x(), q.y(), q.z()}); }
Json json_of(const model::StiffnessPoint& one) {
  return Json::array({one.point_S.x(), one.point_S.y(), one.point_S.z(), one.factor});
}

void read_json(const JsonField& json, double& value) { value = json.number(); }
void read_json(const JsonField& json, bool& value) { value = json.flag(); }
void read_json(const JsonField& json, std::uint32_t& button) { button = json.whole(scene::kLastButton); }
void read_json(const JsonField& json, std::uint64_t& value) { value = json.whole<std::uint64_t>(); }
void read_json(const JsonField& json, std::string& value) { value = json.text(); }

/// Reads the name of an enumerator. @param want all names, for an error
template <class Enum>
void read_name(const JsonField& json, std::optional<Enum> known, const char* want, Enum& value) {
  if (!known) json.fail(want);
  value = *known;
}

void read_json(const JsonField& json, model::OrganMotionKind& value) {
  const std::string name = json.text();
  std::optional<model::OrganMotionKind> known;
  for (const auto kind : {model::OrganMotionKind::kBreathing, model::OrganMotionKind::kHeartbeat}) {
    if (name == model::to_string(kind)) known = kind;
  }
  read_name(json, known, "breathing or heartbeat", value);
}
void read_json(const JsonField& json, scene::EmulatedFaultKind& value) {
  read_name(json, scene::find_emulated_fault(json.text()), "the kind of a simulated fault", value);
}
void read_json(const JsonField& json, scene::PathInterpolation& value) {
  read_name(json, scene::interpolation_of(json.text()), "linear or cubic", value);
}
void read_json(const JsonField& json, scene::OrganFrame& value) {
  read_name(json, scene::find_organ_frame(json.text()), "ras or lps", value);
}
void read_json(const JsonField& json, scene::Task& value) {
  read_name(json, scene::find_task(json.text()), "press, pull, palpate or insert", value);
}

void read_json(const JsonField& json, model::LawKind& value) { value = model::parse_law(json.text()); }

void read_json(const JsonField& json, Vec3& value) {
  const std::vector<JsonField> n = json.exactly(3);
  for (std::size_t i = 0; i < 3; ++i) {
    value[static_cast<Eigen::Index>(i)] = n[i].number(-kFarthest, kFarthest);
  }
}

void read_json(const JsonField& json, Quat& value) {
  constexpr double kSlack = 1e-6;  // of the quaternion's norm, for rounding
  const std::vector<JsonField> q = json.exactly(4);
  value = Quat(q[0].number(), q[1].number(), q[2].number(), q[3].number());
  if (!(std::abs(value.norm() - 1.0) <= kSlack)) json.fail("a unit quaternion");
}

void read_json(const JsonField& json, model::StiffnessPoint& value) {
  const std::vector<JsonField> n = json.exactly(4);
  value = {{n[0].number(), n[1].number(), n[2].number()}, n[3].number()};
  model::validate(value, "stiffness factor");
}

/// Writes the fields of a struct. The limits are for reading.
class SceneWriter final {
 public:
  Json json = Json::object();

  template <class T>
  void operator()(const char* key, const T& value) {
    if constexpr (requires { fields(*this, value); }) {
      (*this).nested(key, [&value](SceneWriter& io) { fields(io, value); });
    } else if constexpr (requires { json_of(value); }) {
      json[key] = json_of(value);
    } else {
      json[key] = value;
    }
  }
  template <class T>
  void operator()(const char* key, const std::optional<T>& value) {
    json[key] = nullptr;
    if (value) (*this)(key, *value);
  }
  void operator()(const char* key, double value, double /*low*/, double /*high*/) { json[key] = value; }
  void positive(const char* key, double value, double /*most*/) { json[key] = value; }
  void positive(const char* key, const std::optional<double>& value) { (*this)(key, value); }
  /// A number of a device that may be unknown.
  void known(const char* key, double value) {
    json[key] = std::isfinite(value) ? Json(value) : Json(nullptr);
  }
  template <class List>
  void list(const char* key, const List& values, std::size_t /*most*/ = kAnyNumber) {
    SceneWriter element;
    Json& array = json[key] = Json::array();
    for (const auto& value : values) {
      element("", value);
      array.push_back(std::move(element.json[""]));
    }
  }
  template <class Fields>
  void nested(const char* key, Fields fields_of) {
    SceneWriter io;
    fields_of(io);
    json[key] = std::move(io.json);
  }
  void tissue_number(const model::TissueField& field, const model::TissueParameters& tissue) {
    const std::string section = field.recorded_section();
    Json& table = section.empty() ? json : json[section];
    const std::optional<double> value = field.at.get(tissue);
    table[field.column()] = value ? Json(*value) : Json(nullptr);
  }
  /// Whether the field is written; has() when reading: whether the file has it, if only as null.
  [[nodiscard]] static bool there(const char* /*key*/, bool written) { return written; }
  [[nodiscard]] static bool has(const char* /*key*/, bool written = true) { return written; }
};

/// Reads the fields of a struct.
class SceneReader final {
 public:
  explicit SceneReader(const JsonField& json) : json_(json) {}

  template <class T>
  void operator()(const char* key, T& value) {
    read_element(json_.at(key), value);
  }
  template <class T>
  void operator()(const char* key, std::optional<T>& value) {
    value.reset();
    if (const JsonField json = json_.at(key); json.there()) read_element(json, value.emplace());
  }
  void operator()(const char* key, double& value, double low, double high) {
    value = json_.at(key).number(low, high);
  }
  void positive(const char* key, double& value, double most) { value = json_.at(key).positive(most); }
  void positive(const char* key, std::optional<double>& value) {
    (*this)(key, value);
    if (value && !(*value > 0.0)) json_.at(key).fail("a number > 0");
  }
  void known(const char* key, double& value) {
    value = json_.at(key).optional_number().value_or(haptics::DeviceAbilities::kUnknown);
  }
  template <class List>
  void list(const char* key, List& values, std::size_t most = kAnyNumber) {
    for (const JsonField& element : json_.at(key).elements(most)) {
      std::remove_cvref_t<decltype(*values.begin())> value{};
      read_element(element, value);
      values.push_back(std::move(value));
    }
  }
  template <class Fields>
  void nested(const char* key, Fields fields_of) {
    SceneReader io(json_.at(key));
    fields_of(io);
  }
  void tissue_number(const model::TissueField& field, model::TissueParameters& tissue) {
    const std::string section = field.recorded_section();
    const JsonField table = section.empty() ? json_ : json_.at(section);
    const std::string name = field.column();
    if (field.added_later && !table.has(name)) return;
    if (!table.has(name)) table.at(name).fail("a number");
    field.at.set(tissue, field.optional() ? table.at(name).optional_number() : table.at(name).number());
  }
  [[nodiscard]] bool there(const char* key, bool /*written*/) const { return json_.at(key).there(); }
  [[nodiscard]] bool has(const char* key, bool /*written*/ = true) const { return json_.has(key); }

 private:
  template <class T>
  static void read_element(const JsonField& json, T& value) {
    SceneReader io(json);
    if constexpr (requires { fields(io, value); }) {
      fields(io, value);
    } else {
      read_json(json, value);
    }
  }

  JsonField json_;
};

void fields(auto& io, Is<Pose> auto& pose) {
  io("position_m", pose.position);
  io("rotation_wxyz", pose.rotation);
}

void fields(auto& io, Is<model::OrganMotionParameters> auto& motion) {
  io("kind", motion.kind);
  io("amplitude_m", motion.amplitude);
  io("direction", motion.direction_W);
  io("rotation_rad", motion.rotation);
  io("axis", motion.axis_W);
  io("period_s", motion.period);
  io("phase", motion.phase);
}

void fields(auto& io, Is<scene::InclusionSetup> auto& setup) {
  io("name", setup.name);
  io("visible", setup.visible);
  io("centre_m", setup.inclusion.centre_S);
  io("radius_m", setup.inclusion.radius);
  io("stiffness_ratio", setup.inclusion.ratio);
  io("pulse_m", setup.inclusion.pulse);
  io("pulse_period_s", setup.inclusion.pulse_period);
}

void fields(auto& io, Is<geometry::Bed> auto& bed) {
  io("direction", bed.direction);
  io("share", bed.share, 0.0, geometry::kLargestBedShare);
}

void fields(auto& io, Is<geometry::HeldFaces> auto& faces) { io("away_from", faces.away_from); }

void fields(auto& io, Is<geometry::Attachment> auto& attachment) {
  io("point_m", attachment.point);
  io("radius_m", attachment.radius, geometry::kSmallestAttachment, geometry::kLargestAttachment);
}

void fields(auto& io, Is<geometry::Support> auto& support) {
  io("bed", support.bed);
  io("faces", support.faces);
  io.list("attachments", support.attachments, geometry::kMaxAttachments);
  if (io.there("painted", !support.painted.empty()))
    io.list("painted", support.painted, geometry::kMaxPainted);
}

void fields(auto& io, Is<model::RelaxationTerm> auto& term) {
  io("share", term.g);
  io("time_s", term.tau);
}

void fields(auto& io, Is<model::SourceParameters> auto& source) {
  io("indenter", source.indenter);
  io("radius_m", source.radius);
}

void fields(auto& io, Is<model::TissueLayer> auto& layer) {
  io("name", layer.name);
  io.known(model::kLayerThicknessColumn, layer.thickness);
  for (const model::LayerField& field : model::kLayerFields) io(field.si_key, layer.*field.at);
}

void fields(auto& io, Is<geometry::Needle> auto& needle) {
  io("tip_m", needle.tip);
  io("axis", needle.axis);
  io("diameter_m", needle.diameter);
  io("length_m", needle.length);
}

/// Older recordings have the layered law of the paper, without relaxation.
void fields(auto& io, Is<model::TissueParameters> auto& tissue) {
  io("name", tissue.name);
  if (io.has("law")) io("law", tissue.law);
  io.list("relaxation", tissue.relaxation, model::kMaxRelaxationTerms);
  if (io.there("layers", !tissue.layers.empty())) io.list("layers", tissue.layers, model::kMaxTissueLayers);
  for (const model::TissueField& field : model::kTissueFields) io.tissue_number(field, tissue);
  io("source", tissue.source);
}

void fields(auto& io, Is<geometry::ToolPart> auto& part) {
  io("name", part.name);
  io("is_jaw", part.is_jaw);
  io("pivot_m", part.pivot);
  io("axis", part.axis);
  io("open_angle_rad", part.open_angle, -kLargestAngle, kLargestAngle);
}

void fields(auto& io, Is<geometry::Tool> auto& tool) {
  io("name", tool.name);
  io.positive("tip_radius_m", tool.tip_radius);
  io.list("parts", tool.parts, kMaxParts);
  if (io.there("needle", tool.needle.has_value())) io("needle", tool.needle);
}

void fields(auto& io, Is<scene::EmulatedFault> auto& fault) {
  io("kind", fault.kind);
  io("time_s", fault.time);
  io("duration_s", fault.duration);
  io("age_s", fault.age);
}

void fields(auto& io, Is<scene::EmulatedHand> auto& hand) {
  io("mass_kg", hand.mass);
  io("grip_N_per_m", hand.grip.stiffness);
  io("grip_N_s_per_m", hand.grip.damping);
  io.list("faults", hand.faults);
}

/// Fields that older recordings do not have keep their defaults.
void fields(auto& io, Is<scene::DeviceSetup> auto& device) {
  io("kind", device.kind);
  io("path", device.path);
  io.positive("workspace_scale", device.workspace_scale, kLargestScale);
  io("base", device.base);
  io("damping_N_s_per_m", device.dynamics.damping);
  io("friction_N", device.dynamics.friction);
  io("resolution_m", device.dynamics.resolution);
  io("clutch_button", device.clutch_button);
  if (io.has("model")) io("model", device.abilities.model);
  io.known("continuous_force_N", device.abilities.continuous_force);
  io.known("max_stiffness_N_per_m", device.abilities.max_stiffness);
  if (io.has("torque")) io("torque", device.abilities.torque);
  if (io.has("force_scale")) io.positive("force_scale", device.force_scale, 1.0);
  if (io.there("interpolation", device.interpolation != scene::PathInterpolation::kLinear)) {
    io("interpolation", device.interpolation);
  }
  if (io.there("path_speed", device.path_speed != 1.0)) {
    io("path_speed", device.path_speed, kSlowestPath, kFastestPath);
  }
  if (io.has("emulated", device.kind == "emulated")) io("emulated", device.emulated);
}

void fields(auto& io, Is<noise::NoiseSettings> auto& noise) {
  io("enabled", noise.enabled);
  io("gain_N_m", noise.gain);
  io("threshold_m", noise.threshold);
  io("rate_Hz", noise.rate_Hz);
  io("seed", noise.seed);
}

void fields(auto& io, Is<scene::SafetySetup> auto& safety) {
  io("max_force_N", safety.max_force, 0.0, safety.kMaxForce);
  io("max_slew_N_per_s", safety.max_slew, 0.0, safety.kMaxSlew);
  io("max_torque_N_m", safety.max_torque, 0.0, safety.kMaxTorque);
  io("max_torque_slew_N_m_per_s", safety.max_torque_slew, 0.0, safety.kMaxTorqueSlew);
}

void fields(auto& io, Is<scene::SearchSetup> auto& search) {
  io("tolerance_m", search.tolerance, 0.0, kFarthest);
  io("mark_button", search.mark_button);
}

void fields(auto& io, Is<scene::TargetSetup> auto& target) {
  io("layer", target.layer);
  io.list("forbidden", target.forbidden, model::kMaxTissueLayers);
}

/// Older recordings have uniform tissue and no organ motion.
void fields(auto& io, Is<scene::Scene> auto& scene) {
  io("name", scene.name);
  io("task", scene.task);
  io("rate_Hz", scene.rate_Hz, scene::kSlowestRate, scene::kFastestRate);
  io("seed", scene.seed);
  io.nested("organ", [&scene](auto& organ) {
    organ("name", scene.organ_name);
    if (organ.there("frame", scene.organ_frame != scene::OrganFrame::kRas)) organ("frame", scene.organ_frame);
    organ("pose", scene.organ_pose);
    organ.list("motion", scene.organ_motion, model::kMaxOrganMotions);
    if (organ.there("inclusions", !scene.inclusions.empty())) {
      organ.list("inclusions", scene.inclusions, model::kMaxInclusions);
    }
    if (organ.there("support", scene.support.has_value())) organ("support", scene.support);
    if (organ.there("stiffness", !scene.stiffness.empty())) {
      organ.list("stiffness", scene.stiffness, model::kMaxStiffnessPoints);
    }
  });
  io("tissue", scene.tissue);
  if (scene.task == scene::Task::kPalpate) io("search", scene.search);
  if (scene.task == scene::Task::kInsert && io.has("target")) io("target", scene.target);
  io.list("tools", scene.tools, kMaxHands);
  io.list("devices", scene.devices, kMaxHands);
  io("noise", scene.noise);
  io("safety", scene.safety);
  io.list("repairs", scene.repairs);
  io.list("remarks", scene.remarks);
}

}  // namespace

std::string scene_to_json(const scene::Scene& scene) {
  SceneWriter io;
  fields(io, scene);
  // File names need not be UTF-8; invalid bytes become the replacement character.
  return io.json.dump(2, ' ', false, Json::error_handler_t::replace);
}

scene::Scene scene_from_json(const std::string& text) {
  try {
    const nlohmann::json json = parse_json(text);
    SceneReader io{JsonField(json)};
    scene::Scene scene;
    fields(io, scene);
    for (scene::DeviceSetup& device : scene.devices) {
      const scene::DeviceKind* kind = scene::find_device_kind(device.kind);
      if (kind != nullptr && kind->path == scene::DevicePath::kLibrary)
        device.path.clear();  // see scene_json.h
    }
    return scene;
  } catch (const InputError& error) {
    throw InputError("scene: " + one_line(error.what()));
  }
}

}  // namespace palpate::record
