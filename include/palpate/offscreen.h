#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "palpate/mesh.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"
#include "palpate/tissue.h"
#include "palpate/tool.h"

namespace palpate::render {

/// How much work a picture may be. All draw the same things in the same light.
enum class Quality : std::uint8_t {
  kFull,      // pictures for reports and files: finest surface, shadows and occlusion of everything, four
              // samples a pixel
  kBalanced,  // moving pictures: occlusion of the organ at rest, the tools' soft shadow, smoothed edges
  kFast,      // the same without the finest pattern, and edges as they come
};

/// Chooses between kBalanced and kFast by how long pictures take, so that they stay within a budget; or kFull
/// where there is time for that. Goes down when pictures are slow in the mean or three in a row are, and up
/// only when there is clearly room, more rarely each time that it had to go down again, so that it does not
/// swing. The first picture of a level does not count: it may have had to be prepared for.
class QualityChoice final {
 public:
  static constexpr double kBudget_ms = 32.0;  // the paper's own frame time

  /// [any] @param best the best level that it may choose
  explicit QualityChoice(Quality best = Quality::kBalanced, double budget_ms = kBudget_ms) noexcept
      : best_(best), now_(best), budget_ms_(budget_ms) {}

  /// [any] Takes the time of one picture at now().
  void add(double frame_ms) noexcept;
  /// [any] From here on no better level than this.
  void limit(Quality best) noexcept;
  [[nodiscard]] Quality now() const noexcept { return now_; }

 private:
  Quality best_;
  Quality now_;
  double budget_ms_;
  double mean_ms_ = 0.0;  // of late, at now_
  int seen_ = 0;          // pictures at now_
  int slow_ = 0;          // of them over the budget without one between them that was not
  int wait_ = 0;          // pictures before a better level is tried again
  int next_wait_ = 120;
};

class GlContext;

/// 8-bit RGB, top row first.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// A picture's sides are 1 to this many pixels.
inline constexpr int kLargestSide = 8192;

/// [setup] Writes a PNG. @throws InputError naming the file when it cannot be written.
void write_png(const Image& image, const std::filesystem::path& file);

/// What a picture shows that does not change from tick to tick.
struct Subject {
  geometry::TriangleMesh organ;  // rest, organ frame
  std::vector<geometry::Tool> tools;
  model::ReachParameters reach;
  std::string tissue_name;  // chooses the colour: gallbladder, heart, liver, kidney; else a neutral tissue
};

/// Where the picture is seen from. World frame.
struct Camera {
  Vec3 eye = Vec3(0.1, -0.2, 0.1);
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitZ();
  double vertical_view_deg = 30.0;
};

/// [setup] A camera that frames organ and tool tip from the side on which the contact is best seen, 33
/// degrees above the tangent plane, the normal upright. The same for equal focus, normal, organ pose and
/// direction of the tool's axis, so that pictures before, at and after contact compare: keep it for all of
/// them.
/// @param focus_W the contact (or nearest) point; @param normal_W outward there
/// @param close_up true: the contact fills the picture; false: the whole organ is in it
[[nodiscard]] Camera frame_contact(const Subject& subject, const haptics::Snapshot& snapshot,
                                   const Vec3& focus_W, const Vec3& normal_W, bool close_up);

/// Draws snapshots without a display: SDL's offscreen video driver over Mesa EGL, OpenGL 3.3 core or later.
/// Any thread may call it, one at a time.
class OffscreenRenderer final {
 public:
  /// [setup] @param width, height of the pictures, 1 to 8192 pixels
  /// @throws std::runtime_error naming the missing packages when no OpenGL context can be had, InputError for
  /// a bad size.
  OffscreenRenderer(const Subject& subject, int width, int height, Quality quality = Quality::kFull);
  /// [setup] The same without a context of its own: it draws in the one that is current on this thread (a
  /// window's) now and at every later call, and that outlives this. The quality follows the time that
  /// pictures take (QualityChoice).
  struct InCurrentContext {};
  OffscreenRenderer(const Subject& subject, int width, int height, InCurrentContext here);
  /// [setup] The same, but all pictures have this quality and are those of a context of its own.
  OffscreenRenderer(const Subject& subject, int width, int height, InCurrentContext here, Quality quality);
  ~OffscreenRenderer();

  /// [setup] The picture of one snapshot; organ deformed as model.md section 3 says, tool at its pose and
  /// opening.
  [[nodiscard]] Image draw(const haptics::Snapshot& snapshot, const Camera& camera);

  /// [setup] draw() in two steps: draws and keeps the picture, and reads what was kept.
  void draw_and_keep(const haptics::Snapshot& snapshot, const Camera& camera);
  [[nodiscard]] Image kept();
  /// [setup] Copies the kept picture, stretched, to a rectangle of the window [pixels, y up from its lower
  /// edge].
  void show_at(int x, int y, int width, int height);
  /// [setup] The size of all pictures from here on, 1 to 8192 pixels. @throws InputError for a bad size.
  void resize(int width, int height);

  /// [setup] Colours the organ by how far it has moved, up to `range` [m]; 0: its own colours.
  void set_map_range(double range);
  /// [setup] Switches the studio's lamps, which are on at first: off, only the light from everywhere is left.
  void switch_lamps(bool on);
  /// [setup] From here on the quality follows the time that pictures take, as in a window.
  void adapt_to_time();

  /// [setup] From here on all pictures have this quality, however long they take.
  void hold_quality(Quality quality);
  /// [setup] Where the quality follows time: no better one than this from here on.
  void limit_quality(Quality best);
  /// [any] The quality of the next picture.
  [[nodiscard]] Quality quality() const;
  /// [any] Computing time [ms] that deformation and upload took in the last picture.
  [[nodiscard]] double update_ms() const;
  /// [setup] Waits until what was drawn is there.
  void finish();

  /// [any] The renderer's name as OpenGL gives it, for the report.
  [[nodiscard]] std::string driver() const;

 private:
  struct Impl;
  class Current;
  std::unique_ptr<GlContext> context_;  // goes last; null: the window's
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::render
