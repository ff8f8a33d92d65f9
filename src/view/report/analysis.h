#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "palpate/recording.h"
#include "palpate/spring_law.h"
#include "view/report/statistics.h"

namespace palpate::report {

/// The moments of one hand's run, as indices into its rows.
struct Moments {
  bool contact = false;     // there was one
  std::size_t rest = 0;     // half-way to the first contact (without contact: the first row)
  std::size_t touch = 0;    // first row in contact (without contact: the nearest)
  std::size_t deepest = 0;  // without contact: the nearest
  std::size_t after = 0;    // last row
};

/// How far the normal force in contact is from the law of one contact.
struct LawDeparture {
  std::size_t rows = 0;
  double median = 0.0;  // N, of |force - law|
  double p95 = 0.0;     // N
  double peak = 0.0;    // N, largest force of the law in these rows
};

/// One hand of one recording, ready for figures and tables.
struct HandAnalysis {
  std::uint32_t hand = 0;
  std::vector<haptics::TickRow> rows;
  Moments moments;
  double peak_depth = 0.0;         // m, press or pull
  double peak_tissue_force = 0.0;  // N
  double peak_device_force = 0.0;  // N, noise included
  double largest_step = 0.0;       // N, of the force vector to the device between ticks
  LawDeparture law;
  // Touch noise, one entry a sample of its own clock:
  std::vector<double> unit_noise;     // divided by sigma
  std::vector<double> contact_noise;  // N, while in contact
  double contact_sigma = 0.0;         // N, what it should be: K / d0
  NormalCheck noise_check;            // of unit_noise
};

/// A measured time: its figures, and how often which value was met.
struct TimeAnalysis {
  Percentiles figures;           // ns
  record::TimeHistogram counts;  // ns
};

/// One recording, ready for figures and tables.
struct Analysis {
  std::vector<HandAnalysis> hands;
  TimeAnalysis tick_time;  // a tick of all hands
  TimeAnalysis lateness;
  std::uint64_t missed = 0;
  std::uint64_t ticks = 0;
  model::Direction direction = model::Direction::kPress;  // of the scene's task
};

/// [setup] Works a recording out. @throws InputError when it has no row.
[[nodiscard]] Analysis analyse(const record::Recording& recording);

/// [setup] The law that the run's contacts followed at its start, before they relaxed.
[[nodiscard]] model::SpringLaw law_of(const scene::Setup& setup, model::Direction direction);

/// [setup] Normal part of the tissue force of a row [N]: what the law gives, without friction.
[[nodiscard]] double normal_force(const haptics::TickRow& row);

/// [setup] Whether a row's phase is contact in that direction.
[[nodiscard]] bool in_contact(const haptics::TickRow& row, model::Direction direction);

/// [setup] Each fault that a hand's rows hold, in words: when it was latched, why, when it was reset.
[[nodiscard]] std::vector<std::string> faults_in_words(const std::vector<haptics::TickRow>& rows);

/// [setup] What the status bits and faults of a run say, in words, with the number of ticks of each.
[[nodiscard]] std::vector<std::string> status_in_words(const std::vector<haptics::TickRow>& rows);

}  // namespace palpate::report
