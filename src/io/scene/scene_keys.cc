#include "io/scene/scene_keys.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/model/tissue_fields.h"

namespace palpate::scene {
namespace {

constexpr const char* kFlag = "--set";
constexpr std::string_view kTissue = "tissue.";

std::vector<SceneKey> make_keys() {
  using enum KeyType;
  constexpr Range kLoopRate{kSlowestRate, kFastestRate};
  constexpr Range kFactor{model::kSmallestFactor, model::kLargestFactor};
  constexpr Range kTime{0.0, 1e6};  // s: eleven days
  const auto up_to = [](double most) { return Range{0.0, most, true}; };
  constexpr double kPerMillisecond = 1000.0;  // slew rates are given per millisecond
  std::vector<SceneKey> keys = {
      {"scene.name", kText},
      {"scene.task", kText},
      {"scene.rate_Hz", kNumber, kLoopRate},
      {"scene.seed", kWhole},
      {"organ.mesh", kText},
      {"organ.unit", kText},
      {"organ.frame", kText},
      {"organ.tissue", kText},
      {"organ.motion.kind", kText},
      {"organ.motion.amplitude_mm", kNumber},
      {"organ.motion.rotation_deg", kNumber},
      {"organ.motion.period_s", kNumber},
      {"organ.motion.phase", kNumber},
      {"organ.inclusion.name", kText},
      {"organ.inclusion.preset", kText},
      {"organ.inclusion.radius_mm", kNumber},
      {"organ.inclusion.stiffness_ratio", kNumber},
      {"organ.inclusion.depth_mm", kNumber, up_to(1000.0)},
      {"organ.inclusion.visible", kTruth},
      {"organ.inclusion.pulse_mm", kNumber},
      {"organ.inclusion.pulse_period_s", kNumber},
      {"organ.support.bed.share", kNumber, up_to(geometry::kLargestBedShare)},
      {"organ.support.attachment.radius_mm", kNumber, {0.5, 200.0}},
      {"organ.support.painted", kText},
      {"organ.stiffness.map", kText},
      {"organ.stiffness.factor_at_black", kNumber, kFactor},
      {"organ.stiffness.factor_at_white", kNumber, kFactor},
      {"tool.mesh", kText},
      {"tool.unit", kText},
      {"tool.tip_radius_mm", kNumber, up_to(1000.0)},
      {"tool.needle.diameter_mm", kNumber, {0.1, 10.0}},
      {"tool.needle.length_mm", kNumber, {10.0, 300.0}},
      {"tool.jaw.mesh", kText},
      {"tool.jaw.open_deg", kNumber, {-180.0, 180.0}},
      {"search.lumps", kWhole},
      {"search.preset", kText},
      {"search.radius_mm", kNumber},
      {"search.stiffness_ratio", kNumber},
      {"search.depth_mm", kNumber, up_to(1000.0)},
      {"search.tolerance_mm", kNumber, {1.0, 100.0}},
      {"search.mark_button", kWhole},
      {"target.layer", kText},
      {"path.speed", kNumber, {0.01, 100.0}},
      {"device.kind", kText},
      {"device.path", kText},
      {"device.interpolation", kText},
      {"device.workspace_scale", kNumber, up_to(1000.0)},
      {"device.damping_N_s_per_m", kNumber, kNotNegative},
      {"device.friction_N", kNumber, kNotNegative},
      {"device.resolution_mm", kNumber, kNotNegative},
      {"device.clutch_button", kWhole},
      {"device.fit", kTruth},
      {"device.mass_kg", kNumber, {1e-3, 100.0}},
      {"device.grip", kText},
      {"device.grip_N_per_m", kNumber, {0.0, 1e5}},
      {"device.grip_N_s_per_m", kNumber, {0.0, 1e3}},
      {"device.fault.kind", kText},
      {"device.fault.time_s", kNumber, kTime},
      {"device.fault.duration_s", kNumber, kTime},
      {"device.fault.age_ms", kNumber, up_to(kLongestFaultAge * kPerMillisecond)},
      {"noise.enabled", kTruth},
      {"noise.gain_N_m", kNumber},
      {"noise.threshold_mm", kNumber, kPositive},
      {"noise.rate_Hz", kNumber, {1e-3, kFastestRate}},
      {"noise.user_threshold_N", kNumber},
      {"noise.share_of_threshold", kNumber},
      {"safety.max_force_N", kNumber, up_to(SafetySetup::kMaxForce)},
      {"safety.max_slew_N_per_ms", kNumber, up_to(SafetySetup::kMaxSlew / kPerMillisecond)},
      {"safety.max_torque_N_m", kNumber, up_to(SafetySetup::kMaxTorque)},
      {"safety.max_slew_N_m_per_ms", kNumber, up_to(SafetySetup::kMaxTorqueSlew / kPerMillisecond)},
      {"tissue.law", kText},
  };
  for (const model::TissueField& field : model::kTissueFields) {
    keys.push_back({std::string(kTissue) + field.path(), kNumber, {}, &field});
  }
  return keys;
}

std::string_view last_part(std::string_view path) { return path.substr(path.rfind('.') + 1); }

/// Whether `path` is `text` followed by a unit.
bool is_without_unit(std::string_view text, std::string_view path) {
  constexpr std::string_view kUnits[] = {"mm", "deg", "kg",      "s",         "ms",       "us",        "Hz",
                                         "N",  "N_m", "N_per_m", "N_s_per_m", "N_per_ms", "N_m_per_ms"};
  return path.size() > text.size() + 1 && path.starts_with(text) && path[text.size()] == '_' &&
         std::find(std::begin(kUnits), std::end(kUnits), path.substr(text.size() + 1)) != std::end(kUnits);
}

std::optional<std::int64_t> whole(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool all = error == std::errc() && end == text.data() + text.size();
  return all && value >= 0 ? std::optional(value) : std::nullopt;
}

void set_in(toml::node& node, std::string_view path, const SceneKey& key, const std::string& value) {
  if (auto* array = node.as_array()) {
    for (toml::node& entry : *array) set_in(entry, path, key, value);
    return;
  }
  toml::table* table = node.as_table();
  if (table == nullptr) return;  // its reader reports the error
  const std::size_t dot = path.find('.');
  if (dot != std::string_view::npos) {
    const std::string_view name = path.substr(0, dot);
    if (!table->contains(name)) table->insert(name, toml::table{});
    set_in(*table->get(name), path.substr(dot + 1), key, value);
    return;
  }
  switch (key.type) {
    case KeyType::kNumber:
      table->insert_or_assign(path, parse_number(value).value());
      break;
    case KeyType::kWhole:
      table->insert_or_assign(path, whole(value).value());
      break;
    case KeyType::kTruth:
      table->insert_or_assign(path, value == "true");
      break;
    case KeyType::kText:
      table->insert_or_assign(path, value);
      break;
  }
}

bool is_of_tissue(const Setting& setting) { return setting.key.starts_with(kTissue); }

}  // namespace

void SceneKey::check(const std::string& flag, const std::string& value) const {
  const auto require = [&](bool right, const std::string& want) {
    if (!right) throw InputError(fmt::format("{} {} = {}: must be {}", flag, path, value, want));
  };
  if (type == KeyType::kNumber) {
    const std::optional<double> number = parse_number(value);
    const bool finite = number && std::isfinite(*number);
    if (tissue != nullptr) {
      require(finite && tissue->range.contains(*number), tissue->range.to_string());
    } else {
      require(finite && range.contains(*number), range.to_string());
    }
  }
  if (type == KeyType::kWhole) require(whole(value).has_value(), "a whole number >= 0");
  if (type == KeyType::kTruth) require(value == "true" || value == "false", "true or false");
  if (type == KeyType::kText) require(!value.empty() && value == one_line(value), "a text, not empty");
}

const std::vector<SceneKey>& scene_keys() {
  static const std::vector<SceneKey> keys = make_keys();
  return keys;
}

const SceneKey& find_scene_key(const std::string& flag, const std::string& text) {
  std::vector<std::string> meant;
  std::vector<std::string> all;
  const SceneKey* found = nullptr;
  for (const SceneKey& key : scene_keys()) {
    if (key.path == text) return key;
    all.push_back(key.path);
    if (!is_without_unit(text, key.path)) continue;
    meant.push_back(key.path);
    found = &key;
  }
  if (meant.size() == 1) return *found;
  if (meant.empty()) {
    for (const std::string& path : all) {
      const std::string_view last = last_part(path);
      if (last == last_part(text) || is_without_unit(last_part(text), last)) meant.push_back(path);
    }
  }
  if (meant.empty()) meant = {nearest_word(text, all)};
  const std::string hint = meant.front().empty()
                               ? "; docs/file-formats.md lists the keys, e.g. tissue.k1 or path.speed"
                               : ", did you mean " + joined(meant, " or ") + "?";
  throw InputError(fmt::format("{} {}: a scene has no such key{}", flag, text, hint));
}

std::vector<std::string> keys_in(std::string_view path, std::initializer_list<const char*> others) {
  std::vector<std::string> names(others.begin(), others.end());
  for (const SceneKey& key : scene_keys()) {
    const std::string_view last = last_part(key.path);
    if (key.path.size() == path.size() + 1 + last.size() && key.path.starts_with(path))
      names.emplace_back(last);
  }
  return names;
}

std::optional<double> number_in(const TomlTable& table, std::string_view key) {
  return table.number(key, find_scene_key(table.field(key), table.field(key)).range);
}

void apply_to_scene(std::span<const Setting> settings, toml::table& root) {
  for (const Setting& setting : settings) {
    if (is_of_tissue(setting)) continue;
    const SceneKey& key = find_scene_key(kFlag, setting.key);
    key.check(kFlag, setting.value);
    set_in(root, key.path, key, setting.value);
  }
}

void apply_to_tissue(std::span<const Setting> settings, model::TissueParameters& tissue) {
  const std::string* law = nullptr;
  for (const Setting& setting : settings) {
    if (!is_of_tissue(setting)) continue;
    const SceneKey& key = find_scene_key(kFlag, setting.key);
    key.check(kFlag, setting.value);
    if (key.tissue == nullptr) {
      law = &setting.value;
    } else {
      key.tissue->at.set(tissue, *parse_number(setting.value) * key.tissue->unit.si);
    }
  }
  try {
    if (law != nullptr) tissue.law = model::parse_law(*law);
    model::validate(tissue);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{} {}{}", kFlag, kTissue, error.what()));
  }
}

}  // namespace palpate::scene
