#include "app/summary.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <ostream>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "palpate/base/text.h"
#include "palpate/haptics/gate.h"

namespace palpate::app {
namespace {

constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint32_t kGateBits =
    haptics::kForceClamped | haptics::kForceSlewed | haptics::kTorqueClamped | haptics::kTorqueSlewed;

double norm(const std::array<double, 3>& v) noexcept {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

const char* phase_name(std::uint32_t phase) {
  switch (static_cast<contact::Phase>(phase)) {
    case contact::Phase::kPress:
      return "press";
    case contact::Phase::kPull:
      return "pull";
    case contact::Phase::kApproach:
      break;
  }
  return "approach";
}

double microseconds(std::int64_t ns) { return static_cast<double>(ns) / 1e3; }

nlohmann::ordered_json igtl_json(const std::optional<net::IgtlTally>& tally) {
  if (!tally) return nullptr;
  return {{"clients", tally->clients},
          {"refused", tally->refused},
          {"given_up", tally->given_up},
          {"frames", tally->frames},
          {"frames_left_out", tally->frames_left_out}};
}

nlohmann::ordered_json histogram_json(const haptics::Histogram& times) {
  return {{"p50", microseconds(times.percentile(0.5))},
          {"p99", microseconds(times.percentile(0.99))},
          {"p999", microseconds(times.percentile(0.999))},
          {"max", microseconds(times.max())}};
}

void print_times(std::ostream& out, const char* name, const haptics::Histogram& times) {
  out << "  " << std::left << std::setw(24) << name << std::right << std::fixed << std::setprecision(1);
  for (const double share : {0.5, 0.99, 0.999}) out << std::setw(10) << microseconds(times.percentile(share));
  out << std::setw(10) << microseconds(times.max()) << '\n' << std::defaultfloat;
}

void print_phases(std::ostream& out, const Highlights& seen, bool several_hands) {
  constexpr std::size_t kShown = 12;
  for (std::size_t i = 0; i < std::min(kShown, seen.phases.size()); ++i) {
    const PhaseSpan& span = seen.phases[i];
    out << "  ";
    if (several_hands) out << "hand " << span.hand << "  ";
    out << std::left << std::setw(10) << phase_name(span.phase) << std::right << std::fixed
        << std::setprecision(3) << span.from << " to " << span.to << " s\n"
        << std::defaultfloat;
  }
  const std::uint64_t more =
      seen.phases_left_out + (seen.phases.size() > kShown ? seen.phases.size() - kShown : 0);
  if (more > 0) out << "  and " << more << " more\n";
}

const char* pace_of(const RunAccount& run) {
  if (run.offline) return "offline";
  return run.loop.polled ? "in real time, polling the clock" : "in real time";
}

void print_timing(std::ostream& out, const RunAccount& run) {
  out << "Timing [us]                      p50       p99     p99.9       max\n";
  print_times(out, "computing a tick", run.loop.tick_time);
  if (run.offline) return;
  print_times(out, "a tick begins late by", run.loop.lateness);
  out << "  missed deadlines: " << run.loop.missed_deadlines << " of " << run.loop.ticks
      << ", longest gap between two ticks: " << std::fixed << std::setprecision(3)
      << microseconds(run.loop.longest_gap_ns) / 1e3 << " ms\n"
      << std::defaultfloat;
}

std::string moment(std::uint64_t tick, double rate_Hz) {
  return fmt::format("tick {} ({} s)", tick, shortest(static_cast<double>(tick) / rate_Hz));
}

/// "a fault was latched (stalled-loop) at tick 12 (0.012 s), hand 0: the loop stood still for 20 ms; zero
/// force from there on".
std::string fault_in_words(const RunAccount& run, const haptics::FaultSeen& seen) {
  const double rate = run.setup->rate_Hz;
  const bool reset = seen.reset_tick != haptics::FaultSeen::kNotReset;
  return fmt::format("a fault was latched ({}) at {}, hand {}: {}; zero force {}",
                     haptics::name_of(seen.fault), moment(seen.tick, rate), seen.hand,
                     haptics::words_of(seen.fault),
                     reset ? "until it was reset at " + moment(seen.reset_tick, rate) : "from there on");
}

nlohmann::ordered_json faults_json(const RunAccount& run) {
  nlohmann::ordered_json faults = nlohmann::ordered_json::array();
  for (const haptics::FaultSeen& seen : run.loop.faults) {
    nlohmann::ordered_json fault{{"tick", seen.tick},
                                 {"time_s", static_cast<double>(seen.tick) / run.setup->rate_Hz},
                                 {"hand", seen.hand},
                                 {"fault", haptics::name_of(seen.fault)},
                                 {"reset_tick", nullptr}};
    if (seen.reset_tick != haptics::FaultSeen::kNotReset) fault["reset_tick"] = seen.reset_tick;
    faults.push_back(fault);
  }
  return faults;
}

}  // namespace

RowWatch::RowWatch(haptics::TickSink* next, const scene::Setup& setup)
    : next_(next),
      period_(1.0 / setup.rate_Hz),
      last_contact_tick_(kNever),
      last_limited_tick_(kNever),
      open_span_(setup.tools.size(), -1),
      last_phase_(setup.tools.size(), -1) {
  highlights_.phases.reserve(Highlights::kMaxSpans);
}

void RowWatch::begin(std::int64_t started_unix_ns) noexcept {
  if (next_ != nullptr) next_->begin(started_unix_ns);
}

void RowWatch::put_change(const haptics::LiveChange& change) noexcept {
  ++highlights_.changes;
  if (next_ != nullptr) next_->put_change(change);
}

void RowWatch::put(const haptics::TickRow& row) noexcept {
  highlights_.peak_force = std::max(highlights_.peak_force, norm(row.force));
  highlights_.peak_tissue = std::max(highlights_.peak_tissue, row.tissue_force);
  if (row.depth > highlights_.peak_depth) {
    highlights_.peak_depth = row.depth;
    highlights_.deepest_tick = row.tick;
    highlights_.deepest_hand = row.hand;
  }
  if (row.phase != 0 && row.tick != last_contact_tick_) {
    ++highlights_.contact_ticks;
    last_contact_tick_ = row.tick;
  }
  if ((row.status & kGateBits) != 0 && row.tick != last_limited_tick_) {
    ++highlights_.limited_ticks;
    last_limited_tick_ = row.tick;
  }
  highlights_.status |= row.status;
  follow_phase(row);
  if (next_ != nullptr) next_->put(row);
}

void RowWatch::follow_phase(const haptics::TickRow& row) noexcept {
  if (last_phase_[row.hand] != static_cast<std::int64_t>(row.phase)) {
    last_phase_[row.hand] = static_cast<std::int64_t>(row.phase);
    open_span_[row.hand] = -1;
    if (highlights_.phases.size() < Highlights::kMaxSpans) {
      open_span_[row.hand] = static_cast<std::int64_t>(highlights_.phases.size());
      highlights_.phases.push_back({row.hand, row.phase, row.time, row.time});  // within what was reserved
    } else {
      ++highlights_.phases_left_out;
    }
  }
  const std::int64_t open = open_span_[row.hand];
  if (open >= 0) highlights_.phases[static_cast<std::size_t>(open)].to = row.time + period_;
}

std::vector<std::string> remarks(const RunAccount& run) {
  std::vector<std::string> all = run.setup->repairs;
  all.insert(all.end(), run.setup->remarks.begin(), run.setup->remarks.end());
  all.insert(all.end(), run.loop.remarks.begin(), run.loop.remarks.end());
  if (run.highlights.changes > 0) {
    all.emplace_back(fmt::format("tissue or noise was changed {}{} while the run went on",
                                 run.highlights.changes, run.highlights.changes == 1 ? " time" : " times"));
  }
  const std::uint32_t status = run.highlights.status;
  if ((status & contact::kStartedInside) != 0) {
    all.emplace_back(
        "a part of the tool was inside the organ at first: it gave no force until it had been outside");
  }
  if ((status & contact::kContactsFull) != 0) {
    all.emplace_back(
        fmt::format("a part wanted more than {} contacts at once: the further ones were left out",
                    contact::kContactsPerPart));
  }
  if ((status & contact::kGripReleased) != 0) {
    all.emplace_back("the grip's limit was passed: it let go (grip_limit_N of the tissue)");
  }
  if ((status & contact::kJump) != 0) {
    all.emplace_back("the tool moved faster than any hand does: it was treated as placed anew");
  }
  if (run.highlights.limited_ticks > 0) {
    all.emplace_back(fmt::format("force or torque was held back by the limits under [safety] in {} ticks",
                                 run.highlights.limited_ticks));
  }
  for (const haptics::FaultSeen& seen : run.loop.faults) all.push_back(fault_in_words(run, seen));
  if (run.loop.further_faults > 0) {
    all.emplace_back(fmt::format("and {} more faults", run.loop.further_faults));
  }
  if (run.loop.stopped_early) all.emplace_back("stopped before its end");
  return all;
}

nlohmann::ordered_json summary_json(const RunAccount& run, const OutputFiles& files) {
  const auto path_or_null = [](const std::filesystem::path& path) {
    return path.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(path.string());
  };
  nlohmann::ordered_json phases = nlohmann::ordered_json::array();
  for (const PhaseSpan& span : run.highlights.phases) {
    phases.push_back(
        {{"hand", span.hand}, {"phase", phase_name(span.phase)}, {"from_s", span.from}, {"to_s", span.to}});
  }
  return {{"scene", run.setup->name},
          {"rate_Hz", run.setup->rate_Hz},
          {"seed", run.setup->seed},
          {"offline", run.offline},
          {"ticks", run.loop.ticks},
          {"duration_s", static_cast<double>(run.loop.ticks) / run.setup->rate_Hz},
          {"stopped_early", run.loop.stopped_early},
          {"missed_deadlines", run.loop.missed_deadlines},
          {"longest_gap_us", microseconds(run.loop.longest_gap_ns)},
          {"late_us", histogram_json(run.loop.lateness)},
          {"tick_us", histogram_json(run.loop.tick_time)},
          {"realtime_priority", run.loop.realtime_priority},
          {"memory_locked", run.loop.memory_locked},
          {"polled", run.loop.polled},
          {"peak_force_N", run.highlights.peak_force},
          {"peak_tissue_force_N", run.highlights.peak_tissue},
          {"peak_depth_mm", run.highlights.peak_depth * 1e3},
          {"peak_depth_tick", run.highlights.deepest_tick},
          {"contact_ticks", run.highlights.contact_ticks},
          {"limited_ticks", run.highlights.limited_ticks},
          {"phases", phases},
          {"fault", haptics::name_of(run.loop.fault)},
          {"faults", faults_json(run)},
          {"further_faults", run.loop.further_faults},
          {"watchdog_stops", run.loop.watchdog_stops},
          {"igtl", igtl_json(run.igtl)},
          {"recording", path_or_null(files.recording)},
          {"report", path_or_null(files.report)},
          {"screenshot", path_or_null(files.screenshot)},
          {"fault_recording", path_or_null(run.fault_recording)},
          {"remarks", remarks(run)}};
}

void print_summary(std::ostream& out, const RunAccount& run, const OutputFiles& files) {
  out << run.setup->name << ": " << run.loop.ticks << " ticks at " << shortest(run.setup->rate_Hz) << " Hz, "
      << pace_of(run) << '\n';
  print_phases(out, run.highlights, run.setup->tools.size() > 1);
  out << std::fixed << std::setprecision(3) << "Deepest: " << run.highlights.peak_depth * 1e3
      << " mm; largest tissue force: " << run.highlights.peak_tissue
      << " N, at the device: " << run.highlights.peak_force << " N\n"
      << std::defaultfloat;
  print_timing(out, run);
  for (const std::string& remark : remarks(run)) out << "Note: " << remark << '\n';
  if (!files.recording.empty()) out << "Recording: " << files.recording.string() << '\n';
  if (!run.fault_recording.empty()) {
    out << "The last seconds before the fault: " << run.fault_recording.string() << '\n';
  }
  if (!files.screenshot.empty()) out << "Picture: " << files.screenshot.string() << '\n';
  if (!files.report.empty()) out << "Report: " << files.report.string() << '\n';
}

}  // namespace palpate::app
