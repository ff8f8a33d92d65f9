// `palpate fit --needle`: how many layers each record shows, one tissue for all of them, and how well each
// record predicts the others.
//
//     force   |    /|           a record: press, puncture, press on the next membrane, puncture, hold,
//             |   / |   /|      way out, with the shaft's friction alone
//             |  /  |__/ |_____
//             |_/              |___
//            -+-----------------------> time
//             |               \___/
//
// 1. Each record alone (own_fit). needle_record.cc finds the places where the force falls: candidates for
//    punctures. Each number of layers up to theirs is fitted from two starts (NeedleProblem::starts). A
//    larger number must lower the Bayesian information criterion by more than kClearly. Its number of rows is
//    the effective one of correlated residuals; else noise in a row would buy layers. Then a relaxation term
//    more or fewer is tried by the same rule.
// 2. The records vote on the numbers of layers and of terms (most_frequent). A record with too few falls is
//    left out with a warning. A record whose own numbers differ is fitted again with the chosen ones (alike).
// 3. Each record's tissue predicts the others, with their own zero and the contact that suits their press, by
//    the needle that punctures by its force, not at a given time (predictions_of).
// 4. One tissue for all records, from the one that predicts best (pooled_of).
// 5. Intervals are those of least squares, or of the scatter among the records where that is wider
//    (needle_intervals.cc).
//
// While a fit runs, the times at which membranes are reached and punctured are parameters, thicknesses and
// puncture forces results (needle_problem.cc): as functions of these the errors would jump.
#include "fit/identify/needle_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include <fmt/core.h>

#include "core/base/infinity.h"
#include "core/base/parallel.h"
#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "palpate/error.h"

#include "fit/identify/local_optima.h"
#include "fit/identify/needle_intervals.h"
#include "fit/identify/needle_problem.h"

namespace palpate::identify {
namespace {

constexpr int kFirstIterations = 10;
constexpr int kNeedleIterations = 20;  // of each of kMostRestarts
constexpr int kMostRestarts = 5;
constexpr double kOtherStep = 1e-5;     // of the derivatives of every second one
constexpr double kConverged = 1e-3;     // relative fall of the squares by a restart
constexpr std::size_t kFirstTerms = 2;  // of relaxation, while layers are counted
constexpr double kClearly = 6.0;        // fall of the Bayesian information criterion
constexpr double kShortestHold = 1.0;   // s
constexpr double kBeforeRecord = 0.02;  // of the depth, from the contact to the first row
constexpr double kMostDrift = 0.1;      // of the range of force
constexpr double kFreeStep = 2e-3;      // s, between ticks where the needle punctures by its force
constexpr double kLongStep = 0.1;       // s, where it presses

/// A solution with the problem that it solves.
struct Solved {
  NeedleProblem problem;
  NeedlePoint solution;

  [[nodiscard]] std::size_t parameters() const {
    return solution.shared.size() + solution.own.front().size();
  }
};

/// RMS error over the range of the force. @param force without the zero, one a row
double error_of(const std::vector<double>& force, const NeedleRecord& rows, double zero, double range) {
  double squares = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double error = force[i] + zero - rows.force[i];
    squares += error * error;
  }
  return std::sqrt(squares / static_cast<double>(force.size())) / range;
}

double own_error(const Solved& fit) {
  const NeedleRecord& all = fit.problem.record(0).all;
  const Point& own = fit.solution.own.front();
  return error_of(fit.problem.run(all, 0, fit.solution.shared, own).force, all, fit.problem.zero(own),
                  fit.problem.record(0).range);
}

/// Depth of first contact [m] at which a tissue's press suits a record best until its first fall. A law that
/// begins softer begins earlier, so the contact of another tissue's fit does not suit.
double contact_under(const model::TissueParameters& tissue, const Solved& own) {
  constexpr double kReach = 0.15;  // of the depth
  constexpr int kSteps = 25;       // each takes a third off
  const Insertion& record = own.problem.record(0);
  const Point& mine = own.solution.own.front();
  const double end = own.problem.first_fall(0).time;
  NeedleRecord press = record.thinned;
  const auto rows = static_cast<std::size_t>(std::lower_bound(press.time.begin(), press.time.end(), end) -
                                             press.time.begin());
  for (std::vector<double>* column : {&press.time, &press.depth, &press.force}) column->resize(rows);
  const auto error = [&](double contact) {
    const std::vector<double> never{kInfinity};  // it punctures at no time
    return error_of(run_needle(press, tissue, contact, never, kLongStep).force, press, own.problem.zero(mine),
                    record.range);
  };
  double low = own.problem.contact(mine) - kReach * record.deepest;
  double high = own.problem.contact(mine) + kReach * record.deepest;
  for (int i = 0; i < kSteps; ++i) {
    const double third = (high - low) / 3.0;
    if (error(low + third) < error(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return (low + high) / 2.0;
}

/// The error of the force that a tissue's needle meets on a record's path, where it punctures by its force,
/// with that record's zero.
double free_error(const model::TissueParameters& tissue, double contact, const Solved& own) {
  const NeedleRecord& all = own.problem.record(0).all;
  return error_of(run_needle(all, tissue, contact, {}, kFreeStep).force, all,
                  own.problem.zero(own.solution.own.front()), own.problem.record(0).range);
}

/// Fall of the Bayesian information criterion from the simple to the rich fit, with the effective number of
/// rows of the rich one.
double gain_of(const Solved& simple, const Solved& rich) {
  const double rows = limited_sample_size(effective_rows(rich.problem, rich.solution),
                                          rich.problem.record(0).thinned.size(), rich.parameters());
  return rows * portable::log(simple.solution.squares / rich.solution.squares) -
         static_cast<double>(rich.parameters() - simple.parameters()) * portable::log(rows);
}

/// Where a parameter moves an event, such as a needle that leaves, into another tick, the force has a small
/// jump. A derivative across it is wrong, and the solver stops. It is started again there, with derivatives
/// of another step.
Solved converged(Solved fit) {
  for (int i = 0; i < kMostRestarts; ++i) {
    const double before = fit.solution.squares;
    const double step = i % 2 == 0 ? kNeedleStep : kOtherStep;
    fit.solution = fit.problem.solved(std::move(fit.solution), kNeedleIterations, step);
    if (i > 0 && fit.solution.squares > (1.0 - kConverged) * before) break;
  }
  return fit;
}

Solved solved_from_data(const Insertion& record, const NeedleSetup& setup, std::size_t layers) {
  Solved best{NeedleProblem({&record}, setup, layers, kFirstTerms), {}};
  std::vector<NeedlePoint> points = best.problem.starts();
  for_ranges(points.size(), 1, [&](std::size_t i, std::size_t) {
    points[i] = best.problem.solved(std::move(points[i]), kFirstIterations);
    points[i] = converged({best.problem, std::move(points[i])}).solution;
  });
  best.solution = *std::min_element(points.begin(), points.end(), [](const auto& one, const auto& other) {
    return one.squares < other.squares;
  });
  if (!std::isfinite(best.solution.squares)) {
    throw InputError(record.all.name + ": no tissue with layers follows this record");
  }
  return best;
}

/// The first iterations of a single record's fit with another number of relaxation terms.
Solved with_terms(const Solved& from, std::size_t terms, const NeedleSetup& setup) {
  Solved made{NeedleProblem({&from.problem.record(0)}, setup, from.problem.layers(), terms), {}};
  const NeedlePoint start = made.problem.with_terms(from.solution, from.problem.terms());
  made.solution = made.problem.solved(start, kFirstIterations);
  return made;
}

/// A relaxation term more where it is clearly better, or fewer where they are.
Solved with_best_terms(Solved fit, const NeedleSetup& setup) {
  if (fit.problem.terms() < model::kMaxRelaxationTerms) {
    Solved more = with_terms(fit, fit.problem.terms() + 1, setup);
    if (gain_of(fit, more) > kClearly) return converged(std::move(more));
  }
  while (fit.problem.terms() > 0) {
    Solved fewer = converged(with_terms(fit, fit.problem.terms() - 1, setup));
    if (gain_of(fewer, fit) > -kClearly) break;
    fit = std::move(fewer);
  }
  return fit;
}

/// A record's own fit, and the error with each number of layers that was tried.
struct OwnFit {
  Solved best;
  std::vector<double> nrmse;
};

OwnFit own_fit(const Insertion& record, const NeedleSetup& setup) {
  OwnFit fit{solved_from_data(record, setup, 1), {}};
  fit.nrmse.push_back(own_error(fit.best));
  for (std::size_t layers = 2; layers <= record.falls.size(); ++layers) {
    Solved more = solved_from_data(record, setup, layers);
    fit.nrmse.push_back(own_error(more));
    if (gain_of(fit.best, more) > kClearly) fit.best = std::move(more);
  }
  fit.best = with_best_terms(std::move(fit.best), setup);
  return fit;
}

std::vector<OwnFit> own_fits(const std::vector<Insertion>& records, const NeedleSetup& setup,
                             const Progress& progress) {
  std::vector<std::optional<OwnFit>> made(records.size());
  std::mutex reporting;
  std::size_t done = 0;
  progress(0.0, "each record");
  for_ranges(records.size(), 1, [&](std::size_t i, std::size_t) {
    made[i] = own_fit(records[i], setup);
    const std::lock_guard lock(reporting);
    progress(static_cast<double>(++done) / static_cast<double>(records.size() + 1), records[i].all.name);
  });
  std::vector<OwnFit> all;
  for (std::optional<OwnFit>& one : made) all.push_back(std::move(*one));
  return all;
}

/// The most frequent value; the smaller of two equally frequent ones.
template <typename Of>
std::size_t most_frequent(const std::vector<OwnFit>& fits, const Of& of) {
  std::map<std::size_t, std::size_t> counts;
  for (const OwnFit& fit : fits) ++counts[of(fit)];
  return std::max_element(counts.begin(), counts.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// The records' own fits with the same layers and terms.
std::vector<Solved> alike(const std::vector<const Insertion*>& records, std::vector<OwnFit>& fits,
                          std::size_t layers, std::size_t terms, const NeedleSetup& setup) {
  std::vector<Solved> all;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Solved& best = fits[r].best;
    Solved one =
        best.problem.layers() == layers ? std::move(best) : solved_from_data(*records[r], setup, layers);
    all.push_back(one.problem.terms() == terms ? std::move(one) : converged(with_terms(one, terms, setup)));
  }
  return all;
}

/// Mean error of each record as the others' fits predict it, and the fit that predicts best.
struct Predictions {
  std::vector<double> nrmse;
  std::size_t best = 0;
};

Predictions predictions_of(const std::vector<Solved>& fits,
                           const std::vector<model::TissueParameters>& tissues) {
  Predictions made{std::vector<double>(fits.size(), 0.0)};
  double least = kInfinity;
  for (std::size_t from = 0; from < fits.size(); ++from) {
    double sum = 0.0;
    for (std::size_t to = 0; to < fits.size(); ++to) {
      if (to == from) continue;
      const double error = free_error(tissues[from], contact_under(tissues[from], fits[to]), fits[to]);
      made.nrmse[to] += error / static_cast<double>(fits.size() - 1);
      sum += error;
    }
    if (sum < least) made.best = from;
    least = std::min(least, sum);
  }
  return made;
}

/// One tissue for all records, from the one that predicts best.
Solved pooled_of(const std::vector<Solved>& each, std::size_t best, const NeedleSetup& setup) {
  if (each.size() == 1) return each.front();
  std::vector<const Insertion*> records;
  NeedlePoint start;
  start.shared = each[best].solution.shared;
  for (const Solved& fit : each) {
    records.push_back(&fit.problem.record(0));
    start.own.push_back(fit.solution.own.front());
  }
  const NeedleProblem& one = each[best].problem;
  Solved pooled{NeedleProblem(records, setup, one.layers(), one.terms()), {}};
  pooled.solution = std::move(start);
  return converged(std::move(pooled));
}

void add_warnings(const std::vector<Solved>& each, NeedleFit& fit) {
  constexpr double kPoor = kPoorFit;
  for (const Solved& one : each) {
    const Insertion& record = one.problem.record(0);
    fit.warnings.insert(fit.warnings.end(), record.notes.begin(), record.notes.end());
    if (record.hold < kShortestHold) {
      fit.warnings.push_back(fmt::format(
          "{}: the needle rests at its depth for {} s: the relaxation shows only in the motion, rest for 5 s",
          record.all.name, brief(record.hold, 2)));
    }
    const double before = record.all.depth.front() - one.problem.contact(one.solution.own.front());
    if (before > kBeforeRecord * record.deepest) {
      fit.warnings.push_back(record.all.name +
                             ": the contact is found before the first row: start 1 mm above the tissue");
    }
    if (std::abs(record.drift) > kMostDrift * record.range && fit.poor.empty()) {
      fit.poor = fmt::format(
          "{}: the sensor drifts by {} N, must be at most {} of the range of force: nothing shows that it "
          "drifts along a straight line; let it warm up",
          record.all.name, brief(record.drift), percent(kMostDrift, 0));
    }
    if (!record.withdrawn && fit.poor.empty()) {
      fit.poor =
          record.all.name +
          ": the needle is not drawn out by a quarter of its depth: cutting force and friction are not "
          "determined apart";
    }
  }
  if (fit.nrmse > kPoor && fit.poor.empty()) {
    fit.poor = fmt::format("the error is {} of the range of force, must be at most {}", percent(fit.nrmse, 0),
                           percent(kPoor, 0));
  }
  if (!fit.poor.empty()) fit.warnings.push_back(fit.poor);
}

void add_repeats(const std::vector<Solved>& each, const Predictions& predictions, NeedleFit& fit) {
  double squares = 0.0;
  for (std::size_t r = 0; r < each.size(); ++r) {
    const Solved& one = each[r];
    const Insertion& record = one.problem.record(0);
    const Point& own = one.solution.own.front();
    NeedleRepeat made;
    made.name = record.all.name;
    made.nrmse = own_error(one);
    made.rms = made.nrmse * record.range;
    if (each.size() > 1) made.predicted_nrmse = predictions.nrmse[r];
    made.contact = one.problem.contact(own);
    made.zero = one.problem.zero(own);
    made.punctures = one.problem.at(0, one.solution.shared, own).run.punctures;
    for (Puncture& puncture : made.punctures) puncture.depth += made.contact;
    made.record = record.thinned;
    const double contact = contact_under(fit.tissue, one);
    made.fitted = run_needle(made.record, fit.tissue, contact, {}, kFreeStep).force;
    for (double& force : made.fitted) force += made.zero;
    const double error = free_error(fit.tissue, contact, one);
    squares += error * error / static_cast<double>(each.size());
    fit.repeats.push_back(std::move(made));
  }
  fit.nrmse = std::sqrt(squares);
}

}  // namespace

std::pair<std::string, std::string> shown(const NeedleValue& value) {
  const Estimate& estimate = value.estimate;
  return {estimate.determined ? brief(estimate.value / value.unit) : "not determined",
          brief(estimate.interval.low / value.unit) + " to " + brief(estimate.interval.high / value.unit)};
}

NeedleFit fit_needle(const std::vector<Insertion>& records, const Settings& settings,
                     const Progress& progress) {
  NeedleFit fit;
  NeedleSetup setup{settings};
  for (const Insertion& record : records) {
    setup.range = std::max(setup.range, record.range);
    setup.depth = std::max(setup.depth, record.deepest);
  }
  std::vector<OwnFit> own = own_fits(records, setup, progress);
  for (const OwnFit& one : own) {
    for (std::size_t n = 1; n <= one.nrmse.size(); ++n) {
      if (fit.evidence.size() < n) fit.evidence.push_back({n, 0, 0.0, 0});
      fit.evidence[n - 1].nrmse += one.nrmse[n - 1];
      ++fit.evidence[n - 1].records;
    }
    ++fit.evidence[one.best.problem.layers() - 1].votes;
  }
  for (LayerEvidence& one : fit.evidence) one.nrmse /= static_cast<double>(one.records);
  fit.layers = most_frequent(own, [](const OwnFit& one) { return one.best.problem.layers(); });
  fit.terms = most_frequent(own, [](const OwnFit& one) { return one.best.problem.terms(); });
  std::vector<const Insertion*> used;
  std::vector<OwnFit> used_fits;
  for (std::size_t r = 0; r < records.size(); ++r) {
    if (records[r].falls.size() < fit.layers) {
      fit.warnings.push_back(fmt::format("{}: left out: it shows {}, the others {}", records[r].all.name,
                                         counted(records[r].falls.size(), "puncture", "punctures"),
                                         fit.layers));
      continue;
    }
    used.push_back(&records[r]);
    used_fits.push_back(std::move(own[r]));
  }
  const std::vector<Solved> each = alike(used, used_fits, fit.layers, fit.terms, setup);
  std::vector<model::TissueParameters> tissues;
  for (const Solved& one : each) tissues.push_back(needle_tissue(one.problem, one.solution));
  const Predictions predictions = predictions_of(each, tissues);
  progress(static_cast<double>(records.size()) / static_cast<double>(records.size() + 1), "all records");
  const Solved pooled = pooled_of(each, predictions.best, setup);
  fit.tissue = needle_tissue(pooled.problem, pooled.solution);
  fit.values = needle_values(pooled.problem, pooled.solution, tissues);
  add_repeats(each, predictions, fit);
  add_warnings(each, fit);
  return fit;
}

}  // namespace palpate::identify
