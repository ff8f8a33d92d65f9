#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/model/relaxation.h"
#include "palpate/recording.h"
#include "palpate/spring_law.h"
#include "run/palpation/felt_map.h"

namespace palpate::report {

/// Percentiles of a set of times [ns]; all 0 when empty.
struct Percentiles {
  std::size_t count = 0;
  std::int64_t p50 = 0;
  std::int64_t p99 = 0;
  std::int64_t p999 = 0;
  std::int64_t max = 0;
};

/// [setup] Exact percentiles: the smallest value that at least that fraction of all values does not exceed.
[[nodiscard]] Percentiles percentiles(std::vector<std::int64_t> values);

/// Histogram: counts[i] values with edges[i] <= value < edges[i+1]; the last bin includes its upper edge.
struct Bins {
  std::vector<double> edges;  // one more than counts
  std::vector<std::size_t> counts;
};

/// [setup] `number` bins of equal width over [low, high]; values outside are ignored. @throws InputError
/// unless low < high and number > 0.
[[nodiscard]] Bins bin_linear(std::span<const double> values, double low, double high, int number);

/// [setup] Logarithmic bins, `per_decade` per factor of ten, from the decade of the smallest value to that of
/// the largest. Values <= 0 are ignored. Empty when there is no positive value.
/// @param times multiplicity of each value; empty: 1 each
/// @throws InputError unless per_decade > 0, and when the number of multiplicities differs from that of the
/// values.
[[nodiscard]] Bins bin_logarithmic(std::span<const double> values, int per_decade,
                                   std::span<const std::uint64_t> times = {});

/// One-sided power spectral density.
struct Spectrum {
  std::vector<double> frequency;  // Hz
  std::vector<double> density;    // unit of the samples squared, per Hz
  std::size_t segments = 0;       // number of segments averaged
};

/// [setup] Welch's method: Hann windows of `segment` samples with an overlap of one half. White noise of
/// variance v has density 2 v / rate. Empty when there are fewer samples than one segment.
/// @param rate sampling rate [Hz] @throws InputError unless `segment` is a power of two and at least 4.
[[nodiscard]] Spectrum welch(std::span<const double> samples, double rate, std::size_t segment);

/// Comparison of a sample with the standard normal distribution.
struct NormalCheck {
  std::size_t count = 0;
  double mean = 0.0;
  double standard_deviation = 0.0;
  double ks_distance = 0.0;  // Kolmogorov-Smirnov statistic: largest distance between the distribution
                             // functions
};

/// [setup] Compares with mean 0 and standard deviation 1; all 0 when empty.
[[nodiscard]] NormalCheck check_standard_normal(std::vector<double> values);

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
  double median = 0.0;  // N, of force minus law
  double p95 = 0.0;     // N
  double peak = 0.0;    // N, largest force of the law over these rows
};

/// Results of one hand of a recording.
struct HandAnalysis {
  std::uint32_t hand = 0;
  std::vector<haptics::TickRow> rows;
  KeyTicks key_ticks;
  double peak_depth = 0.0;         // m, press or pull, or the way of a needle's tip
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

/// [setup] Elastic law at the start of the run, before relaxation and parameter updates, as the tool of this
/// hand meets it.
[[nodiscard]] model::SpringLaw law_of(const scene::Scene& scene, model::Direction direction,
                                      std::size_t hand);

using palpation::normal_force;

/// [setup] Whether the row is in contact in that direction.
[[nodiscard]] bool in_contact(const haptics::TickRow& row, model::Direction direction);

/// [setup] Describes each fault in a hand's rows: when and why it was latched, when it was reset.
[[nodiscard]] std::vector<std::string> faults_text(const std::vector<haptics::TickRow>& rows);

/// [setup] Describes the status bits and faults of a run, with the number of ticks of each.
[[nodiscard]] std::vector<std::string> status_text(const std::vector<haptics::TickRow>& rows);

/// Expected force of a single contact at each tick of a recording: the law valid at that tick, with
/// relaxation since the contact began.
class LawOverTime final {
 public:
  /// [setup] @param recording must outlive this object @throws ParameterError for an invalid recorded tissue
  LawOverTime(const record::Recording& recording, model::Direction direction, std::size_t hand);

  /// [setup] Expected force [N] of a row; 0 out of contact. Call it once per row of one hand, in order.
  double force_at(const haptics::TickRow& row);

 private:
  void change_to(const model::TissueParameters& tissue);

  const record::Recording& recording_;
  model::Direction direction_;
  std::size_t hand_;
  double period_;  // s
  model::SpringLaw law_;
  model::Relaxation relaxation_;
  model::RelaxationState memory_;
  std::size_t next_change_ = 0;
};

/// [setup] Describes each parameter update of tissue or noise in a recording.
[[nodiscard]] std::vector<std::string> changes_text(const record::Recording& recording);

}  // namespace palpate::report
