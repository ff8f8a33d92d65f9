#pragma once
#include <vector>

#include "palpate/mesh.h"
#include "view/render/gl_objects.h"
#include "view/render/tissue_look.h"

namespace palpate::render {

/// [any] Smooth noise of a point, -1 to 1: the value and the gradient that the shaders' noise() has, too.
struct NoiseValue {
  float value = 0.0F;
  Eigen::Vector3f gradient = Eigen::Vector3f::Zero();
};
[[nodiscard]] NoiseValue smooth_noise(const Eigen::Vector3f& p);

/// [setup] What does not change of an organ's vertices: the colours of its tissue that vary over millimetres,
/// where its vessels run, and how much of the sky each vertex sees
/// (sky_in_sight).
[[nodiscard]] std::vector<StillVertex> tissue_pattern(const geometry::TriangleMesh& rest,
                                                      const TissueLook& look);

/// [setup] For each vertex of `mesh` the share of the hemisphere over it that `blocker` does not hide, 0 to
/// 1, weighted by the cosine to its normal: by depth maps of the blocker from many sides. Linear in both
/// sizes.
[[nodiscard]] std::vector<float> sky_in_sight(const geometry::TriangleMesh& mesh,
                                              const geometry::TriangleMesh& blocker);

}  // namespace palpate::render
