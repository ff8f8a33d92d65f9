#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/identify.h"
#include "science/identify/fit_many.h"
#include "science/tasks/ranks.h"

namespace palpate::identify {

inline constexpr std::size_t kFewestSweepValues = 3;
inline constexpr std::size_t kMostSweepValues = 1000;

/// A parameter of the law that is held at value after value, each time with all others fitted again.
struct SweepRequest {
  std::size_t parameter = 0;   // 0 .. kLawParameters - 1, in the order of labels()
  std::optional<double> low;   // SI, > 0; without: half as far below the interval as it is long [logarithms]
  std::optional<double> high;  // and as far above it, no farther than a fit would search
  std::size_t values = 21;     // evenly spaced in the logarithm
};

/// One value of a sweep.
struct SweepPoint {
  double value = 0.0;     // SI, of the parameter that is held
  double nrmse = 0.0;     // RMS of what the others leave, over the range of force; pooled: as PooledFit's
  double deviance = 0.0;  // one specimen: twice the fall of the log posterior (squares and the priors of
                          // first contact and offset) from its best, for as many points as count; pooled: NaN
  bool within_95 = false;      // the data leave it
  std::vector<double> others;  // the law's and relaxation's parameters, SI, in the order of labels(terms)
};

/// The sweep of one parameter, for one specimen or for all together.
struct Sweep {
  std::string specimen;  // empty: all together
  std::size_t parameter = 0;
  std::size_t terms = 0;  // of relaxation
  double best = 0.0;      // the fit's own value, SI
  double best_nrmse = 0.0;
  std::vector<SweepPoint> points;  // by rising value
  bool open_below = false;  // the lowest value swept is left by the data, so they do not bound it there
  bool open_above = false;
  bool found_better = false;  // a value fits clearly better than the fit did: it was not the best
};

/// What the sweeps of a call gave.
struct Sweeps {
  std::vector<Sweep> all;   // specimen by specimen, then all together, each in the order of the requests
  std::size_t resumed = 0;  // pieces that were taken from the results file
};

/// [setup] A request as users write it: "q", "q=0.5:0.9:41" or "limit_mm=2:9:15", in the units of labels();
/// "all" makes one of each. @throws InputError naming flag, text and what would be right.
[[nodiscard]] std::vector<SweepRequest> sweep_requests(const std::string& flag, const std::string& text);

/// [setup] Sweeps every request for every specimen and, when there are several, for all together, the work
/// shared out among ranks as fit_many() does: the same bits on any number of them. Within a sweep the way
/// goes from the best fit outwards, then back, so that each value knows what its neighbours found.
/// @param specimens of rank 0; what others give does not count; @param fits of the same, on every rank
/// @param results_file as fit_many()'s: finished pieces are added at once, and taken from there
/// @throws InputError on every rank alike when the file cannot be written.
[[nodiscard]] Sweeps sweep_many(std::vector<Specimen> specimens, const ManyFits& fits,
                                const std::vector<SweepRequest>& requests, const Settings& settings,
                                tasks::Ranks& ranks, const std::string& results_file,
                                const Progress& progress);

}  // namespace palpate::identify
