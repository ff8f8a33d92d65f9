#include "fit/identify/map_tissue.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include <ceres/ceres.h>

#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::identify {
namespace {

constexpr int kDepths = 80;             // at which the tissue is compared
constexpr double kSoftestGrowth = 1e3;  // beta; larger ones differ by less than 0.1 % a layer
constexpr double kLoopPeriod = 1e-3;    // s

model::TissueParameters smooth_tissue(const double* logarithms) {
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  return tissue_of({logarithms, kLawParameters}, settings);
}

/// Differences of the forces, as fractions of the largest force; false where the tissue has no law.
struct TissueCost {
  const FittedMap* map;
  double deepest;
  bool operator()(double const* const* blocks, double* out) const {
    try {
      const model::TissueParameters tissue = smooth_tissue(blocks[0]);
      model::validate(tissue);
      const model::SpringLaw law(tissue, model::Direction::kPress, kLoopPeriod);
      const double largest = map->uniform(deepest).first;
      for (int i = 0; i < kDepths; ++i) {
        const double depth = deepest * (i + 1) / kDepths;
        out[i] = (law.force_at(depth).force - map->uniform(depth).first) / largest;
        if (!std::isfinite(out[i])) return false;
      }
      return true;
    } catch (const InputError&) {
      return false;
    }
  }
};

}  // namespace

MapTissue tissue_of_map(const FittedMap& map, double deepest) {
  const double reached = deepest + map.first_depth;
  const TissueCost compared{&map, reached};
  MapTissue best;
  best.error = std::numeric_limits<double>::infinity();
  for (const double limit : {0.02, 0.1, 0.4}) {  // of the depth, L_1
    for (const double q : {0.8, 1.2, 2.0}) {
      const double start = map.uniform(limit * reached).first / (limit * reached);
      double values[kLawParameters] = {std::log(start), std::log(3.0), std::log(q),
                                       std::log(limit * reached)};
      double differences[kDepths];
      const double* const block = values;
      if (!compared(&block, differences)) continue;
      auto cost = std::make_unique<ceres::DynamicNumericDiffCostFunction<TissueCost, ceres::CENTRAL>>(
          new TissueCost(compared));
      cost->AddParameterBlock(static_cast<int>(kLawParameters));
      cost->SetNumResiduals(kDepths);
      ceres::Problem problem;
      problem.AddResidualBlock(cost.release(), nullptr, values);
      problem.SetParameterUpperBound(values, 1, std::log(kSoftestGrowth));
      ceres::Solver::Options options;
      options.linear_solver_type = ceres::DENSE_QR;
      options.max_num_iterations = 200;
      options.logging_type = ceres::SILENT;
      options.num_threads = 1;
      ceres::Solver::Summary summary;
      ceres::Solve(options, &problem, &summary);
      if (!compared(&block, differences)) continue;
      double error = 0.0;
      for (const double one : differences) error = std::max(error, std::abs(one));
      if (error >= best.error) continue;
      best.error = error;
      best.tissue = smooth_tissue(values);
    }
  }
  if (!std::isfinite(best.error)) throw InputError("no tissue has the background of this map");
  best.tissue.name = "background of a map";
  best.tissue.source = model::SourceParameters{"ball", map.tip_radius};
  best.tissue.max_depth = reached;
  return best;
}

}  // namespace palpate::identify
