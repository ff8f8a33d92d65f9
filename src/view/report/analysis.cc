#include "view/report/analysis.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Core>
#include <fmt/core.h>
#include <unsupported/Eigen/FFT>

#include "core/base/normal_distribution.h"
#include "core/base/statistics.h"
#include "core/base/text.h"
#include "core/contact/contact.h"
#include "core/haptics/gate.h"
#include "palpate/error.h"
#include "palpate/touch_noise.h"
#include "palpate/units.h"
#include "view/report/page.h"

namespace palpate::report {
namespace {

bool touching(const haptics::TickRow& row) {
  return row.phase != static_cast<std::uint32_t>(contact::Phase::kApproach);
}

double norm(const std::array<double, 3>& v) { return std::hypot(v[0], v[1], v[2]); }

bool inserted(const haptics::TickRow& row) {
  return row.phase == static_cast<std::uint32_t>(contact::Phase::kInsert);
}

/// How far the tool is in the tissue [m]: its depth, or the way of a needle's tip.
double reached(const haptics::TickRow& row) { return inserted(row) ? -row.distance : row.depth; }

KeyTicks find_key_ticks(const std::vector<haptics::TickRow>& rows, model::Direction direction) {
  KeyTicks key_ticks;
  key_ticks.after = rows.size() - 1;
  std::size_t nearest = 0;
  bool deep = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].distance < rows[nearest].distance) nearest = i;
    if (!key_ticks.contact && touching(rows[i])) {
      key_ticks.contact = true;
      key_ticks.touch = i;
    }
    if ((in_contact(rows[i], direction) || inserted(rows[i])) &&
        (!deep || reached(rows[i]) > reached(rows[key_ticks.deepest]))) {
      deep = true;
      key_ticks.deepest = i;
    }
  }
  if (!key_ticks.contact) {
    key_ticks.touch = nearest;
  } else {
    key_ticks.rest = key_ticks.touch / 2;
  }
  if (!deep) key_ticks.deepest = key_ticks.touch;
  return key_ticks;
}

LawDeparture departure(const std::vector<haptics::TickRow>& rows, const record::Recording& recording,
                       model::Direction direction) {
  LawOverTime law(recording, direction, rows.empty() ? 0 : rows.front().hand);
  std::vector<double> apart;
  double peak = 0.0;
  for (const haptics::TickRow& row : rows) {
    const double wanted = law.force_at(row);
    if (!in_contact(row, direction)) continue;
    apart.push_back(std::abs(normal_force(row) - wanted));
    peak = std::max(peak, wanted);
  }
  return {apart.size(), quantile(apart, 0.5), quantile(apart, 0.95), peak};
}

/// First tick after a change of the noise.
std::uint64_t first_noise_change(const record::Recording& recording) {
  for (const haptics::ParameterUpdate& change : recording.changes) {
    if ((change.what & haptics::kNoiseChanged) != 0) return change.tick;
  }
  return std::numeric_limits<std::uint64_t>::max();
}

/// Collects the noise of the rows before its first change, because afterwards a crossfade changes its gain
/// gradually.
void collect_noise(HandAnalysis& analysis, const record::Recording& recording) {
  const scene::Scene& scene = recording.scene;
  if (!scene.noise.enabled) return;
  const noise::TouchNoise source(scene.noise, scene.rate_Hz);
  analysis.contact_sigma = source.sigma(0.0);
  const std::uint64_t end = first_noise_change(recording);
  const haptics::TickRow* previous = nullptr;
  for (const haptics::TickRow& row : analysis.rows) {
    if (row.tick >= end) break;
    const bool fresh =
        previous == nullptr || source.sample_number(row.tick) != source.sample_number(previous->tick);
    previous = &row;
    if (!fresh) continue;
    const double sigma = source.sigma(touching(row) ? 0.0 : row.distance);
    if (!(sigma > 0.0)) continue;
    analysis.unit_noise.push_back(row.noise_force / sigma);
    if (touching(row)) analysis.contact_noise.push_back(row.noise_force);
  }
  analysis.noise_check = check_standard_normal(analysis.unit_noise);
}

HandAnalysis analyse_hand(const record::Recording& recording, std::uint32_t hand,
                          model::Direction direction) {
  HandAnalysis result;
  result.hand = hand;
  for (const haptics::TickRow& row : recording.rows) {
    if (row.hand == hand) result.rows.push_back(row);
  }
  result.key_ticks = find_key_ticks(result.rows, direction);
  const haptics::TickRow* previous = nullptr;
  for (const haptics::TickRow& row : result.rows) {
    if (touching(row)) result.peak_depth = std::max(result.peak_depth, reached(row));
    result.peak_tissue_force = std::max(result.peak_tissue_force, row.tissue_force);
    result.peak_device_force = std::max(result.peak_device_force, norm(row.force));
    if (previous != nullptr) {
      const std::array<double, 3> step{row.force[0] - previous->force[0], row.force[1] - previous->force[1],
                                       row.force[2] - previous->force[2]};
      result.largest_step = std::max(result.largest_step, norm(step));
    }
    previous = &row;
  }
  result.law = departure(result.rows, recording, direction);
  collect_noise(result, recording);
  return result;
}

/// Prefers the loop's own counts, which exist for offline runs too and include lost rows. Recordings that
/// were cut off or lack the counts use the rows.
TimeAnalysis time_analysis(const record::TimeHistogram& counted, const record::TimeStatistics& figures,
                           std::vector<std::int64_t> of_rows) {
  if (!counted.empty()) {
    std::uint64_t number = 0;
    for (const haptics::Histogram::Bucket& bucket : counted) number += bucket.count;
    return {{number, figures.p50_ns, figures.p99_ns, figures.p999_ns, figures.max_ns}, counted};
  }
  TimeAnalysis analysis;
  haptics::Histogram histogram;
  for (const std::int64_t value : of_rows) histogram.add(value);
  analysis.counts = histogram.buckets();
  analysis.figures = percentiles(std::move(of_rows));
  return analysis;
}

std::string moment(const haptics::TickRow& row) {
  return fmt::format("tick {} ({} s)", row.tick, fixed(row.time, 3));
}

/// @param times multiplicity of each value; empty: 1 each
void count_into(Bins& bins, std::span<const double> values, std::span<const std::uint64_t> times = {}) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    if (!(value >= bins.edges.front() && value <= bins.edges.back())) continue;
    const auto above = std::upper_bound(bins.edges.begin(), bins.edges.end(), value);
    const auto index = static_cast<std::size_t>(above - bins.edges.begin());
    bins.counts[std::min(index, bins.counts.size()) - 1] += times.empty() ? 1 : times[i];
  }
}

std::string noise_text(const haptics::LiveNoise& noise) {
  if (!noise.enabled) return "touch noise off";
  return fmt::format("touch noise on, K {} N m, d\u2080 {} mm", shortest(noise.gain),
                     shortest(noise.threshold / kMillimetre));
}

std::string tissue_text(const model::TissueParameters& tissue) {
  std::string text =
      fmt::format("tissue {}, {}: k1 {} N/m, beta {}, q {}", tissue.name, model::to_string(tissue.law),
                  shortest(tissue.k1), shortest(tissue.beta), shortest(tissue.q));
  for (const model::RelaxationTerm& term : tissue.relaxation) {
    text += fmt::format(", relaxing by {} in {} s", shortest(term.g), shortest(term.tau));
  }
  return text;
}

/// The tissue as the tool of a hand meets it.
model::TissueParameters met_tissue(const scene::Scene& scene, const model::TissueParameters& tissue,
                                   std::size_t hand) {
  if (tissue.size_exponent == 0.0) return tissue;
  return model::for_tool(tissue, contact::tip_radius_of(scene.tools.at(hand)));
}

}  // namespace

LawOverTime::LawOverTime(const record::Recording& recording, model::Direction direction, std::size_t hand)
    : recording_(recording),
      direction_(direction),
      hand_(hand),
      period_(1.0 / recording.scene.rate_Hz),
      law_(law_of(recording.scene, direction, hand)),
      relaxation_(recording.scene.tissue.relaxation, period_) {}

void LawOverTime::change_to(const model::TissueParameters& tissue) {
  const model::Relaxation before = relaxation_;
  law_ = model::SpringLaw(met_tissue(recording_.scene, tissue, hand_), direction_, period_);
  relaxation_ = model::Relaxation(tissue.relaxation, period_);
  relaxation_.convert_history(memory_, before);
}

double LawOverTime::force_at(const haptics::TickRow& row) {
  const std::vector<haptics::ParameterUpdate>& changes = recording_.changes;
  for (; next_change_ < changes.size() && changes[next_change_].tick <= row.tick; ++next_change_) {
    const haptics::ParameterUpdate& change = changes[next_change_];
    if ((change.what & haptics::kTissueChanged) != 0) change_to(tissue_of(change));
  }
  if (!in_contact(row, direction_)) {
    memory_ = {};
    return 0.0;
  }
  return relaxation_.next(memory_, law_.force_at(row.depth).force);
}

namespace {

std::string change_text(const haptics::ParameterUpdate& change) {
  if ((change.what & haptics::kTissueChanged) != 0) return tissue_text(tissue_of(change));
  if ((change.what & haptics::kNoiseChanged) != 0) return noise_text(change.noise);
  if ((change.what & haptics::kStimulusChanged) != 0) {
    return fmt::format("commanded force {} N within {} ms", shortest(change.stimulus.force),
                       brief(1e3 * change.stimulus.ramp, 3));
  }
  const haptics::LiveInclusion& inclusion = change.inclusion;
  return fmt::format("inclusion {} at {} with stiffness ratio {}", inclusion.index + 1,
                     point_mm({inclusion.centre_S[0], inclusion.centre_S[1], inclusion.centre_S[2]}),
                     brief(inclusion.ratio, 3));
}

}  // namespace

model::SpringLaw law_of(const scene::Scene& scene, model::Direction direction, std::size_t hand) {
  return {met_tissue(scene, scene.tissue, hand), direction, 1.0 / scene.rate_Hz};
}

bool in_contact(const haptics::TickRow& row, model::Direction direction) {
  const contact::Phase phase =
      direction == model::Direction::kPull ? contact::Phase::kPull : contact::Phase::kPress;
  return row.phase == static_cast<std::uint32_t>(phase);
}

Analysis analyse(const record::Recording& recording) {
  if (recording.rows.empty()) throw InputError("report: the recording has no tick");
  Analysis analysis;
  analysis.direction =
      recording.scene.task == scene::Task::kPull ? model::Direction::kPull : model::Direction::kPress;
  std::uint32_t hands = 0;
  std::vector<std::int64_t> tick_time;
  std::vector<std::int64_t> lateness;
  const auto period_ns = static_cast<std::int64_t>(1e9 / recording.scene.rate_Hz);
  std::uint64_t late_rows = 0;
  for (const haptics::TickRow& row : recording.rows) {
    hands = std::max(hands, row.hand + 1);
    if (row.hand != 0) continue;
    tick_time.push_back(row.tick_ns);
    lateness.push_back(row.late_ns);
    if (row.late_ns >= period_ns) ++late_rows;
  }
  analysis.ticks = tick_time.size();
  analysis.missed = recording.facts.complete ? recording.facts.missed_deadlines : late_rows;
  const record::RunFacts& facts = recording.facts;
  analysis.tick_time = time_analysis(facts.tick_histogram, facts.tick_time, std::move(tick_time));
  analysis.lateness = time_analysis(facts.late_histogram, facts.lateness, std::move(lateness));
  for (std::uint32_t hand = 0; hand < hands; ++hand) {
    analysis.hands.push_back(analyse_hand(recording, hand, analysis.direction));
  }
  return analysis;
}

std::vector<std::string> faults_text(const std::vector<haptics::TickRow>& rows) {
  std::vector<std::string> texts;
  std::uint32_t latched = 0;
  for (const haptics::TickRow& row : rows) {
    const bool reset = (row.events & haptics::kResetFault) != 0;
    if (row.fault == latched && (row.fault == 0 || !reset)) continue;
    if (latched != 0) texts.back() += ", until it was reset at " + moment(row);
    latched = row.fault;
    if (latched == 0) continue;
    const auto fault = static_cast<haptics::Fault>(latched);
    texts.push_back(fmt::format("fault at {}: {} ({}); zero force from there on", moment(row),
                                haptics::describe(fault), haptics::name_of(fault)));
  }
  return texts;
}

std::vector<std::string> status_text(const std::vector<haptics::TickRow>& rows) {
  static constexpr std::array<std::pair<std::uint32_t, const char*>, 12> kStatusTexts{{
      {contact::kStartedInside, "a part of the tool was inside at the start and gave no force until outside"},
      {contact::kContactsFull, "more than four contacts wanted on one part"},
      {contact::kGripReleased, "the grip let go, past its limit"},
      {contact::kJump, "the tool moved faster than any hand; its contacts were reset"},
      {contact::kExtrapolated,
       "deeper than the tissue's max_depth_mm: past it the force went on by its tangent"},
      {contact::kAtHub, "the needle was in up to its hub, which pushed the tissue"},
      {haptics::kForceClamped, "the force was clamped at max_force_N"},
      {haptics::kForceSlewed, "the force's change was limited by max_slew_N_per_ms"},
      {haptics::kTorqueClamped, "the torque was clamped at max_torque_N_m"},
      {haptics::kTorqueSlewed, "the torque's change was limited by max_slew_N_m_per_ms"},
      {haptics::kDutyHigh, "the RMS force over 10 s was more than the device gives without end"},
      {haptics::kDutyLimited,
       "the force was lowered: its RMS over 60 s reached what the device gives without end, or the device's "
       "motors were warm"},
  }};
  std::vector<std::string> texts;
  for (const auto& [bit, text] : kStatusTexts) {
    const std::uint32_t mask = bit;
    const auto ticks = std::count_if(
        rows.begin(), rows.end(), [mask](const haptics::TickRow& row) { return (row.status & mask) != 0; });
    if (ticks > 0) texts.push_back(fmt::format("{} ({} ticks)", text, ticks));
  }
  const auto faults =
      std::count_if(rows.begin(), rows.end(), [](const haptics::TickRow& row) { return row.fault != 0; });
  if (faults > 0) texts.push_back(fmt::format("a fault was latched ({} ticks)", faults));
  return texts;
}

Percentiles percentiles(std::vector<std::int64_t> values) {
  Percentiles result;
  result.count = values.size();
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  result.p50 = values[quantile_index(0.5, values.size())];
  result.p99 = values[quantile_index(0.99, values.size())];
  result.p999 = values[quantile_index(0.999, values.size())];
  result.max = values.back();
  return result;
}

Bins bin_linear(std::span<const double> values, double low, double high, int number) {
  if (!(low < high) || number <= 0) throw InputError("histogram: want low < high and at least one bin");
  Bins bins;
  bins.counts.assign(static_cast<std::size_t>(number), 0);
  for (int i = 0; i <= number; ++i) bins.edges.push_back(low + (high - low) * i / number);
  count_into(bins, values);
  return bins;
}

Bins bin_logarithmic(std::span<const double> values, int per_decade, std::span<const std::uint64_t> times) {
  if (per_decade <= 0) throw InputError("histogram: want at least one bin a decade");
  if (!times.empty() && times.size() != values.size()) {
    throw InputError(
        fmt::format("histogram: want one count a value, {} for {}", times.size(), values.size()));
  }
  double low = 0.0;
  double high = 0.0;
  for (const double value : values) {
    if (!(value > 0.0) || !std::isfinite(value)) continue;
    low = low > 0.0 ? std::min(low, value) : value;
    high = std::max(high, value);
  }
  Bins bins;
  if (!(low > 0.0)) return bins;
  const int first = static_cast<int>(std::floor(std::log10(low)));
  const int last = std::max(first + 1, static_cast<int>(std::ceil(std::log10(high))));
  bins.counts.assign(static_cast<std::size_t>(last - first) * static_cast<std::size_t>(per_decade), 0);
  for (int i = 0; i <= (last - first) * per_decade; ++i)
    bins.edges.push_back(std::pow(10.0, first + static_cast<double>(i) / per_decade));
  count_into(bins, values, times);
  return bins;
}

Spectrum welch(std::span<const double> samples, double rate, std::size_t segment) {
  if (!std::has_single_bit(segment) || segment < 4) {
    throw InputError(fmt::format("spectrum: segments of {} samples, want a power of two >= 4", segment));
  }
  Spectrum result;
  if (samples.size() < segment) return result;
  std::vector<double> window(segment);
  double power = 0.0;
  for (std::size_t i = 0; i < segment; ++i) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(segment);
    window[i] = 0.5 - 0.5 * std::cos(phase);
    power += window[i] * window[i];
  }
  const std::size_t half = segment / 2;
  result.density.assign(half + 1, 0.0);
  Eigen::FFT<double> fft;
  std::vector<double> values(segment);
  std::vector<std::complex<double>> frequencies;
  for (std::size_t start = 0; start + segment <= samples.size(); start += half) {
    for (std::size_t i = 0; i < segment; ++i) values[i] = samples[start + i] * window[i];
    fft.fwd(frequencies, values);
    for (std::size_t i = 0; i <= half; ++i) result.density[i] += std::norm(frequencies[i]);
    ++result.segments;
  }
  for (std::size_t i = 0; i <= half; ++i) {
    const double sides = i == 0 || i == half ? 1.0 : 2.0;
    result.density[i] *= sides / (rate * power * static_cast<double>(result.segments));
    result.frequency.push_back(rate * static_cast<double>(i) / static_cast<double>(segment));
  }
  return result;
}

NormalCheck check_standard_normal(std::vector<double> values) {
  NormalCheck result;
  result.count = values.size();
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  const auto count = static_cast<double>(values.size());
  result.mean = mean(values);
  result.standard_deviation = standard_deviation(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double expected = normal_cdf(values[i]);
    const double below = static_cast<double>(i) / count;
    const double up_to = static_cast<double>(i + 1) / count;
    result.ks_distance = std::max({result.ks_distance, expected - below, up_to - expected});
  }
  return result;
}

std::vector<std::string> changes_text(const record::Recording& recording) {
  constexpr std::size_t kMaxListed = 20;
  std::vector<std::string> texts;
  for (const haptics::ParameterUpdate& change : recording.changes) {
    if (texts.size() == kMaxListed) {
      texts.push_back(fmt::format("and {} more changes while it ran", recording.changes.size() - kMaxListed));
      break;
    }
    const double time = static_cast<double>(change.tick) / recording.scene.rate_Hz;
    texts.push_back(fmt::format("changed while it ran, from tick {} ({} s) on: {}", change.tick,
                                fixed(time, 3), change_text(change)));
  }
  return texts;
}

}  // namespace palpate::report
