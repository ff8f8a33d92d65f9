#include "fit/identify/map_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <ceres/ceres.h>
#include <fmt/core.h>

#include "core/base/parallel.h"
#include "core/base/text.h"
#include "palpate/units.h"

#include "fit/identify/fit_record.h"
#include "fit/identify/map_model.h"
#include "fit/identify/map_problem.h"

namespace palpate::identify {
namespace {

constexpr std::size_t kFewestToHoldOut = 16;  // probes

// The kind with the least product of error and price wins. Inclusions must predict better than the tissue,
// and a map with inclusions better than without them; a map alone must be better by a fifth, because it has
// no cause that holds at other depths and for other balls.
constexpr std::array<double, kMapKinds> kPrices = {1.0, 1.05, 1.25, 1.08};

double rms_difference(const Values& forces, const std::vector<MapRow>& rows) {
  double sum = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) sum += std::pow(forces[i] - rows[i].force, 2);
  return std::sqrt(sum / static_cast<double>(rows.size()));
}

/// Force and energy of F = K (D + D_0)^p. @param tissue ln K at 1 mm, p, D_0 [mm]
std::pair<double, double> power_law(const std::array<double, kMapTissue>& tissue, double depth) {
  const double force = std::exp(tissue[0]) * std::pow(depth / kMillimetre, tissue[1]);
  return {force, force * depth / (tissue[1] + 1.0)};
}

/// One row a probe, in the order of the map.
std::vector<MapRow> probes_of(const std::vector<MapRow>& rows) {
  std::vector<MapRow> firsts;
  std::map<int, bool> seen;
  for (const MapRow& row : rows) {
    if (seen.emplace(row.probe, true).second) firsts.push_back(row);
  }
  return firsts;
}

FittedMap uniform_map(const Values& values, double tip_radius) {
  FittedMap made;
  made.tip_radius = tip_radius;
  made.first_depth = values[2] * kMillimetre;
  const std::array<double, kMapTissue> tissue{values[0], values[1], values[2]};
  made.uniform = [tissue](double depth) { return power_law(tissue, depth); };
  return made;
}

/// The map that a fit describes: its inclusions, and its polynomial as factors at the probes.
FittedMap map_of(const MapFit& fit, const std::vector<MapRow>& rows, double tip_radius) {
  FittedMap made = uniform_map(fit.values, tip_radius);
  const MapModel model(rows, tip_radius, fit.map_terms);
  Values uniform = fit.values;
  std::fill(uniform.begin() + kMapTissue, uniform.end(), 0.0);
  if (fit.map_terms > 1) {
    for (MapRow probe : probes_of(rows)) {
      probe.depth = kMillimetre;  // the factor is the same at every depth that has a force
      const double factor = model.background(fit.values, probe) / model.background(uniform, probe);
      made.stiffness.push_back(
          {probe.point, std::clamp(factor, model::kSmallestFactor, model::kLargestFactor)});
    }
  }
  for (const FoundInclusion& found : fit.inclusions) {
    model::Inclusion one;
    one.centre_S = Vec3(found.centre[0].value, found.centre[1].value, found.centre[2].value);
    one.radius = found.radius.value;
    one.ratio = found.ratio.value;
    made.inclusions.push_back(one);
  }
  return made;
}

/// The factor of each probe by which its forces are those of a prediction, by least squares.
std::map<int, double> factors_of(const Values& forces, const Values& weights,
                                 const std::vector<MapRow>& rows) {
  std::map<int, std::pair<double, double>> sums;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double weight = weights[i] * weights[i];
    sums[rows[i].probe].first += weight * forces[i] * rows[i].force;
    sums[rows[i].probe].second += weight * forces[i] * forces[i];
  }
  std::map<int, double> factors;
  for (const auto& [probe, both] : sums) {
    factors[probe] = both.second > 0.0 ? std::max(model::kSmallestFactor, both.first / both.second) : 1.0;
  }
  return factors;
}

/// Multiplies the factors of a map by those that its rows leave, smoothed as much as predicts each probe from
/// the others best.
void add_factors(FittedMap& map, const Values& weights, const std::vector<MapRow>& rows) {
  const Values forces = predicted_forces(map, rows, rows);
  const std::map<int, double> factors = factors_of(forces, weights, rows);
  std::map<int, double> sizes;
  for (std::size_t i = 0; i < rows.size(); ++i) sizes[rows[i].probe] += forces[i] * forces[i];
  const std::vector<MapRow> probes = probes_of(rows);
  std::vector<model::StiffnessPoint> points;
  for (const MapRow& probe : probes) points.push_back({probe.point, factors.at(probe.probe)});
  const std::size_t step = (points.size() + FactorField::kMostPoints - 1) / FactorField::kMostPoints;
  const Eigen::MatrixXd kernels = FactorField::kernels_of(points);
  constexpr std::array<double, 4> kTolerances = {FactorField::kOrganTolerance, 0.02, 0.1, 0.5};
  std::array<FactorField, kTolerances.size()> fields;
  std::array<double, kTolerances.size()> sums{};
  for_ranges(kTolerances.size(), 1, [&](std::size_t k, std::size_t) {
    fields.at(k) = FactorField(points, kTolerances.at(k), kernels);
    for (std::size_t i = 0; i < points.size(); i += step) {
      sums.at(k) +=
          sizes.at(probes[i].probe) * std::pow(fields.at(k).without(i / step) - points[i].factor, 2);
    }
  });
  const FactorField& best =
      fields.at(static_cast<std::size_t>(std::min_element(sums.begin(), sums.end()) - sums.begin()));
  const bool varies = !map.stiffness.empty();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double before = varies ? map.stiffness[i].factor : 1.0;
    points[i].factor =
        std::clamp(before * best.at(points[i].point_S), model::kSmallestFactor, model::kLargestFactor);
  }
  map.stiffness = std::move(points);
}

/// Residuals of exponent and first depth, with the best factor for each probe.
struct ShapeCost {
  const std::vector<MapRow>* rows;
  const Values* weights;
  bool operator()(double const* const* blocks, double* out) const {
    Values forces;
    for (const MapRow& row : *rows) {
      // Numerical derivatives step below D_0 = 0, where a row of depth 0 has no power.
      forces.push_back(std::pow(std::max(0.0, row.depth / kMillimetre + blocks[0][1]), blocks[0][0]));
    }
    const std::map<int, double> factors = factors_of(forces, *weights, *rows);
    for (std::size_t i = 0; i < rows->size(); ++i) {
      out[i] = (*weights)[i] * (factors.at((*rows)[i].probe) * forces[i] - (*rows)[i].force);
    }
    return true;
  }
};

/// The tissue whose force over depth fits all probes, each with a factor of its own.
FittedMap tissue_under_factors(Values tissue, const Values& weights, const std::vector<MapRow>& rows,
                               double tip_radius) {
  double shape[] = {tissue[1], tissue[2]};
  auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<ShapeCost, ceres::CENTRAL>>(
      new ShapeCost{&rows, &weights});
  cost->AddParameterBlock(2);
  cost->SetNumResiduals(static_cast<int>(rows.size()));
  ceres::Problem problem;
  problem.AddResidualBlock(cost.release(), nullptr, shape);
  const MapBounds bounds = MapProblem(rows, {tip_radius, 0, false}, 1, weights).bounds(kMapTissue);
  for (int i = 0; i < 2; ++i) {
    problem.SetParameterLowerBound(shape, i, bounds.low[static_cast<std::size_t>(i) + 1]);
    problem.SetParameterUpperBound(shape, i, bounds.high[static_cast<std::size_t>(i) + 1]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  tissue = {0.0, shape[0], shape[1]};
  const FittedMap unit = uniform_map(tissue, tip_radius);
  Values logarithms;
  for (const auto& [probe, factor] : factors_of(predicted_forces(unit, rows, rows), weights, rows)) {
    logarithms.push_back(std::log(factor));
  }
  const auto middle = logarithms.begin() + static_cast<std::ptrdiff_t>(logarithms.size() / 2);
  std::nth_element(logarithms.begin(), middle, logarithms.end());
  tissue[0] = *middle;
  return uniform_map(tissue, tip_radius);
}

/// The fits of a map without and with inclusions, without intervals.
struct Searched {
  MapFit tissue, lumps;
};

Searched search_both(const std::vector<MapRow>& rows, MapSettings settings, const MapProgress& progress) {
  Searched made;
  made.lumps = search_map(rows, settings, progress);
  settings.max_inclusions = 0;
  made.tissue = made.lumps.inclusions.empty() ? made.lumps : search_map(rows, settings);
  return made;
}

FittedMap described_by(MapKind kind, const Searched& found, const std::vector<MapRow>& rows,
                       double tip_radius) {
  if (kind == MapKind::kTissue) return map_of(found.tissue, rows, tip_radius);
  if (kind == MapKind::kLumps) return map_of(found.lumps, rows, tip_radius);
  const Values weights = weights_of(rows);
  FittedMap made = kind == MapKind::kLumpsAndStiffness
                       ? map_of(found.lumps, rows, tip_radius)
                       : tissue_under_factors(found.tissue.values, weights, rows, tip_radius);
  add_factors(made, weights, rows);
  return made;
}

bool has_inclusions(MapKind kind) { return kind == MapKind::kLumps || kind == MapKind::kLumpsAndStiffness; }

/// Whether an inclusion ended at the largest or smallest ratio: the probes ask for more than the law can
/// give.
bool is_saturated(const MapFit& fit) {
  for (const FoundInclusion& one : fit.inclusions) {
    for (const std::string& key : one.at_bounds) {
      if (key == "stiffness_ratio") return true;
    }
  }
  return false;
}

/// Every second probe, to which a map is fitted that predicts the others. Both are empty where there are too
/// few.
struct Halves {
  std::vector<MapRow> fitted, held;
  std::size_t held_probes = 0;
};

Halves halves_of(const std::vector<MapRow>& rows) {
  std::map<int, std::size_t> order;
  Halves made;
  for (const MapRow& row : rows) {
    const std::size_t at = order.emplace(row.probe, order.size()).first->second;
    (at % 2 == 0 ? made.fitted : made.held).push_back(row);
  }
  if (order.size() < kFewestToHoldOut || made.fitted.size() < kFewestMapRows) return {};
  made.held_probes = order.size() / 2;
  return made;
}

/// Chooses the kind that predicts the held-out probes best. @param half fitted to the others
void choose_kind(const std::vector<MapRow>& rows, const Halves& halves, const Searched& half,
                 const MapSettings& settings, const Searched& all, DescribedMap& map) {
  map.held_out = halves.held_probes;
  for_ranges(kMapKinds, 1, [&](std::size_t i, std::size_t) {
    const FittedMap made = described_by(static_cast<MapKind>(i), half, halves.fitted, settings.tip_radius);
    map.held_error[i] = rms_difference(predicted_forces(made, halves.held, rows), halves.held);
  });
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kMapKinds; ++i) {
    const auto kind = static_cast<MapKind>(i);
    if (has_inclusions(kind) && all.lumps.inclusions.empty()) continue;
    // Without inclusions, or where they cannot be stiff enough, a map needs to be better only as they do.
    const bool alone =
        kind == MapKind::kStiffness && (all.lumps.inclusions.empty() || is_saturated(all.lumps));
    const double price = alone ? kPrices[1] : kPrices[i];
    if (!(price * map.held_error[i] < least)) continue;
    least = price * map.held_error[i];
    map.won = kind;
  }
}

/// No map may be written that has no numbers. @throws InputError
void require_finite(const DescribedMap& map) {
  const MapFit& fit = map.fit;
  std::vector<std::pair<std::string, double>> numbers = {{"error", fit.error},
                                                         {"error of the uniform tissue", fit.uniform_error},
                                                         {"stiffness", fit.stiffness},
                                                         {"exponent", fit.exponent},
                                                         {"first depth", fit.first_depth}};
  for (std::size_t i = 0; i < kMapKinds; ++i) {
    numbers.emplace_back(fmt::format("error of held-out probes, {}", to_string(static_cast<MapKind>(i))),
                         map.held_error[i]);
  }
  for (const model::StiffnessPoint& one : fit.stiffness_map)
    numbers.emplace_back("factor of a probe", one.factor);
  for (const FoundInclusion& one : fit.inclusions) {
    numbers.emplace_back("radius of an inclusion", one.radius.value);
    numbers.emplace_back("stiffness ratio of an inclusion", one.ratio.value);
    numbers.emplace_back("depth of an inclusion", one.depth.value);
    for (const Estimate& centre : one.centre) numbers.emplace_back("centre of an inclusion", centre.value);
  }
  for (const auto& [name, value] : numbers) require_finite_result(name, value);
}

/// Warns where a run of the tissue, which counts depth from the organ's surface, differs from the probes,
/// which count it from their first rows.
void question_first_contact(const std::vector<MapRow>& rows, DescribedMap& map) {
  constexpr double kMatters = 0.05;  // of the force, half as deep as the deepest row
  double deepest = 0.0;
  for (const MapRow& row : rows) deepest = std::max(deepest, row.depth);
  const double half = 0.5 * deepest;
  const double change = std::pow(half / std::max(half + map.fit.first_depth, 0.0), map.fit.exponent) - 1.0;
  if (!(std::abs(change) > kMatters)) return;
  const bool is_above = map.fit.first_depth > 0.0;
  map.warnings.push_back(fmt::format(
      "first contact is {} mm {} the first rows, but palpate run counts depth from the organ's surface: {} "
      "mm "
      "deep it gives {} {} force than the probes. Is the sensor tared, and depth_mm counted from contact?",
      brief(std::abs(map.fit.first_depth) / kMillimetre, 2), is_above ? "above" : "below",
      brief(half / kMillimetre, 2), percent(std::abs(change), 0), change < 0.0 ? "less" : "more"));
}

/// Warns where the background's first depth or exponent ended at the bound of the search.
void add_bounds(const std::vector<MapRow>& rows, const MapSettings& settings, DescribedMap& map) {
  constexpr double kAtBound = 1e-3;  // of the bound
  const MapBounds bounds = MapProblem(rows, settings, 1, weights_of(rows)).bounds(kMapTissue);
  if (map.fit.first_depth / kMillimetre > (1.0 - kAtBound) * bounds.high[2]) {
    map.warnings.push_back(fmt::format(
        "first contact is as far above the first rows as the search goes, {} mm: is the sensor tared?",
        bounds.high[2]));
  }
  if (map.fit.exponent > (1.0 - kAtBound) * bounds.high[1]) {
    map.warnings.push_back(fmt::format(
        "the force grows as steeply as the search goes, as D^{}: is depth_mm counted from contact?",
        bounds.high[1]));
  }
}

constexpr double kPlateLength = 10e-3;  // m, l of contact::StiffnessMap

double plate_kernel(double distance) {
  const double ratio = distance / kPlateLength;
  constexpr double kNear = 1e-6;  // below, the limit: ln 2 minus Euler's constant
  const double sum = ratio < kNear ? std::numbers::ln2 - std::numbers::egamma
                                   : std::log(ratio) + std::cyl_bessel_k(0.0, ratio);
  return -sum / (2.0 * std::numbers::pi);
}

}  // namespace

const char* to_string(MapKind kind) noexcept {
  constexpr const char* kNames[] = {"tissue", "lumps", "map", "lumps and map"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::vector<double> predicted_forces(const FittedMap& map, std::span<const MapRow> rows,
                                     std::span<const MapRow> surface) {
  const MapModel model(surface, map.tip_radius, 1);
  std::vector<PlacedLump> placed;
  for (const model::Inclusion& one : map.inclusions) {
    const double h = std::max(one.radius, model.depth_below(one.centre_S));
    placed.push_back(
        {model.frame().local(one.centre_S), h * h, model::InclusionLaw(one.radius, h, one.ratio)});
  }
  const FactorField field(map.stiffness);
  std::map<int, double> factors;
  std::vector<double> forces;
  for (const MapRow& row : rows) {
    const auto [known, is_new] = factors.emplace(row.probe, 1.0);
    if (is_new) known->second = field.at(row.point);
    const double depth = row.depth + map.first_depth;
    const auto [force, energy] = map.uniform(depth);
    const LumpFactor lumps =
        factor_of(placed, model::PressedTip(map.tip_radius, depth), model.frame().local(row.point));
    forces.push_back(known->second * lumps.value * (force + energy * lumps.by_depth));
  }
  return forces;
}

DescribedMap describe_map(const std::vector<MapRow>& rows, const MapSettings& settings,
                          const MapProgress& progress) {
  const auto part = [&progress](double from, double share) -> MapProgress {
    if (!progress) return {};
    return [&progress, from, share](double done, const std::string& what) {
      progress(from + share * done, what);
    };
  };
  const Halves halves = halves_of(rows);
  std::array<Searched, 2> found;  // in all rows, and in half of them
  for_ranges(halves.fitted.empty() ? 1 : 2, 1, [&](std::size_t i, std::size_t) {
    found[i] =
        i == 0 ? search_both(rows, settings, part(0.0, 0.6)) : search_both(halves.fitted, settings, {});
  });
  const Searched& all = found[0];
  DescribedMap map;
  if (halves.held_probes > 0) choose_kind(rows, halves, found[1], settings, all, map);
  map.predictor = described_by(map.won, all, rows, settings.tip_radius);
  map.fit = has_inclusions(map.won) ? all.lumps : all.tissue;
  if (has_inclusions(map.won)) {
    if (settings.profiles) add_intervals(rows, settings, map.fit, part(0.6, 0.4));
  } else {
    map.left_out = all.lumps.inclusions;
  }
  if (map.won == MapKind::kStiffness || map.won == MapKind::kLumpsAndStiffness) {
    const auto [force, energy] = map.predictor.uniform(kMillimetre);
    map.fit.exponent = kMillimetre * force / energy - 1.0;
    map.fit.stiffness = force * std::pow(1.0 / kMillimetre, map.fit.exponent);
    map.fit.first_depth = map.predictor.first_depth;
    map.fit.map_terms = 1;
  }
  map.fit.error = rms_difference(predicted_forces(map.predictor, rows, rows), rows);
  map.fit.stiffness_map = map.predictor.stiffness;
  if (map.fit.stiffness_map.empty()) {
    for (const MapRow& probe : probes_of(rows)) map.fit.stiffness_map.push_back({probe.point, 1.0});
  }
  require_finite(map);
  question_first_contact(rows, map);
  add_bounds(rows, settings, map);
  return map;
}

namespace {

std::size_t step_of(std::span<const model::StiffnessPoint> points) {
  return (points.size() + FactorField::kMostPoints - 1) / FactorField::kMostPoints;
}

}  // namespace

Eigen::MatrixXd FactorField::kernels_of(std::span<const model::StiffnessPoint> points) {
  std::vector<Vec3> used;
  for (std::size_t i = 0; i < points.size(); i += step_of(points)) used.push_back(points[i].point_S);
  const auto n = static_cast<Eigen::Index>(used.size());
  Eigen::MatrixXd kernels(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      kernels(i, j) =
          plate_kernel((used[static_cast<std::size_t>(i)] - used[static_cast<std::size_t>(j)]).norm());
      kernels(j, i) = kernels(i, j);
    }
  }
  return kernels;
}

FactorField::FactorField(std::span<const model::StiffnessPoint> points, double tolerance,
                         const Eigen::MatrixXd& kernels) {
  if (points.empty()) return;
  std::vector<double> logarithms;
  for (std::size_t i = 0; i < points.size(); i += step_of(points)) {
    points_.push_back(points[i].point_S);
    logarithms.push_back(std::log(points[i].factor));
  }
  const auto n = static_cast<Eigen::Index>(points_.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(n + 1, n + 1);  // the last row: the weights' sum is 0
  matrix(n, n) = 0.0;
  matrix.topLeftCorner(n, n) = kernels;
  matrix.diagonal().head(n).array() += tolerance;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1);
  std::copy(logarithms.begin(), logarithms.end(), right.begin());
  const Eigen::MatrixXd inverse = matrix.partialPivLu().inverse();
  weights_ = inverse * right;
  for (Eigen::Index i = 0; i < n; ++i) {
    own_.push_back(std::exp(right[i] - tolerance * weights_[i]));
    without_.push_back(std::exp(right[i] - weights_[i] / inverse(i, i)));
  }
}

double FactorField::at(const Vec3& point) const {
  if (points_.empty()) return 1.0;
  const auto own = std::find(points_.begin(), points_.end(), point);
  if (own != points_.end()) return own_[static_cast<std::size_t>(own - points_.begin())];
  double logarithm = weights_[weights_.size() - 1];
  for (std::size_t i = 0; i < points_.size(); ++i) {
    logarithm += weights_[static_cast<Eigen::Index>(i)] * plate_kernel((point - points_[i]).norm());
  }
  return std::exp(logarithm);
}

}  // namespace palpate::identify
