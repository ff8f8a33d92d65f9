#pragma once
#include <string>
#include <vector>

#include "palpate/tissue.h"
#include "science/imaging/image_line.h"

namespace palpate::imaging {

struct ImageSettings {
  double pixel = 0.0;  // m a pixel
  model::Direction direction = model::Direction::kPress;
  bool fixed_camera = false;  // the pictures lie on one another: no turn or shift is taken out
};

/// How far the surface moved at one place. SI.
struct ImagePoint {
  double x = 0.0;            // column of the second picture, pixels
  double y = 0.0;            // row of the line there, pixels
  double rest_y = 0.0;       // row where the line would be had it not moved, pixels
  double r = 0.0;            // along the undisturbed surface from the dent's centre [m]
  bool right = false;        // of the centre
  double u = 0.0;            // along the press or pull, square to the undisturbed surface [m]; + as asked for
  double uncertainty = 0.0;  // of u, 95 % [m]
};

/// A deformation measured between two pictures. SI but where it says pixels.
struct ImageMeasurement {
  SurfaceLine before;
  SurfaceLine after;
  std::vector<ImagePoint> points;   // from left to right
  double depth = 0.0;               // largest u that is seen [m]
  bool tip_hidden = false;          // the deepest place is not seen
  double centre_x = 0.0;            // of the dent, pixels of the second picture
  double centre_uncertainty = 0.0;  // 95 % [m]
  double tilt = 0.0;                // of the undisturbed surface against the picture's rows [rad]
  double turn = 0.0;                // of the second picture against the first, taken out [rad]
  double shift = 0.0;               // of the same, square to the surface [m]
  double far_uncertainty = 0.0;     // of u: how far the flanks themselves may have moved [m]
  double uncertainty = 0.0;         // median of the points' [m]
  double asymmetry = 0.0;           // rms of left less right over the depth
  int confidence = 0;               // 0 .. 100
  std::string confidence_words;     // why it is no more
};

/// [setup] Measures how a surface moved between two side views of one size, the tissue below, the instrument
/// from above. Both lines are found (image_line.h); the turn and shift of one picture against the other come
/// from the undisturbed flanks and are taken out, as is an elastic far field under them, whose size counts as
/// uncertain; u is square to the undisturbed surface. Places that an instrument hides give no point.
/// @param names of the pictures, for messages
/// @throws InputError in one line: sizes differ, no line to trust, the lines look different, nothing moved or
/// the other way, the dent not between undisturbed flanks.
[[nodiscard]] ImageMeasurement measure_pictures(const Picture& before, const Picture& after,
                                                const ImageSettings& settings, const std::string& before_name,
                                                const std::string& after_name);

}  // namespace palpate::imaging
