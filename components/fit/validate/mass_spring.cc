#include "fit/validate/mass_spring.h"

#include <cmath>
#include <numbers>

namespace palpate::validate {

MassSpringPatch::MassSpringPatch(double ratio) : ratio_(ratio), down_(kSide * kSide, 0.0) {}

MassSpringPatch::Pull MassSpringPatch::pull_of_neighbours(std::size_t row,
                                                          std::size_t column) const noexcept {
  Pull pull;
  const double here = down_[row * kSide + column];
  for (std::size_t r = row - 1; r <= row + 1; ++r) {
    for (std::size_t c = column - 1; c <= column + 1; ++c) {
      if (r == row && c == column) continue;
      const double there = down_[r * kSide + c];
      const double rest = r == row || c == column ? kSpacing : std::numbers::sqrt2 * kSpacing;
      const double length = std::sqrt(rest * rest + (there - here) * (there - here));
      const double rise = there - here;
      pull.force += ratio_ * (1.0 - rest / length) * rise;
      pull.stiffness += ratio_ * (1.0 - rest / length + rest * rise * rise / (length * length * length));
    }
  }
  return pull;
}

double MassSpringPatch::press(double depth) noexcept {
  node(kMiddle, kMiddle) = depth;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t row = 1; row + 1 < kSide; ++row) {
      for (std::size_t column = 1; column + 1 < kSide; ++column) {
        if (row == kMiddle && column == kMiddle) continue;
        const Pull pull = pull_of_neighbours(row, column);
        double& here = node(row, column);
        here += (pull.force - here) / (pull.stiffness + 1.0);  // Newton step for this node
      }
    }
  }
  return depth - pull_of_neighbours(kMiddle, kMiddle).force;
}

double MassSpringPatch::at(double r) const noexcept {
  const double place = r / kSpacing;
  if (!(place < static_cast<double>(kSide - 1 - kMiddle))) return 0.0;
  const auto low = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(low);
  const double* const row = down_.data() + kMiddle * kSide + kMiddle;
  return (1.0 - share) * row[low] + share * row[low + 1];
}

}  // namespace palpate::validate
