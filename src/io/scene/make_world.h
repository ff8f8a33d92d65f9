#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/haptics/simulation.h"
#include "palpate/parameter_updates.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] Builds the world of a tick from a loaded scene. @param how as for contact::World @throws
/// InputError, ParameterError.
[[nodiscard]] haptics::SimulationWorld make_world(const Scene& scene, const contact::Preparation& how = {});

/// [setup] Adapts the scene to the abilities of its opened devices (DeviceSetup::abilities): the limits of
/// force and torque, and the force scale where DeviceSetup::fit is set. Changes the setup, which a recording
/// stores, and its world. @return a sentence for each change
[[nodiscard]] std::vector<std::string> apply_device_abilities(Scene& scene, haptics::SimulationWorld& world);

/// [setup] The organ's motion; it rotates about the centre of its bounding box. @throws ParameterError.
[[nodiscard]] model::OrganMotion organ_motion_of(const Scene& scene);

/// [setup] Warnings of the stability check (haptics/stability.h) for all held devices: the condition that
/// fails, or that the device's mechanics are unknown. Empty: no warning. @throws ParameterError.
[[nodiscard]] std::vector<std::string> stability_remarks(const Scene& scene,
                                                         const haptics::SimulationWorld& world);

/// [setup] stability_remarks() of this scene with another tissue and other inclusions.
[[nodiscard]] std::vector<std::string> stability_remarks(const Scene& scene,
                                                         const haptics::SimulationWorld& world,
                                                         const model::TissueParameters& tissue,
                                                         const std::vector<model::Inclusion>& inclusions);

/// [setup] Warns that the force may be wrong for each hand whose tool tip has more than twice, or less than
/// half, the radius of the indenter that the tissue was fitted with. F(D) does not depend on the tool's size.
[[nodiscard]] std::vector<std::string> radius_remarks(const Scene& scene,
                                                      const haptics::SimulationWorld& world);

/// [setup] A remark for each two visible inclusions that overlap. Hidden ones are not named.
[[nodiscard]] std::vector<std::string> overlap_remarks(const Scene& scene);

/// [setup] The object that gives updates of tissue and noise to a run of this scene; it warns like
/// stability_remarks(). @param scene, world must outlive it
[[nodiscard]] std::unique_ptr<haptics::ParameterUpdates> make_parameter_updates(
    const Scene& scene, const haptics::SimulationWorld& world);

}  // namespace palpate::scene
