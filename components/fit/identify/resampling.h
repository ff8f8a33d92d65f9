#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "run/tasks/communicator.h"

#include "fit/identify/local_optima.h"

namespace palpate::identify {

/// [setup] Block bootstrap [Kuensch 1989]: fits `count` resamples of a specimen. A resample is the fitted
/// curve plus its residuals redrawn in blocks; the block length follows from their autocorrelation. Each
/// resample is fitted from the best optima.
/// @param ranks share the resamples and must all make this call; null: this process only
/// @return one point per resample, shared parameters first
[[nodiscard]] std::vector<Point> bootstrap(const LocalOptima& optima, int count, std::uint64_t seed,
                                           std::uint32_t job, const std::function<void(double)>& progress,
                                           tasks::Communicator* ranks = nullptr);

/// [setup] Error of 5-fold cross-validation: RMS residual of the points left out (every fifth point in each
/// fold), divided by the force range.
[[nodiscard]] double cross_validation_error(const LocalOptima& optima);

}  // namespace palpate::identify
