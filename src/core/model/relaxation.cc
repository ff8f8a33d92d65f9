#include "core/model/relaxation.h"

#include <cmath>

#include "core/base/portable_math.h"
#include "palpate/error.h"

namespace palpate::model {

Relaxation::Relaxation(std::span<const RelaxationTerm> terms, double step) {
  validate_relaxation(terms);
  if (!std::isfinite(step) || !(step > 0.0)) throw ParameterError("step_s", step, "finite and > 0");
  for (const RelaxationTerm& term : terms) {
    Term& made = terms_[count_];
    ++count_;
    made.g = term.g;
    made.tau = term.tau;
    lasting_ -= term.g;
  }
  set_step(step);
}

void Relaxation::set_step(double step) noexcept {
  for (std::size_t i = 0; i < count_; ++i) {
    Term& term = terms_[i];
    const double steps = step / term.tau;
    const double lost = -portable::expm1(-steps);
    term.keep = 1.0 - lost;
    term.gain = steps > 0.0 ? lost / steps : 1.0;  // a time constant too long for the quotient does not relax
  }
}

Relaxation::Line Relaxation::next_line(const RelaxationState& state) const noexcept {
  Line line{0.0, lasting_};
  for (std::size_t i = 0; i < count_; ++i) {
    const Term& term = terms_[i];
    line.at_zero += term.g * (term.keep * state.history[i] - term.gain * state.elastic);
    line.slope += term.g * term.gain;
  }
  return line;
}

double Relaxation::next(RelaxationState& state, double elastic) const noexcept {
  const double rise = elastic - state.elastic;
  state.elastic = elastic;
  double force = lasting_ * elastic;
  for (std::size_t i = 0; i < count_; ++i) {
    const Term& term = terms_[i];
    state.history[i] = term.keep * state.history[i] + term.gain * rise;
    force += term.g * state.history[i];
  }
  return force;
}

}  // namespace palpate::model
