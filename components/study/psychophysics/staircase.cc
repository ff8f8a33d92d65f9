#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/statistics.h"
#include "palpate/error.h"

#include "study/psychophysics/psychophysics.h"

namespace palpate::psychophysics {

Staircase::Staircase(StaircaseSetup setup) : setup_(std::move(setup)), level_(setup_.start) {
  if (setup_.down < 1) throw ParameterError("down", setup_.down, ">= 1");
  if (setup_.steps.empty()) throw ParameterError("steps", 0.0, "at least one step");
  for (const double step : setup_.steps) {
    if (!(step > 0.0 && std::isfinite(step))) throw ParameterError("steps", step, "finite and > 0");
  }
  if (setup_.reversals_per_step < 1) {
    throw ParameterError("reversals_per_step", setup_.reversals_per_step, ">= 1");
  }
  if (!(setup_.down_ratio > 0.0 && std::isfinite(setup_.down_ratio))) {
    throw ParameterError("down_ratio", setup_.down_ratio, "finite and > 0");
  }
  if (!(setup_.start >= setup_.least && setup_.start <= setup_.largest)) {
    throw ParameterError("start", setup_.start, "within the limits of the level");
  }
  if (setup_.discarded < 0) throw ParameterError("discarded", setup_.discarded, ">= 0");
}

void Staircase::update(bool correct) {
  correct_in_succession_ = correct ? correct_in_succession_ + 1 : 0;
  if (correct && correct_in_succession_ < setup_.down) return;
  correct_in_succession_ = 0;
  const int direction = correct ? -1 : 1;
  if (direction_ == -direction) reversals_.push_back(level_);
  direction_ = direction;
  const auto used = reversals_.size() / static_cast<std::size_t>(setup_.reversals_per_step);
  const double step = setup_.steps[std::min(used, setup_.steps.size() - 1)];
  level_ += correct ? -step * setup_.down_ratio : step;
  level_ = std::clamp(level_, setup_.least, setup_.largest);
}

std::optional<double> Staircase::mean() const {
  const auto discarded = static_cast<std::size_t>(setup_.discarded);
  if (reversals_.size() < discarded + 2) return std::nullopt;
  return palpate::mean(reversals().subspan(discarded));
}

}  // namespace palpate::psychophysics
