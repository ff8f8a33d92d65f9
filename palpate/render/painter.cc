#include "palpate/render/painter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "palpate/render/shaders.h"

namespace palpate::render {
namespace {

constexpr int kShadowSize = 2048;         // texels a side
constexpr double kPenumbra = 0.018;       // of the picture's height at the target, radius
constexpr double kOcclusionReach = 0.16;  // of the picture's height at the target
constexpr double kNearShare = 0.02;       // near plane: share of the distance to the target
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

// Everything that the passes need to know of one picture.
struct Painter::View {
  Vec3 eye, right, up, back;
  Vec3 key, fill, rim;
  double near_plane, far_plane, half_height, half_width, height_at_target;
  Eigen::Matrix4f projection;
  Eigen::Matrix4f light;
  double light_radius;

  View(const Camera& camera, double aspect, const LitRegion& region) {
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

    // The light's map covers what is seen and lit, whichever is smaller, and no more.
    light_radius = std::min(region.radius, 1.1 * distance * std::hypot(half_height, half_width));
    const Vec3 middle = light_radius < region.radius ? camera.target : region.middle;
    const Vec3 light_right = up.cross(key).normalized();
    Eigen::Matrix4f box = Eigen::Matrix4f::Identity();
    box(0, 0) = box(1, 1) = static_cast<float>(1.0 / light_radius);
    box(2, 2) = static_cast<float>(-0.5 / region.radius);
    light = box * look_along(light_right, key.cross(light_right), key, middle);
  }
};

Painter::Painter(const TissueLook& look, int width, int height)
    : look_(look),
      depth_(shaders::scene_vertex(), shaders::depth_fragment()),
      occlusion_(shaders::fullscreen_vertex(), shaders::occlusion_fragment()),
      blur_(shaders::fullscreen_vertex(), shaders::blur_fragment()),
      background_(shaders::fullscreen_vertex(), shaders::background_fragment()),
      tissue_(shaders::scene_vertex(), shaders::tissue_fragment()),
      steel_(shaders::scene_vertex(), shaders::steel_fragment()),
      shadow_(Target::Kind::kShadow, kShadowSize, kShadowSize),
      depth_half_(Target::Kind::kDepth, (width + 1) / 2, (height + 1) / 2),
      occlusion_half_(Target::Kind::kGrey, (width + 1) / 2, (height + 1) / 2),
      blurred_half_(Target::Kind::kGrey, (width + 1) / 2, (height + 1) / 2),
      picture_(Target::Kind::kColourMultisampled, width, height),
      resolved_(Target::Kind::kColour, width, height) {}

void Painter::draw_scene() const {
  organ_.draw();
  tools_.draw();
}

void Painter::draw_shadow(const View& view) {
  shadow_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_CLAMP);
  depth_.use();
  depth_.set("projection", view.light);
  draw_scene();
  glDisable(GL_DEPTH_CLAMP);
}

void Painter::draw_occlusion(const View& view) {
  depth_half_.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  depth_.use();
  depth_.set("projection", view.projection);
  draw_scene();

  const Eigen::Vector2f texel(1.0F / static_cast<float>(depth_half_.width()),
                              1.0F / static_cast<float>(depth_half_.height()));
  glDisable(GL_DEPTH_TEST);
  occlusion_half_.bind();
  depth_half_.bind_texture(0);
  occlusion_.use();
  occlusion_.set("depth_map", 0);
  occlusion_.set("pixel_size", texel);
  occlusion_.set("half_view",
                 Eigen::Vector2f(static_cast<float>(view.half_width), static_cast<float>(view.half_height)));
  occlusion_.set("near_plane", static_cast<float>(view.near_plane));
  occlusion_.set("far_plane", static_cast<float>(view.far_plane));
  occlusion_.set("radius", static_cast<float>(kOcclusionReach * view.height_at_target));
  nothing_.draw_fullscreen();
  blurred_half_.bind();
  occlusion_half_.bind_texture(0);
  blur_.use();
  blur_.set("source", 0);
  blur_.set("pixel_size", texel);
  nothing_.draw_fullscreen();
  glEnable(GL_DEPTH_TEST);
}

void Painter::set_studio(const Program& program, const View& view) const {
  program.use();
  program.set("projection", view.projection);
  program.set("light_projection", view.light);
  program.set("eye", Eigen::Vector3f(view.eye.cast<float>()));
  program.set("rig_right", Eigen::Vector3f(view.right.cast<float>()));
  program.set("rig_up", Eigen::Vector3f(view.up.cast<float>()));
  program.set("rig_back", Eigen::Vector3f(view.back.cast<float>()));
  program.set("key", Eigen::Vector3f(view.key.cast<float>()));
  program.set("fill", Eigen::Vector3f(view.fill.cast<float>()));
  program.set("rim", Eigen::Vector3f(view.rim.cast<float>()));
  program.set("shadow_texel", static_cast<float>(2.0 * view.light_radius / kShadowSize));
  program.set("shadow_lift", static_cast<float>(0.5 * kPenumbra * view.height_at_target));
  program.set("shadow_softness",
              static_cast<float>(0.5 * kPenumbra * view.height_at_target / view.light_radius));
  program.set("shadow_map", 0);
  program.set("occlusion_map", 1);
  program.set("pixel_size", Eigen::Vector2f(1.0F / static_cast<float>(picture_.width()),
                                            1.0F / static_cast<float>(picture_.height())));
}

void Painter::draw_picture(const View& view) {
  picture_.bind();
  shadow_.bind_texture(0);
  blurred_half_.bind_texture(1);
  glClear(GL_DEPTH_BUFFER_BIT | GL_COLOR_BUFFER_BIT);
  glDisable(GL_DEPTH_TEST);
  background_.use();
  nothing_.draw_fullscreen();
  glEnable(GL_DEPTH_TEST);

  set_studio(tissue_, view);
  tissue_.set("base_colour", look_.base);
  tissue_.set("mottle_colour", look_.mottle);
  tissue_.set("vessel_colour", look_.vessel);
  tissue_.set("fat_colour", look_.fat);
  tissue_.set("vessel_share", look_.vessel_share);
  tissue_.set("fat_share", look_.fat_share);
  tissue_.set("mottle_scale", look_.mottle_per_m);
  tissue_.set("vessel_scale", look_.vessel_per_m);
  organ_.draw();
  set_studio(steel_, view);
  glDisable(GL_CULL_FACE);                            // instruments need not be closed
  const bool each_sample = epoxy_gl_version() >= 40;  // fine teeth glitter when lit once a pixel
  if (each_sample) {
    glEnable(GL_SAMPLE_SHADING);
    glMinSampleShading(1.0F);
  }
  tools_.draw();
  if (each_sample) glDisable(GL_SAMPLE_SHADING);
  glEnable(GL_CULL_FACE);
}

void Painter::draw(const Camera& camera, const LitRegion& region) {
  const View view(camera, static_cast<double>(picture_.width()) / picture_.height(), region);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);  // an organ's inside is never drawn
  glEnable(GL_MULTISAMPLE);
  draw_shadow(view);
  draw_occlusion(view);
  draw_picture(view);
  picture_.resolve_to(resolved_);
}

void Painter::resize(int width, int height) {
  depth_half_.resize((width + 1) / 2, (height + 1) / 2);
  occlusion_half_.resize((width + 1) / 2, (height + 1) / 2);
  blurred_half_.resize((width + 1) / 2, (height + 1) / 2);
  picture_.resize(width, height);
  resolved_.resize(width, height);
}

Image Painter::read() const {
  resolved_.bind();
  Image image{picture_.width(), picture_.height(), {}};
  const std::size_t row = static_cast<std::size_t>(image.width) * 3;
  std::vector<std::uint8_t> bottom_up(row * static_cast<std::size_t>(image.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, bottom_up.data());
  image.rgb.reserve(bottom_up.size());
  for (auto line = bottom_up.end(); line != bottom_up.begin(); line -= static_cast<std::ptrdiff_t>(row))
    image.rgb.insert(image.rgb.end(), line - static_cast<std::ptrdiff_t>(row), line);
  return image;
}

Image Painter::paint(const Camera& camera, const LitRegion& region) {
  draw(camera, region);
  return read();
}

}  // namespace palpate::render
