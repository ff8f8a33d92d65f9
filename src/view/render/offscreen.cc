#include "palpate/offscreen.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "io/system/clock.h"
#include "palpate/error.h"
#include "view/render/drape.h"
#include "view/render/gl_context.h"
#include "view/render/gl_objects.h"
#include "view/render/opengl.h"
#include "view/render/organ_picture.h"
#include "view/render/organ_vessels.h"
#include "view/render/painter.h"
#include "view/render/surface_map.h"
#include "view/render/tissue_pattern.h"

namespace palpate::render {
namespace {

// Of the organ's diagonal: radius of the ball that the light must cover, and how far its box reaches beyond
// the organ at rest.
constexpr double kLitShare = 0.75;
constexpr double kLitMargin = 0.1;
const Vec3 kNowhere(0, 0, 1e3);  // m: position of tools that a snapshot lacks

void check_size(int width, int height) {
  if (width >= 1 && height >= 1 && width <= kLargestSide && height <= kLargestSide) return;
  throw InputError(fmt::format("a picture of {} x {} pixels cannot be drawn; want 1 to {} a side", width,
                               height, kLargestSide));
}

void check_count(std::size_t values, std::size_t points) {
  if (values == points) return;
  throw InputError(fmt::format("{} values for {} points of the surface; want one per point", values, points));
}

constexpr double kSameHole = 0.5e-3;  // m between entries through one hole

constexpr double kShare = 0.15;  // weight of the newest picture in the running mean
constexpr int kFewest = 12;      // number of pictures before the mean is used
constexpr int kSlowInARow = 3;   // consecutive pictures over the budget that lower the quality at once
constexpr double kRoom = 0.6;    // of the budget: a mean below it allows a higher quality
constexpr int kLongestWait = 120 * 32;

Quality better(Quality q) { return static_cast<Quality>(static_cast<int>(q) - 1); }
Quality cheaper(Quality q) { return static_cast<Quality>(static_cast<int>(q) + 1); }

}  // namespace

struct OffscreenRenderer::Impl {
  Impl(const Subject& subject, int width, int height, Quality quality)
      : look(tissue_appearance(subject.tissue_name)),
        organ_name(subject.organ_name),
        painter(look, width, height, quality),
        organ(subject.organ, subject.reach, quality == Quality::kFull ? Detail::kStill : Detail::kLive,
              subject.support, subject.store) {
    for (const geometry::Tool& tool : subject.tools) {
      shapes.emplace_back(tool);
      tools.emplace_back(tool);
      jaws.push_back(Jaws::of(tool));
      has_needle = has_needle || tool.needle;
    }
    if (has_needle) painter.show_holes({});
    const geometry::Bounds box = geometry::bounds(subject.organ);
    const double diagonal = box.size().norm();
    region = {box.middle(), kLitShare * diagonal, Quat::Identity(),
              0.5 * box.size() + Vec3::Constant(kLitMargin * diagonal)};
    driver = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    upload_organ_at_rest();
    upload_tools();
    painter.show_inclusions(subject.inclusions);
  }

  void upload_organ_at_rest() {
    DeformingMesh& mesh = painter.organ().mesh;
    std::vector<std::uint32_t> corners;
    corners.reserve(organ.rest().triangles.size() * 3);
    for (const geometry::Triangle& t : organ.rest().triangles)
      for (const std::int32_t v : t) corners.push_back(static_cast<std::uint32_t>(v));
    mesh.set(corners, organ.vertices());
    std::vector<StaticVertex> pattern = tissue_pattern(organ.rest(), look);
    paint_vessels(organ_name, organ.rest(), look, pattern);
    mesh.gpu().set_static(pattern);
    painter.redraw_all();
    static_cast<void>(organ.take_changes());
    assign_values();
  }

  // Assigns the points of the values to the displayed mesh.
  void assign_values() {
    map = SurfaceMap(organ.rest(), values.points_S);
    upload_values();
  }

  void upload_values() {
    painter.show_values(!values.values.empty());
    if (!values.values.empty())
      painter.organ().mesh.gpu().set_map(
          map.attributes(organ.rest().triangles, values.values, values.low, values.high));
  }

  void upload_tools() {
    for (const ToolPicture& tool : tools) {
      for (std::size_t part = 0; part < tool.parts(); ++part) {
        const IndexedCorners indexed = indexed_corners(tool.corners(part));
        std::vector<StaticVertex> still;
        for (const deform::SurfaceVertex& v : indexed.vertices)
          still.push_back({v.position, {}, Eigen::Vector3f::Zero(), {255, 0, 0, 0}});
        auto solid = std::make_unique<Solid>();
        solid->mesh.set_triangles(indexed.corners);
        solid->mesh.set_static(still);
        solid->mesh.set_moving(indexed.vertices);
        solid->blocks = RigidBlocks(tool.corners(part));
        painter.tools().push_back(std::move(solid));
      }
    }
  }

  // Keeps a hole wherever a needle has gone in, until a run begins again.
  void keep_holes(const haptics::Snapshot& snapshot) {
    if (!has_needle) return;
    bool changed = snapshot.tick < newest_tick && !holes.empty();
    if (changed) holes.clear();
    newest_tick = snapshot.tick;
    for (const contact::ToolResult& result : snapshot.hand_results()) {
      if (result.phase != contact::Phase::kInsert || result.view_count == 0) continue;
      const contact::ContactView& entry = result.views.front();
      const bool known = std::any_of(holes.begin(), holes.end(), [&entry](const PunctureHole& hole) {
        return (hole.point_S - entry.point_S).norm() < kSameHole;
      });
      if (known) continue;
      if (holes.size() == kMaxMarks) holes.erase(holes.begin());
      holes.push_back({entry.point_S, entry.half_width});
      changed = true;
    }
    if (changed) painter.show_holes(holes);
  }

  void show_drape(bool shown) {
    drape_shown = shown;
    if (shown && drape) {
      painter.show_drape(&*drape);
    } else if (!shown) {
      painter.show_drape(nullptr);
    }
  }

  // The drape is where the organ of the first picture lies.
  void lay_down(const Pose& organ_W) {
    if (!drape_shown || drape) return;
    drape = drape_below(organ.rest(), organ_W);
    painter.show_drape(&*drape);
  }

  void show(const haptics::Snapshot& snapshot) {
    keep_holes(snapshot);
    lay_down(snapshot.organ_W);
    painter.organ().pose_W = snapshot.organ_W;
    std::size_t solid = 0;
    for (std::size_t hand = 0; hand < tools.size(); ++hand) {
      const bool there = hand < std::min<std::size_t>(snapshot.hands, kMaxHands);
      const double gripper = there ? drawn_gripper(snapshot, hand, jaws[hand] ? &*jaws[hand] : nullptr) : 0.0;
      for (std::size_t part = 0; part < tools[hand].parts(); ++part, ++solid) {
        painter.tools()[solid]->pose_W =
            there ? tools[hand].part_pose(part, snapshot.tools[hand].pose_W, gripper)
                  : Pose{Quat::Identity(), kNowhere};
      }
    }
    if (organ.update(deform::indentations_of(snapshot.hand_results()), imprints_of(snapshot, shapes),
                     folds_of(snapshot, jaws))) {
      upload_organ_at_rest();
      return;
    }
    for (const deform::DeformedSurface::Range& range : organ.take_changes())
      painter.organ().mesh.change(range.first, organ.vertices().subspan(range.first, range.count));
  }

  void follow_time() {
    choice.emplace();
    draw_each_quality();
  }

  // Draws once in each adaptive quality: a driver compiles shaders at their first draw, which takes longer
  // than several pictures and must not happen during motion.
  void draw_each_quality() {
    const Camera camera{region.middle - 3.0 * region.radius * Vec3::UnitY(), region.middle};
    for (const Quality quality : {Quality::kFast, choice->now()}) {
      painter.set_quality(quality);
      painter.draw(camera, region);
    }
    finish_drawing();
    annotated_before = annotated_before || painter.annotated();
  }

  // After a change of values, marks or inclusions: the first ones need shaders of their own.
  void prepare_annotations() {
    if (choice && painter.annotated() && !annotated_before) draw_each_quality();
  }

  void draw(const haptics::Snapshot& snapshot, const Camera& camera) {
    const std::int64_t start = monotonic_ns();
    const std::int64_t computed = thread_cpu_ns();
    show(snapshot);
    update_ms = static_cast<double>(thread_cpu_ns() - computed) * 1e-6;
    painter.draw(camera, {snapshot.organ_W * region.middle, region.radius, snapshot.organ_W.rotation,
                          region.half_size});
    if (!choice) return;
    finish_drawing();
    choice->add(static_cast<double>(monotonic_ns() - start) * 1e-6);
    painter.set_quality(choice->now());
  }

  TissueAppearance look;
  std::string organ_name;
  Painter painter;
  OrganPicture organ;
  SurfaceValues values;
  SurfaceMap map;
  std::vector<ToolShape> shapes;
  std::vector<ToolPicture> tools;
  std::vector<std::optional<Jaws>> jaws;  // of the tools
  LitRegion region;                       // organ frame
  bool has_needle = false;
  std::uint64_t newest_tick = 0;
  std::vector<PunctureHole> holes;
  bool drape_shown = false;
  std::optional<Drape> drape;  // once it was shown
  std::string driver;
  double update_ms = 0.0;
  std::optional<QualityChoice> choice;
  bool annotated_before = false;  // draw_each_quality() has drawn with values, marks or inclusions
};

// Makes the renderer's own context, if any, current during a call.
class OffscreenRenderer::Current final {
 public:
  explicit Current(GlContext* context) : context_(context) {
    if (context_ != nullptr) context_->make_current();
  }
  ~Current() {
    if (context_ != nullptr) context_->release();
  }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  GlContext* context_;
};

OffscreenRenderer::OffscreenRenderer(const Subject& subject, int width, int height, Quality quality) {
  check_size(width, height);
  context_ = std::make_unique<GlContext>();
  impl_ = std::make_unique<Impl>(subject, width, height, quality);
  context_->release();
}

OffscreenRenderer::OffscreenRenderer(const Subject& subject, int width, int height, InCurrentContext here)
    : OffscreenRenderer(subject, width, height, here, Quality::kBalanced) {
  impl_->follow_time();
}

OffscreenRenderer::OffscreenRenderer(const Subject& subject, int width, int height, InCurrentContext /*here*/,
                                     Quality quality) {
  check_size(width, height);
  impl_ = std::make_unique<Impl>(subject, width, height, quality);
}

OffscreenRenderer::~OffscreenRenderer() {
  if (context_) context_->make_current();
}

Image OffscreenRenderer::draw(const haptics::Snapshot& snapshot, const Camera& camera) {
  draw_and_keep(snapshot, camera);
  return kept();
}

void OffscreenRenderer::draw_and_keep(const haptics::Snapshot& snapshot, const Camera& camera) {
  const Current current(context_.get());
  impl_->draw(snapshot, camera);
}

Image OffscreenRenderer::kept() {
  const Current current(context_.get());
  return impl_->painter.read();
}

void OffscreenRenderer::show_at(int x, int y, int width, int height) {
  const Current current(context_.get());
  impl_->painter.show_at(x, y, width, height);
}

void OffscreenRenderer::resize(int width, int height) {
  check_size(width, height);
  const Current current(context_.get());
  impl_->painter.resize(width, height);
}

void OffscreenRenderer::set_map_range(double range) { impl_->painter.set_map_range(range); }

void OffscreenRenderer::show_values(SurfaceValues values) {
  check_count(values.values.size(), values.points_S.size());
  if (!(values.low < values.high)) {
    throw InputError(fmt::format("a map of values from {} to {} cannot be drawn; the first must be lower",
                                 values.low, values.high));
  }
  const Current current(context_.get());
  impl_->values = std::move(values);
  impl_->assign_values();
  impl_->prepare_annotations();
}

void OffscreenRenderer::update_values(std::span<const float> values) {
  check_count(values.size(), impl_->values.points_S.size());
  const Current current(context_.get());
  impl_->values.values.assign(values.begin(), values.end());
  impl_->upload_values();
}

void OffscreenRenderer::show_marks(const std::vector<SurfaceMark>& marks) {
  if (marks.size() > kMaxMarks)
    throw InputError(fmt::format("{} marks cannot be drawn; want at most {}", marks.size(), kMaxMarks));
  std::vector<Vec3> points;
  for (const SurfaceMark& mark : marks) points.push_back(mark.point_S);
  const std::vector<Vec3> normals = normals_at(impl_->organ.rest(), points);
  std::vector<PlacedMark> placed;
  for (std::size_t i = 0; i < marks.size(); ++i) placed.push_back({marks[i], normals[i]});
  const Current current(context_.get());
  impl_->painter.show_marks(std::move(placed));
  impl_->prepare_annotations();
}

void OffscreenRenderer::show_inclusions(std::vector<model::Inclusion> inclusions) {
  const Current current(context_.get());
  impl_->painter.show_inclusions(std::move(inclusions));
  impl_->prepare_annotations();
}

void OffscreenRenderer::set_support(std::optional<geometry::Support> support) {
  impl_->organ.set_support(std::move(support));
}

ResponseState OffscreenRenderer::response() const noexcept { return impl_->organ.response(); }

void OffscreenRenderer::show_drape(bool shown) {
  const Current current(context_.get());
  impl_->show_drape(shown);
}

void OffscreenRenderer::switch_lamps(bool on) { impl_->painter.switch_lamps(on); }

void OffscreenRenderer::redraw_all() { impl_->painter.redraw_all(); }

void OffscreenRenderer::adapt_to_time() {
  const Current current(context_.get());
  impl_->follow_time();
}

void OffscreenRenderer::hold_quality(Quality quality) {
  const Current current(context_.get());
  impl_->choice.reset();
  impl_->painter.set_quality(quality);
}

void OffscreenRenderer::limit_quality(Quality best) {
  if (!impl_->choice) return;
  impl_->choice->limit(best);
  const Current current(context_.get());
  impl_->painter.set_quality(impl_->choice->now());
}

Quality OffscreenRenderer::quality() const { return impl_->painter.quality(); }

double OffscreenRenderer::update_ms() const { return impl_->update_ms; }

void OffscreenRenderer::finish() {
  const Current current(context_.get());
  finish_drawing();
}

std::string OffscreenRenderer::driver() const { return impl_->driver; }

void QualityChoice::add(double frame_ms) noexcept {
  if (wait_ > 0) --wait_;
  if (seen_++ == 0) return;
  mean_ms_ = seen_ == 2 ? frame_ms : mean_ms_ + kShare * (frame_ms - mean_ms_);
  slow_ = frame_ms > budget_ms_ ? slow_ + 1 : 0;
  const bool judged = seen_ > kFewest;
  if (now_ != Quality::kFast && (slow_ >= kSlowInARow || (judged && mean_ms_ > budget_ms_))) {
    now_ = cheaper(now_);
    seen_ = slow_ = 0;
    wait_ = next_wait_;
    next_wait_ = std::min(2 * next_wait_, kLongestWait);  // each failure of a level doubles the wait
  } else if (judged && mean_ms_ < kRoom * budget_ms_ && now_ != best_ && wait_ == 0) {
    now_ = better(now_);
    seen_ = slow_ = 0;
  }
}

void QualityChoice::limit(Quality best) noexcept {
  best_ = best;
  if (now_ >= best) return;
  now_ = best;
  seen_ = slow_ = 0;
}

}  // namespace palpate::render
