#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "study/psychophysics/psychophysics.h"
#include "study/session/course.h"
#include "study/session/study.h"

namespace palpate::study {

/// A simulated participant. Its own thresholds are drawn at random.
struct SimulatedPerson {
  std::string kind;  // a name of psychophysics::make_observer(), or "cue-user"
  psychophysics::Observer observer;
  double noise_threshold = 0.02;     // N, standard deviation that is detected in 75 % of the trials
  double force_unit = 0.05;          // N: the observer's threshold T of a force
  double inclusion_threshold = 0.0;  // log10 of ln ratio
  double ln_spread = 0.0;            // of ln(stiffness ratio), without noise
  double interval_bias = 0.0;        // toward the comparison, in ln ratio
  double lapse = 0.0;
  std::map<double, double> force_thresholds;  // with a noise, relative to none; computed when needed
};

/// [setup] A person of a simulated group. Just noticeable differences of stiffness lie between 8 and 22 %,
/// lapse rates between 0 and 4 %. @param kind as psychophysics::make_observer(), or cue-user, which answers
/// by the largest force @throws InputError for another kind
[[nodiscard]] SimulatedPerson make_person(const std::string& kind, std::uint64_t seed,
                                          std::uint32_t participant);

/// [setup] Fills in answer, response time and cues of a trial, by formulas instead of rendered force.
/// @param progress elapsed share of the session, 0..1
void answer_by_formula(const Study& study, SimulatedPerson& person, const Trial& trial, double progress,
                       std::uint64_t seed, std::uint32_t participant, TrialRecord& record);

}  // namespace palpate::study
