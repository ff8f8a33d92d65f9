#pragma once
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "palpate/identify.h"

namespace palpate::identify {

/// [setup] Forces [N] that the model predicts at the points of a specimen: the law at displacement minus
/// first-contact depth, relaxed over the specimen's times if the model has relaxation terms, limited to >= 0
/// (a contact cannot pull), plus the sensor offset.
/// @param force one value [N] per point; all NaN where the parameters are not a valid law
/// @param shared, own parameters in the form of a Point
void predict(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
             std::span<const double> shared, std::span<const double> own, std::span<double> force);

/// [setup] Applies relaxation to elastic forces [N] at increasing times [s]. The force at the first point is
/// treated as applied at that instant. @param time same size as `force`, at least 2
void relax(std::span<const model::RelaxationTerm> terms, const std::vector<double>& time,
           std::span<double> force);

/// Number of layers of the law, and how many of them the specimen's largest depth reaches.
struct LayerCount {
  int allowed = 0;
  int reached = 0;
};
[[nodiscard]] LayerCount layers_of(const Specimen& specimen, const Ranges& ranges, const Settings& settings,
                                   std::span<const double> shared, std::span<const double> own);

/// Lower limit of sigma, as a fraction of the force range: below the resolution of any sensor.
inline constexpr double kSmallestSigma = 1e-5;

/// Scale of the Cauchy loss in standard deviations: it then costs normal noise 1 % of its information.
inline constexpr double kLoss = 4.0;

/// One specimen in a least-squares problem.
struct Part {
  const Specimen* specimen = nullptr;
  Ranges ranges;
  OwnPrior prior;
  std::vector<double> weight;  // weight of each point's squared residual, >= 0
};

/// Least-squares problem: find the shared parameters, and each specimen's own, that minimise the sum of
/// squared residuals. Residuals are divided by the specimen's force range.
struct Problem {
  Settings settings;
  std::size_t terms = 0;  // number of relaxation terms
  Bounds bounds;          // of the shared parameters
  std::vector<Part> parts;
  /// Scale c of the Cauchy loss c^2 ln(1 + (r/c)^2); infinite: plain squares r^2.
  double loss_scale = std::numeric_limits<double>::infinity();
  /// Standard deviation of the residuals; it sets the weight of the priors of the own parameters.
  double sigma = 0.01;
};

/// [setup] A part with weight 1 for every point. The specimen must outlive it. @throws as ranges_of().
[[nodiscard]] Part make_part(const Specimen& specimen);

/// [setup] Makes the problem and its bounds from the parts.
[[nodiscard]] Problem make_problem(const Settings& settings, std::size_t terms, std::vector<Part> parts);

struct Solution {
  Point shared;
  std::vector<Point> own;                                 // one per part
  double cost = std::numeric_limits<double>::infinity();  // sum of squares, priors included
};

/// [setup] Number of residuals of a part: one per point, plus one for each of the two priors.
[[nodiscard]] std::size_t residual_count(const Part& part) noexcept;

/// [setup] Residuals of a part: those of the points, after the loss and times the square root of their
/// weights, then those of the priors.
void residuals(const Problem& problem, const Part& part, std::span<const double> shared,
               std::span<const double> own, std::span<double> out);

/// [setup] Sum of squares of all residuals; infinite where the parameters are not a valid law.
[[nodiscard]] double cost_of(const Problem& problem, const Point& shared, const std::vector<Point>& own);

/// [setup] Minimises the cost within the bounds by the Levenberg-Marquardt method (Ceres, one thread), from
/// `start` clamped into the bounds. Deterministic: the same input gives the same bits.
/// @param held index of a parameter that is held constant: shared parameters first, then the first part's
/// own; negative: none
/// @param tolerance stops when a step lowers the cost by a smaller fraction
[[nodiscard]] Solution solve(const Problem& problem, const Solution& start, int most_iterations = 60,
                             int held = -1, double tolerance = 1e-9);

/// [setup] Jacobian of a part's residuals in row-major order: one row per residual, shared parameters first.
/// Derivatives by beta, q, L_1 and the relaxation times are central differences, the others are exact. All
/// NaN where the parameters are not a valid law.
[[nodiscard]] std::vector<double> jacobian(const Problem& problem, const Part& part,
                                           std::span<const double> shared, std::span<const double> own);

/// A least-squares problem of several records with shared parameters and some of their own. A record's
/// residuals depend on the shared parameters and its own, if it has any.
struct RecordsProblem {
  Bounds shared;
  std::vector<Bounds> own;             // one per record
  std::vector<std::size_t> residuals;  // of each record
  /// Maps the parameters of a record to its residuals; false: they are not valid.
  std::function<bool(std::size_t record, std::span<const double> shared, std::span<const double> own,
                     std::span<double> out)>
      errors;
  double step = 1e-5;  // of the central differences: parameters are of the order of 1
};

/// [setup] Minimises a RecordsProblem by the Levenberg-Marquardt method with central differences, from points
/// within the bounds.
/// @param held index of a shared parameter that is held constant; negative: none
/// @return the remaining sum of squares; infinite when no step gave valid residuals
double minimise(const RecordsProblem& problem, Point& shared, std::vector<Point>& own, int most_iterations,
                int held = -1);

/// [setup] The points sorted by displacement, without times.
[[nodiscard]] Specimen by_displacement(const Specimen& specimen);

/// [setup] The rows to which a law is fitted: without relaxation the last whole loading of a loop; with the
/// sensor's zero, drift or tilt subtracted where the rows before contact, or the first row, show it.
[[nodiscard]] Specimen prepared(const Specimen& specimen, const Settings& settings);

/// [setup] The points used for a specimen's own fit: prepared() rows, averages of neighbours when there are
/// too many.
[[nodiscard]] Specimen as_fitted(const Specimen& specimen, const Settings& settings);

/// [setup] The points used for the pooled fit.
[[nodiscard]] std::vector<Specimen> as_pooled(const std::vector<Specimen>& specimens,
                                              const Settings& settings);

/// [setup] One part per specimen of as_pooled(), which must outlive the parts. All specimens have the same
/// total weight, whatever their number of points.
[[nodiscard]] std::vector<Part> pooled_parts(const std::vector<Specimen>& pooled);

}  // namespace palpate::identify
