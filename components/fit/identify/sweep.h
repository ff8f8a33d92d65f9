#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "run/tasks/communicator.h"

#include "fit/identify/fit_many.h"

namespace palpate::identify {

inline constexpr std::size_t kFewestSweepValues = 3;
inline constexpr std::size_t kMaxSweepValues = 1000;

/// A parameter of the law that is fixed at a series of values; all others are fitted again at each.
struct ParameterSweep {
  std::size_t parameter = 0;   // 0 .. kLawParameters - 1, in the order of labels()
  std::optional<double> low;   // SI, > 0; absent: below the interval by half its length (in logarithms)
  std::optional<double> high;  // absent: above it by the same length; both within the bounds of the fit
  std::size_t values = 21;     // number of values, evenly spaced in the logarithm
};

/// One value of a sweep.
struct SweepPoint {
  double value = 0.0;      // SI, of the fixed parameter
  double nrmse = 0.0;      // RMS residual divided by the force range; pooled: as PooledFit::nrmse
  double deviance = 0.0;   // one specimen: twice the decrease of the log posterior from its maximum, with the
                           // effective number of points; pooled: NaN
  bool within_95 = false;  // the value is in the 95 % confidence set
  std::vector<double> others;  // parameters of law and relaxation, SI, in the order of labels(terms)
};

/// The sweep of one parameter, for one specimen or for all together (pooled).
struct Sweep {
  std::string specimen;  // empty: pooled
  std::size_t parameter = 0;
  std::size_t terms = 0;  // number of relaxation terms
  double best = 0.0;      // value of the fit, SI
  double best_nrmse = 0.0;
  // By increasing value: those requested, the fit's own, one on each side of it, and those of the fit's other
  // local optima that the data allow.
  std::vector<SweepPoint> points;
  bool open_below = false;  // the lowest value is in the confidence set: the sweep does not bound it there
  bool open_above = false;
  bool found_better = false;  // a value fits clearly better than the fit, which was not the global optimum
};

/// Result of sweep_many().
struct Sweeps {
  std::vector<Sweep> all;   // by specimen, then pooled; for each in the order of the requests
  std::size_t resumed = 0;  // pieces read from the results file
};

/// [setup] Parses a request: "q", "q=0.5:0.9:41" or "limit_mm=2:9:15", in the units of labels(). "all" gives
/// one request per law parameter. @throws InputError that names the flag, the text and a valid form.
[[nodiscard]] std::vector<ParameterSweep> sweep_requests(const std::string& flag, const std::string& text);

/// [setup] Adds the points of a results line to a sweep. @throws InputError when the line is invalid.
void add_sweep_line(const std::string& line, Sweep& sweep);

/// [setup] Runs all requests for each specimen and, with several specimens, for the pooled fit. The ranks
/// share the work as in fit_many(); the result has the same bits for any number of ranks. A sweep proceeds
/// from the best fit outwards and then back, so that each value also starts from its neighbours' solutions.
/// @param specimens used from rank 0 only @param fits of these specimens, on all ranks
/// @param results_file rank 0 reads finished pieces from it and appends new ones; empty: no file
/// @throws InputError on all ranks when the file cannot be written.
[[nodiscard]] Sweeps sweep_many(std::vector<Specimen> specimens, const ManyFits& fits,
                                const std::vector<ParameterSweep>& requests, const Settings& settings,
                                tasks::Communicator& ranks, const std::string& results_file,
                                const Progress& progress);

}  // namespace palpate::identify
