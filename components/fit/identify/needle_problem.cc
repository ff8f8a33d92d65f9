// The least-squares problem of a needle's records. A puncture makes the error of a fit jump wherever the
// simulated needle goes through a membrane earlier or later than the measured one, and a membrane that it
// does not reach has no derivatives. So the times at which it reaches and punctures each membrane are
// parameters here, these near the falls of the measured force. The depth at the one time and the force at the
// other are results: the layer's thickness and the puncture force.
#include "fit/identify/needle_problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/infinity.h"
#include "core/base/portable_math.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::identify {
namespace {

using portable::exp;
using portable::log;

constexpr double kTimeUnit = 10e-3;     // s, of the times of punctures
constexpr double kTimeReach = 6.0;      // of these units: how far a puncture may be from its fall's start
constexpr double kLongestStep = 0.1;    // s, between ticks of a fit
constexpr double kLeastForce = 1e-4;    // of the range: no force, with room for derivatives
constexpr double kMostForce = 2.0;      // of the range
constexpr double kThinnest = 0.005;     // press, of the depth
constexpr double kReached = 0.02;       // of the time between two punctures: a membrane is reached after it
constexpr double kContactReach = 0.15;  // of the depth
constexpr double kZeroReach = 0.2;      // of the range
constexpr double kPriorLaw = 0.01;  // weight of usual values, which settles what compensates for each other
constexpr double kUsualBeta = 2.0;
constexpr double kUsualQ = 0.7;

/// Depth until which the force is flat before the first fall.
double contact_of(const Insertion& insertion, double end) {
  Specimen press;
  const NeedleRecord& all = insertion.thinned;
  for (std::size_t i = 0; i < all.size() && all.time[i] < end; ++i) {
    press.displacement.push_back(all.depth[i]);
    press.force.push_back(all.force[i]);
  }
  return flat_until(press, ranges_of(press));
}

double force_near(const NeedleRecord& record, double from, double to) {
  double sum = 0.0;
  double rows = 0.0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (record.time[i] < from || record.time[i] > to) continue;
    sum += record.force[i];
    rows += 1.0;
  }
  return rows > 0.0 ? sum / rows : 0.0;
}

/// The time at which a force that stays and then rises is farthest below the straight line.
double bend_between(const NeedleRecord& record, double from, double to) {
  constexpr double kMean = 40e-3;  // s
  const double first = force_near(record, from, from + kMean);
  const double last = force_near(record, to - kMean, to);
  double bend = 0.5 * (from + to);
  double farthest = 0.0;
  for (double time = from; time < to; time += kMean) {
    const double line = first + (last - first) * (time - from) / (to - from);
    const double below = line - force_near(record, time, time + kMean);
    if (below > farthest) bend = time;
    farthest = std::max(farthest, below);
  }
  return bend;
}

/// By how much the measured force at a puncture is above that of a fit [N], if that is more than noise: where
/// the model does not follow a record, its force there is not the one at which the membrane gave way. The
/// measured one is that of a straight line through the rows before.
double missed_by(const Puncture& puncture, double zero, const Insertion& insertion) {
  constexpr double kBefore = 0.2;       // s
  constexpr double kClearErrors = 4.0;  // standard errors
  constexpr double kMatters = 0.02;     // of the range
  const NeedleRecord& all = insertion.all;
  const auto row_at = [&all](double time) {
    return std::lower_bound(all.time.begin(), all.time.end(), time);
  };
  const auto first = static_cast<std::size_t>(row_at(puncture.time - kBefore) - all.time.begin());
  const auto last = static_cast<std::size_t>(row_at(puncture.time) - all.time.begin());
  if (last < first + 5) return 0.0;
  const auto count = static_cast<double>(last - first);
  double time = 0.0;
  double force = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    time += all.time[i] / count;
    force += all.force[i] / count;
  }
  double time_squares = 0.0;
  double product = 0.0;
  double force_squares = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const double t = all.time[i] - time;
    const double f = all.force[i] - force;
    time_squares += t * t;
    product += t * f;
    force_squares += f * f;
  }
  const double reach = puncture.time - time;
  const double missed = force + product / time_squares * reach - zero - puncture.force;
  const double variance = (force_squares - product * product / time_squares) / (count - 2.0);
  const double error = std::sqrt(std::max(0.0, variance) * (1.0 / count + reach * reach / time_squares));
  return std::abs(missed) > std::max(kClearErrors * error, kMatters * insertion.range) ? missed : 0.0;
}

}  // namespace

NeedleProblem::NeedleProblem(std::vector<const Insertion*> records, const NeedleSetup& setup,
                             std::size_t layers, std::size_t terms)
    : records_(std::move(records)),
      settings_(setup.settings),
      layers_(layers),
      terms_(terms),
      range_(setup.range),
      depth_(setup.depth) {
  Ranges ranges;
  ranges.shortest_step = kInfinity;
  for (const Insertion* one : records_) {
    ranges.duration = std::max(ranges.duration, one->all.time.back() - one->all.time.front());
    ranges.shortest_step = std::min(ranges.shortest_step, 0.04);
    std::vector<Fall> falls(one->falls.begin(), one->falls.begin() + static_cast<std::ptrdiff_t>(layers_));
    std::sort(falls.begin(), falls.end(), [](const Fall& a, const Fall& b) { return a.time < b.time; });
    falls_.push_back(std::move(falls));
  }
  ranges.force = range_;
  ranges.displacement = 0.5 * depth_;
  bounds_ = shared_bounds(ranges, terms_);
  for (std::size_t i = 0; i < terms_; ++i) bounds_.high[kLawParameters + 2 * i + 1] = log(ranges.duration);
  bounds_.low.push_back(bounds_.low[kLawParameters - 1]);
  bounds_.high.push_back(bounds_.high[kLawParameters - 1]);
  bounds_.low.insert(bounds_.low.end(), 3 * layers_, kLeastForce);
  bounds_.high.insert(bounds_.high.end(), 3 * layers_, kMostForce);
}

model::TissueParameters NeedleProblem::tissue(std::span<const double> shared) const {
  const std::size_t law = shared_count(terms_);
  model::TissueParameters tissue = tissue_of(shared.first(law), settings_);
  tissue.name = "fitted";
  tissue.max_length = tissue.rest_length + exp(shared[law]);
  for (std::size_t k = 0; k < layers_; ++k) {
    const double* const values = shared.data() + law + 1 + 3 * k;
    model::TissueLayer layer;
    layer.name = "layer " + std::to_string(k + 1);
    layer.cutting_force = range_ * values[0];
    layer.friction = range_ * values[1];
    layer.friction_per_length = range_ / depth_ * values[2];
    if (k + 1 < layers_) layer.thickness = depth_;  // until the tip reaches its end
    tissue.layers.push_back(layer);
  }
  return tissue;
}

std::vector<double> NeedleProblem::times_of(std::size_t record, std::span<const double> own) const {
  std::vector<double> times;
  for (std::size_t k = 0; k < layers_; ++k) {
    const double yields = falls_[record][k].time + kTimeUnit * own[2 + k];
    if (k > 0) times.push_back(times.back() + own[1 + layers_ + k] * std::max(0.0, yields - times.back()));
    times.push_back(yields);
  }
  return times;
}

NeedleRun NeedleProblem::run(const NeedleRecord& rows, std::size_t record, std::span<const double> shared,
                             std::span<const double> own) const {
  return run_needle(rows, tissue(shared), contact(own), times_of(record, own), kLongestStep);
}

NeedleProblem::Result NeedleProblem::at(std::size_t record, std::span<const double> shared,
                                        std::span<const double> own) const {
  const NeedleRecord& rows = records_[record]->thinned;
  Result result;
  try {
    result.run = run(rows, record, shared, own);
  } catch (const ParameterError&) {
    return result;
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double error = (result.run.force[i] + zero(own) - rows.force[i]) / range_;
    result.residuals.push_back(error * std::sqrt(rows.rows[i]));
  }
  const Insertion& insertion = *records_[record];
  for (Puncture& one : result.run.punctures) {
    const double missed = missed_by(one, zero(own), insertion);
    one.force += missed;
    one.tip += missed;
  }
  result.residuals.push_back((own[1] - insertion.air / range_) * std::sqrt(insertion.air_rows));
  for (std::size_t i = 0; i < terms_; ++i)  // shares
    result.residuals.push_back(kPriorLaw * (shared[kLawParameters + 2 * i] - log(0.2)));
  result.residuals.push_back(kPriorLaw * (shared[1] - log(kUsualBeta)));
  result.residuals.push_back(kPriorLaw * (shared[2] - log(kUsualQ)));
  return result;
}

Bounds NeedleProblem::own_bounds_of(std::size_t record) const {
  const Insertion& insertion = *records_[record];
  const double lowest = *std::min_element(insertion.all.depth.begin(), insertion.all.depth.end()) / depth_;
  Bounds bounds{{lowest - kContactReach, -kZeroReach}, {lowest + 1.0, kZeroReach}};
  bounds.low.insert(bounds.low.end(), layers_, -kTimeReach);
  bounds.high.insert(bounds.high.end(), layers_, kTimeReach);
  bounds.low.insert(bounds.low.end(), layers_ - 1, kReached);
  bounds.high.insert(bounds.high.end(), layers_ - 1, 1.0 - kReached);
  return bounds;
}

NeedlePoint NeedleProblem::solved(NeedlePoint from, int most_iterations, double step) const {
  RecordsProblem problem;
  problem.shared = bounds_;
  for (std::size_t i = 0; i < bounds_.low.size(); ++i)
    from.shared[i] = std::clamp(from.shared[i], bounds_.low[i], bounds_.high[i]);
  for (std::size_t r = 0; r < records_.size(); ++r) {
    problem.own.push_back(own_bounds_of(r));
    problem.residuals.push_back(records_[r]->thinned.size() + priors());
    for (std::size_t i = 0; i < from.own[r].size(); ++i)
      from.own[r][i] = std::clamp(from.own[r][i], problem.own[r].low[i], problem.own[r].high[i]);
  }
  problem.errors = [this](std::size_t record, std::span<const double> shared, std::span<const double> own,
                          std::span<double> out) {
    const Result result = at(record, shared, own);
    if (result.residuals.size() != out.size()) return false;
    std::copy(result.residuals.begin(), result.residuals.end(), out.begin());
    return true;
  };
  problem.step = step;
  from.squares = minimise(problem, from.shared, from.own, most_iterations);
  return from;
}

NeedlePoint NeedleProblem::start_from(const Point& law, double contact, double zero) const {
  constexpr double kPhi = 0.3;       // of the friction that does not grow with the length
  constexpr double kFallen = 80e-3;  // s, after which a fall is over
  const Insertion& insertion = *records_.front();
  const NeedleRecord& rows = insertion.thinned;
  const double turn = insertion.all.time[insertion.turn];
  const double leaves = turn + insertion.hold;
  const double end = rows.time.back();
  const double cutting = force_near(insertion.all, turn - 0.3, turn) - zero;
  double friction = 0.4 * std::max(0.0, cutting);
  if (insertion.withdrawn) {
    friction =
        std::max(0.05 * range_, zero - force_near(insertion.all, leaves, leaves + 0.5 * (end - leaves)));
  }
  NeedlePoint start;
  start.shared = law;
  start.shared.resize(kLawParameters);
  const double held = force_near(insertion.all, leaves - 0.2, leaves) - zero;
  const double loss = std::clamp(1.0 - held / std::max(cutting, 1e-9), 0.1, 0.7);
  for (std::size_t i = 0; i < terms_; ++i) {
    const double share = loss / static_cast<double>(terms_);
    start.shared.push_back(log(share / (1.0 - loss)));
    const double slowest = std::max(insertion.hold, 1.0);
    start.shared.push_back(log(slowest * std::pow(0.1, static_cast<double>(terms_ - 1 - i)) / 2.0));
  }
  start.shared.push_back(law[kLawParameters - 1]);  // pulled
  const model::SpringLaw press(tissue_of(law, settings_), model::Direction::kPress, settings_.period);
  const auto inside = [&](double time) {
    const auto row = static_cast<std::size_t>(
        std::lower_bound(insertion.all.time.begin(), insertion.all.time.end(), time) -
        insertion.all.time.begin());
    const double at = insertion.all.depth[std::min(row, insertion.all.size() - 1)] - contact;
    return at - press.deformation_under(force_near(insertion.all, time - 0.02, time) - zero).depth;
  };
  const double longest = std::max(0.1 * depth_, inside(turn));
  std::vector<double> reached;
  for (std::size_t k = 0; k < layers_; ++k) {
    const double fall = falls_.front()[k].time;
    const double fallen = fall + kFallen;
    const double length = k > 0 ? std::max(0.0, inside(fall)) : 0.0;
    const double cuts =
        force_near(insertion.all, fallen, fallen + kFallen) - zero - friction * length / longest;
    start.shared.push_back(std::max(0.05, cuts / range_));
    start.shared.push_back(kPhi * friction / range_ / static_cast<double>(layers_));
    start.shared.push_back((1.0 - kPhi) * friction / range_ * depth_ / longest);
    if (k == 0) continue;
    const double before = falls_.front()[k - 1].time;
    reached.push_back((bend_between(insertion.all, before + kFallen, fall) - before) / (fall - before));
  }
  start.own = {{contact / depth_, zero / range_}};
  start.own.front().resize(2 + layers_, 0.0);
  start.own.front().insert(start.own.front().end(), reached.begin(), reached.end());
  return start;
}

std::vector<NeedlePoint> NeedleProblem::starts() const {
  constexpr double kFirstLimits[] = {0.5, 0.8};  // L_1 of the indentation at the first puncture
  const Insertion& insertion = *records_.front();
  const double fall = first_fall(0).time;
  const double contact = contact_of(insertion, fall);
  const auto row =
      static_cast<std::size_t>(std::lower_bound(insertion.all.time.begin(), insertion.all.time.end(), fall) -
                               insertion.all.time.begin());
  const double indentation = std::max(kThinnest * depth_, insertion.all.depth[row] - contact);
  const double force =
      std::max(kLeastForce * range_, force_near(insertion.all, fall - 0.02, fall) - insertion.air);
  std::vector<NeedlePoint> all;
  for (const double first_limit : kFirstLimits) {
    Point law = {0.0, log(kUsualBeta), log(kUsualQ), log(first_limit * indentation)};
    const model::SpringLaw press(tissue_of(law, settings_), model::Direction::kPress, settings_.period);
    law[0] = log(force / press.force_at(indentation).force);
    all.push_back(start_from(law, contact, insertion.air));
  }
  return all;
}

NeedlePoint NeedleProblem::with_terms(const NeedlePoint& from, std::size_t terms_before) const {
  constexpr double kNewShare = 0.1;  // g_i over the lasting share
  NeedlePoint start = from;
  const auto law = static_cast<std::ptrdiff_t>(kLawParameters);
  for (std::size_t n = terms_before; n < terms_; ++n) {  // the new term is the fastest
    double fastest = log(records_.front()->hold + 1.0);
    for (std::size_t i = 0; i < n; ++i) fastest = std::min(fastest, start.shared[kLawParameters + 2 * i + 1]);
    start.shared.insert(start.shared.begin() + law, {log(kNewShare), fastest - 2.0});
  }
  for (std::size_t n = terms_before; n > terms_; --n)
    start.shared.erase(start.shared.begin() + law, start.shared.begin() + law + 2);
  return start;
}

}  // namespace palpate::identify
