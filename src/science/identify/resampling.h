#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "science/identify/minima.h"
#include "science/tasks/ranks.h"

namespace palpate::identify {

/// [setup] Fits to `count` resamples of a specimen: the fitted curve plus its residuals drawn again in blocks
/// as long as neighbours follow each other [Kuensch 1989], each descended to from the best minima. One point
/// a resample, shared parameters first. @param ranks share the resamples, all of them making this call;
/// null: this process alone
[[nodiscard]] std::vector<Point> bootstrap(const Minima& minima, int count, std::uint64_t seed,
                                           std::uint32_t job, const std::function<void(double)>& progress,
                                           tasks::Ranks* ranks = nullptr);

/// [setup] RMS over the range of force of points that a fit had not seen: five folds, every fifth point of
/// each left out in turn.
[[nodiscard]] double leave_out_error(const Minima& minima);

}  // namespace palpate::identify
