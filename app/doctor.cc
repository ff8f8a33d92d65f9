// `palpate doctor`: checks whether this machine can run the haptic loop in real time, and advises how to
// change what it lacks.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "run/realtime/machine_checks.h"

#include "app/commands.h"
#include "app/output.h"
#include "app/summary.h"

namespace palpate::app {
namespace {

constexpr double kRate = 1000.0;         // Hz, loop rate of the measurement
constexpr std::uint64_t kTicks = 1000;   // 1 s
constexpr double kGoodLateness = 100e3;  // ns, goal for p99.9: a tenth of a period at 1 kHz

/// Measured lateness of a tick's start, for a thread that sleeps between ticks and for one that polls.
struct Lateness {
  realtime::WakeUpLatency slept;
  realtime::WakeUpLatency polled;
};

realtime::MachineCheck judged(const Lateness& lateness) {
  const realtime::WakeUpLatency& wake_ups = lateness.slept;
  realtime::MachineCheck check{"wake-ups at 1 kHz", realtime::Verdict::kGood, {}, {}};
  const std::int64_t late = wake_ups.late.percentile(0.999);
  check.found = fmt::format(
      "999 of 1000 at most {} us late, {} late by a full period or more ({} real-time priority, {} locked "
      "memory)",
      late / 1000, wake_ups.missed, wake_ups.realtime_priority ? "with" : "without",
      wake_ups.memory_locked ? "with" : "without");
  if (static_cast<double>(late) <= kGoodLateness) return check;
  check.verdict = realtime::Verdict::kBad;
  check.advice = wake_ups.realtime_priority
                     ? "close other programs, use a kernel with PREEMPT_RT, and palpate run --core N; or "
                       "palpate run --poll (polling: 999 of 1000 at most " +
                           fmt::format("{:.1f}", microseconds(lateness.polled.late.percentile(0.999))) +
                           " us late)"
                     : "grant real-time priority (above), then measure again";
  return check;
}

const char* word(realtime::Verdict verdict) {
  switch (verdict) {
    case realtime::Verdict::kGood:
      return "good";
    case realtime::Verdict::kBad:
      return "bad";
    case realtime::Verdict::kUnknown:
      break;
  }
  return "unknown";
}

/// Prints the histogram of the lateness with one line per octave: each bin is twice as wide as the previous
/// one.
void print_histogram(std::ostream& out, const haptics::Histogram& late) {
  std::vector<std::uint64_t> octaves;
  for (const haptics::Histogram::Bucket& bucket : late.buckets()) {
    const auto octave =
        static_cast<std::size_t>(std::max(0.0, std::floor(std::log2(microseconds(bucket.upper)))));
    if (octaves.size() <= octave) octaves.resize(octave + 1, 0);
    octaves[octave] += bucket.count;
  }
  constexpr double kWidest = 50.0;  // characters
  std::uint64_t most = 1;
  for (const std::uint64_t count : octaves) most = std::max(most, count);
  for (std::size_t i = 0; i < octaves.size(); ++i) {
    const double share = static_cast<double>(octaves[i]) / static_cast<double>(most);
    out << "  under " << std::setw(8) << (std::uint64_t{2} << i) << " us " << std::setw(6) << octaves[i]
        << "  " << std::string(static_cast<std::size_t>(std::ceil(kWidest * share)), '#') << '\n';
  }
}

void print_percentiles(const haptics::Histogram& late) {
  std::cout << fmt::format(" p50 {:.3f}, p99 {:.3f}, p99.9 {:.3f}, max {:.3f}\n",
                           microseconds(late.percentile(0.5)), microseconds(late.percentile(0.99)),
                           microseconds(late.percentile(0.999)), microseconds(late.max()));
}

void print_text(const std::vector<realtime::MachineCheck>& checks, const Lateness& lateness) {
  for (const realtime::MachineCheck& check : checks) {
    std::cout << std::left << std::setw(8) << word(check.verdict) << std::setw(24) << check.name
              << check.found << '\n'
              << std::right;
    if (!check.advice.empty()) std::cout << std::string(8, ' ') << "-> " << check.advice << '\n';
  }
  std::cout << "\nLateness of a tick when the loop polls the clock (palpate run --poll) [us]:";
  print_percentiles(lateness.polled.late);
  std::cout << "Lateness of a tick when the loop sleeps between ticks (palpate run) [us]:";
  print_percentiles(lateness.slept.late);
  print_histogram(std::cout, lateness.slept.late);
}

void print_json(const std::vector<realtime::MachineCheck>& checks, const Lateness& lateness) {
  const realtime::WakeUpLatency& wake_ups = lateness.slept;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const realtime::MachineCheck& check : checks) {
    list.push_back({{"name", check.name},
                    {"verdict", word(check.verdict)},
                    {"found", check.found},
                    {"advice", check.advice.empty() ? nlohmann::ordered_json(nullptr)
                                                    : nlohmann::ordered_json(check.advice)}});
  }
  nlohmann::ordered_json histogram = nlohmann::ordered_json::array();
  for (const haptics::Histogram::Bucket& bucket : wake_ups.late.buckets()) {
    histogram.push_back({microseconds(bucket.upper), bucket.count});
  }
  const nlohmann::ordered_json json{{"checks", list},
                                    {"wake_ups",
                                     {{"rate_Hz", kRate},
                                      {"samples", wake_ups.late.count()},
                                      {"realtime_priority", wake_ups.realtime_priority},
                                      {"memory_locked", wake_ups.memory_locked},
                                      {"missed_deadlines", wake_ups.missed},
                                      {"late_us", to_json(wake_ups.late)},
                                      {"polled_late_us", to_json(lateness.polled.late)},
                                      {"histogram_us", histogram}}}};
  std::cout << json_text(json) << '\n';
}

void doctor(bool json) {
  std::vector<realtime::MachineCheck> checks = realtime::check_machine();
  const Lateness lateness{realtime::measure_wake_up_latency(kRate, kTicks, haptics::Waiting::kSleep),
                          realtime::measure_wake_up_latency(kRate, kTicks, haptics::Waiting::kPoll)};
  checks.push_back(judged(lateness));
  if (json) {
    print_json(checks, lateness);
  } else {
    print_text(checks, lateness);
  }
}

}  // namespace

void add_doctor(CLI::App& program, int& exit_code) {
  CLI::App* command = program.add_subcommand(
      "doctor", "Check what this machine lacks for real time, and how to change it (takes a few seconds)");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json, "print one JSON document");
  command->footer("Example: palpate doctor\nExit: always 0");
  command->callback([json, &exit_code] {
    doctor(*json);
    exit_code = kDone;
  });
}

}  // namespace palpate::app
