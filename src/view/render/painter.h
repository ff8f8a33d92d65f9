#pragma once
#include <array>
#include <memory>
#include <vector>

#include "palpate/offscreen.h"
#include "view/render/gl_context.h"
#include "view/render/gl_objects.h"
#include "view/render/tissue_look.h"

namespace palpate::render {

/// A ball that holds what the light must reach. World frame.
struct LitRegion {
  Vec3 middle = Vec3::Zero();
  double radius = 0.1;  // m
};

/// A mesh and where it is.
struct Solid {
  GpuMesh mesh;
  Pose place_W;
};

/// [setup] The framebuffer that is bound, from its upper left corner.
[[nodiscard]] Image read_pixels(int width, int height);

/// Draws tissue and steel in a studio's light. All members: [setup], with the context current.
class Painter final {
 public:
  Painter(const TissueLook& look, int width, int height, Quality quality);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// What to draw; kept until changed.
  Solid& organ() noexcept { return organ_; }
  std::vector<std::unique_ptr<Solid>>& tools() noexcept { return tools_; }
  /// Displacement [m] that the colour map over the organ spans; 0: the tissue's own colours.
  void set_map_range(double range) noexcept { map_range_ = range; }
  /// Whether the studio's lamps are on, as they are at first.
  void switch_lamps(bool on) noexcept { lamps_ = on; }
  /// Shaders are kept: only the first time takes long.
  void set_quality(Quality quality);
  [[nodiscard]] Quality quality() const noexcept { return quality_; }

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
  struct Still;  // what kFull needs
  struct Live;   // what the others need
  struct Materials;
  [[nodiscard]] std::unique_ptr<Materials>& materials() noexcept {
    return materials_[static_cast<std::size_t>(quality_)];
  }
  void draw_tools(const Program& program) const;
  void draw_scene(const Program& program) const;
  void set_studio(const Program& program, const View& view) const;
  void draw_materials(const View& view, bool each_sample);
  void draw_shadow(const View& view);
  void draw_occlusion(const View& view);
  void draw_still(const View& view);
  void draw_soft_shadow(const View& view);
  void draw_live(const View& view);

  TissueLook look_;
  Quality quality_;
  int width_;
  int height_;
  double map_range_ = 0.0;  // m
  bool lamps_ = true;
  Solid organ_;
  std::vector<std::unique_ptr<Solid>> tools_;
  GpuMesh nothing_;  // OpenGL core draws nothing without a vertex array
  Program background_;
  std::array<std::unique_ptr<Materials>, 3> materials_;  // of each quality, once it was used
  std::unique_ptr<Still> still_;
  std::unique_ptr<Live> live_;
  Target resolved_;
};

}  // namespace palpate::render
