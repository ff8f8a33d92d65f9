#include "app/session.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <limits>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/devices/devices.h"
#include "palpate/haptics/realtime.h"
#include "palpate/record/assemble.h"
#include "palpate/record/flight_recorder.h"
#include "palpate/record/recorder.h"
#include "palpate/record/replay.h"
#include "palpate/render/indentations.h"

#include "app/commands.h"
#include "app/preparation.h"
#include "app/run_companion.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

constexpr double kLongestRun = 1e12;  // ticks, 30 years at 1 kHz: --duration-s beyond it is a typing mistake

/// What a signal handler may set. The one mutable global: a handler has no other way to say anything.
std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void ask_to_stop(int) { stop_asked.store(true, std::memory_order_relaxed); }

/// The same for the reset of faults, a bit a hand.
std::atomic<std::uint32_t> resets_asked{0};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

extern "C" void ask_for_resets(int) { reset_faults(); }

/// Rows to two sinks.
class RowsToBoth final : public haptics::TickSink {
 public:
  /// [setup] @param second may be null
  RowsToBoth(haptics::TickSink& first, haptics::TickSink* second) : first_(first), second_(second) {}
  void begin(std::int64_t started_unix_ns) noexcept override {
    first_.begin(started_unix_ns);
    if (second_ != nullptr) second_->begin(started_unix_ns);
  }
  void put_change(const haptics::LiveChange& change) noexcept override {
    first_.put_change(change);
    if (second_ != nullptr) second_->put_change(change);
  }
  void put(const haptics::TickRow& row) noexcept override {
    first_.put(row);
    if (second_ != nullptr) second_->put(row);
  }

 private:
  haptics::TickSink& first_;
  haptics::TickSink* second_;
};

/// SIGUSR1 resets the faults of all hands while this lives, and does nothing afterwards: a reset that comes
/// too late must not end the program before its report is written.
class ResetOnSignal final {
 public:
  ResetOnSignal() {
    resets_asked.store(0);
    struct sigaction action {};
    action.sa_handler = ask_for_resets;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGUSR1, &action, nullptr);
  }
  ~ResetOnSignal() { std::signal(SIGUSR1, SIG_IGN); }
  ResetOnSignal(const ResetOnSignal&) = delete;
  ResetOnSignal& operator=(const ResetOnSignal&) = delete;
};

std::uint64_t ticks_to_run(const Session& session, std::optional<double> duration_s) {
  const double rate = session.setup.rate_Hz;
  if (duration_s) {
    const double ticks = std::round(*duration_s * rate);
    if (!(ticks >= 0.0) || ticks > kLongestRun || *duration_s <= 0.0) {
      throw ParameterError("--duration-s", *duration_s, "> 0 and at most " + shortest(kLongestRun / rate));
    }
    return static_cast<std::uint64_t>(ticks);
  }
  std::uint64_t last = 0;
  for (const auto& device : session.devices) last = std::max(last, device->last_tick(rate));
  return last;
}

void require_writable_parent(const fs::path& path, const std::string& flag) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError(flag + " " + path.string() + ": there is no folder " + folder.string());
  }
  if (access(folder.c_str(), W_OK) != 0) {
    throw InputError(flag + " " + path.string() + ": the folder " + folder.string() + " is not writable");
  }
}

/// Writes what led to a fault to the user's state folder; that it could not be is a remark, not a failure.
void keep_flight(const record::FlightRecorder& flight, scene::Setup& setup, RunAccount& account) {
  try {
    account.fault_recording = record::keep_flight(flight, account.loop);
  } catch (const InputError& failure) {
    setup.remarks.push_back(std::string("the ticks before the fault were not kept: ") + failure.what());
  }
}

}  // namespace

void reset_faults() noexcept {
  resets_asked.store(std::numeric_limits<std::uint32_t>::max(), std::memory_order_relaxed);
}

bool may_pause(const Session& session) { return haptics::stall_limit_ns(session.world) == 0; }

Session prepare(const scene::Request& request, std::optional<double> duration_s, bool no_cache) {
  return prepare(scene::load(request), duration_s, no_cache);
}

Session prepare(scene::Setup setup, std::optional<double> duration_s, bool no_cache) {
  haptics::SimulationWorld world = record::assemble(setup, OrganPreparation(no_cache).how());
  Session session{std::move(setup), std::move(world), {}, 0};
  for (std::size_t hand = 0; hand < session.setup.devices.size(); ++hand) {
    session.devices.push_back(devices::open_device(session.setup, hand));
  }
  session.ticks = ticks_to_run(session, duration_s);
  for (std::string& remark : record::radius_remarks(session.setup, session.world)) {
    session.setup.remarks.push_back(std::move(remark));
  }
  for (std::string& remark : record::stability_remarks(session.setup)) {
    session.setup.remarks.push_back(std::move(remark));
  }
  return session;
}

void require_writable_file(const fs::path& file, const std::string& flag) {
  std::error_code error;
  if (!file.has_filename() || fs::is_directory(file, error)) {
    throw InputError(flag + " " + file.string() + ": is a folder; a file is wanted");
  }
  require_writable_parent(file, flag);
  if (fs::exists(file, error) && access(file.c_str(), W_OK) != 0) {
    throw InputError(flag + " " + file.string() + ": the file is there and not writable");
  }
}

void require_writable_folder(const fs::path& folder, const std::string& flag) {
  std::error_code error;
  fs::path there = fs::absolute(folder);
  while (!fs::exists(there, error) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, error)) {
    throw InputError(flag + " " + folder.string() + ": " + there.string() + " is not a folder");
  }
  if (access(there.c_str(), W_OK) != 0) {
    throw InputError(flag + " " + folder.string() + ": the folder " + there.string() + " is not writable");
  }
}

StopOnSignal::StopOnSignal() {
  stop_asked.store(false);
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

StopOnSignal::~StopOnSignal() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

const std::atomic<bool>& StopOnSignal::flag() const noexcept { return stop_asked; }

void add_thread_flags(CLI::App& command, haptics::LoopThread& thread) {
  command.add_option("--core", thread.core, "run the haptic loop on this core only (0 is the first)");
  command.add_flag_callback(
      "--poll", [&thread] { thread.waiting = haptics::Waiting::kPoll; },
      "keep asking for the time between ticks instead of sleeping: ticks begin within a few "
      "microseconds, and one core is busy all the while");
}

void require_usable_core(std::optional<int> core) {
  if (!core) return;
  const std::vector<int> cores = haptics::usable_cores();
  if (std::find(cores.begin(), cores.end(), *core) != cores.end()) return;
  std::string list;
  for (const int usable : cores) list += (list.empty() ? "" : ", ") + std::to_string(usable);
  throw ParameterError("--core", *core, "a core that this program may use: " + list);
}

RunAccount play(Session& session, const PlayOptions& how, const std::atomic<bool>& stop) {
  std::optional<record::Recorder> recorder;
  std::optional<record::FlightRecorder> flight;
  if (how.recording.empty()) {
    flight.emplace(nullptr, session.setup);
  } else {
    recorder.emplace(how.recording, session.setup, how.offline);
  }
  RowWatch watch(recorder ? static_cast<haptics::TickSink*>(&*recorder) : &*flight, session.setup);
  RowsToBoth rows(watch, how.onlooker);
  haptics::SimulationState state(session.world);
  std::vector<haptics::Device*> devices;
  for (const auto& device : session.devices) devices.push_back(device.get());

  RunAccount account;
  account.setup = &session.setup;
  account.offline = how.offline;
  {
    const ResetOnSignal signals;
    net::IgtlRun shown(how.igtl, session.setup, render::indentations_of);
    RunCompanion companion(session.setup.name, session.ticks, session.setup.rate_Hz, devices);
    account.loop = haptics::run_loop(session.world, state, devices, &rows,
                                     {.ticks = session.ticks,
                                      .offline = how.offline,
                                      .stop = &stop,
                                      .snapshots = how.snapshots,
                                      .more_snapshots = shown.snapshots(),
                                      .progress = &companion.done(),
                                      .resets = &resets_asked,
                                      .changes = how.changes,
                                      .fault_news = &companion.fault_news(),
                                      .thread = how.thread,
                                      .stalled_after_ns = haptics::stall_limit_ns(session.world),
                                      .pause = how.pause});
  }
  if (recorder) recorder->finish(account.loop);
  if (flight && flight->fault_met()) keep_flight(*flight, session.setup, account);
  account.highlights = watch.highlights();
  return account;
}

int exit_code_of(const RunAccount& run, std::optional<std::uint64_t> max_missed) {
  if (run.loop.fault != haptics::Fault::kNone) return kFault;
  if (max_missed && run.loop.missed_deadlines > *max_missed) return kGoalMissed;
  return kDone;
}

std::string title_of(const scene::Setup& setup) {
  std::string organ = fs::path(setup.organ_name).stem().string();
  if (organ.empty()) organ = "organ";
  organ.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(organ.front())));
  std::string tools;
  for (const geometry::Tool& tool : setup.tools) tools += (tools.empty() ? "" : " and ") + tool.name;
  return organ + (setup.task == scene::Task::kPull ? " pulled with " : " pressed with ") + tools;
}

void write_screenshot(const record::Recording& recording, const Highlights& highlights, const fs::path& file,
                      bool no_cache) {
  constexpr int kWidth = 1280;
  constexpr int kHeight = 960;
  if (recording.rows.empty()) throw InputError("--screenshot " + file.string() + ": no tick was run");
  const std::vector<haptics::Snapshot> snapshots =
      record::snapshots_at(recording, {highlights.deepest_tick}, OrganPreparation(no_cache).how());
  const haptics::Snapshot& deepest = snapshots.front();
  const contact::ToolResult& result = deepest.results[highlights.deepest_hand];
  const render::Subject subject{recording.setup.organ, recording.setup.tools, recording.setup.tissue.reach,
                                recording.setup.tissue.name};
  render::OffscreenRenderer renderer(subject, kWidth, kHeight);
  const bool touched = result.phase != contact::Phase::kApproach;
  const render::Camera camera = render::frame_contact(
      subject, deepest, touched ? result.contact_W : result.nearest_W, result.normal_W, touched);
  render::write_png(renderer.draw(deepest, camera), file);
}

}  // namespace palpate::app
