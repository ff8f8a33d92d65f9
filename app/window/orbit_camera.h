#pragma once
#include <optional>

#include "core/geometry/ray.h"
#include "palpate/offscreen.h"

namespace palpate::app {

/// Upright camera that orbits a target point. All members: [any], one thread.
class OrbitCamera final {
 public:
  /// Takes the view of another camera, except that up is always z.
  /// @param aspect width over height of the picture; for a narrow picture the camera moves back
  void look_as(const render::Camera& camera, double aspect);
  /// Takes the view of another camera with its up direction. Until it is moved, camera() returns that camera
  /// bit for bit.
  void look_exactly_as(const render::Camera& camera);

  /// Orbits the target by these angles [rad], to the right and upwards. The eye stays off the poles.
  void orbit(double right, double up);
  /// Moves target and eye in the picture's plane by fractions of the picture's height.
  void pan(double right, double up);
  /// Multiplies the distance to the target, within 20 mm to 3 m; a factor below 1 zooms in.
  void zoom(double factor);

  [[nodiscard]] render::Camera camera() const;
  /// Unit vectors of the picture to the right and upwards, in the world frame.
  [[nodiscard]] Vec3 right() const;
  [[nodiscard]] Vec3 up() const;
  /// Height of the visible area at the target's distance [m].
  [[nodiscard]] double height_at_target() const;

 private:
  [[nodiscard]] Vec3 to_eye() const;
  void look(const render::Camera& camera, const Quat& world_P);

  Quat world_P_ = Quat::Identity();  // world frame from the pole frame, whose z axis is up
  std::optional<render::Camera> exact_;
  Vec3 target_ = Vec3::Zero();
  double azimuth_ = -1.2;  // rad
  double elevation_ = 0.5;
  double distance_ = 0.3;  // m
  double vertical_view_deg_ = 28.0;
};

/// The plane across a tool's axis: the camera's right and up in it, as unit vectors in the world frame. A
/// pointer moves a tool in it.
struct ToolPlane {
  Vec3 right;
  Vec3 away;
};
/// [any] @param axis_W unit vector
[[nodiscard]] ToolPlane plane_across(const Vec3& axis_W, const OrbitCamera& camera);

/// [any] The line of sight through a point of the picture. @param aspect width over height of the picture
/// @param x, y 0 to 1 from the picture's upper left corner
[[nodiscard]] geometry::Ray ray_through(const render::Camera& camera, double aspect, double x, double y);

/// A place of a picture: 0 to 1 from its upper left corner.
struct PicturePlace {
  double x = 0.0;
  double y = 0.0;
};
/// [any] Where a point is in the picture, the inverse of ray_through(); nothing: it is behind the camera.
[[nodiscard]] std::optional<PicturePlace> place_of(const Vec3& point_W, const render::Camera& camera,
                                                   double aspect);

/// [any] The view from above, tilted by 35 degrees so that depth is seen; y stays upwards.
[[nodiscard]] render::Camera tilted(render::Camera from_above);

}  // namespace palpate::app
