#include "app/window/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/rotation.h"

namespace palpate::app {
namespace {

constexpr double kHighest = 1.48;  // rad: 85 degrees
constexpr double kNearest = 0.02;  // m
constexpr double kFarthest = 3.0;  // m
constexpr double kUsualAspect = 4.0 / 3.0;

}  // namespace

void OrbitCamera::look(const render::Camera& camera, const Quat& world_P) {
  world_P_ = world_P;
  const Vec3 way = world_P_.conjugate() * Vec3(camera.eye - camera.target);
  target_ = camera.target;
  distance_ = std::clamp(way.norm(), kNearest, kFarthest);
  azimuth_ = std::atan2(way.y(), way.x());
  elevation_ = std::clamp(std::asin(std::clamp(way.z() / way.norm(), -1.0, 1.0)), -kHighest, kHighest);
  vertical_view_deg_ = camera.vertical_view_deg;
}

void OrbitCamera::look_as(const render::Camera& camera, double aspect) {
  exact_.reset();
  look(camera, Quat::Identity());
  distance_ =
      std::clamp(distance_ * std::max(1.0, kUsualAspect / std::max(0.1, aspect)), kNearest, kFarthest);
}

void OrbitCamera::look_exactly_as(const render::Camera& camera) {
  look(camera, rotation_between(Vec3::UnitZ(), camera.up));
  exact_ = camera;
}

void OrbitCamera::orbit(double right, double up) {
  exact_.reset();
  azimuth_ = std::remainder(azimuth_ - right, 2.0 * std::numbers::pi);
  elevation_ = std::clamp(elevation_ + up, -kHighest, kHighest);
}

void OrbitCamera::pan(double right_share, double up_share) {
  exact_.reset();
  target_ -= height_at_target() * (right_share * right() + up_share * up());
}

void OrbitCamera::zoom(double factor) {
  exact_.reset();
  distance_ = std::clamp(distance_ * factor, kNearest, kFarthest);
}

Vec3 OrbitCamera::to_eye() const {
  return world_P_ * Vec3(std::cos(elevation_) * std::cos(azimuth_), std::cos(elevation_) * std::sin(azimuth_),
                         std::sin(elevation_));
}

Vec3 OrbitCamera::right() const { return world_P_ * Vec3(-std::sin(azimuth_), std::cos(azimuth_), 0.0); }

Vec3 OrbitCamera::up() const { return to_eye().cross(right()); }

double OrbitCamera::height_at_target() const {
  return 2.0 * distance_ * std::tan(0.5 * vertical_view_deg_ * std::numbers::pi / 180.0);
}

render::Camera OrbitCamera::camera() const {
  if (exact_) return *exact_;
  return {target_ + distance_ * to_eye(), target_, world_P_ * Vec3::UnitZ(), vertical_view_deg_};
}

ToolPlane plane_across(const Vec3& axis_W, const OrbitCamera& camera) {
  const auto flat = [&axis_W](const Vec3& v) { return Vec3(v - v.dot(axis_W) * axis_W); };
  Vec3 right = flat(camera.right());
  if (right.norm() < 0.2) right = flat(camera.up());
  right.normalize();
  Vec3 away = flat(camera.up());
  if (away.norm() < 0.2) away = flat(camera.up().cross(camera.right()));
  away -= away.dot(right) * right;
  return {right, away.normalized()};
}

geometry::Ray ray_through(const render::Camera& camera, double aspect, double x, double y) {
  const Vec3 back = (camera.eye - camera.target).normalized();
  const Vec3 right = camera.up.cross(back).normalized();
  const double half = std::tan(0.5 * camera.vertical_view_deg * std::numbers::pi / 180.0);
  const Vec3 direction =
      (2.0 * x - 1.0) * aspect * half * right + (1.0 - 2.0 * y) * half * back.cross(right) - back;
  return {camera.eye, direction.normalized()};
}

std::optional<PicturePlace> place_of(const Vec3& point_W, const render::Camera& camera, double aspect) {
  const Vec3 back = (camera.eye - camera.target).normalized();
  const Vec3 right = camera.up.cross(back).normalized();
  const double half = std::tan(0.5 * camera.vertical_view_deg * std::numbers::pi / 180.0);
  const Vec3 way = point_W - camera.eye;
  const double far = -way.dot(back);
  if (far < 1e-3) return std::nullopt;
  const double unit = 1.0 / (2.0 * half * far);
  return PicturePlace{0.5 + unit * way.dot(right) / aspect, 0.5 - unit * way.dot(back.cross(right))};
}

render::Camera tilted(render::Camera from_above) {
  constexpr double kTilt = 0.61;  // rad
  const double distance = (from_above.eye - from_above.target).norm();
  from_above.eye = from_above.target + distance * Vec3(0.0, -std::sin(kTilt), std::cos(kTilt));
  from_above.up = Vec3::UnitZ();
  return from_above;
}

}  // namespace palpate::app
