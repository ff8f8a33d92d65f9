#pragma once
#include <cstddef>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "net/live_protocol.h"
#include "palpate/scene.h"

// Inclusions in the live interface. Clients see only visible inclusions, so that a hidden lump stays to be
// found. All [any], not for the tick.
namespace palpate::net {

/// A visible inclusion with the keys of a scene file. @param index in the scene, from 0
[[nodiscard]] nlohmann::ordered_json inclusion_json(const scene::InclusionSetup& inclusion,
                                                    std::size_t index);

/// {"inclusions": the visible ones, "hidden_inclusions": the number of the others}.
[[nodiscard]] nlohmann::ordered_json inclusions_json(const std::vector<scene::InclusionSetup>& inclusions);

/// The index of the visible inclusion that a client selects. @throws LiveError that lists the visible ones
[[nodiscard]] std::size_t find_inclusion(const std::vector<scene::InclusionSetup>& inclusions,
                                         const InclusionEdit& edit);

/// Applies changes to an inclusion, without model::validate().
[[nodiscard]] scene::InclusionSetup edited(scene::InclusionSetup inclusion, const InclusionEdit& edit);

}  // namespace palpate::net
