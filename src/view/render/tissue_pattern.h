#pragma once
#include <string>
#include <vector>

#include <Eigen/Core>

#include "palpate/mesh.h"
#include "view/render/gl_objects.h"

namespace palpate::render {

/// Colours and surface appearance of a tissue; linear colours, 0..1.
struct TissueAppearance {
  Eigen::Vector3f base;       // main colour
  Eigen::Vector3f mottle;     // colour of patches
  Eigen::Vector3f vessel;     // colour of vessels
  Eigen::Vector3f fat;        // colour of fat
  float vessel_share = 0.0F;  // vessels: 0 none .. 1 strong
  float fat_share = 0.0F;
  float mottle_per_m = 150.0F;  // patches per metre
  float vessel_per_m = 45.0F;
};

/// [setup] Appearance by tissue name (gallbladder, heart, liver, kidney); any other name: pink tissue.
[[nodiscard]] TissueAppearance tissue_appearance(const std::string& tissue_name);

/// [any] Smooth noise at a point, -1 to 1, and its gradient; equal to noise() in the shaders.
struct NoiseValue {
  float value = 0.0F;
  Eigen::Vector3f gradient = Eigen::Vector3f::Zero();
};
[[nodiscard]] NoiseValue smooth_noise(const Eigen::Vector3f& p);

/// [setup] Static attributes of an organ's vertices: colours of its tissue, position in the pattern of
/// vessels, and visible fraction of the sky (sky_visibility).
[[nodiscard]] std::vector<StaticVertex> tissue_pattern(const geometry::TriangleMesh& rest,
                                                       const TissueAppearance& look);

/// [setup] Visible fraction of the sky for each vertex of `mesh`, 0 to 1: the part of the hemisphere above it
/// that `blocker` does not hide, weighted by the cosine to its normal. Computed from depth maps of the
/// blocker from many directions; linear in the size of both meshes.
[[nodiscard]] std::vector<float> sky_visibility(const geometry::TriangleMesh& mesh,
                                                const geometry::TriangleMesh& blocker);

}  // namespace palpate::render
