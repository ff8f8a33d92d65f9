// The signed distance of a scene's organ, shared by everything that a session prepares.
#include <mutex>
#include <optional>

#include "core/geometry/signed_distance.h"
#include "palpate/scene.h"

namespace palpate::scene {

struct OrganDistance::Built {
  std::mutex mutex;
  std::optional<geometry::SignedDistance> distance;
};

OrganDistance::OrganDistance() : built_(std::make_shared<Built>()) {}

geometry::SignedDistance OrganDistance::of(const geometry::TriangleMesh& organ) const {
  const std::lock_guard lock(built_->mutex);
  if (!built_->distance || !built_->distance->is_of(organ)) built_->distance.emplace(organ);
  return *built_->distance;
}

}  // namespace palpate::scene
