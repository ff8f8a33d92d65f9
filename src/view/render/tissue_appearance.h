#pragma once
#include <string>

#include <Eigen/Core>

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

}  // namespace palpate::render
