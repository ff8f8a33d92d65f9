#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/base/portable_math.h"
#include "io/scene/toml_reader.h"
#include "palpate/organ_motion.h"

namespace palpate::scene {

inline constexpr double kRadiansPerDegree = portable::kPi / 180.0;

/// [setup] Reads [organ.motion], one table or several ([[organ.motion]]). Missing keys get the defaults of
/// the kind; a table of kind "none" is ignored. @throws InputError as TomlTable.
[[nodiscard]] std::vector<model::OrganMotionParameters> read_organ_motions(const TomlTable& organ);

/// [setup] The motions of the flag `--organ-motion`, one word per flag (breathing, heartbeat or none), with
/// their defaults. @throws InputError naming the flag and the word.
[[nodiscard]] std::vector<model::OrganMotionParameters> organ_motions_by_flags(
    std::span<const std::string> flags);

}  // namespace palpate::scene
