#pragma once
#include "core/geometry/signed_distance.h"
#include "palpate/scene.h"

namespace palpate::scene {

/// [setup] From any thread. The signed distance of the scene's organ, built at the first call and again when
/// the organ is another mesh than at the last call. @throws InputError when the mesh is not closed.
[[nodiscard]] geometry::SignedDistance organ_distance_of(const Scene& scene);

/// [setup] A depth below the organ's surface [m]: more than `enough` where a point of it is that deep, else
/// that of its deepest point, within 5 % and 0.25 mm. @throws InputError as organ_distance_of()
[[nodiscard]] double deepest_point(const Scene& scene, double enough);

}  // namespace palpate::scene
