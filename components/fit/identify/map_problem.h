#pragma once
#include <optional>
#include <span>
#include <vector>

#include "fit/identify/map_fit.h"
#include "fit/identify/map_model.h"

namespace palpate::identify {

inline constexpr double kDeepestInclusion = 40.0;    // mm
inline constexpr double kShallowestInclusion = 1.0;  // mm
inline constexpr double kThinnestInclusion = 0.05;   // radius over depth
inline constexpr double kThickestInclusion = 0.97;   // radius over depth

using Values = std::vector<double>;

struct MapBounds {
  Values low, high;
};

/// The rows with their weights, and a model of them. It keeps references to rows and weights.
class MapProblem final {
 public:
  MapProblem(const std::vector<MapRow>& rows, const MapSettings& settings, std::size_t terms,
             const Values& weights)
      : rows_(rows), weights_(weights), model_(rows, settings.tip_radius, terms) {}

  [[nodiscard]] const MapModel& model() const { return model_; }
  [[nodiscard]] const std::vector<MapRow>& rows() const { return rows_; }

  [[nodiscard]] Values residuals(std::span<const double> values) const;
  /// Derivatives of the residuals by the values, in row-major order.
  [[nodiscard]] Values slopes(std::span<const double> values) const;
  /// The measured force of a row with its weight: what its residual subtracts.
  [[nodiscard]] double weighted_force(std::size_t row) const { return weights_[row] * rows_[row].force; }
  [[nodiscard]] double sum_of_squares(std::span<const double> values) const;
  /// The Bayesian information criterion.
  [[nodiscard]] double criterion(std::span<const double> values) const;
  [[nodiscard]] MapBounds bounds(std::size_t size) const;

 private:
  const std::vector<MapRow>& rows_;
  const Values& weights_;
  MapModel model_;
};

/// [setup] Least squares from `values`. @param held a parameter that stays as it is @param enough a sum of
/// squares at which the search ends, also where it gets there too slowly
[[nodiscard]] Values solve_map(const MapProblem& map, Values values,
                               std::optional<std::size_t> held = std::nullopt, int iterations = 60,
                               double enough = 0.0);

/// [setup] Weights of the rows, 1 / sigma with sigma^2 = s^2 + (c F)^2. The noise is that of the third
/// differences along each probe, which a smooth force over depth hardly has; the residuals of a fit would
/// also have its faults.
[[nodiscard]] Values weights_of(const std::vector<MapRow>& rows);

/// [setup] The inclusion whose parameters begin at `from`, with its intervals; without them where the search
/// ended at a bound. @param values of the fit @param deepest depth of the map [m] @param profiles also
/// intervals of radius and ratio
[[nodiscard]] FoundInclusion describe_inclusion(const MapProblem& map, const Values& values,
                                                const Eigen::MatrixXd& covariance, std::size_t from,
                                                double deepest, bool profiles);

/// [setup] The covariance of the parameters; those at a bound, or without effect, have none.
[[nodiscard]] Eigen::MatrixXd covariance_of(const MapProblem& map, const Values& values);

/// The parameters of an inclusion, in the order of MapModel.
enum MapParameter : std::size_t { kAlong, kAcross, kDepthBelow, kLogThickness, kLogRatio };

/// [setup] Which parameters of the inclusion that begins at `from` are at a bound of the search.
[[nodiscard]] std::vector<MapParameter> bounds_reached(const MapProblem& map, const Values& values,
                                                       std::size_t from);

/// [setup] The values, with a radius or ratio that ended at a bound moved off it where the data allow that as
/// well (95 %): they leave it undetermined, and do not ask for more than the law can give.
[[nodiscard]] Values moved_off_bounds(const MapProblem& map, Values values);

}  // namespace palpate::identify
