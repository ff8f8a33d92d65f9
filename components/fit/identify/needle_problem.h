#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "fit/identify/least_squares.h"
#include "fit/identify/needle_record.h"

namespace palpate::identify {

/// Values of all parameters.
struct NeedlePoint {
  Point shared;
  std::vector<Point> own;  // one per record
  double squares = 0.0;    // sum of squared residuals
};

/// What the problems of a fit have in common: parameters of one are those of another.
struct NeedleSetup {
  Settings settings;
  double range = 0.0;  // of the force [N], the largest of all records
  double depth = 0.0;  // [m], the largest
};

/// The step of derivatives by a parameter in the form of the solver.
inline constexpr double kNeedleStep = 3e-5;

/// Parameters of a needle's fit in the form of the solver. Shared: those of the law and its relaxation (as in
/// a Point), the logarithm of the pulled law's L_1, and for each layer cutting force, friction and friction
/// per length. A record's own: first contact, the sensor's zero, the time of each puncture, and for each
/// membrane below the surface the part of the time since the last puncture after which the tip reaches it.
/// Forces are in parts of the range of force, lengths of that of the depth.
class NeedleProblem final {
 public:
  /// [setup] @param records must outlive this
  NeedleProblem(std::vector<const Insertion*> records, const NeedleSetup& setup, std::size_t layers,
                std::size_t terms);

  /// What one record gives at a point.
  struct Result {
    std::vector<double> residuals;  // in parts of the range, times the root of the number of rows
    NeedleRun run;                  // its punctures at the measured force where the fit misses that
  };
  /// [setup] A run on other rows of the same record.
  [[nodiscard]] NeedleRun run(const NeedleRecord& rows, std::size_t record, std::span<const double> shared,
                              std::span<const double> own) const;
  [[nodiscard]] Result at(std::size_t record, std::span<const double> shared,
                          std::span<const double> own) const;

  /// [setup] Starts for a single record: laws of usual shape through its force and depth at the first
  /// puncture, the rest from its phases.
  [[nodiscard]] std::vector<NeedlePoint> starts() const;
  /// [setup] The solution with other records or relaxation terms as a start.
  [[nodiscard]] NeedlePoint with_terms(const NeedlePoint& from, std::size_t terms_before) const;
  [[nodiscard]] NeedlePoint solved(NeedlePoint from, int most_iterations, double step = kNeedleStep) const;

  /// [setup] The tissue. Its layers have no puncture forces and thicknesses.
  [[nodiscard]] model::TissueParameters tissue(std::span<const double> shared) const;

  [[nodiscard]] double contact(std::span<const double> own) const { return own[0] * depth_; }
  [[nodiscard]] double zero(std::span<const double> own) const { return own[1] * range_; }
  [[nodiscard]] const Insertion& record(std::size_t i) const { return *records_[i]; }
  /// The fall of the force that is the first puncture; a record may show others, of noise.
  [[nodiscard]] const Fall& first_fall(std::size_t record) const { return falls_[record].front(); }
  [[nodiscard]] std::size_t records() const noexcept { return records_.size(); }
  [[nodiscard]] std::size_t layers() const noexcept { return layers_; }
  [[nodiscard]] std::size_t terms() const noexcept { return terms_; }
  /// Residuals after those of the rows, which are weak priors: of the zero, the law and the relaxation.
  [[nodiscard]] std::size_t priors() const noexcept { return 3 + terms_; }

 private:
  [[nodiscard]] std::vector<double> times_of(std::size_t record, std::span<const double> own) const;
  [[nodiscard]] NeedlePoint start_from(const Point& law, double contact, double zero) const;
  [[nodiscard]] Bounds own_bounds_of(std::size_t record) const;

  std::vector<const Insertion*> records_;
  Settings settings_;
  std::size_t layers_;
  std::size_t terms_;
  double range_;
  double depth_;
  Bounds bounds_;
  std::vector<std::vector<Fall>> falls_;  // of each record: the largest, in the order of time
};

}  // namespace palpate::identify
