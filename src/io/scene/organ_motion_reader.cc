#include "io/scene/organ_motion_reader.h"

#include <optional>

#include <fmt/core.h>

#include "io/scene/scene_keys.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

using model::OrganMotionKind;
using model::OrganMotionParameters;

constexpr Range kDirection{-1e6, 1e6};
constexpr const char* kKindWanted = "must be breathing, heartbeat or none";

/// Whether `word` is a kind of motion; "none" is valid and leaves `kind` empty.
bool is_kind(const std::string& flag, std::optional<OrganMotionKind>& kind) {
  kind.reset();
  if (flag == "none") return true;
  for (const OrganMotionKind known : {OrganMotionKind::kBreathing, OrganMotionKind::kHeartbeat}) {
    if (flag == model::to_string(known)) kind = known;
  }
  return kind.has_value();
}

void read_direction(const TomlTable& table, const char* key, Vec3& direction) {
  const std::optional<Vec3> given = table.vector(key, kDirection);
  if (!given) return;
  if (given->norm() < 1e-9) table.fail(key, "must be a direction, not zero");
  direction = given->normalized();
}

std::optional<OrganMotionParameters> read_one(const TomlTable& table) {
  table.allow_only(keys_in("organ.motion", {"direction", "axis"}));
  const std::optional<std::string> flag = table.text("kind");
  if (!flag) table.fail_missing("kind", kKindWanted);
  std::optional<OrganMotionKind> kind;
  if (!is_kind(*flag, kind)) table.fail("kind", kKindWanted);
  OrganMotionParameters motion =
      model::organ_motion_preset(kind.value_or(OrganMotionKind::kBreathing));  // "none": only checked
  if (const auto amplitude = table.number("amplitude_mm")) motion.amplitude = *amplitude * kMillimetre;
  if (const auto rotation = table.number("rotation_deg")) motion.rotation = *rotation * kRadiansPerDegree;
  motion.period = table.number("period_s").value_or(motion.period);
  motion.phase = table.number("phase").value_or(motion.phase);
  read_direction(table, "direction", motion.direction_W);
  read_direction(table, "axis", motion.axis_W);
  try {
    model::validate({&motion, 1});
  } catch (const ParameterError& error) {
    table.fail(error);
  }
  if (!kind) return std::nullopt;
  return motion;
}

}  // namespace

std::vector<OrganMotionParameters> read_organ_motions(const TomlTable& organ) {
  std::vector<OrganMotionParameters> motions;
  for (const TomlTable& table : organ.tables("motion")) {
    const std::optional<OrganMotionParameters> motion = read_one(table);
    if (!motion) continue;
    motions.push_back(*motion);
    try {
      model::validate(motions);
    } catch (const ParameterError& error) {
      table.fail(error);
    } catch (const InputError& error) {
      table.fail("kind", error.what());
    }
  }
  return motions;
}

std::vector<OrganMotionParameters> organ_motions_by_flags(std::span<const std::string> flags) {
  std::vector<OrganMotionParameters> motions;
  for (const std::string& flag : flags) {
    std::optional<OrganMotionKind> kind;
    if (!is_kind(flag, kind)) throw InputError(fmt::format("--organ-motion = \"{}\": {}", flag, kKindWanted));
    if (kind) motions.push_back(model::organ_motion_preset(*kind));
  }
  try {
    model::validate(motions);
  } catch (const InputError& error) {
    throw InputError(std::string("--organ-motion: ") + error.what());
  }
  return motions;
}

}  // namespace palpate::scene
