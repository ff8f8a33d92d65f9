#include "app/window/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::app {
namespace {

constexpr double kHighest = 1.48;  // rad: 85 degrees
constexpr double kNearest = 0.02;  // m
constexpr double kFarthest = 3.0;  // m
constexpr double kUsualAspect = 4.0 / 3.0;

}  // namespace

void OrbitCamera::look_as(const render::Camera& camera, double aspect) {
  const Vec3 way = camera.eye - camera.target;
  target_ = camera.target;
  distance_ =
      std::clamp(way.norm() * std::max(1.0, kUsualAspect / std::max(0.1, aspect)), kNearest, kFarthest);
  azimuth_ = std::atan2(way.y(), way.x());
  elevation_ = std::clamp(std::asin(std::clamp(way.z() / way.norm(), -1.0, 1.0)), -kHighest, kHighest);
  vertical_view_deg_ = camera.vertical_view_deg;
}

void OrbitCamera::orbit(double right, double up) {
  azimuth_ = std::remainder(azimuth_ - right, 2.0 * std::numbers::pi);
  elevation_ = std::clamp(elevation_ + up, -kHighest, kHighest);
}

void OrbitCamera::pan(double right_share, double up_share) {
  target_ -= height_at_target() * (right_share * right() + up_share * up());
}

void OrbitCamera::zoom(double factor) { distance_ = std::clamp(distance_ * factor, kNearest, kFarthest); }

Vec3 OrbitCamera::to_eye() const {
  return {std::cos(elevation_) * std::cos(azimuth_), std::cos(elevation_) * std::sin(azimuth_),
          std::sin(elevation_)};
}

Vec3 OrbitCamera::right() const { return {-std::sin(azimuth_), std::cos(azimuth_), 0.0}; }

Vec3 OrbitCamera::up() const { return to_eye().cross(right()); }

double OrbitCamera::height_at_target() const {
  return 2.0 * distance_ * std::tan(0.5 * vertical_view_deg_ * std::numbers::pi / 180.0);
}

render::Camera OrbitCamera::camera() const {
  return {target_ + distance_ * to_eye(), target_, Vec3::UnitZ(), vertical_view_deg_};
}

}  // namespace palpate::app
