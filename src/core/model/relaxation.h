#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "palpate/tissue.h"

namespace palpate::model {

/// The history variables of relaxation, carried from sample to sample.
struct RelaxationState {
  std::array<double, kMaxRelaxationTerms> history{};  // q_i, unrelaxed force of each Prony term [N]
  double elastic = 0.0;                               // elastic force F_e at the last sample [N]
};

/// Quasi-linear viscoelasticity [Fung 1993, ch. 7]: F(t) = integral of G(t - s) dF_e with the Prony series
/// G(t) = 1 - sum g_i (1 - e^(-t/tau_i)). So F = (1 - sum g_i) F_e + sum g_i q_i with dq_i/dt = dF_e/dt -
/// q_i/tau_i. Updated sample by sample; exact where F_e is linear between samples.
///
/// It is passive for every rising law. With v_i = F_e - q_i and D_e the inverse of the law, the stored energy
/// of term i is integral_0^D F_e - v_i D + integral_0^v_i D_e >= 0 (Young's inequality), and the dissipated
/// power is (D - D_e(v_i)) (F_e - v_i)/tau_i >= 0.
class Relaxation final {
 public:
  /// No relaxation: the force is the elastic force.
  Relaxation() = default;
  /// [setup] @param terms of a checked tissue @param step between samples [s]
  /// @throws ParameterError when there are too many terms, a share or time is not finite and > 0, the shares
  /// sum to 1 or more, or the step is not finite and > 0.
  Relaxation(std::span<const RelaxationTerm> terms, double step);

  /// [rt] Number of Prony terms; 0: the force is the elastic force.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

  /// [rt] The force [N] at the next sample, where the elastic force is `elastic` [N]. It is negative where an
  /// adhering tissue would pull the tool back; a contact that cannot pull uses 0 then.
  [[nodiscard]] double next(RelaxationState& state, double elastic) const noexcept;

  /// The force at the next sample over the elastic force there.
  struct Line {
    double at_zero = 0.0;  // [N]
    double slope = 1.0;    // > 0
  };
  /// [rt] next() gives at_zero + slope x elastic; nothing changes.
  [[nodiscard]] Line next_line(const RelaxationState& state) const noexcept;

  /// [rt] Share g_i of term i.
  [[nodiscard]] double share(std::size_t i) const noexcept { return terms_[i].g; }

  /// [rt] v_i = F_e - q_i [N] of term i after the next sample, where the elastic force is `elastic` [N].
  [[nodiscard]] double relaxed_after(const RelaxationState& state, std::size_t i,
                                     double elastic) const noexcept {
    const Term& term = terms_[i];
    return elastic - (term.keep * state.history[i] + term.gain * (elastic - state.elastic));
  }

  /// [rt] Converts the history variables of `before` to these terms. Existing terms continue; a new term
  /// begins unrelaxed. Without terms no history is kept, so the first terms treat the present force as just
  /// applied.
  void convert_history(RelaxationState& memory, const Relaxation& before) const noexcept {
    if (before.count_ == 0 || count_ == 0) memory = {};
    for (std::size_t i = before.count_; i < count_; ++i) memory.history[i] = memory.elastic;
  }

  /// [setup] Sets the time between samples [s] from here on, for measurements with unequal sampling.
  /// @param step >= 0
  void set_step(double step) noexcept;

 private:
  struct Term {
    double g = 0.0;
    double tau = 0.0;   // tau_i [s]
    double keep = 0.0;  // e^(-step/tau_i)
    double gain = 0.0;  // (1 - keep) tau_i/step: of a ramp over one step
  };

  std::size_t count_ = 0;
  std::array<Term, kMaxRelaxationTerms> terms_{};
  double lasting_ = 1.0;  // 1 - sum of the g_i
};

}  // namespace palpate::model
