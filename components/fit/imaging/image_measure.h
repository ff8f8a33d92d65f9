#pragma once
#include <string>
#include <vector>

#include "palpate/tissue.h"

#include "fit/imaging/image_line.h"

namespace palpate::imaging {

struct ImageSettings {
  double pixel = 0.0;  // m per pixel
  model::Direction direction = model::Direction::kPress;
  bool fixed_camera = false;  // the pictures are aligned: no rotation or shift is corrected
};

/// Displacement of the surface at one point. SI units.
struct ImagePoint {
  double x = 0.0;            // column of the second picture, pixels
  double y = 0.0;            // row of the line there, pixels
  double rest_y = 0.0;       // row of the line without displacement, pixels
  double r = 0.0;            // arc length along the undisturbed surface from the centre of the indentation
                             // [m]
  bool right = false;        // side of the centre
  double u = 0.0;            // displacement perpendicular to the undisturbed surface [m]; + in the requested
                             // direction
  double uncertainty = 0.0;  // 95 % uncertainty of u [m]
};

/// A displacement profile measured between two pictures. SI units unless pixels are stated.
struct ImageMeasurement {
  SurfaceLine before;
  SurfaceLine after;
  std::vector<ImagePoint> points;   // from left to right
  double depth = 0.0;               // largest u that is seen [m]
  bool tip_hidden = false;          // the deepest point is hidden
  double centre_x = 0.0;            // centre of the indentation, pixels of the second picture
  double centre_uncertainty = 0.0;  // 95 % [m]
  double tilt = 0.0;                // angle of the undisturbed surface to the picture's rows [rad]
  double turn = 0.0;                // rotation of the second picture relative to the first, corrected [rad]
  double shift = 0.0;               // its shift perpendicular to the surface, corrected [m]
  double far_uncertainty = 0.0;     // part of the uncertainty of u due to motion of the flanks [m]
  double uncertainty = 0.0;         // median over the points [m]
  double asymmetry = 0.0;           // RMS difference of left and right, divided by the depth
  int confidence = 0;               // 0 .. 100
  std::string confidence_text;      // what limits it
};

/// [setup] Measures the displacement of a surface between two side views of equal size, with the tissue below
/// and the instrument above. Both surface lines are detected (image_line.h). Rotation and shift between the
/// pictures are estimated from the undisturbed flanks and corrected, together with an elastic far field,
/// whose size adds to the uncertainty. u is perpendicular to the undisturbed surface. Points that an
/// instrument hides are omitted.
/// @param names of the pictures, for messages
/// @throws InputError of one line. Causes: different sizes, no reliable line, lines that look different, no
/// displacement or the opposite one, an indentation that is not between undisturbed flanks.
[[nodiscard]] ImageMeasurement measure_pictures(const Picture& before, const Picture& after,
                                                const ImageSettings& settings, const std::string& before_name,
                                                const std::string& after_name);

}  // namespace palpate::imaging
