#include "app/session.h"

#include <array>
#include <cctype>
#include <cmath>
#include <csignal>
#include <limits>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "core/base/text.h"
#include "io/scene/device_kinds.h"
#include "io/system/file_exists.h"
#include "palpate/error.h"
#include "palpate/recording.h"
#include "run/devices/ros.h"
#include "run/ros/ros_node.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/preparation.h"
#include "app/progress_observer.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// Set by the handler of SIGINT, SIGTERM and SIGHUP. It is a mutable global because a signal handler has no
/// arguments that could carry it.
std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);
constexpr std::array<int, 3> kStopSignals{SIGINT, SIGTERM, SIGHUP};

extern "C" void ask_to_stop(int) { stop_asked.store(true, std::memory_order_relaxed); }

/// Set by the handler of SIGUSR1: reset the faults of all hands.
std::atomic<bool> reset_asked{false};

extern "C" void ask_for_reset(int) { reset_asked.store(true, std::memory_order_relaxed); }

/// Stops a run, or resets its faults, after a signal requested it. It is an observer, so the run exists
/// whenever it is called.
class SignalRelay final : public haptics::TickObserver {
 public:
  /// [setup] @param stop flag that ends the run; null: Ctrl-C does not end the run here
  SignalRelay(haptics::RunControl& control, const std::atomic<bool>* stop) : control_(control), stop_(stop) {}
  void on_tick(const haptics::TickState& /*now*/) noexcept override {
    if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) control_.stop();
    if (!reset_asked.load(std::memory_order_relaxed)) return;
    if (reset_asked.exchange(false, std::memory_order_relaxed)) control_.reset_faults();
  }

 private:
  haptics::RunControl& control_;
  const std::atomic<bool>* stop_;
};

/// SIGUSR1 resets the faults of all hands during the lifetime of this object, and is ignored afterwards. A
/// late reset must not end the program before its report is written.
class ResetOnSignal final {
 public:
  ResetOnSignal() {
    reset_asked.store(false);
    struct sigaction action {};
    action.sa_handler = ask_for_reset;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGUSR1, &action, nullptr);
  }
  ~ResetOnSignal() { std::signal(SIGUSR1, SIG_IGN); }
  ResetOnSignal(const ResetOnSignal&) = delete;
  ResetOnSignal& operator=(const ResetOnSignal&) = delete;
};

void require_writable_parent(const fs::path& path, const std::string& flag) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!folder_exists(folder)) {
    throw InputError(flag + " " + path.string() + ": the folder " + folder.string() + " does not exist");
  }
  if (access(folder.c_str(), W_OK) != 0) {
    throw InputError(flag + " " + path.string() + ": the folder " + folder.string() + " is not writable");
  }
}

/// Reports for which topics the run waits.
void report_awaited_topics(const scene::Scene& setup) {
  for (std::size_t hand = 0; hand < setup.devices.size(); ++hand) {
    const scene::DeviceSetup& device = setup.devices[hand];
    if (device.kind != "ros" || !ros::has_plugin()) continue;
    report_message("device ros: the run begins when a program publishes poses to " +
                   (device.path.empty() ? devices::default_ros_topic(hand) : device.path));
  }
}

/// Says for which clients the run waits.
void report_awaited_clients(const scene::Scene& setup) {
  for (const scene::DeviceSetup& device : setup.devices) {
    const scene::DeviceKind* kind = scene::find_device_kind(device.kind);
    if (kind == nullptr || kind->path != scene::DevicePath::kClient) continue;
    const bool local = device.path.find(':') == std::string::npos || device.path.rfind("127.", 0) == 0;
    report_message(
        "device " + device.kind + ":" + device.path + ": the run begins when a client sends poses; " +
        (local ? "programs on this machine may connect"
               : "anyone who can reach it over the network can move the tool; there is no password"));
  }
}

}  // namespace

std::unique_ptr<Session> prepare(scene::Scene setup, std::optional<double> duration_s, bool no_cache,
                                 const std::atomic<bool>* broken_off) {
  if (duration_s) (void)session::ticks_in(*duration_s, setup.rate_Hz, "--duration-s");
  if (broken_off != nullptr && broken_off->load(std::memory_order_relaxed)) throw Cancelled();
  const OrganPreparation preparation(no_cache);
  session::SessionOptions options;
  options.duration_s = duration_s;
  options.preparation = preparation.how();
  report_awaited_topics(setup);
  report_awaited_clients(setup);
  if (broken_off != nullptr) {
    options.preparation.progress = [broken_off, &preparation](double share, const std::string& what) {
      if (broken_off->load(std::memory_order_relaxed)) throw Cancelled();
      preparation.how().progress(share, what);
    };
  }
  return std::make_unique<Session>(std::move(setup), std::move(options));
}

void require_writable_file(const fs::path& file, const std::string& flag) {
  if (!file.has_filename() || folder_exists(file)) {
    throw InputError(flag + " " + file.string() + ": is a folder; must be a file");
  }
  if (!is_special_file(file)) require_writable_parent(link_target(file), flag);
  if (file_exists(file) && access(file.c_str(), W_OK) != 0) {
    throw InputError(flag + " " + file.string() + ": the file exists and is not writable");
  }
}

void require_regular_file(const fs::path& file, const std::string& flag) {
  require_writable_file(file, flag);
  require_regular_output(file, flag);
}

std::vector<NamedFile> sources_of(const scene::Scene& setup) {
  std::vector<NamedFile> files;
  for (const scene::SourceFile& file : setup.files) files.push_back({file.named_by, file.path});
  return files;
}

void require_writable_folder(const fs::path& folder, const std::string& flag) {
  fs::path there = fs::absolute(folder);
  while (!file_exists(there) && there.has_relative_path()) there = there.parent_path();
  if (!folder_exists(there)) {
    throw InputError(flag + " " + folder.string() + ": " + there.string() + " is not a folder");
  }
  if (access(there.c_str(), W_OK) != 0) {
    throw InputError(flag + " " + folder.string() + ": the folder " + there.string() + " is not writable");
  }
}

StopOnSignal::StopOnSignal() : hangup_before_(std::signal(SIGHUP, SIG_IGN)) {
  stop_asked.store(false);
  struct sigaction action {};
  action.sa_handler = ask_to_stop;
  sigemptyset(&action.sa_mask);
  for (const int number : kStopSignals) {
    // A second Ctrl-C ends the program. A terminal that closes sends SIGHUP twice by itself.
    action.sa_flags = number == SIGHUP ? 0 : static_cast<int>(SA_RESETHAND);
    sigaction(number, &action, nullptr);
  }
  if (hangup_before_ == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

StopOnSignal::~StopOnSignal() {
  for (const int number : kStopSignals) std::signal(number, SIG_DFL);
  std::signal(SIGHUP, hangup_before_);
}

const std::atomic<bool>& StopOnSignal::flag() const noexcept { return stop_asked; }

void add_thread_flags(CLI::App& command, haptics::LoopThread& thread) {
  command.add_option("--core", thread.core, "run the haptic loop on this core only (0 is the first)");
  command.add_flag_callback(
      "--poll", [&thread] { thread.waiting = haptics::Waiting::kPoll; },
      "poll the clock between ticks instead of sleeping: ticks begin within a few microseconds, "
      "and one core is always busy");
}

RunResult play(Session& session, const PlayOptions& how) {
  const ResetOnSignal signals;
  const net::IgtlRun shown(how.igtl, session.setup());
  ProgressObserver companion(session);
  SignalRelay relay(session.control(), how.stop);
  std::vector<haptics::TickObserver*> observers = how.observers;
  observers.insert(observers.end(), {&companion, &relay});
  if (how.igtl != nullptr) observers.push_back(how.igtl);
  session::RunOptions options = how.run;
  options.on_recording_failure = [&companion](const std::string& failure) {
    companion.queue_error(failure +
                          "; the run continues without recording: free disk space, then record again");
  };
  return session.run(options, observers);
}

std::unique_ptr<session::BackgroundRun> play_in_background(Session& session, PlayOptions how) {
  return std::make_unique<session::BackgroundRun>(
      session.control(), [&session, how = std::move(how)] { return play(session, how); });
}

int exit_code_of(const RunResult& run, std::optional<std::uint64_t> max_missed) {
  if (run.loop.fault != haptics::Fault::kNone) return kFault;
  if (!run.recording_failure.empty()) return kBadInput;
  if (max_missed && run.loop.missed_deadlines > *max_missed) return kGoalMissed;
  return kDone;
}

std::string title_of(const scene::Scene& setup) {
  std::string organ = fs::path(setup.organ_name).stem().string();
  if (organ.empty()) organ = "organ";
  organ.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(organ.front())));
  std::string tools;
  for (const geometry::Tool& tool : setup.tools) tools += (tools.empty() ? "" : " and ") + tool.name;
  const char* done = setup.task == scene::Task::kPull      ? " pulled with "
                     : setup.task == scene::Task::kPalpate ? " palpated with "
                                                           : " pressed with ";
  constexpr std::size_t kLongestTitle = 256;  // bytes; the names may be of a foreign recording
  return excerpt(organ + done + tools, kLongestTitle);
}

void write_screenshot(const record::Recording& recording, const session::RunStatistics& statistics,
                      const fs::path& file, bool no_cache) {
  constexpr int kWidth = 1280;
  constexpr int kHeight = 960;
  if (recording.rows.empty()) throw InputError("--screenshot " + file.string() + ": no tick was run");
  const std::vector<haptics::Snapshot> snapshots =
      record::snapshots_at(recording, {statistics.deepest_tick}, OrganPreparation(no_cache).how());
  const haptics::Snapshot& deepest = snapshots.front();
  const contact::ToolResult& result = deepest.results[statistics.deepest_hand];
  const scene::Scene& setup = recording.setup;
  const render::Subject subject{setup.organ, setup.tools, setup.tissue.reach, setup.tissue.name,
                                scene::visible_inclusions(setup.inclusions)};
  render::OffscreenRenderer renderer(subject, kWidth, kHeight);
  const bool touched = result.phase != contact::Phase::kApproach;
  const render::Camera camera = render::frame_contact(
      subject, deepest, touched ? result.contact_W : result.nearest_W, result.normal_W, touched);
  render::write_png(renderer.draw(deepest, camera), file);
}

}  // namespace palpate::app
