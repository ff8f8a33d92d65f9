#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "run/tasks/communicator.h"

#include "study/session/study.h"

namespace palpate::study {

struct PowerRequest {
  std::optional<double> jnd_ratio;       // ln JND with the condition less that with the reference, as a ratio
  std::optional<double> internal_noise;  // of the observer sr, in units of its threshold
  std::vector<int> participants = {12, 16, 24};
  int groups = 200;
};

/// One effect and number of participants.
struct PowerRow {
  std::string effect;  // "jnd=0.85" or "sr=0.4"
  std::string analysis;
  int participants = 0;
  double power = 0.0;  // share of the groups whose analysis finds the effect
  double error = 0.0;  // standard error of the power, of the simulation
  double mean_effect = 0.0;
  double width = 0.0;  // mean width of the 95 % interval: of ln of the ratio, or of the rise of d'
};

struct Power {
  int groups = 0;
  std::vector<PowerRow> rows;
  double hours_per_person = 0.0;  // planned, of all sessions
};

/// [setup] Simulates the primary analysis of groups, and that of the inverted U with the calibration before
/// it: thresholds are measured with their errors. jnd: people with just noticeable differences of 8 to 22 %,
/// lapse rates of 0 to 4 % and effects that differ between people with a standard deviation of 10 %. sr: the
/// observer of make_person() with this internal noise. Without any effect requested: 0.85 and 0.4, as far as
/// the study has the analysis.
/// @param ranks null: this process only. The result does not depend on their number; all must call
/// @param progress receives the finished share; may be empty @throws InputError for values out of range or an
/// effect that the study does not analyse
[[nodiscard]] Power simulate_power(const Study& study, PowerRequest request, tasks::Communicator* ranks,
                                   const std::function<void(double)>& progress);

/// [setup] Table of a power simulation, with its assumptions.
[[nodiscard]] std::string power_text(const Study& study, const Power& power);
[[nodiscard]] std::string power_json(const Study& study, const Power& power);

}  // namespace palpate::study
