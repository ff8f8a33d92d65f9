#pragma once
// Inclusions and stiffness maps as arguments of Python calls.
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "io/scene/stiffness_map_reader.h"
#include "io/scene/variation_reader.h"
#include "palpate/parameter_updates.h"
#include "palpate/scene.h"

#include "bindings/python/binding.h"

namespace palpate::python {

/// Inclusion argument: an object, or the name of a preset.
using InclusionArgument = std::variant<scene::InclusionTable, std::string>;

/// Stiffness map argument: a CSV or PLY file, or an array with the columns x, y, z [m] and factor.
using StiffnessArgument = std::variant<std::filesystem::path, Numbers>;

/// [setup] The preset of this name. @throws InputError that lists the presets
[[nodiscard]] scene::InclusionTable inclusion_preset(const std::string& name);

/// [setup] Replaces the inclusions of a loaded scene. @throws InputError for an inclusion that is not inside
/// the organ, ParameterError for an invalid number
void set_inclusions(const std::vector<InclusionArgument>& arguments, scene::Scene& scene);

/// [setup] Points of a stiffness map. @throws InputError, ParameterError for an invalid factor
[[nodiscard]] scene::StiffnessMapFile stiffness_of(const StiffnessArgument& argument);

/// [setup] The inclusions of a scene with the numbers of a run.
[[nodiscard]] std::vector<scene::InclusionTable> inclusion_tables(const scene::Scene& scene,
                                                                  const std::vector<model::Inclusion>& now);

/// [setup] The number of an inclusion, from 0, by its name or number. @throws InputError that lists the names
[[nodiscard]] std::size_t inclusion_index(const scene::Scene& scene,
                                          const std::variant<std::size_t, std::string>& which);

/// [setup] The update that moves an inclusion and sets its ratio; values that are not given stay.
/// @throws ParameterError for a ratio out of range
[[nodiscard]] haptics::LiveInclusion live_inclusion(std::size_t index, const model::Inclusion& now,
                                                    const std::optional<Numbers>& position,
                                                    std::optional<double> ratio);

/// A position argument. @throws InputError that names it when it does not have three finite numbers
[[nodiscard]] Vec3 position_of(const Numbers& numbers, const char* name);

}  // namespace palpate::python
