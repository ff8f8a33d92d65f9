#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/contact/contact.h"
#include "palpate/offscreen.h"
#include "palpate/scene.h"
#include "palpate/tick_observer.h"
#include "view/render/needle_section.h"

#include "app/window/orbit_camera.h"

namespace palpate::app {

/// Which marks are drawn over the picture.
struct PictureMarks {
  bool force = true;    // an arrow at each contact
  bool scale = true;    // a bar of known length
  bool axes = true;     // directions of the world's axes
  bool section = true;  // the layers along a needle, beside the picture
  bool inside = false;  // a needle's shaft through the tissue
};

/// Length of the force arrow [m per N].
inline constexpr double kArrowLength = 0.1;

/// Marks as lines, filled triangles and words, in pixels from the picture's upper left corner, for any means
/// of drawing.
struct MarkShapes {
  enum class Colour { kText, kForce, kX, kY, kZ, kPlate, kSteel, kLayer };  // kLayer + i: layer i
  struct Point {
    float x = 0.0F;
    float y = 0.0F;
  };
  struct Line {
    Point from;
    Point to;
    Colour colour;
    float width;
  };
  struct Triangle {
    Point tip;
    Point left;
    Point right;
    Colour colour;
  };
  struct Words {
    Point at;  // upper left corner
    Colour colour;
    std::string text;
  };

  std::vector<Line> lines;  // from the farthest to the nearest
  std::vector<Triangle> triangles;
  std::vector<Words> words;
};

/// A picture's size in pixels, and the size of its letters.
struct PictureSize {
  float width = 0.0F;
  float height = 0.0F;
  float letters = 15.0F;
};

/// [any] Length of a scale bar: 1, 2 or 5 times a power of ten, the longest that is at most `longest` [m].
[[nodiscard]] double scale_bar_length(double longest);

/// The first needle of a scene whose tissue has layers: the section along it at the right of the picture, and
/// its shaft in the tissue.
class NeedleMarks final {
 public:
  /// [setup] @return nothing in scenes without a needle that goes in
  [[nodiscard]] static std::optional<NeedleMarks> of(const scene::Scene& scene, const contact::World& world);
  /// [setup] The names of the layers are left out in a narrow picture.
  void add(MarkShapes& shapes, const PictureMarks& marks, const PictureSize& size,
           const render::Camera& camera, const haptics::Snapshot& shown);

 private:
  NeedleMarks(std::size_t hand, const geometry::Needle& needle, const model::TissueParameters& tissue,
              const geometry::SignedDistance& rest);

  std::size_t hand_;
  geometry::Needle needle_;
  std::vector<model::TissueLayer> layers_;
  render::NeedleSection section_;
};

/// [setup] The marks over a picture; none if it is too small. The bar is right at the distance of the view's
/// centre. @param needle may be null
[[nodiscard]] MarkShapes shapes_of(const PictureMarks& marks, const PictureSize& size,
                                   const OrbitCamera& camera, const haptics::Snapshot& shown,
                                   NeedleMarks* needle);

/// [any] Whether tools and contacts are inside the picture, not at its very edge. Tools far from the organ do
/// not count.
[[nodiscard]] bool contacts_in_frame(const haptics::Snapshot& shown, const render::Camera& camera,
                                     double aspect);

/// [setup] Takes the view at the start of a run: the organ from above in a search, else the tool and the
/// place nearest to it. @param aspect width over height of the picture
void look_as_at_start(OrbitCamera& camera, const render::Subject& subject, const haptics::Snapshot& shown,
                      bool search, double aspect);

}  // namespace palpate::app
