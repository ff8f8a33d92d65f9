// The least-squares problem of a needle's records. A puncture makes the error of a fit jump wherever the
// simulated needle goes through a membrane earlier or later than the measured one. So the time of each
// puncture is a parameter here, near a fall of the measured force, and the force at that time is the
// result: the puncture force.
#include "fit/identify/needle_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/infinity.h"
#include "core/base/portable_math.h"
#include "palpate/error.h"
#include "palpate/spring_law.h"

#include "fit/identify/local_optima.h"

namespace palpate::identify {
namespace {

using portable::exp;
using portable::log;

constexpr double kTimeUnit = 10e-3;     // s, of the times of punctures
constexpr double kTimeReach = 6.0;      // of these units: how far a puncture may be from its fall's start
constexpr double kLongestStep = 0.1;    // s, between ticks of a fit
constexpr double kLeastForce = 1e-4;    // of the range: no force, with room for derivatives
constexpr double kMostForce = 2.0;      // of the range
constexpr double kThinnest = 0.005;     // layer, of the depth
constexpr double kContactReach = 0.15;  // of the depth
constexpr double kZeroReach = 0.2;      // of the range
constexpr double kPriorLaw = 0.01;   // weight of usual values, which settles what compensates for each other
constexpr double kShallower = 0.85;  // of the length inside at a puncture
constexpr std::size_t kPressStarts = 3;

/// The press before the first fall, with contact near displacement 0.
struct Press {
  Specimen curve;
  double shift = 0.0;  // [m] subtracted from the depths
};

Press press_of(const Insertion& insertion, double end) {
  Press press;
  press.curve.name = insertion.all.name;
  const NeedleRecord& all = insertion.thinned;
  for (std::size_t i = 0; i < all.size() && all.time[i] < end; ++i) {
    press.curve.displacement.push_back(all.depth[i]);
    press.curve.force.push_back(all.force[i]);
  }
  press.shift = flat_until(press.curve, ranges_of(press.curve));
  for (double& depth : press.curve.displacement) depth -= press.shift;
  return press;
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
  bounds_.low.insert(bounds_.low.end(), layers_ - 1, kThinnest);
  bounds_.high.insert(bounds_.high.end(), layers_ - 1, 1.0);
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
    if (k + 1 < layers_) layer.thickness = depth_ * shared[law + 1 + 3 * layers_ + k];
    tissue.layers.push_back(layer);
  }
  return tissue;
}

std::vector<double> NeedleProblem::times_of(std::size_t record, std::span<const double> own) const {
  std::vector<double> times;
  for (std::size_t k = 0; k < layers_; ++k) times.push_back(falls_[record][k].time + kTimeUnit * own[2 + k]);
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
  result.residuals.push_back((own[1] - insertion.air / range_) * std::sqrt(insertion.air_rows));
  for (std::size_t i = 0; i < terms_; ++i)  // shares
    result.residuals.push_back(kPriorLaw * (shared[kLawParameters + 2 * i] - log(0.2)));
  result.residuals.push_back(kPriorLaw * (shared[1] - log(2.0)));  // beta
  result.residuals.push_back(kPriorLaw * (shared[2] - log(0.7)));  // q
  return result;
}

Bounds NeedleProblem::own_bounds_of(std::size_t record) const {
  const Insertion& insertion = *records_[record];
  const double lowest = *std::min_element(insertion.all.depth.begin(), insertion.all.depth.end()) / depth_;
  Bounds bounds{{lowest - kContactReach, -kZeroReach}, {lowest + 1.0, kZeroReach}};
  bounds.low.insert(bounds.low.end(), layers_, -kTimeReach);
  bounds.high.insert(bounds.high.end(), layers_, kTimeReach);
  return bounds;
}

NeedlePoint NeedleProblem::solved(NeedlePoint from, int most_iterations) const {
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
  from.squares = minimise(problem, from.shared, from.own, most_iterations);
  return from;
}

NeedlePoint NeedleProblem::start_from(const Point& law, double contact, double zero, double reached) const {
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
  std::vector<double> thicknesses;
  double before = 0.0;  // [m], length inside at the layer's puncture
  for (std::size_t k = 0; k < layers_; ++k) {
    const double fallen = falls_.front()[k].time + kFallen;
    if (k > 0) {
      const double boundary = std::max(before + 0.02 * depth_, reached * inside(falls_.front()[k].time));
      thicknesses.push_back((boundary - before) / depth_);
      before = boundary;
    }
    const double cuts =
        force_near(insertion.all, fallen, fallen + kFallen) - zero - friction * before / longest;
    start.shared.push_back(std::max(0.05, cuts / range_));
    start.shared.push_back(kPhi * friction / range_ / static_cast<double>(layers_));
    start.shared.push_back((1.0 - kPhi) * friction / range_ * depth_ / longest);
  }
  start.shared.insert(start.shared.end(), thicknesses.begin(), thicknesses.end());
  start.own = {{contact / depth_, zero / range_}};
  start.own.front().resize(2 + layers_, 0.0);
  return start;
}

std::vector<NeedlePoint> NeedleProblem::starts() const {
  const Press press = press_of(*records_.front(), falls_.front().front().time);
  Settings elastic = settings_;
  elastic.relaxation = false;
  const identify::Problem problem = make_problem(elastic, 0, {make_part(press.curve)});
  const LocalOptima optima = run_multistart(problem, multistart_points(problem, 2));
  const Ranges& ranges = problem.parts.front().ranges;
  std::vector<NeedlePoint> all;
  for (const Solution& one : optima.all) {
    if (all.size() >= kPressStarts) break;
    const Point& own = one.own.front();
    // A membrane that the needle does not reach in the simulation has no derivatives: one start is shallower.
    for (const double reached : {1.0, kShallower}) {
      all.push_back(
          start_from(one.shared, press.shift + own[0] * ranges.displacement, own[1] * ranges.force, reached));
      if (layers_ == 1) break;
    }
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
