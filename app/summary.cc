#include "app/summary.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <utility>
#include <variant>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "io/system/path_text.h"
#include "palpate/tool_contact.h"
#include "palpate/units.h"
#include "run/session/run_quantities.h"

#include "app/progress.h"

namespace palpate::app {

using session::RunResult;

namespace {

nlohmann::ordered_json igtl_json(const std::optional<net::IgtlStatistics>& tally) {
  if (!tally) return nullptr;
  return {{"clients", tally->clients},
          {"refused", tally->refused},
          {"given_up", tally->given_up},
          {"frames", tally->frames},
          {"frames_left_out", tally->frames_left_out}};
}

void print_times(std::ostream& out, const char* name, const haptics::Histogram& times) {
  out << "  " << std::left << std::setw(24) << name << std::right << std::fixed << std::setprecision(1);
  for (const double share : {0.5, 0.99, 0.999}) out << std::setw(10) << microseconds(times.percentile(share));
  out << std::setw(10) << microseconds(times.max()) << '\n' << std::defaultfloat;
}

void print_phases(std::ostream& out, const session::RunStatistics& seen, bool several_hands) {
  constexpr std::size_t kShown = 12;
  for (std::size_t i = 0; i < std::min(kShown, seen.phases.size()); ++i) {
    const session::PhaseSpan& span = seen.phases[i];
    out << "  ";
    if (several_hands) out << "hand " << span.hand << "  ";
    out << std::left << std::setw(10) << contact::kPhaseNames.at(span.phase) << std::right << std::fixed
        << std::setprecision(3) << span.from << " to " << span.to << " s\n"
        << std::defaultfloat;
  }
  const std::uint64_t more =
      seen.phases_left_out + (seen.phases.size() > kShown ? seen.phases.size() - kShown : 0);
  if (more > 0) out << "  and " << more << " more\n";
}

const char* pace_of(const RunResult& run) {
  if (run.offline) return "offline";
  return run.loop.polled ? "in real time, polling the clock" : "in real time";
}

void print_timing(std::ostream& out, const RunResult& run) {
  out << "Timing [us]                      p50       p99     p99.9       max\n";
  print_times(out, "computing a tick", run.loop.tick_time);
  if (run.offline) return;
  print_times(out, "lateness of a tick", run.loop.lateness);
  out << "  missed deadlines: " << run.loop.missed_deadlines << " of " << run.loop.ticks
      << ", longest gap between two ticks: " << std::fixed << std::setprecision(3)
      << microseconds(run.loop.longest_gap_ns) / 1e3 << " ms\n"
      << std::defaultfloat;
}

std::string moment(std::uint64_t tick, double rate_Hz) {
  return fmt::format("tick {} ({} s)", tick, shortest(static_cast<double>(tick) / rate_Hz));
}

/// For example "a fault was latched (stalled-loop) at tick 12 (0.012 s), hand 0: the loop stood still for 20
/// ms; zero force from there on".
std::string fault_text(const RunResult& run, const haptics::FaultSeen& seen) {
  const double rate = run.rate_Hz;
  const bool reset = seen.reset_tick != haptics::FaultSeen::kNotReset;
  return fmt::format("a fault was latched ({}) at {}, hand {}: {}; zero force {}",
                     haptics::name_of(seen.fault), moment(seen.tick, rate), seen.hand,
                     haptics::describe(seen.fault),
                     reset ? "until it was reset at " + moment(seen.reset_tick, rate) : "from there on");
}

nlohmann::ordered_json faults_json(const RunResult& run) {
  nlohmann::ordered_json faults = nlohmann::ordered_json::array();
  for (const haptics::FaultSeen& seen : run.loop.faults) {
    nlohmann::ordered_json fault{{"tick", seen.tick},
                                 {"time_s", static_cast<double>(seen.tick) / run.rate_Hz},
                                 {"hand", seen.hand},
                                 {"fault", haptics::name_of(seen.fault)},
                                 {"reset_tick", nullptr}};
    if (seen.reset_tick != haptics::FaultSeen::kNotReset) fault["reset_tick"] = seen.reset_tick;
    faults.push_back(fault);
  }
  return faults;
}

/// How far the first mark of a lump is from it [m].
double distance_of(const palpation::Score& score, std::size_t lump) {
  for (const palpation::Mark& mark : score.marks) {
    if (mark.first && mark.lump == lump) return mark.distance;
  }
  return 0.0;
}

}  // namespace

nlohmann::ordered_json to_json(const haptics::Histogram& times) {
  return {{"p50", microseconds(times.percentile(0.5))},
          {"p99", microseconds(times.percentile(0.99))},
          {"p999", microseconds(times.percentile(0.999))},
          {"max", microseconds(times.max())}};
}

std::vector<std::string> remarks(const RunResult& run) {
  std::vector<std::string> all = run.scene_remarks;
  all.insert(all.end(), run.loop.remarks.begin(), run.loop.remarks.end());
  if (run.statistics.changes > 0) {
    all.emplace_back(fmt::format("tissue or noise was changed {}{} during the run", run.statistics.changes,
                                 run.statistics.changes == 1 ? " time" : " times"));
  }
  const std::pair<std::uint32_t, std::string> texts[] = {
      {contact::kStartedInside,
       "a part of the tool started inside the organ: it gave no force until it had left the organ"},
      {contact::kContactsFull,
       fmt::format("a part of the tool had more than {} contacts at once: the other ones were ignored",
                   contact::kContactsPerPart)},
      {contact::kGripReleased,
       "the force limit of the grip was exceeded: it let go (grip_limit_N of the tissue)"},
      {contact::kJump, "the tool moved faster than a hand can: its contacts were reset"},
      {contact::kExtrapolated,
       "the tool went deeper than max_depth_mm under [tissue.source]: past it the force goes on by its "
       "tangent there"},
      {contact::kAtHub,
       "the needle went in up to its hub: from there on its hub pushed the tissue; take a longer needle"}};
  for (const auto& [bit, text] : texts) {
    if ((run.statistics.status & bit) != 0) all.push_back(text);
  }
  if (run.statistics.contact_ticks == 0 && run.statistics.nearest > 0.0 &&
      std::isfinite(run.statistics.nearest)) {
    all.emplace_back(fmt::format("no tool touched the organ: the nearest came within {:.1f} mm",
                                 1e3 * run.statistics.nearest));
  }
  if (run.statistics.limited_ticks > 0) {
    all.emplace_back(fmt::format("force or torque was reduced to the limits under [safety] in {} ticks",
                                 run.statistics.limited_ticks));
  }
  for (const haptics::FaultSeen& seen : run.loop.faults) all.push_back(fault_text(run, seen));
  if (!run.recording_failure.empty()) all.push_back(run.recording_failure);
  if (run.loop.further_faults > 0) {
    all.emplace_back(fmt::format("and {} more faults", run.loop.further_faults));
  }
  if (run.loop.stopped_early) all.emplace_back("the run was stopped before its end");
  return all;
}

nlohmann::ordered_json summary_json(const RunResult& run, const OutputFiles& files,
                                    const std::optional<net::IgtlStatistics>& igtl) {
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
  };
  nlohmann::ordered_json phases = nlohmann::ordered_json::array();
  for (const session::PhaseSpan& span : run.statistics.phases) {
    phases.push_back({{"hand", span.hand},
                      {"phase", contact::kPhaseNames.at(span.phase)},
                      {"from_s", span.from},
                      {"to_s", span.to}});
  }
  nlohmann::ordered_json json = {{"scene", run.scene},
                                 {"rate_Hz", run.rate_Hz},
                                 {"seed", run.seed},
                                 {"offline", run.offline},
                                 {"ticks", run.loop.ticks},
                                 {"duration_s", static_cast<double>(run.loop.ticks) / run.rate_Hz},
                                 {"stopped_early", run.loop.stopped_early},
                                 {"missed_deadlines", run.loop.missed_deadlines},
                                 {"longest_gap_us", microseconds(run.loop.longest_gap_ns)},
                                 {"late_us", to_json(run.loop.lateness)},
                                 {"tick_us", to_json(run.loop.tick_time)},
                                 {"realtime_priority", run.loop.realtime_priority},
                                 {"memory_locked", run.loop.memory_locked},
                                 {"polled", run.loop.polled}};
  for (const session::RunQuantity& quantity : session::kRunQuantities) json[quantity.name] = quantity.of(run);
  json.update({{"missed_contact", run.statistics.contact_ticks == 0},
               {"peak_depth_tick", run.statistics.deepest_tick},
               {"contact_ticks", run.statistics.contact_ticks},
               {"limited_ticks", run.statistics.limited_ticks},
               {"phases", phases},
               {"fault", haptics::name_of(run.loop.fault)},
               {"faults", faults_json(run)},
               {"further_faults", run.loop.further_faults},
               {"watchdog_stops", run.loop.watchdog_stops},
               {"igtl", igtl_json(igtl)},
               {"recording", text_or_null(to_text(files.recording))},
               {"recording_failure", text_or_null(run.recording_failure)},
               {"report", text_or_null(to_text(files.report))},
               {"screenshot", text_or_null(to_text(files.screenshot))},
               {"fault_recording", text_or_null(to_text(run.fault_recording))},
               {"remarks", remarks(run)}});
  return json;
}

void print_summary(std::ostream& out, const RunResult& run, const OutputFiles& files) {
  out << run.scene << ": " << run.loop.ticks << " ticks at " << shortest(run.rate_Hz) << " Hz, "
      << pace_of(run) << '\n';
  print_phases(out, run.statistics, run.hands > 1);
  const bool inserted = std::any_of(
      run.statistics.phases.begin(), run.statistics.phases.end(), [](const session::PhaseSpan& span) {
        return span.phase == static_cast<std::uint32_t>(contact::Phase::kInsert);
      });
  out << std::fixed << std::setprecision(3) << (inserted ? "Tissue displaced by at most: " : "Deepest: ")
      << run.statistics.peak_depth * 1e3 << " mm; largest tissue force: " << run.statistics.peak_tissue
      << " N, at the device: " << run.statistics.peak_force << " N\n"
      << std::defaultfloat;
  print_timing(out, run);
  for (const std::string& remark : remarks(run)) out << "Note: " << remark << '\n';
  if (!files.recording.empty()) out << "Recording: " << to_text(files.recording) << '\n';
  if (!run.fault_recording.empty()) {
    out << "The last seconds before the fault: " << to_text(run.fault_recording) << '\n';
  }
  if (!files.screenshot.empty()) out << "Picture: " << to_text(files.screenshot) << '\n';
  if (!files.report.empty()) out << "Report: " << to_text(files.report) << '\n';
}

palpation::ScoredRecording score_of(const record::Recording& recording, bool no_cache) {
  const OrganPreparation preparation(no_cache);
  Progress bar("score");
  return {recording, preparation.how(), [&bar](double share) { bar.update(share, "scoring"); }};
}

palpation::AnyScore any_score_of(const record::Recording& recording, bool no_cache) {
  if (!palpation::is_insertion(recording.scene)) return score_of(recording, no_cache).scorer().score();
  const OrganPreparation preparation(no_cache);
  Progress bar("score");
  return palpation::score_insertions(recording, preparation.how(),
                                     [&bar](double share) { bar.update(share, "scoring"); });
}

void print_score(std::ostream& out, const palpation::AnyScore& any) {
  for (const palpation::Measure& one : palpation::measures(any)) {
    out << fmt::format("{:<20}{}\n", one.name, one.value);
  }
  if (!std::holds_alternative<palpation::Score>(any)) return;
  const palpation::Score& score = std::get<palpation::Score>(any);
  for (std::size_t i = 0; i < score.lumps.size(); ++i) {
    const palpation::Lump& lump = score.lumps[i];
    out << fmt::format(
        "{:<20}{}\n", lump.name,
        lump.found     ? fmt::format("found, its mark is {:.1f} mm away", distance_of(score, i) / kMillimetre)
        : lump.covered ? "missed, though it was touched"
                       : "missed, never touched");
  }
}

}  // namespace palpate::app
