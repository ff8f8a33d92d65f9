#include "view/render/studio_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::render {
namespace {

constexpr double kNearShare = 0.02;  // near plane, as a fraction of the distance to the target
constexpr double kFarShare = 4.0;

Eigen::Matrix4f look_along(const Vec3& right, const Vec3& up, const Vec3& back, const Vec3& origin) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<1, 3>(0, 0) = right.transpose();
  m.block<1, 3>(1, 0) = up.transpose();
  m.block<1, 3>(2, 0) = back.transpose();
  m.block<3, 1>(0, 3) = -m.block<3, 3>(0, 0) * origin;
  return m.cast<float>();
}

}  // namespace

StudioView::StudioView(const Camera& camera, double aspect, const LitRegion& region) {
  eye = camera.eye;
  const double distance = (camera.eye - camera.target).norm();
  back = (camera.eye - camera.target).normalized();
  right = camera.up.cross(back).normalized();
  up = back.cross(right);
  key = (-0.62 * right + 0.70 * up + 0.36 * back).normalized();
  fill = (0.75 * right + 0.10 * up + 0.65 * back).normalized();
  rim = (0.45 * right + 0.45 * up - 0.77 * back).normalized();
  near_plane = kNearShare * distance;
  far_plane = kFarShare * distance;
  half_height = std::tan(0.5 * camera.vertical_view_deg * std::numbers::pi / 180.0);
  half_width = aspect * half_height;
  height_at_target = 2.0 * distance * half_height;
  Eigen::Matrix4f lens = Eigen::Matrix4f::Zero();
  lens(0, 0) = static_cast<float>(1.0 / half_width);
  lens(1, 1) = static_cast<float>(1.0 / half_height);
  lens(2, 2) = static_cast<float>(-(far_plane + near_plane) / (far_plane - near_plane));
  lens(2, 3) = static_cast<float>(-2.0 * far_plane * near_plane / (far_plane - near_plane));
  lens(3, 2) = -1.0F;
  projection = lens * look_along(right, up, back, eye);

  // The shadow map covers what is both visible and lit.
  const Vec3 light_right = up.cross(key).normalized();
  const Vec3 light_up = key.cross(light_right);
  const double lit = std::max(region.extent(light_right), region.extent(light_up));
  light_radius = std::min(lit, 1.1 * distance * std::hypot(half_height, half_width));
  light_depth = 4.0 * region.radius;
  const Vec3 middle = light_radius < lit ? camera.target : region.middle;
  Eigen::Matrix4f box = Eigen::Matrix4f::Identity();
  box(0, 0) = box(1, 1) = static_cast<float>(1.0 / light_radius);
  box(2, 2) = static_cast<float>(-2.0 / light_depth);
  light = box * look_along(light_right, light_up, key, middle);
}

}  // namespace palpate::render
