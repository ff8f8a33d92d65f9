#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/haptics/simulation.h"
#include "palpate/live_changes.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] Builds what a tick needs from a resolved scene. @param how as for contact::World.
/// @throws InputError, ParameterError.
[[nodiscard]] haptics::SimulationWorld make_world(const Setup& setup, const contact::Preparation& how = {});

/// [setup] Lets a scene follow what its devices bear (DeviceSetup::abilities, of devices that are open): the
/// limits of force and torque and, where DeviceSetup::fit is set, the scale of the force; in the setup, which
/// is what a recording keeps, and in its world. @return what was changed, in words
[[nodiscard]] std::vector<std::string> follow_devices(Setup& setup, haptics::SimulationWorld& world);

/// [setup] The organ's motion, with rotations about the middle of its bounding box. @throws ParameterError.
[[nodiscard]] model::OrganMotion organ_motion_of(const Setup& setup);

/// [setup] What the stability check (haptics/stability.h) says of every held device of a scene, in words:
/// what is short, or that the device's mechanics are not known. Empty: nothing to say. @throws
/// ParameterError.
[[nodiscard]] std::vector<std::string> stability_remarks(const Setup& setup);

/// [setup] The same of another tissue in this scene.
[[nodiscard]] std::vector<std::string> stability_remarks(const Setup& setup,
                                                         const model::TissueParameters& tissue);

/// [setup] Of each hand whose tool's tip is more than twofold larger or smaller than the indenter that the
/// tissue was fitted with: that the force may be wrong, in words. F(D) knows nothing of the tool's size.
[[nodiscard]] std::vector<std::string> radius_remarks(const Setup& setup,
                                                      const haptics::SimulationWorld& world);

/// [setup] What hands changes of tissue and noise to a run of this scene, warning as stability_remarks()
/// does. @param setup, world outlive it
[[nodiscard]] std::unique_ptr<haptics::LiveChanges> live_changes(const Setup& setup,
                                                                 const haptics::SimulationWorld& world);

}  // namespace palpate::scene
