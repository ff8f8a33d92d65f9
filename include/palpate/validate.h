#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "palpate/surface.h"
#include "palpate/tissue.h"

namespace palpate::validate {

/// A measured deformation of the surface around one contact: how far each place moved along the tool's
/// direction. SI.
struct Deformation {
  std::string name;
  double depth = 0.0;                // D [m], of the tool into the rest surface; 0: the file does not say
  std::vector<double> distance;      // r [m] from the contact along the surface at rest, rising from >= 0
  std::vector<double> displacement;  // u [m], with the tool counts positive

  [[nodiscard]] std::size_t size() const noexcept { return distance.size(); }
};

inline constexpr std::size_t kFewestPlaces = 5;

/// [setup] The deformations of one CSV file with columns r_mm, u_mm and optionally depth_mm, by header name;
/// lines that begin with # and blank lines do not count. Rows of one depth_mm are one deformation, named
/// after the file and its depth. r_mm < 0 is the other side of the contact and counts as its distance. Rows
/// may stand in any order.
/// @throws InputError naming file, line, column and value: no such file, a header that is missing or unknown,
/// a value that is no finite number, a depth that is not > 0, fewer than kFewestPlaces rows, places or
/// displacements that are all the same, displacements that grow away from the contact (a wrong sign).
[[nodiscard]] std::vector<Deformation> read_deformations(const std::filesystem::path& file);

/// [setup] Refuses what no profile can be compared with, and sorts by distance. @param where for the message
/// @throws InputError as read_deformations().
void check_deformation(Deformation& deformation, const std::string& where);

/// [setup] At most `most` places, each the mean of as many neighbours as that takes. A deformation, sorted by
/// distance, that has no more is returned as it is.
[[nodiscard]] Deformation thinned(const Deformation& deformation, std::size_t most);

/// Which surface under a ball is meant.
struct SurfaceRule {
  /// False: u(r) of model.md, section 3, R_1 at most the ball's radius. True: as the picture shows it, R_1
  /// without a bound, and nowhere above the ball itself.
  bool as_drawn = false;
  /// Of the surface at rest, bulging towards the ball [m]; 0: flat. Past a quarter turn it faces away from
  /// the ball and u(r) alone holds.
  double rest_radius = 0.0;
};

/// How far the surface moves around a ball that is pressed into it.
class BallSurface final {
 public:
  /// [any] @param depth D [m]; <= 0: nothing moves @param radius R of the ball [m]
  BallSurface(const model::ReachParameters& reach, double depth, double radius,
              const SurfaceRule& rule) noexcept;

  /// [rt] Displacement [m] at distance r [m] along the surface; at(0) is D.
  [[nodiscard]] double at(double r) const noexcept;

 private:
  deform::SurfaceProfile profile_;
  double depth_;
  double radius_;
  SurfaceRule rule_;
};

/// The smallest change of a force that a hand notices, in shares of the force [Jones 2000; model.md].
inline constexpr double kForceJnd = 0.07;

/// What a computed curve leaves of a measured one, in the measured one's unit.
struct Errors {
  double rms = 0.0;
  double max = 0.0;    // the largest, without sign
  double scale = 0.0;  // what they are compared with: the range of force, or the depth
  double nrmse = 0.0;  // rms / scale
};

/// [setup] Errors of `computed` over `scale` > 0; both as long, not empty.
[[nodiscard]] Errors errors_of(const std::vector<double>& measured, const std::vector<double>& computed,
                               double scale);

/// A tissue's law as validation uses it.
struct Law {
  model::TissueParameters tissue;
  model::Direction direction = model::Direction::kPress;
  double period = 1e-3;  // T of the loop [s]: decides how many layers move

  /// [setup] Elastic force [N] at each depth [m], 0 at depths <= 0; `beyond` gets how many are past the
  /// layers' end. @throws ParameterError as the laws do.
  [[nodiscard]] std::vector<double> forces_at(const std::vector<double>& depths, std::size_t& beyond) const;
  /// [setup] Depth [m] under a force [N]. @throws InputError when the layers cannot take it.
  [[nodiscard]] double depth_under(double force) const;
};

/// Where a measurement's zeros are.
struct Zeros {
  double first_contact = 0.0;  // displacement [m] at which the tool touched
  double force = 0.0;          // what the sensor showed without load [N]
};

/// One measured force curve beside the law's. SI.
struct ForceComparison {
  identify::Specimen measured;   // at most kMostPoints points, as they were compared
  std::vector<double> computed;  // N, what the sensor would have shown
  Errors errors;                 // scale: the range of the measured force
  double within_jnd = 0.0;       // share of the points with an error of at most kForceJnd of their force
  std::size_t beyond = 0;        // points deeper than the tissue's layers go: extrapolated
  std::size_t rows = 0;          // of the file
  Zeros zeros;                   // that were taken
};

/// Files with more rows are thinned to this many by means of neighbours.
inline constexpr std::size_t kMostPoints = 20'000;

/// [setup] The law's force at every point of a measurement, relaxed over its times when the tissue relaxes.
/// Nothing is fitted. @throws ParameterError as the laws do.
[[nodiscard]] ForceComparison compare_force(const identify::Specimen& specimen, const Law& law,
                                            const Zeros& zeros);

/// One measured deformation beside the model's u(r). SI.
struct DeformationComparison {
  Deformation measured;
  double depth = 0.0;       // D [m]
  double tip_radius = 0.0;  // R [m]
  SurfaceRule rule;
  std::vector<double> computed;  // u [m]
  Errors errors;                 // scale: D
};

/// [setup] The surface around a ball at every place. @param depth D [m], 0: the deformation's own
/// @throws InputError when there is no depth, or the largest displacement is more than twice the depth (a
/// mistaken unit or depth).
[[nodiscard]] DeformationComparison compare_deformation(const Deformation& deformation,
                                                        const model::ReachParameters& reach, double depth,
                                                        double tip_radius, const SurfaceRule& rule = {});

}  // namespace palpate::validate
