#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/inclusion.h"
#include "palpate/mesh.h"
#include "palpate/preparation.h"
#include "palpate/surface.h"
#include "palpate/tick_observer.h"
#include "palpate/tissue.h"
#include "palpate/tool.h"

namespace palpate::render {

/// Rendering quality. All levels draw the same objects in the same light.
enum class Quality : std::uint8_t {
  kFull,      // for reports and files: finest surface, shadows and occlusion of everything, four samples per
              // pixel
  kBalanced,  // for moving pictures: occlusion of the organ at rest, soft shadow of the tools, antialiasing
  kFast,      // as kBalanced without the finest pattern and without antialiasing
};

/// Chooses the quality from measured frame times, so that they stay within a budget [ms]. It chooses
/// kBalanced or kFast, or kFull if `best` allows it. The quality goes down when the mean frame time or three
/// consecutive frame times exceed the budget. It goes up when the mean is clearly below the budget. Each time
/// it goes down again, the wait before the next rise doubles, so that the quality does not oscillate. The
/// first picture of a level is ignored, because its time may include preparation.
class QualityChoice final {
 public:
  static constexpr double kBudget_ms = 32.0;  // frame time of the paper

  /// [any] @param best highest level that it may choose
  explicit QualityChoice(Quality best = Quality::kBalanced, double budget_ms = kBudget_ms) noexcept
      : best_(best), now_(best), budget_ms_(budget_ms) {}

  /// [any] Adds the frame time [ms] of one picture with the quality now().
  void add(double frame_ms) noexcept;
  /// [any] Limits all further pictures to this level.
  void limit(Quality best) noexcept;
  [[nodiscard]] Quality now() const noexcept { return now_; }

 private:
  Quality best_;
  Quality now_;
  double budget_ms_;
  double mean_ms_ = 0.0;  // running mean at now_
  int seen_ = 0;          // number of pictures at now_
  int slow_ = 0;          // consecutive pictures over the budget
  int wait_ = 0;          // pictures until a higher level is tried again
  int next_wait_ = 120;
};

class GlContext;

/// 8-bit RGB image, top row first.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Largest width and height of a picture, in pixels.
inline constexpr int kLargestSide = 8192;

/// [setup] Writes a PNG file. @throws InputError that names the file when it cannot be written.
void write_png(const Image& image, const std::filesystem::path& file);

/// The scene data that stay constant between ticks.
struct Subject {
  geometry::TriangleMesh organ;  // rest surface, organ frame
  std::vector<geometry::Tool> tools;
  model::FalloffRatios reach;
  std::string tissue_name;  // selects the colours: gallbladder, heart, liver, kidney; else a neutral tissue
  std::vector<model::Inclusion> inclusions{};          // the visible ones, at most model::kMaxInclusions
  std::optional<geometry::Support> support{};          // with it, the whole organ gives way
  std::string organ_name{};                            // of a built-in organ: shows its vessels
  std::shared_ptr<const contact::OrganStore> store{};  // for the organ's response under `support`
};

/// Values at points of the rest surface, drawn as a colour map.
struct SurfaceValues {
  std::vector<Vec3> points_S;  // [m], organ frame, about 1 mm apart
  std::vector<float> values;   // one per point; NaN: not known
  double low = 0.0;            // value at the dark end of the colour map
  double high = 1.0;           // value at the bright end, above `low`
};

/// What moves the organ's surface.
enum class ResponseState : std::uint8_t {
  kNone,       // the displacement profile: nothing is known to hold the organ
  kPreparing,  // the profile, until the response is there
  kShown,      // the response of the whole organ
  kFailed,     // the profile, because too little is held
};

/// A mark on the organ's surface.
struct SurfaceMark {
  enum class Kind : std::uint8_t {
    kFound,  // a dot in a ring
    kFalse,  // a cross
    kLump,   // a larger ring
  };
  Vec3 point_S = Vec3::Zero();  // [m], organ frame
  Kind kind = Kind::kFound;
};
inline constexpr std::size_t kMaxMarks = 32;

/// Position and direction of view. World frame.
struct Camera {
  Vec3 eye = Vec3(0.1, -0.2, 0.1);
  Vec3 target = Vec3::Zero();
  Vec3 up = Vec3::UnitZ();
  double vertical_view_deg = 30.0;

  bool operator==(const Camera&) const = default;
};

/// [setup] A camera that frames organ and tool tip from the direction with the best view of the contact, 33
/// degrees above the tangent plane, with the normal upright. It depends only on focus, normal, organ pose and
/// direction of the tool's axis. To compare pictures before, during and after a contact, use one camera for
/// all of them.
/// @param focus_W contact point (or nearest point) @param normal_W outward normal there
/// @param close_up true: the contact fills the picture; false: the whole organ is visible
[[nodiscard]] Camera frame_contact(const Subject& subject, const haptics::Snapshot& snapshot,
                                   const Vec3& focus_W, const Vec3& normal_W, bool close_up);

/// [setup] A camera that looks straight down (-z) and frames the whole organ, with y upwards in the picture.
/// @param aspect width of the picture over its height
[[nodiscard]] Camera frame_from_above(const Subject& subject, const haptics::Snapshot& snapshot,
                                      double aspect);

/// Renders snapshots without a display: SDL's offscreen video driver over Mesa EGL, OpenGL 3.3 core or later.
/// Any thread may call it, one at a time.
class OffscreenRenderer final {
 public:
  /// [setup] @param width, height of the pictures, 1 to 8192 pixels
  /// @throws std::runtime_error that names the missing packages when there is no OpenGL context, InputError
  /// for an invalid size.
  OffscreenRenderer(const Subject& subject, int width, int height, Quality quality = Quality::kFull);
  /// Selects the OpenGL context that is current on this thread, such as a window's.
  struct InCurrentContext {};
  /// [setup] Renders in the context that is current on this thread. It must be current at every later call
  /// too, and must outlive this object. The quality adapts to the frame time (QualityChoice).
  OffscreenRenderer(const Subject& subject, int width, int height, InCurrentContext here);
  /// [setup] Renders in the current context like the constructor above, but with a fixed quality and with the
  /// same pictures as a renderer that has its own context.
  OffscreenRenderer(const Subject& subject, int width, int height, InCurrentContext here, Quality quality);
  ~OffscreenRenderer();

  /// [setup] Renders one snapshot: the deformed organ (model.md section 3), each tool at its pose and jaw
  /// opening.
  [[nodiscard]] Image draw(const haptics::Snapshot& snapshot, const Camera& camera);

  /// [setup] The two steps of draw(): renders and keeps the picture; reads the kept picture.
  void draw_and_keep(const haptics::Snapshot& snapshot, const Camera& camera);
  [[nodiscard]] Image kept();
  /// [setup] Copies the kept picture, scaled, to a rectangle of the window [pixels, y up from its lower
  /// edge].
  void show_at(int x, int y, int width, int height);
  /// [setup] Sets the size of all further pictures, 1 to 8192 pixels. @throws InputError for an invalid size.
  void resize(int width, int height);

  /// [setup] Colours the organ by displacement, up to `range` [m]; 0: natural colours.
  void set_map_range(double range);
  /// [setup] Colours the organ by values at points of its rest surface, in place of the displacement. Each
  /// vertex takes the value of the nearest point within 3 mm on its side of the organ. Where no value is
  /// known, the organ keeps its natural colour, slightly greyed. No points: natural colours again.
  /// @throws InputError when the numbers of points and values differ, or `low` < `high` does not hold
  void show_values(SurfaceValues values);
  /// [setup] Replaces the values of the last show_values() without a new assignment of points. 100,000 values
  /// take about a millisecond. @throws InputError when the number of values differs
  void update_values(std::span<const float> values);
  /// [setup] Replaces the marks on the surface. They are drawn where they face the camera, as large as a
  /// fixed fraction of the picture. @throws InputError for more than kMaxMarks
  void show_marks(const std::vector<SurfaceMark>& marks);
  /// [setup] Changes what holds the organ. Its response is prepared in the background; until then, and after
  /// a support that holds too little, the displacement profile shows.
  void set_support(std::optional<geometry::Support> support);
  /// [any] Whether the surface gives way as a whole.
  [[nodiscard]] ResponseState response() const noexcept;
  /// [setup] Replaces the inclusions that are drawn as translucent spheres inside the organ: pale where they
  /// are stiffer than the tissue, blue where softer.
  void show_inclusions(std::vector<model::Inclusion> inclusions);
  /// [setup] Shows a surgical drape spread under the organ, initially hidden. It touches the lowest point of
  /// the organ in the first picture, stays there, and has the soft shadow of the organ at rest. It hides
  /// nothing, and from below it is not seen.
  void show_drape(bool shown);
  /// [setup] Switches the studio lamps, initially on. Off: ambient light only.
  void switch_lamps(bool on);
  /// [setup] Draws all of the next picture. Other pictures for motion (kBalanced, kFast) draw only what
  /// changed since the last one, where the camera and all settings are the same; their pixels are the same.
  void redraw_all();
  /// [setup] Adapts the quality to the frame time, as in a window.
  void adapt_to_time();

  /// [setup] Fixes the quality of all further pictures.
  void hold_quality(Quality quality);
  /// [setup] Limits the adaptive quality to this level.
  void limit_quality(Quality best);
  /// [any] The quality of the next picture.
  [[nodiscard]] Quality quality() const;
  /// [any] CPU time [ms] of deformation and upload for the last picture.
  [[nodiscard]] double update_ms() const;
  /// [setup] Waits until all drawing is complete.
  void finish();

  /// [any] Name of the renderer as OpenGL reports it, for the report.
  [[nodiscard]] std::string driver() const;

 private:
  struct Impl;
  class Current;
  std::unique_ptr<GlContext> context_;  // destroyed last; null: the window's context
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::render
