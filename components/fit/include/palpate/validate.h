#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "palpate/surface.h"
#include "palpate/tissue.h"

namespace palpate::validate {

/// A measured displacement profile: displacement of the surface around one contact, along the tool's
/// direction. SI units.
struct Deformation {
  std::string name;
  double depth = 0.0;                // D [m], indentation depth below the rest surface; 0: not in the file
  std::vector<double> distance;      // r [m] from the contact along the rest surface, >= 0, increasing
  std::vector<double> displacement;  // u [m], positive in the tool's direction

  [[nodiscard]] std::size_t size() const noexcept { return distance.size(); }
};

inline constexpr std::size_t kFewestPlaces = 5;

/// [setup] Reads the displacement profiles of a CSV file. Columns, by header name: r_mm, u_mm and optionally
/// depth_mm. Lines that begin with # and blank lines are ignored. Rows with equal depth_mm form one profile,
/// named after the file and its depth. r_mm < 0 is the other side of the contact and counts as its absolute
/// value. Rows may be in any order.
/// @throws InputError that names file, line, column and value. Causes: no such file, a missing or unknown
/// header, a value that is not a finite number, a depth that is not > 0, fewer than kFewestPlaces rows.
/// Causes in a profile: constant positions or displacements, displacements that grow away from the contact (a
/// wrong sign).
[[nodiscard]] std::vector<Deformation> read_deformations(const std::filesystem::path& file);

/// [setup] Sorts a profile by distance and checks it. @param where file or name, for the message @throws
/// InputError for the causes that read_deformations() lists.
void check_deformation(Deformation& deformation, const std::string& where);

/// [setup] Reduces a profile, sorted by distance, to at most `most` points, each the mean of neighbours. A
/// profile with no more points is returned unchanged.
[[nodiscard]] Deformation thinned(const Deformation& deformation, std::size_t most);

/// Form of the surface under an indenting ball.
struct SurfaceRule {
  /// False: u(r) of model.md, section 3, with R_1 limited to the ball's radius. True: the displayed surface,
  /// with unlimited R_1 and nowhere above the ball.
  bool as_drawn = false;
  /// Radius of the convex rest surface [m]; 0: flat. More than 90 degrees from the contact the surface faces
  /// away from the ball; u(r) then applies unchanged.
  double rest_radius = 0.0;
};

/// Displacement of the surface around an indenting ball.
class BallSurface final {
 public:
  /// [any] @param depth D [m]; <= 0: no displacement @param radius R of the ball [m]
  BallSurface(const model::FalloffRatios& reach, double depth, double radius,
              const SurfaceRule& rule) noexcept;

  /// [rt] Displacement [m] at distance r [m] along the surface; at(0) is D.
  [[nodiscard]] double at(double r) const noexcept;

 private:
  deform::DisplacementProfile profile_;
  double depth_;
  double radius_;
  SurfaceRule rule_;
};

/// Just-noticeable difference of force, as a fraction of the force [Jones 2000; model.md].
inline constexpr double kForceJnd = 0.07;

/// Errors of a computed curve, in the unit of the measured one.
struct Errors {
  double rms = 0.0;
  double max = 0.0;    // largest absolute error
  double scale = 0.0;  // reference: the force range, or the depth
  double nrmse = 0.0;  // rms / scale
};

/// [setup] Errors of `computed`. Both curves must have equal size and must not be empty. @param scale > 0, in
/// the unit of the curves
[[nodiscard]] Errors errors_of(const std::vector<double>& measured, const std::vector<double>& computed,
                               double scale);

/// The law of a tissue, for validation.
struct Law {
  model::TissueParameters tissue;
  model::Direction direction = model::Direction::kPress;
  double period = 1e-3;  // T of the loop [s]: it influences the number of layers

  /// [setup] Elastic force [N] at each depth [m]; 0 at depths <= 0. `beyond` receives the number of depths
  /// beyond the last layer. @throws ParameterError as the laws do.
  [[nodiscard]] std::vector<double> forces_at(const std::vector<double>& depths, std::size_t& beyond) const;
  /// [setup] Depth [m] at a force [N]. @throws InputError when the force exceeds what the layers carry.
  [[nodiscard]] double depth_under(double force) const;
};

/// Zeros of a measurement.
struct Zeros {
  double first_contact = 0.0;  // displacement [m] at first contact
  double force = 0.0;          // sensor reading without load [N]
};

/// Comparison of a measured force curve with the law. SI units.
struct ForceComparison {
  identify::Specimen measured;   // the points compared, at most kMaxPoints
  std::vector<double> computed;  // N, predicted sensor reading
  Errors errors;                 // scale: the measured force range
  double within_jnd = 0.0;       // fraction of the points with a relative error of at most kForceJnd
  std::size_t beyond = 0;        // points beyond the last layer, where the law is extrapolated
  std::size_t rows = 0;          // number of rows in the file
  Zeros zeros;                   // the zeros used
};

/// Files with more rows are reduced to this many by means of neighbours.
inline constexpr std::size_t kMaxPoints = 20'000;

/// [setup] Computes the law's force at each point of a measurement, with relaxation over its times when the
/// tissue relaxes. Nothing is fitted. @throws ParameterError as the laws do.
[[nodiscard]] ForceComparison compare_force(const identify::Specimen& specimen, const Law& law,
                                            const Zeros& zeros);

/// Comparison of a measured displacement profile with the model's u(r). SI units.
struct DeformationComparison {
  Deformation measured;
  double depth = 0.0;       // D [m]
  double tip_radius = 0.0;  // R [m]
  SurfaceRule rule;
  std::vector<double> computed;  // u [m]
  Errors errors;                 // scale: D
};

/// [setup] Computes the surface around a ball at each point. @param depth D [m]; 0: the profile's own @throws
/// InputError when there is no depth, or the largest displacement exceeds twice the depth (a wrong unit or
/// depth).
[[nodiscard]] DeformationComparison compare_deformation(const Deformation& deformation,
                                                        const model::FalloffRatios& reach, double depth,
                                                        double tip_radius, const SurfaceRule& rule = {});

}  // namespace palpate::validate
