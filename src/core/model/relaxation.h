#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "palpate/tissue.h"

namespace palpate::model {

/// What relaxation remembers from sample to sample: the part of each term's force that has not let go yet.
struct RelaxationState {
  std::array<double, kMostRelaxationTerms> kept{};  // q_i [N]
  double elastic = 0.0;                             // elastic force at the last sample [N]
};

/// Quasi-linear viscoelasticity on top of an elastic law: F(t) = integral of G(t - s) dF_e, with
/// G(t) = 1 - sum share_i (1 - e^(-t/time_i)) [Fung 1993, ch. 7], so F = (1 - sum share_i) F_e + sum share_i
/// q_i with dq_i/dt = dF_e/dt - q_i/time_i. Updated sample by sample, exact where F_e is linear between
/// samples.
///
/// It never gives back more than was put in: with v_i = F_e - q_i and D_e the law's inverse, the stored
/// energy integral_0^D F_e - v_i D + integral_0^v_i D_e >= 0 (Young's inequality) falls by (D - D_e(v_i))
/// (F_e - v_i)/time_i >= 0 of what the hand puts in, for every law that rises.
class Relaxation final {
 public:
  /// No relaxation: the force is the elastic one.
  Relaxation() = default;
  /// [setup] @param terms as in a checked tissue @param step [s] between samples
  /// @throws ParameterError when there are too many terms, a share or time is not finite and > 0, the shares
  /// sum to 1 or more, or the step is not finite and > 0.
  Relaxation(std::span<const RelaxationTerm> terms, double step);

  /// [rt] Terms; 0: the force is the elastic one.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

  /// [rt] The force [N] at the next sample, at which the elastic force is `elastic` [N]. Below 0 where an
  /// elastic tissue that sticks would hold the tool back; a contact that cannot pull counts 0 there.
  [[nodiscard]] double next(RelaxationState& state, double elastic) const noexcept;

  /// [rt] Makes a memory that `before` kept one of these terms: it goes on, and a term that is new has let
  /// nothing go yet. Without terms nothing is kept up, so when the first come all of the force counts as just
  /// put in.
  void take_over(RelaxationState& memory, const Relaxation& before) const noexcept {
    if (before.count_ == 0 || count_ == 0) memory = {};
    for (std::size_t i = before.count_; i < count_; ++i) memory.kept[i] = memory.elastic;
  }

  /// [setup] The time [s] from here on between samples, for measurements whose samples are not equally far
  /// apart. @param step >= 0
  void set_step(double step) noexcept;

 private:
  struct Term {
    double share = 0.0;
    double time = 0.0;  // s
    double keep = 0.0;  // e^(-step/time)
    double gain = 0.0;  // (1 - keep) time/step: of a ramp over one step
  };

  std::size_t count_ = 0;
  std::array<Term, kMostRelaxationTerms> terms_{};
  double lasting_ = 1.0;  // 1 - sum of the shares
};

}  // namespace palpate::model
