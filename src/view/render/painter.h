#pragma once
#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/offscreen.h"
#include "view/render/changed_region.h"
#include "view/render/drape.h"
#include "view/render/gl_objects.h"
#include "view/render/studio_view.h"
#include "view/render/tissue_pattern.h"

namespace palpate::render {

/// The organ's mesh and its pose.
struct DeformingSolid {
  DeformingMesh mesh;
  Pose pose_W;
};

/// A rigid part of an instrument and its pose.
struct Solid {
  GpuMesh mesh;
  RigidBlocks blocks;
  Pose pose_W;
};

/// A mark and the outward unit normal of the surface there. Organ frame.
struct PlacedMark {
  SurfaceMark mark;
  Vec3 normal_S = Vec3::UnitZ();
};

/// A hole that a needle has left in the surface. Organ frame.
struct PunctureHole {
  Vec3 point_S;
  double radius = 0.0;  // m
};

/// Draws tissue and steel in studio lighting. All members: [setup], with the context current.
///
/// In the qualities for moving pictures it draws only what changed since its last picture, where camera,
/// light, organ pose, size and settings are the same: the tiles of the tools that moved, of the triangles of
/// the organ that moved, before and after, and of the triangles that the tools' shadow moved on. Only blocks
/// of triangles in those tiles are drawn, and only the changed part of the shadow map. The picture is the
/// same, bit for bit, as if all of it were drawn.
class Painter final {
 public:
  Painter(const TissueAppearance& look, int width, int height, Quality quality);
  ~Painter();
  Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  /// The organ to draw; kept between pictures.
  DeformingSolid& organ() noexcept { return organ_; }
  std::vector<std::unique_ptr<Solid>>& tools() noexcept { return tools_; }
  /// Draws all of the next picture. Required after a change of the organ's triangles or static attributes.
  void redraw_all() noexcept { drawn_.reset(); }
  /// Displacement [m] that the colour map covers; 0: natural colours.
  void set_map_range(double range) noexcept {
    map_range_ = range;
    redraw_all();
  }
  /// Whether the organ's map attributes give its colours. Required after each change of them.
  void show_values(bool shown) noexcept {
    values_shown_ = shown;
    redraw_all();
  }
  /// Marks drawn on the organ's surface, at most kMaxMarks.
  void show_marks(std::vector<PlacedMark> marks) {
    marks_ = std::move(marks);
    redraw_all();
  }
  /// Where needles have gone in, at most kMaxMarks; organ frame. The first call prepares the shaders.
  void show_holes(std::vector<PunctureHole> holes) {
    holes_ = std::move(holes);
    holes_expected_ = true;
    redraw_all();
  }
  /// Whether values, marks, holes or inclusions are shown. The first picture with them in each quality takes
  /// long.
  [[nodiscard]] bool annotated() const noexcept {
    return values_shown_ || holes_expected_ || !marks_.empty() || !inclusions_.empty();
  }
  /// The inclusions to draw inside the organ, at most model::kMaxInclusions; organ frame.
  void show_inclusions(std::vector<model::Inclusion> inclusions) {
    inclusions_ = std::move(inclusions);
    redraw_all();
  }
  /// Draws a drape behind everything else, or no drape.
  void show_drape(const Drape* drape);
  /// Switches the studio lamps; initially on.
  void switch_lamps(bool on) noexcept {
    lamps_ = on;
    redraw_all();
  }
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
  struct Still;  // resources for kFull
  struct Live;   // resources for the other qualities
  struct Materials;
  struct Spread;  // the drape
  // What the kept picture shows.
  struct Drawn {
    Camera camera;
    LitRegion region;
    Pose organ_W;
    std::vector<Pose> tools_W;
  };
  // The part of a picture to draw.
  struct Part {
    ChangedTiles tiles;
    PixelBox shadow;  // entries of the shadow map before it is softened
  };
  [[nodiscard]] std::unique_ptr<Materials>& materials() noexcept {
    return materials_[static_cast<std::size_t>(quality_)];
  }
  void draw_tools(const Program& program) const;
  void draw_tools(const Program& program, const StudioView& view, const ChangedTiles& tiles) const;
  void draw_scene(const Program& program) const;
  void set_studio(const Program& program, const StudioView& view) const;
  void set_inclusions(const Program& program) const;
  [[nodiscard]] const Program& tissue_program();
  void set_marks(const Program& program, const StudioView& view) const;
  void draw_materials(const StudioView& view, const ChangedTiles& tiles);
  void draw_shadow(const StudioView& view);
  void draw_occlusion(const StudioView& view);
  void draw_still(const StudioView& view);
  [[nodiscard]] Projection projection_of(const StudioView& view, const Pose& pose_W) const;
  [[nodiscard]] Part whole() const;
  [[nodiscard]] Part changed_part(const StudioView& view, const Camera& camera, const LitRegion& region);
  void draw_behind(const StudioView& view);
  void draw_backdrop(const StudioView& view, const Camera& camera);
  void draw_soft_shadow(const StudioView& view, const PixelBox& changed);
  void draw_live(const StudioView& view, const Camera& camera, const Part& part);
  void draw_part(const StudioView& view, const ChangedTiles& tiles);

  TissueAppearance look_;
  Quality quality_;
  int width_;
  int height_;
  double map_range_ = 0.0;  // m
  bool values_shown_ = false;
  bool lamps_ = true;
  std::vector<model::Inclusion> inclusions_;
  std::vector<PlacedMark> marks_;
  std::vector<PunctureHole> holes_;
  bool holes_expected_ = false;
  DeformingSolid organ_;
  std::vector<std::unique_ptr<Solid>> tools_;
  GpuMesh nothing_;  // OpenGL core needs a bound vertex array for every draw
  Program background_;
  std::unique_ptr<Spread> drape_;
  std::array<std::unique_ptr<Materials>, 3> materials_;  // one per quality, created at its first use
  std::unique_ptr<Still> still_;
  std::unique_ptr<Live> live_;
  Target resolved_;
  const Target* finished_ = &resolved_;  // the newest picture
  std::optional<Drawn> drawn_;           // nothing: the next picture is drawn as a whole
};

}  // namespace palpate::render
