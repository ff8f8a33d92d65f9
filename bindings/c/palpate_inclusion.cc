// Functions of palpate.h for the inclusions of a simulation.
#include <cstddef>
#include <cstdint>

#include "palpate/inclusion.h"
#include "palpate/parameter_updates.h"

#include "bindings/c/errors.h"
#include "bindings/c/float_environment.h"
#include "bindings/c/simulation.h"
#include "bindings/c/struct_size.h"

using palpate::c_interface::give;
using palpate::c_interface::guarded;
using palpate::c_interface::require_given;
using palpate::c_interface::require_size;
using palpate::c_interface::require_usable;
using palpate::c_interface::taken;
using palpate::c_interface::UseError;

namespace {

void require_inclusion(const palpate_simulation& simulation, std::size_t index) {
  if (index >= simulation.scene().inclusions.size()) {
    throw UseError("index: must be less than palpate_inclusion_count()");
  }
}

/// An inclusion of the scene at the last change.
palpate_inclusion inclusion_now(const palpate_simulation& simulation, std::size_t index) {
  const palpate::scene::InclusionSetup& of_scene = simulation.scene().inclusions[index];
  const palpate::model::Inclusion now = simulation.updates().inclusions()[index];
  palpate_inclusion found{};
  for (int axis = 0; axis < 3; ++axis) found.position[axis] = now.centre_S[axis];
  found.radius = now.radius;
  found.stiffness_ratio = now.ratio;
  found.name = of_scene.name.c_str();
  found.visible = of_scene.visible ? 1 : 0;
  return found;
}

}  // namespace

extern "C" {

size_t palpate_inclusion_count(const palpate_simulation* simulation) {
  return simulation == nullptr ? 0 : simulation->scene().inclusions.size();
}

palpate_status palpate_get_inclusion(const palpate_simulation* simulation, size_t index,
                                     palpate_inclusion* inclusion) {
  return guarded([&] {
    require_usable(simulation);
    require_given(inclusion, "inclusion");
    require_size(*inclusion, "palpate_inclusion");
    require_inclusion(*simulation, index);
    give(inclusion_now(*simulation, index), inclusion);
  });
}

palpate_status palpate_set_inclusion(palpate_simulation* simulation, size_t index,
                                     const palpate_inclusion* inclusion) {
  return guarded([&] {
    require_usable(simulation);
    require_given(inclusion, "inclusion");
    require_size(*inclusion, "palpate_inclusion");
    require_inclusion(*simulation, index);
    const palpate::c_interface::DefaultFloatEnvironment environment;
    const palpate_inclusion wanted = taken(inclusion, inclusion_now(*simulation, index));
    const double* position = wanted.position;
    (void)simulation->updates().offer(palpate::haptics::LiveInclusion{
        static_cast<std::uint32_t>(index), {position[0], position[1], position[2]}, wanted.stiffness_ratio});
  });
}

}  // extern "C"
