#include "view/report/analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "core/base/statistics.h"
#include "core/contact/contact.h"
#include "core/haptics/gate.h"
#include "palpate/error.h"
#include "palpate/touch_noise.h"
#include "view/report/law_over_time.h"
#include "view/report/text_format.h"

namespace palpate::report {
namespace {

bool touching(const haptics::TickRow& row) {
  return row.phase != static_cast<std::uint32_t>(contact::Phase::kApproach);
}

double norm(const std::array<double, 3>& v) { return std::hypot(v[0], v[1], v[2]); }

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
    if (in_contact(rows[i], direction) && (!deep || rows[i].depth > rows[key_ticks.deepest].depth)) {
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
  LawOverTime law(recording, direction);
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
  const scene::Scene& setup = recording.setup;
  if (!setup.noise.enabled) return;
  const noise::TouchNoise source(setup.noise, setup.rate_Hz);
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
    if (touching(row)) result.peak_depth = std::max(result.peak_depth, row.depth);
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

}  // namespace

model::SpringLaw law_of(const scene::Scene& setup, model::Direction direction) {
  return {setup.tissue, direction, 1.0 / setup.rate_Hz};
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
      recording.setup.task == scene::Task::kPull ? model::Direction::kPull : model::Direction::kPress;
  std::uint32_t hands = 0;
  std::vector<std::int64_t> tick_time;
  std::vector<std::int64_t> lateness;
  const auto period_ns = static_cast<std::int64_t>(1e9 / recording.setup.rate_Hz);
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
  std::vector<std::string> words;
  std::uint32_t latched = 0;
  for (const haptics::TickRow& row : rows) {
    const bool reset = (row.events & haptics::kResetFault) != 0;
    if (row.fault == latched && (row.fault == 0 || !reset)) continue;
    if (latched != 0) words.back() += ", until it was reset at " + moment(row);
    latched = row.fault;
    if (latched == 0) continue;
    const auto fault = static_cast<haptics::Fault>(latched);
    words.push_back(fmt::format("fault at {}: {} ({}); zero force from there on", moment(row),
                                haptics::describe(fault), haptics::name_of(fault)));
  }
  return words;
}

std::vector<std::string> status_text(const std::vector<haptics::TickRow>& rows) {
  static constexpr std::array<std::pair<std::uint32_t, const char*>, 10> kWords{{
      {contact::kStartedInside, "a part of the tool was inside at the start and gave no force until outside"},
      {contact::kContactsFull, "more than four contacts wanted on one part"},
      {contact::kGripReleased, "the grip let go, past its limit"},
      {contact::kJump, "the tool moved faster than any hand; its contacts were reset"},
      {haptics::kForceClamped, "the force was clamped at max_force_N"},
      {haptics::kForceSlewed, "the force's change was limited by max_slew_N_per_ms"},
      {haptics::kTorqueClamped, "the torque was clamped at max_torque_N_m"},
      {haptics::kTorqueSlewed, "the torque's change was limited by max_slew_N_m_per_ms"},
      {haptics::kDutyHigh, "the RMS force over 10 s was more than the device gives without end"},
      {haptics::kDutyLimited,
       "the force was lowered: its RMS over 60 s reached what the device gives without end, or the device's "
       "motors "
       "were warm"},
  }};
  std::vector<std::string> words;
  for (const auto& [bit, text] : kWords) {
    const std::uint32_t mask = bit;
    const auto ticks = std::count_if(
        rows.begin(), rows.end(), [mask](const haptics::TickRow& row) { return (row.status & mask) != 0; });
    if (ticks > 0) words.push_back(fmt::format("{} ({} ticks)", text, ticks));
  }
  const auto faults =
      std::count_if(rows.begin(), rows.end(), [](const haptics::TickRow& row) { return row.fault != 0; });
  if (faults > 0) words.push_back(fmt::format("a fault was latched ({} ticks)", faults));
  return words;
}

}  // namespace palpate::report
