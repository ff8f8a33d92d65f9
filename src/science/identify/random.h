#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/philox.h"
#include "core/base/portable_math.h"

namespace palpate::identify {

/// Random numbers of one job of a fit: a pure function of seed, job and how many were drawn, so that neither
/// the order of the jobs nor who computes them changes anything. [setup]
class Random final {
 public:
  /// @param job which specimen, @param part which part of its fit
  Random(std::uint64_t seed, std::uint32_t job, std::uint32_t part) noexcept
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        counter_{0, 0, job, part} {}

  /// In (0, 1).
  double uniform() noexcept {
    constexpr double kStep = 0x1p-53;
    const PhiloxCounter words = philox4x32(counter_, key_);
    if (++counter_[0] == 0) ++counter_[1];
    const std::uint64_t bits = (static_cast<std::uint64_t>(words[0]) << 32 | words[1]) >> 11;
    return (static_cast<double>(bits) + 0.5) * kStep;
  }

  /// Standard normal, by Box and Muller.
  double normal() noexcept {
    const double length = std::sqrt(-2.0 * portable::log(uniform()));
    return length * portable::cos_of_turns(uniform());
  }

  /// Goes on as if `count` more had been drawn; normal() draws two.
  void skip(std::uint64_t count) noexcept {
    const std::uint64_t drawn = (static_cast<std::uint64_t>(counter_[1]) << 32 | counter_[0]) + count;
    counter_[0] = static_cast<std::uint32_t>(drawn);
    counter_[1] = static_cast<std::uint32_t>(drawn >> 32);
  }

  /// A whole number below `count`; draws one.
  std::size_t below(std::size_t count) noexcept {
    const auto drawn = static_cast<std::size_t>(uniform() * static_cast<double>(count));
    return drawn < count ? drawn : count - 1;
  }

 private:
  PhiloxKey key_;
  PhiloxCounter counter_;
};

}  // namespace palpate::identify
