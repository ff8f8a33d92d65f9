#include "io/scene/organ_distance.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <queue>

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

/// Branch and bound: a cube whose middle is d deep has no point deeper than d plus half of its diagonal.
double deepest_point(const Scene& scene, double enough) {
  constexpr double kShare = 1.05;
  constexpr double kError = 0.25e-3;  // m
  struct Cube {
    Vec3 middle;
    double half;
    double most;  // m, bound of the depth in it
    bool operator<(const Cube& other) const { return most < other.most; }
  };
  const geometry::SignedDistance surface = organ_distance_of(scene);
  const geometry::Bounds box = geometry::bounds(scene.organ);
  std::priority_queue<Cube> cubes;
  double best = 0.0;
  const auto add = [&](const Vec3& middle, double half) {
    const double depth = -surface.nearest(middle).distance;
    best = std::max(best, depth);
    cubes.push({middle, half, depth + std::sqrt(3.0) * half});
  };
  add(box.middle(), box.size().maxCoeff() / 2.0);
  while (best <= enough && cubes.top().most > std::min(enough, kShare * best) + kError) {
    const Cube cube = cubes.top();
    cubes.pop();
    const double half = cube.half / 2.0;
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner((i & 1) != 0 ? half : -half, (i & 2) != 0 ? half : -half,
                        (i & 4) != 0 ? half : -half);
      add(cube.middle + corner, half);
    }
  }
  return best;
}

}  // namespace palpate::scene
