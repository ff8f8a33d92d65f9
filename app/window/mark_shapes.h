#pragma once
#include <string>
#include <vector>

#include "palpate/offscreen.h"
#include "palpate/tick_observer.h"

#include "app/window/orbit_camera.h"

namespace palpate::app {

/// Which marks are drawn over the picture.
struct PictureMarks {
  bool force = true;  // an arrow at each contact
  bool scale = true;  // a bar of known length
  bool axes = true;   // directions of the world's axes
};

/// Length of the force arrow [m per N].
inline constexpr double kArrowLength = 0.1;

/// Marks as lines, filled triangles and words, in pixels from the picture's upper left corner, for any means
/// of drawing.
struct MarkShapes {
  enum class Colour { kText, kForce, kX, kY, kZ };
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

/// [setup] The marks over a picture; none if it is too small. The bar is right at the distance of the view's
/// centre.
[[nodiscard]] MarkShapes shapes_of(const PictureMarks& marks, const PictureSize& size,
                                   const OrbitCamera& camera, const haptics::Snapshot& shown);

/// [any] Whether tools and contacts are inside the picture, not at its very edge. Tools far from the organ do
/// not count.
[[nodiscard]] bool contacts_in_frame(const haptics::Snapshot& shown, const render::Camera& camera,
                                     double aspect);

/// [setup] Takes the view at the start of a run: the organ from above in a search, else the tool and the
/// place nearest to it. @param aspect width over height of the picture
void look_as_at_start(OrbitCamera& camera, const render::Subject& subject, const haptics::Snapshot& shown,
                      bool search, double aspect);

}  // namespace palpate::app
