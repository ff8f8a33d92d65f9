#pragma once
#include <string>

#include <Eigen/Core>

namespace palpate::render {

/// The colours and the surface of a tissue; colours linear, 0..1.
struct TissueLook {
  Eigen::Vector3f base;       // most of it
  Eigen::Vector3f mottle;     // patches
  Eigen::Vector3f vessel;     // lines
  Eigen::Vector3f fat;        // pads
  float vessel_share = 0.0F;  // 0 none .. 1 strong
  float fat_share = 0.0F;
  float mottle_per_m = 150.0F;  // patches a metre
  float vessel_per_m = 45.0F;
};

/// [setup] The look of a tissue by its name (gallbladder, heart, liver, kidney); any other name: pink tissue.
[[nodiscard]] TissueLook tissue_look(const std::string& tissue_name);

}  // namespace palpate::render
