#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "palpate/fit/ball_surface.h"
#include "palpate/fit/deformation.h"
#include "palpate/fit/specimen.h"
#include "palpate/model/tissue.h"

namespace palpate::fit {

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
  Specimen measured;             // at most kMostPoints points, as they were compared
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
[[nodiscard]] ForceComparison compare_force(const Specimen& specimen, const Law& law, const Zeros& zeros);

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

}  // namespace palpate::fit
