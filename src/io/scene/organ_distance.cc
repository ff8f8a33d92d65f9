#include "io/scene/organ_distance.h"

#include <mutex>
#include <optional>

namespace palpate::scene {

struct OrganDistance::Built {
  std::mutex mutex;
  std::optional<geometry::SignedDistance> distance;
};

OrganDistance::OrganDistance() : built_(std::make_shared<Built>()) {}

geometry::SignedDistance organ_distance_of(const Scene& scene) {
  OrganDistance::Built& built = scene.organ_distance.built();
  const std::lock_guard lock(built.mutex);
  if (!built.distance || !built.distance->is_of(scene.organ)) built.distance.emplace(scene.organ);
  return *built.distance;
}

}  // namespace palpate::scene
