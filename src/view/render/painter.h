#pragma once
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "palpate/offscreen.h"
#include "view/render/gl_context.h"
#include "view/render/gl_objects.h"
#include "view/render/tissue_pattern.h"

namespace palpate::render {

/// Bounding ball of what the light must cover. World frame.
struct LitRegion {
  Vec3 middle = Vec3::Zero();
  double radius = 0.1;  // m
};

/// A mesh and its pose.
struct Solid {
  GpuMesh mesh;
  Pose pose_W;
};

/// A mark and the outward unit normal of the surface there. Organ frame.
struct PlacedMark {
  SurfaceMark mark;
  Vec3 normal_S = Vec3::UnitZ();
};

/// [setup] Reads the bound framebuffer from its upper left corner.
[[nodiscard]] Image read_pixels(int width, int height);

/// Draws tissue and steel in studio lighting. All members: [setup], with the context current.
class Painter final {
 public:
  Painter(const TissueAppearance& look, int width, int height, Quality quality);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// The organ to draw; kept between pictures.
  Solid& organ() noexcept { return organ_; }
  std::vector<std::unique_ptr<Solid>>& tools() noexcept { return tools_; }
  /// Displacement [m] that the colour map covers; 0: natural colours.
  void set_map_range(double range) noexcept { map_range_ = range; }
  /// Whether the organ's map attributes give its colours.
  void show_values(bool shown) noexcept { values_shown_ = shown; }
  /// Marks drawn on the organ's surface, at most kMaxMarks.
  void show_marks(std::vector<PlacedMark> marks) { marks_ = std::move(marks); }
  /// Whether values, marks or inclusions are shown. The first picture with them in each quality takes long.
  [[nodiscard]] bool annotated() const noexcept {
    return values_shown_ || !marks_.empty() || !inclusions_.empty();
  }
  /// The inclusions to draw inside the organ, at most model::kMaxInclusions; organ frame.
  void show_inclusions(std::vector<model::Inclusion> inclusions) { inclusions_ = std::move(inclusions); }
  /// Switches the studio lamps; initially on.
  void switch_lamps(bool on) noexcept { lamps_ = on; }
  /// Selects the quality. The first use of each compiles its shaders, which takes long; they are kept.
  void set_quality(Quality quality);
  [[nodiscard]] Quality quality() const noexcept { return quality_; }

  [[nodiscard]] Image paint(const Camera& camera, const LitRegion& region);

  /// The two steps of paint(). The picture is kept until the next draw().
  void draw(const Camera& camera, const LitRegion& region);
  [[nodiscard]] Image read() const;

  /// Copies the kept picture, scaled, to a rectangle of the window's framebuffer [pixels, y up].
  void show_at(int x, int y, int width, int height) const { finished_->show_at(x, y, width, height); }
  /// Sets the size of all further pictures.
  void resize(int width, int height);

 private:
  struct View;
  struct Still;  // resources for kFull
  struct Live;   // resources for the other qualities
  struct Materials;
  [[nodiscard]] std::unique_ptr<Materials>& materials() noexcept {
    return materials_[static_cast<std::size_t>(quality_)];
  }
  void draw_tools(const Program& program) const;
  void draw_scene(const Program& program) const;
  void set_studio(const Program& program, const View& view) const;
  void set_inclusions(const Program& program) const;
  [[nodiscard]] const Program& tissue_program();
  void set_marks(const Program& program, const View& view) const;
  void draw_materials(const View& view, bool each_sample);
  void draw_shadow(const View& view);
  void draw_occlusion(const View& view);
  void draw_still(const View& view);
  void draw_soft_shadow(const View& view);
  void draw_live(const View& view);

  TissueAppearance look_;
  Quality quality_;
  int width_;
  int height_;
  double map_range_ = 0.0;  // m
  bool values_shown_ = false;
  bool lamps_ = true;
  std::vector<model::Inclusion> inclusions_;
  std::vector<PlacedMark> marks_;
  Solid organ_;
  std::vector<std::unique_ptr<Solid>> tools_;
  GpuMesh nothing_;  // OpenGL core needs a bound vertex array for every draw
  Program background_;
  std::array<std::unique_ptr<Materials>, 3> materials_;  // one per quality, created at its first use
  std::unique_ptr<Still> still_;
  std::unique_ptr<Live> live_;
  Target resolved_;
  const Target* finished_ = &resolved_;  // the newest picture
};

}  // namespace palpate::render
