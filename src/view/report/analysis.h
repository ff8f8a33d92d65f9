#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "palpate/spring_law.h"
#include "run/palpation/felt_map.h"
#include "view/report/statistics.h"

namespace palpate::report {

/// Key ticks of one hand's run, as indices of its rows.
struct KeyTicks {
  bool contact = false;     // whether the run has a contact
  std::size_t rest = 0;     // half-way to the first contact (without contact: the first row)
  std::size_t touch = 0;    // first row in contact (without contact: the row nearest to the organ)
  std::size_t deepest = 0;  // row of largest depth (without contact: the row nearest to the organ)
  std::size_t after = 0;    // last row
};

/// Deviation of the normal force in contact from the law for a single contact.
struct LawDeparture {
  std::size_t rows = 0;
  double median = 0.0;  // N, of
                        // force - law
                        //
  double p95 = 0.0;     // N
  double peak = 0.0;    // N, largest force of the law over these rows
};

/// Results of one hand of a recording.
struct HandAnalysis {
  std::uint32_t hand = 0;
  std::vector<haptics::TickRow> rows;
  KeyTicks key_ticks;
  double peak_depth = 0.0;         // m, press or pull
  double peak_tissue_force = 0.0;  // N
  double peak_device_force = 0.0;  // N, noise included
  double largest_step = 0.0;       // N, largest change of the commanded force vector between ticks
  LawDeparture law;
  // Touch noise, one entry per sample of the noise clock:
  std::vector<double> unit_noise;     // divided by sigma
  std::vector<double> contact_noise;  // N, while in contact
  double contact_sigma = 0.0;         // N, expected value K / d0
  NormalCheck noise_check;            // of unit_noise
};

/// Statistics and histogram of a measured time.
struct TimeAnalysis {
  Percentiles figures;           // ns
  record::TimeHistogram counts;  // ns
};

/// Results of one recording.
struct Analysis {
  std::vector<HandAnalysis> hands;
  TimeAnalysis tick_time;  // of a tick of all hands
  TimeAnalysis lateness;
  std::uint64_t missed = 0;
  std::uint64_t ticks = 0;
  model::Direction direction = model::Direction::kPress;  // of the scene's task
};

/// [setup] Computes the results of a recording. @throws InputError when it has no row.
[[nodiscard]] Analysis analyse(const record::Recording& recording);

/// [setup] Elastic law at the start of the run, before relaxation and parameter updates.
[[nodiscard]] model::SpringLaw law_of(const scene::Scene& setup, model::Direction direction);

using palpation::normal_force;

/// [setup] Whether the row is in contact in that direction.
[[nodiscard]] bool in_contact(const haptics::TickRow& row, model::Direction direction);

/// [setup] Describes each fault in a hand's rows: when and why it was latched, when it was reset.
[[nodiscard]] std::vector<std::string> faults_text(const std::vector<haptics::TickRow>& rows);

/// [setup] Describes the status bits and faults of a run, with the number of ticks of each.
[[nodiscard]] std::vector<std::string> status_text(const std::vector<haptics::TickRow>& rows);

}  // namespace palpate::report
