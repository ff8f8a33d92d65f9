#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/base/portable_math.h"
#include "io/scene/toml_reader.h"
#include "palpate/organ_motion.h"

namespace palpate::scene {

inline constexpr double kRadiansPerDegree = portable::kPi / 180.0;

/// [setup] The motions of [organ.motion], one table or several ([[organ.motion]]); what is left out is the
/// kind's default, a table of kind "none" counts for nothing. @throws InputError as TomlTable: one line,
/// FILE:LINE: field = value: what would be right.
[[nodiscard]] std::vector<model::OrganMotionParameters> read_organ_motions(const TomlTable& organ);

/// [setup] The motions of `--organ-motion`, given once for each, with their defaults: breathing, heartbeat or
/// none. @throws InputError naming the flag and the word.
[[nodiscard]] std::vector<model::OrganMotionParameters> organ_motions_by_flags(
    std::span<const std::string> words);

}  // namespace palpate::scene
