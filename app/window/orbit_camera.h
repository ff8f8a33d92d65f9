#pragma once
#include <optional>

#include "palpate/offscreen.h"

namespace palpate::app {

/// A camera that goes round a point, upright. All members: [any], one thread.
class OrbitCamera final {
 public:
  /// What another camera sees, as far as a camera with z up can.
  /// @param aspect width over height of the picture: a narrow one is seen from farther away
  void look_as(const render::Camera& camera, double aspect);
  /// What another camera sees, its own up and all; until it is moved, camera() is that camera bit for bit.
  void look_exactly_as(const render::Camera& camera);

  /// Round the point [rad]: to the right, upwards. The eye stays off the poles.
  void orbit(double right, double up);
  /// Moves point and eye in the picture's plane, by shares of the picture's height.
  void pan(double right, double up);
  /// Nearer (factor < 1) or farther; from 20 mm to 3 m.
  void zoom(double factor);

  [[nodiscard]] render::Camera camera() const;
  /// In the picture: unit vectors to the right and upwards. World frame.
  [[nodiscard]] Vec3 right() const;
  [[nodiscard]] Vec3 up() const;
  /// Height of the picture at the point's distance [m].
  [[nodiscard]] double height_at_target() const;

 private:
  [[nodiscard]] Vec3 to_eye() const;
  void look(const render::Camera& camera, const Quat& world_P);

  Quat world_P_ = Quat::Identity();  // from the pole's frame, in which up is z
  std::optional<render::Camera> exact_;
  Vec3 target_ = Vec3::Zero();
  double azimuth_ = -1.2;  // rad
  double elevation_ = 0.5;
  double distance_ = 0.3;  // m
  double vertical_view_deg_ = 28.0;
};

}  // namespace palpate::app
