#pragma once
#include <memory>
#include <span>

#include "palpate/render/gl_context.h"
#include "palpate/render/gl_objects.h"
#include "palpate/render/offscreen.h"
#include "palpate/render/tissue_look.h"

namespace palpate::render {

/// A ball that holds what the light must reach. World frame.
struct LitRegion {
  Vec3 middle = Vec3::Zero();
  double radius = 0.1;  // m
};

/// Draws triangles of tissue and of steel in a studio's light: soft shadow of the key light, ambient
/// occlusion, tissue and steel, edges smoothed. All members: [setup], with the context current.
class Painter final {
 public:
  Painter(const TissueLook& look, int width, int height);

  /// The meshes to draw; kept until replaced.
  GpuMesh& organ() noexcept { return organ_; }
  GpuMesh& tools() noexcept { return tools_; }

  [[nodiscard]] Image paint(const Camera& camera, const LitRegion& region);

  /// paint() in two steps: what was drawn stays until the next draw().
  void draw(const Camera& camera, const LitRegion& region);
  [[nodiscard]] Image read() const;

  /// Copies what was drawn, stretched, to a rectangle of the window's own framebuffer [pixels, y up].
  void show_at(int x, int y, int width, int height) const { resolved_.show_at(x, y, width, height); }
  /// The size of all pictures from here on.
  void resize(int width, int height);

 private:
  struct View;
  void draw_scene() const;
  void set_studio(const Program& program, const View& view) const;
  void draw_shadow(const View& view);
  void draw_occlusion(const View& view);
  void draw_picture(const View& view);

  TissueLook look_;
  Program depth_;
  Program occlusion_;
  Program blur_;
  Program background_;
  Program tissue_;
  Program steel_;
  GpuMesh organ_;
  GpuMesh tools_;
  GpuMesh nothing_;  // OpenGL core draws nothing without a vertex array
  Target shadow_;
  Target depth_half_;
  Target occlusion_half_;
  Target blurred_half_;
  Target picture_;
  Target resolved_;
};

}  // namespace palpate::render
