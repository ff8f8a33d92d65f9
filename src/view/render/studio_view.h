#pragma once
#include <Eigen/Core>

#include "palpate/offscreen.h"

namespace palpate::render {

/// What the light must cover: a box, and the ball around it. World frame.
struct LitRegion {
  Vec3 middle = Vec3::Zero();
  double radius = 0.1;                   // m, of the ball
  Quat rotation = Quat::Identity();      // of the box
  Vec3 half_size = Vec3(0.1, 0.1, 0.1);  // m, of the box

  bool operator==(const LitRegion&) const = default;
  /// [any] Half the box's extent [m] along a unit vector.
  [[nodiscard]] double extent(const Vec3& along) const {
    return (rotation.conjugate() * along).cwiseAbs().dot(half_size);
  }
};

/// Camera, lamps and matrices of one picture. World frame.
struct StudioView {
  /// [any] @param aspect width of the picture over its height
  StudioView(const Camera& camera, double aspect, const LitRegion& region);

  Vec3 eye, right, up, back;       // of the camera; unit vectors
  Vec3 key, fill, rim;             // unit vectors to the lamps, which are fixed to the camera
  double near_plane, far_plane;    // m before the camera
  double half_height, half_width;  // tangents of the half angles of view
  double height_at_target;         // m
  Eigen::Matrix4f projection;      // from the world to the picture's clip coordinates
  Eigen::Matrix4f light;           // from the world to the shadow map's clip coordinates
  double light_radius;             // m, half the width of the shadow map
  double light_depth;              // m, of the shadow map
};

}  // namespace palpate::render
