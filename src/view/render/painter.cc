#include "view/render/painter.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "view/render/shaders.h"

namespace palpate::render {
namespace {

// The shadow of kFull is softened by 16 interpolated taps. With this many texels in the penumbra's radius
// they leave no texel out, so that the shadow is smooth, and texels are small enough to show no steps.
constexpr double kShadowTexels = 2.5;
constexpr int kLargestShadow = 1024;  // texels per side
constexpr int kSoftShadowSize = ChangedShadow::kEntries;
constexpr double kPenumbra = 0.018;       // radius, as a fraction of the picture's height at the target
constexpr double kOcclusionReach = 0.16;  // as a fraction of the picture's height at the target
constexpr double kMarkRadius = 0.016;     // as a fraction of the picture's height at the target
constexpr double kLeastMarkRadius = 7.0;  // pixels
constexpr double kLeastHole = 1.5;        // pixels: radius of a hole

Eigen::Matrix4f matrix_of(const Pose& pose) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.block<3, 3>(0, 0) = pose.rotation.toRotationMatrix();
  m.block<3, 1>(0, 3) = pose.position;
  return m.cast<float>();
}

Eigen::Vector2f texel_of(const Target& target) {
  return {1.0F / static_cast<float>(target.width()), 1.0F / static_cast<float>(target.height())};
}

// The entries of the soft shadow but for the outermost: nothing is covered in those.
constexpr PixelBox kInnerShadow{1, 1, kSoftShadowSize - 1, kSoftShadowSize - 1};

PixelBox within(const PixelBox& box, const PixelBox& limit) {
  return {std::max(box.left, limit.left), std::max(box.low, limit.low), std::min(box.right, limit.right),
          std::min(box.high, limit.high)};
}

void limit_drawing(const PixelBox& box) {
  glScissor(box.left, box.low, std::max(box.right - box.left, 0), std::max(box.high - box.low, 0));
}

void clear_depth(float depth) { glClearBufferfv(GL_DEPTH, 0, &depth); }

}  // namespace

// For kFull: shadow and occlusion of everything in its current position, four samples per pixel.
struct Painter::Still {
  Still(int width, int height)
      : depth(shaders::position_vertex(), shaders::depth_fragment()),
        occlusion(shaders::fullscreen_vertex(), shaders::occlusion_fragment()),
        blur(shaders::fullscreen_vertex(), shaders::blur_fragment()),
        shadow(Target::Kind::kShadow, kLargestShadow, kLargestShadow),
        depth_half(Target::Kind::kDepth, (width + 1) / 2, (height + 1) / 2),
        occlusion_half(Target::Kind::kGrey, (width + 1) / 2, (height + 1) / 2),
        blurred_half(Target::Kind::kGrey, (width + 1) / 2, (height + 1) / 2),
        picture(Target::Kind::kColourMultisampled, width, height) {}

  Program depth;
  Program occlusion;
  Program blur;
  Target shadow;
  Target depth_half;
  Target occlusion_half;
  Target blurred_half;
  Target picture;
};

// For moving pictures: soft shadow of the tools, a background drawn once, antialiasing at the end.
struct Painter::Live {
  Live(int width, int height)
      : cover(shaders::position_vertex(), shaders::cover_fragment()),
        soften(shaders::fullscreen_vertex(), shaders::blur_cover_fragment()),
        smooth_edges(shaders::fullscreen_vertex(), shaders::antialias_fragment()),
        copy(shaders::fullscreen_vertex(), shaders::copy_fragment()),
        shadow(Target::Kind::kCover, kSoftShadowSize, kSoftShadowSize),
        softer(Target::Kind::kCover, kSoftShadowSize, kSoftShadowSize),
        softest(Target::Kind::kCover, kSoftShadowSize, kSoftShadowSize),
        backdrop(Target::Kind::kColour, width, height),
        picture(Target::Kind::kColourWithDepth, width, height) {
    glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
    softest.bind();
    glClear(GL_COLOR_BUFFER_BIT);  // its outermost entries stay so: nothing is covered outside the map
  }

  Program cover;
  Program soften;
  Program smooth_edges;
  Program copy;
  Target shadow;
  Target softer;   // softened along x
  Target softest;  // along both
  Target backdrop;
  Target picture;
  std::optional<Camera> backdrop_of;  // nothing: it is not drawn yet
};

struct Painter::Spread {
  explicit Spread(const Drape& drape)
      : program(shaders::drape_vertex(), shaders::drape_fragment()),
        middle(drape.middle.cast<float>()),
        radius(static_cast<float>(drape.radius)) {
    mesh.set_triangles(drape.corners);
    mesh.set_static(std::vector<StaticVertex>(drape.vertices.size()));
    mesh.set_moving(drape.vertices);
  }

  Program program;
  GpuMesh mesh;
  Eigen::Vector3f middle;
  float radius;
};

// Shaders of tissue and steel in one quality.
struct Painter::Materials {
  explicit Materials(Quality quality)
      : tissue(shaders::scene_vertex(quality, shaders::Annotated::kNo),
               shaders::tissue_fragment(quality, shaders::Annotated::kNo)),
        steel(shaders::scene_vertex(quality, shaders::Annotated::kNo), shaders::steel_fragment(quality)) {}

  Program tissue;
  Program steel;
  std::unique_ptr<Program> annotated;  // tissue with values, marks, inclusions; created at its first use
};

Painter::Painter(const TissueAppearance& look, int width, int height, Quality quality)
    : look_(look),
      quality_(quality),
      width_(width),
      height_(height),
      background_(shaders::fullscreen_vertex(), shaders::background_fragment()),
      resolved_(Target::Kind::kColour, width, height) {
  set_quality(quality);
}

Painter::~Painter() = default;

void Painter::set_quality(Quality quality) {
  if (quality != quality_) redraw_all();
  quality_ = quality;
  if (!materials()) materials() = std::make_unique<Materials>(quality);
  if (quality == Quality::kFull) {
    finished_ = &resolved_;
    live_.reset();
    if (!still_) still_ = std::make_unique<Still>(width_, height_);
  } else {
    still_.reset();
    if (!live_) live_ = std::make_unique<Live>(width_, height_);
  }
}

void Painter::resize(int width, int height) {
  width_ = width;
  height_ = height;
  redraw_all();
  resolved_.resize(width, height);
  if (still_) still_ = std::make_unique<Still>(width, height);
  if (live_) {
    live_->backdrop.resize(width, height);
    live_->picture.resize(width, height);
    live_->backdrop_of.reset();
  }
}

void Painter::show_drape(const Drape* drape) {
  drape_ = drape == nullptr ? nullptr : std::make_unique<Spread>(*drape);
  if (live_) live_->backdrop_of.reset();
  redraw_all();
}

void Painter::draw_tools(const Program& program) const {
  for (const auto& tool : tools_) {
    program.set("model", matrix_of(tool->pose_W));
    tool->mesh.draw();
  }
}

void Painter::draw_tools(const Program& program, const StudioView& view, const ChangedTiles& tiles) const {
  for (const auto& tool : tools_) {
    program.set("model", matrix_of(tool->pose_W));
    tool->blocks.draw(tool->mesh, projection_of(view, tool->pose_W), tiles);
  }
}

void Painter::draw_scene(const Program& program) const {
  program.set("model", matrix_of(organ_.pose_W));
  organ_.mesh.gpu().draw();
  draw_tools(program);
}

void Painter::draw_shadow(const StudioView& view) {
  const double wanted = kShadowTexels * 2.0 * view.light_radius / (kPenumbra * view.height_at_target);
  const int size = std::min(static_cast<int>(std::ceil(wanted)), kLargestShadow);
  if (size != still_->shadow.width()) still_->shadow.resize(size, size);
  still_->shadow.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  clamp_depths(true);
  still_->depth.use();
  still_->depth.set("projection", view.light);
  draw_scene(still_->depth);
  clamp_depths(false);
}

void Painter::draw_occlusion(const StudioView& view) {
  still_->depth_half.bind();
  glClear(GL_DEPTH_BUFFER_BIT);
  still_->depth.use();
  still_->depth.set("projection", view.projection);
  draw_scene(still_->depth);

  const Eigen::Vector2f texel = texel_of(still_->depth_half);
  glDisable(GL_DEPTH_TEST);
  still_->occlusion_half.bind();
  still_->depth_half.bind_texture(0);
  const Program& occlusion = still_->occlusion;
  occlusion.use();
  occlusion.set("depth_map", 0);
  occlusion.set("pixel_size", texel);
  occlusion.set("half_view",
                Eigen::Vector2f(static_cast<float>(view.half_width), static_cast<float>(view.half_height)));
  occlusion.set("near_plane", static_cast<float>(view.near_plane));
  occlusion.set("far_plane", static_cast<float>(view.far_plane));
  occlusion.set("radius", static_cast<float>(kOcclusionReach * view.height_at_target));
  nothing_.draw_fullscreen();
  still_->blurred_half.bind();
  still_->occlusion_half.bind_texture(0);
  still_->blur.use();
  still_->blur.set("source", 0);
  still_->blur.set("pixel_size", texel);
  nothing_.draw_fullscreen();
  glEnable(GL_DEPTH_TEST);
}

void Painter::set_studio(const Program& program, const StudioView& view) const {
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
  program.set("lamps", lamps_ ? 1.0F : 0.0F);
  const double penumbra = kPenumbra * view.height_at_target;
  const double softened = 2.0 * view.light_radius * ChangedShadow::kBlur / kSoftShadowSize;
  program.set("shadow_reach", static_cast<float>(quality_ == Quality::kFull ? penumbra : softened));
  program.set("shadow_softness", static_cast<float>(0.5 * penumbra / view.light_radius));
  program.set("shadow_depth", static_cast<float>(view.light_depth));
  program.set("shadow_map", 0);
  program.set("cover_map", 0);
  program.set("occlusion_map", 1);
  program.set("pixel_size", texel_of(resolved_));
}

void Painter::set_inclusions(const Program& program) const {
  const std::size_t count = std::min(inclusions_.size(), model::kMaxInclusions);
  program.set("inclusion_count", static_cast<int>(count));
  for (std::size_t i = 0; i < count; ++i) {
    const model::Inclusion& inclusion = inclusions_[i];
    const std::string element = "[" + std::to_string(i) + "]";
    program.set(("inclusion_centre" + element).c_str(),
                Eigen::Vector3f((organ_.pose_W * inclusion.centre_S).cast<float>()));
    program.set(("inclusion_radius" + element).c_str(), static_cast<float>(inclusion.radius));
    program.set(("inclusion_soft" + element).c_str(), inclusion.ratio < 1.0 ? 1.0F : 0.0F);
  }
}

// Sets the marks that face the camera.
void Painter::set_marks(const Program& program, const StudioView& view) const {
  int count = 0;
  for (const PlacedMark& placed : marks_) {
    const Vec3 point_W = organ_.pose_W * placed.mark.point_S;
    if ((organ_.pose_W.rotation * placed.normal_S).dot(view.eye - point_W) <= 0.0) continue;
    const std::string element = "[" + std::to_string(count++) + "]";
    program.set(("mark_point" + element).c_str(), Eigen::Vector3f(point_W.cast<float>()));
    program.set(("mark_kind" + element).c_str(), static_cast<int>(placed.mark.kind));
  }
  program.set("mark_count", count);
  const double pixel = view.height_at_target / height_;  // m
  program.set("hole_count", static_cast<int>(holes_.size()));
  for (std::size_t i = 0; i < holes_.size(); ++i) {
    const std::string element = "[" + std::to_string(i) + "]";
    program.set(("hole_point" + element).c_str(),
                Eigen::Vector3f((organ_.pose_W * holes_[i].point_S).cast<float>()));
    program.set(("hole_radius" + element).c_str(),
                static_cast<float>(std::max(holes_[i].radius, kLeastHole * pixel)));
  }
  program.set("mark_radius", static_cast<float>(pixel * std::max(kMarkRadius * height_, kLeastMarkRadius)));
  program.set("pixel_length", static_cast<float>(pixel));
}

const Program& Painter::tissue_program() {
  if (!annotated()) return materials()->tissue;
  std::unique_ptr<Program>& program = materials()->annotated;
  if (!program) {
    program = std::make_unique<Program>(shaders::scene_vertex(quality_, shaders::Annotated::kYes),
                                        shaders::tissue_fragment(quality_, shaders::Annotated::kYes));
  }
  return *program;
}

void Painter::draw_materials(const StudioView& view, const ChangedTiles& tiles) {
  const Program& tissue = tissue_program();
  set_studio(tissue, view);
  tissue.set("vessel_colour", look_.vessel);
  tissue.set("vessel_share", look_.vessel_share);
  tissue.set("map_range", values_shown_ ? 0.0F : static_cast<float>(map_range_));
  tissue.set("model", matrix_of(organ_.pose_W));
  if (annotated()) {
    set_inclusions(tissue);
    tissue.set("values_shown", values_shown_ ? 1.0F : 0.0F);
    set_marks(tissue, view);
  }
  if (quality_ == Quality::kFull) {
    organ_.mesh.gpu().draw();
  } else {
    organ_.mesh.draw(tiles);
  }
  const Program& steel = materials()->steel;
  set_studio(steel, view);
  steel.set("map_range", 0.0F);
  glDisable(GL_CULL_FACE);  // meshes of instruments may be open
  if (quality_ == Quality::kFull) {
    shade_samples(true);  // fine teeth glitter otherwise
    draw_tools(steel);
    shade_samples(false);
  } else {
    draw_tools(steel, view, tiles);
  }
  glEnable(GL_CULL_FACE);
}

void Painter::draw_still(const StudioView& view) {
  draw_shadow(view);
  draw_occlusion(view);
  still_->picture.bind();
  still_->shadow.bind_texture(0);
  still_->blurred_half.bind_texture(1);
  glClear(GL_DEPTH_BUFFER_BIT | GL_COLOR_BUFFER_BIT);
  draw_behind(view);
  draw_materials(view, whole().tiles);
  still_->picture.resolve_to(resolved_);
}

Projection Painter::projection_of(const StudioView& view, const Pose& pose_W) const {
  const Eigen::Matrix4f model = matrix_of(pose_W);
  return {view.projection * model, view.light * model, static_cast<float>(width_),
          static_cast<float>(height_), static_cast<float>(view.near_plane)};
}

Painter::Part Painter::whole() const {
  Part part{ChangedTiles(width_, height_), {0, 0, kSoftShadowSize, kSoftShadowSize}};
  part.tiles.add_all();
  return part;
}

Painter::Part Painter::changed_part(const StudioView& view, const Camera& camera, const LitRegion& region) {
  const Projection organ = projection_of(view, organ_.pose_W);
  const bool same_view =
      drawn_ && drawn_->camera == camera && drawn_->region == region && drawn_->organ_W == organ_.pose_W;
  Drawn now{camera, region, organ_.pose_W, {}};
  for (const auto& tool : tools_) now.tools_W.push_back(tool->pose_W);
  const std::optional<Drawn> before = std::exchange(drawn_, std::move(now));
  if (!same_view) {
    organ_.mesh.place(organ);
    return whole();
  }

  ChangedTiles tiles(width_, height_);
  ChangedShadow shadow;
  organ_.mesh.add_changes(organ, tiles);
  bool bounded = !organ_.mesh.is_cut();
  for (std::size_t i = 0; i < tools_.size(); ++i) {
    if (before->tools_W[i] == tools_[i]->pose_W) continue;
    for (const Pose& pose_W : {before->tools_W[i], tools_[i]->pose_W}) {
      const Projection projection = projection_of(view, pose_W);
      bounded = tools_[i]->blocks.add_pixels(projection, tiles) && bounded;
      tools_[i]->blocks.add_shadow(projection, shadow, true);
    }
  }
  for (std::size_t i = 0; i < tools_.size() && !shadow.empty(); ++i) {
    if (before->tools_W[i] == tools_[i]->pose_W)
      tools_[i]->blocks.add_shadow(projection_of(view, tools_[i]->pose_W), shadow, false);
  }
  for (const auto& tool : tools_) {
    const Projection projection = projection_of(view, tool->pose_W);
    if (!shadow.empty()) bounded = tool->blocks.add_shaded(projection, shadow, tiles) && bounded;
  }
  if (!shadow.empty()) organ_.mesh.add_shaded(shadow, tiles);
  if (!bounded) return whole();
  return {std::move(tiles), shadow.entries()};
}

// Softens the tools' shadow first along x, then along y. The steps before are kept for the next picture.
void Painter::draw_soft_shadow(const StudioView& view, const PixelBox& changed) {
  if (changed.empty()) return;
  constexpr int kBlur = ChangedShadow::kBlur;
  live_->shadow.bind();
  limit_drawing(changed);
  glClearColor(0.0F, 0.0F, 0.0F, 0.0F);
  glClear(GL_DEPTH_BUFFER_BIT | GL_COLOR_BUFFER_BIT);
  clamp_depths(true);
  glDisable(GL_CULL_FACE);
  live_->cover.use();
  live_->cover.set("projection", view.light);
  draw_tools(live_->cover);
  glEnable(GL_CULL_FACE);
  clamp_depths(false);

  glDisable(GL_DEPTH_TEST);
  live_->soften.use();
  live_->soften.set("source", 0);
  live_->softer.bind();
  limit_drawing(changed.grown(kBlur, 0, kSoftShadowSize, kSoftShadowSize));
  live_->shadow.bind_texture(0);
  live_->soften.set("along", 1, 0);
  nothing_.draw_fullscreen();
  live_->softest.bind();
  limit_drawing(within(changed.grown(kBlur, kBlur, kSoftShadowSize, kSoftShadowSize), kInnerShadow));
  live_->softer.bind_texture(0);
  live_->soften.set("along", 0, 1);
  nothing_.draw_fullscreen();
  glEnable(GL_DEPTH_TEST);
}

// Wall and drape. Neither hides anything, because they are drawn first and without depths.
void Painter::draw_behind(const StudioView& view) {
  glDisable(GL_DEPTH_TEST);
  background_.use();
  nothing_.draw_fullscreen();
  if (drape_) {
    drape_->program.use();
    drape_->program.set("projection", view.projection);
    drape_->program.set("middle", drape_->middle);
    drape_->program.set("radius", drape_->radius);
    drape_->program.set("pixel_size", texel_of(resolved_));
    drape_->mesh.draw();
  }
  glEnable(GL_DEPTH_TEST);
}

void Painter::draw_backdrop(const StudioView& view, const Camera& camera) {
  if (live_->backdrop_of && (!drape_ || *live_->backdrop_of == camera)) return;
  live_->backdrop.bind();
  draw_behind(view);
  live_->backdrop_of = camera;
}

void Painter::draw_live(const StudioView& view, const Camera& camera, const Part& part) {
  finished_ = quality_ == Quality::kFast ? &live_->picture : &resolved_;
  draw_backdrop(view, camera);
  glEnable(GL_SCISSOR_TEST);
  draw_soft_shadow(view, part.shadow);
  if (!part.tiles.empty()) draw_part(view, part.tiles);
  glDisable(GL_SCISSOR_TEST);
}

void Painter::draw_part(const StudioView& view, const ChangedTiles& tiles) {
  Target& drawn = live_->picture;
  drawn.bind();
  const std::vector<PixelBox> rectangles = tiles.rectangles();
  // Everything is drawn once, over the rectangle around all tiles. Outside the tiles nothing is nearer than
  // the depth there.
  limit_drawing(tiles.bounds());
  if (!tiles.all()) clear_depth(0.0F);
  for (const PixelBox& pixels : rectangles) {
    limit_drawing(pixels);
    clear_depth(1.0F);
  }
  limit_drawing(tiles.bounds());
  live_->softest.bind_texture(0);
  draw_materials(view, tiles);
  // The background last, only where nothing covers it.
  live_->backdrop.bind_texture(0);
  live_->copy.use();
  live_->copy.set("source", 0);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_FALSE);
  nothing_.draw_fullscreen();
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  if (quality_ != Quality::kFast) {
    glDisable(GL_DEPTH_TEST);
    resolved_.bind();
    drawn.bind_texture(0);
    live_->smooth_edges.use();
    live_->smooth_edges.set("source", 0);
    live_->smooth_edges.set("last", drawn.width() - 1, drawn.height() - 1);
    for (const PixelBox& pixels : rectangles) {
      limit_drawing(pixels.grown(1, 1, width_, height_));  // it looks at the neighbours of a pixel
      nothing_.draw_fullscreen();
    }
    glEnable(GL_DEPTH_TEST);
  }
}

void Painter::draw(const Camera& camera, const LitRegion& region) {
  finished_ = &resolved_;
  const StudioView view(camera, static_cast<double>(width_) / height_, region);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);  // the inside of an organ is never drawn
  enable_multisampling();
  if (quality_ == Quality::kFull) {
    draw_still(view);
  } else {
    draw_live(view, camera, changed_part(view, camera, region));
  }
}

Image Painter::read() const {
  finished_->bind();
  return read_pixels(width_, height_);
}

Image Painter::paint(const Camera& camera, const LitRegion& region) {
  draw(camera, region);
  return read();
}

}  // namespace palpate::render
