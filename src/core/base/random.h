#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/philox.h"
#include "core/base/portable_math.h"

namespace palpate {

/// [setup] Counter-based random numbers of one part of one job: a pure function of seed, job, part and the
/// number of draws. Results do not depend on the order of the jobs or on the rank that runs them.
class Random final {
 public:
  /// @param job index of a specimen or participant @param part index of a stage of its fit, or of a trial
  Random(std::uint64_t seed, std::uint32_t job, std::uint32_t part) noexcept
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        counter_{0, 0, job, part} {}

  /// Uniform in (0, 1).
  double uniform() noexcept {
    constexpr double kStep = 0x1p-53;
    const PhiloxCounter words = philox4x32(counter_, key_);
    if (++counter_[0] == 0) ++counter_[1];
    const std::uint64_t bits = (static_cast<std::uint64_t>(words[0]) << 32 | words[1]) >> 11;
    return (static_cast<double>(bits) + 0.5) * kStep;
  }

  /// Standard normal, by the Box-Muller method; uses two draws.
  double normal() noexcept {
    const double length = std::sqrt(-2.0 * portable::log(uniform()));
    return length * portable::cos_of_turns(uniform());
  }

  /// Skips `count` draws.
  void skip(std::uint64_t count) noexcept {
    const std::uint64_t drawn = (static_cast<std::uint64_t>(counter_[1]) << 32 | counter_[0]) + count;
    counter_[0] = static_cast<std::uint32_t>(drawn);
    counter_[1] = static_cast<std::uint32_t>(drawn >> 32);
  }

  /// Uniform integer in [0, count); uses one draw.
  std::size_t below(std::size_t count) noexcept {
    const auto drawn = static_cast<std::size_t>(uniform() * static_cast<double>(count));
    return drawn < count ? drawn : count - 1;
  }

  /// The numbers 0 .. count - 1 in random order; uses count - 1 draws.
  std::vector<std::size_t> permutation(std::size_t count) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[below(i)]);
    return order;
  }

 private:
  PhiloxKey key_;
  PhiloxCounter counter_;
};

}  // namespace palpate
