#include "app/session.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>

#include "core/base/spsc_queue.h"
#include "core/base/text.h"
#include "io/scene/device_kinds.h"
#include "io/system/file_exists.h"
#include "io/system/files.h"
#include "io/system/path_text.h"
#include "palpate/builtin.h"
#include "run/devices/ros.h"
#include "run/ros/ros_node.h"
#include "view/report/page.h"

#include "app/commands.h"
#include "app/messages.h"
#include "app/pictures.h"
#include "app/progress.h"

namespace palpate::app {
namespace {

/// Reports the progress of a run from its own thread: a progress bar, and a message for each fault with the
/// command that resets it. The haptic loop only counts ticks and puts faults into a lock-free queue.
class ProgressObserver final : public haptics::TickObserver {
 public:
  /// [setup] @param session outlives this
  explicit ProgressObserver(const session::Session& session);
  /// [setup] Reports the remaining faults and errors, then ends the thread.
  ~ProgressObserver() override;
  ProgressObserver(const ProgressObserver&) = delete;
  ProgressObserver& operator=(const ProgressObserver&) = delete;

  /// [setup] Prints an error on standard error within 0.1 s. Any thread except the haptic loop may call it.
  void queue_error(std::string error) {
    const std::scoped_lock lock(mutex_);
    errors_.push_back(std::move(error));
  }

  void on_fault(const haptics::FaultSeen& fault) noexcept override { (void)faults_.push(fault); }
  void on_row(const haptics::TickRow& row) noexcept override {
    if ((row.events & haptics::kMotorsWarm) != 0)
      warm_hand_.store(static_cast<int>(row.hand), std::memory_order_relaxed);
  }
  void on_tick(const haptics::TickState& now) noexcept override {
    done_.store(now.tick + 1, std::memory_order_relaxed);
  }

 private:
  static constexpr std::size_t kFaultsKept = 64;

  void report_progress(const std::stop_token& stop);
  void report_fault(const haptics::FaultSeen& seen) const;
  [[nodiscard]] std::string describe_warm_motors(std::size_t hand) const;

  const session::Session& session_;
  std::atomic<std::uint64_t> done_{0};  // ticks
  std::atomic<int> warm_hand_{-1};      // hand whose device last reported warm motors; -1: none
  SpscQueue<haptics::FaultSeen> faults_{kFaultsKept};
  std::mutex mutex_;  // guards errors_
  std::vector<std::string> errors_;
  std::jthread thread_;  // last: the thread ends before the members that it uses are destroyed
};

constexpr std::chrono::milliseconds kRedraw{100};

std::string seconds(double time) { return shortest(std::round(time * 10.0) / 10.0) + " s"; }

ProgressObserver::ProgressObserver(const session::Session& session)
    : session_(session), thread_([this](const std::stop_token& stop) { report_progress(stop); }) {}

ProgressObserver::~ProgressObserver() {
  thread_.request_stop();
  thread_.join();
}

void ProgressObserver::report_progress(const std::stop_token& stop) {
  Progress bar(session_.scene().name);
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  bool warm_reported = false;
  for (bool last = false; !last;) {
    last = wake.wait_for(lock, stop, kRedraw, [&stop] { return stop.stop_requested(); });
    haptics::FaultSeen seen;
    while (faults_.pop(seen)) {
      bar.clear();
      report_fault(seen);
    }
    const int hand = warm_hand_.load(std::memory_order_relaxed);
    if (hand >= 0 && !warm_reported &&
        session_.scene().devices[static_cast<std::size_t>(hand)].kind != "replay") {
      bar.clear();
      app::report_message(describe_warm_motors(static_cast<std::size_t>(hand)));
      warm_reported = true;
    }
    {
      const std::scoped_lock errors(mutex_);
      if (!errors_.empty()) bar.clear();
      for (const std::string& error : std::exchange(errors_, {})) report_error(error);
    }
    if (last) break;
    const auto ticks = static_cast<double>(done_.load(std::memory_order_relaxed));
    bar.update(ticks / static_cast<double>(session_.ticks()), seconds(ticks / session_.scene().rate_Hz));
  }
}

std::string ProgressObserver::describe_warm_motors(std::size_t hand) const {
  const bool lowers = std::isfinite(session_.scene().devices[hand].abilities.continuous_force);
  return "hand " + std::to_string(hand) + ": the device's motors are warm: pause for some minutes; " +
         (lowers ? "its force is reduced until they have cooled"
                 : "its force is not reduced, because it does not report its continuous force");
}

void ProgressObserver::report_fault(const haptics::FaultSeen& seen) const {
  const std::string last_error = session_.devices()[seen.hand]->last_error();
  report_error("fault at tick " + std::to_string(seen.tick) + " (" +
               shortest(static_cast<double>(seen.tick) / session_.scene().rate_Hz) + " s), hand " +
               std::to_string(seen.hand) + ": " + haptics::describe(seen.fault) +
               (last_error.empty() ? "" : " (" + last_error + ")") + "; the force stays zero " +
               describe_reset());
}

namespace fs = std::filesystem;

/// Stops a run, or resets its faults, after a signal requested it. It is an observer, so the run exists
/// whenever it is called.
class SignalRelay final : public haptics::TickObserver {
 public:
  /// [setup] @param stop flag that ends the run; null: Ctrl-C does not end the run here
  SignalRelay(haptics::RunControl& control, const std::atomic<bool>* stop) : control_(control), stop_(stop) {}
  void on_tick(const haptics::TickState& /*now*/) noexcept override {
    if (stop_ != nullptr && stop_->load(std::memory_order_relaxed)) control_.stop();
    if (ResetOnSignal::take()) control_.reset_faults();
  }

 private:
  haptics::RunControl& control_;
  const std::atomic<bool>* stop_;
};

void require_writable_parent(const fs::path& path, const std::string& flag) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!folder_exists(folder)) {
    throw InputError(flag + " " + to_text(path) + ": the folder " + to_text(folder) + " does not exist");
  }
  if (!may_write(folder)) {
    throw InputError(flag + " " + to_text(path) + ": the folder " + to_text(folder) + " is not writable");
  }
}

/// Reports for which topics the run waits.
void report_awaited_topics(const scene::Scene& scene) {
  for (std::size_t hand = 0; hand < scene.devices.size(); ++hand) {
    const scene::DeviceSetup& device = scene.devices[hand];
    if (device.kind != "ros" || !ros::has_plugin()) continue;
    report_message("device ros: the run begins when a program publishes poses to " +
                   (device.path.empty() ? devices::default_ros_topic(hand) : device.path));
  }
}

/// Says for which clients the run waits.
void report_awaited_clients(const scene::Scene& scene) {
  for (const scene::DeviceSetup& device : scene.devices) {
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

scene::Scene load_scene(scene::Overrides request, bool no_cache) {
  request.store = OrganPreparation(no_cache).how().store;
  return scene::load(request);
}

std::unique_ptr<Session> prepare(scene::Scene scene, std::optional<double> duration_s, bool no_cache,
                                 const std::atomic<bool>* broken_off) {
  if (duration_s) (void)session::ticks_in(*duration_s, scene.rate_Hz, "--duration-s");
  if (broken_off != nullptr && broken_off->load(std::memory_order_relaxed)) throw Cancelled();
  const OrganPreparation preparation(no_cache);
  session::SessionOptions options;
  options.duration_s = duration_s;
  options.preparation = preparation.how();
  report_awaited_topics(scene);
  report_awaited_clients(scene);
  if (broken_off != nullptr) {
    options.preparation.progress = [broken_off, &preparation](double share, const std::string& what) {
      if (broken_off->load(std::memory_order_relaxed)) throw Cancelled();
      preparation.how().progress(share, what);
    };
  }
  return std::make_unique<Session>(std::move(scene), std::move(options));
}

void require_writable_file(const fs::path& file, const std::string& flag) {
  if (!file.has_filename() || folder_exists(file)) {
    throw InputError(flag + " " + to_text(file) + ": is a folder; must be a file");
  }
  if (!is_special_file(file)) require_writable_parent(link_target(file), flag);
  if (file_exists(file) && !may_write(file)) {
    throw InputError(flag + " " + to_text(file) + ": the file exists and is not writable");
  }
}

void require_regular_file(const fs::path& file, const std::string& flag) {
  require_writable_file(file, flag);
  require_regular_output(file, flag);
}

void require_png_file(const fs::path& file, const std::string& flag) {
  require_pictures(flag);
  const std::string extension = lower_case(to_text(file.extension()));
  static constexpr std::array<const char*, 11> kOthers = {".jpg",  ".jpeg", ".gif", ".bmp", ".tif", ".tiff",
                                                          ".webp", ".svg",  ".pdf", ".ppm", ".eps"};
  if (std::find(kOthers.begin(), kOthers.end(), extension) != kOthers.end()) {
    throw InputError(flag + " " + to_text(file) + ": pictures are PNG files, must end in .png: " +
                     to_text(fs::path(file).replace_extension(".png")));
  }
  require_writable_file(file, flag);
}

void require_none_of_report(const fs::path& report_folder, std::span<const NamedFile> files) {
  if (report_folder.empty()) return;
  const auto resolved = [](const fs::path& folder) {
    std::error_code error;  // an error leaves an empty path, which equals no folder
    return fs::weakly_canonical(fs::absolute(folder / ""), error);
  };
  const fs::path folder = resolved(report_folder);
  for (const NamedFile& named : files) {
    if (named.path.empty()) continue;
    for (const fs::path& file : {fs::absolute(named.path), fs::absolute(link_target(named.path))}) {
      if (!report::is_report_file(to_text(file.filename())) || resolved(file.parent_path()) != folder)
        continue;
      throw InputError(named.flag + " " + to_text(named.path) + ": the report in " + to_text(report_folder) +
                       " may write " + to_text(file.filename()) + " there: use another name or folder");
    }
  }
}

std::vector<NamedFile> sources_of(const scene::Scene& scene) {
  std::vector<NamedFile> files;
  for (const scene::SourceFile& file : scene.files) files.push_back({file.named_by, file.path});
  return files;
}

void require_writable_folder(const fs::path& folder, const std::string& flag) {
  fs::path there = fs::absolute(folder);
  while (!file_exists(there) && there.has_relative_path()) there = there.parent_path();
  if (!folder_exists(there)) {
    throw InputError(flag + " " + to_text(folder) + ": " + to_text(there) + " is not a folder");
  }
  if (!may_write(there)) {
    throw InputError(flag + " " + to_text(folder) + ": the folder " + to_text(there) + " is not writable");
  }
}

void add_thread_flags(CLI::App& command, haptics::LoopThread& thread) {
  command.add_option("--core", thread.core, "run the haptic loop on this core only (0 is the first)");
  command.add_flag_callback(
      "--poll", [&thread] { thread.waiting = haptics::Waiting::kPoll; },
      "poll the clock between ticks instead of sleeping: ticks begin within a few microseconds, "
      "and one core is always busy");
}

RunResult play(Session& session, const PlayOptions& how) {
  const ResetOnSignal signals;
  const net::IgtlRun shown(how.igtl, session.scene());
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

std::string title_of(const scene::Scene& scene) {
  std::string organ = to_text(to_path(scene.organ_name).stem());
  if (organ.empty()) organ = "organ";
  organ.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(organ.front())));
  std::string tools;
  const std::vector<std::string>& builtin = geometry::builtin_tool_names();
  for (const geometry::Tool& tool : scene.tools) {
    std::string name = tool.name;
    if (std::find(builtin.begin(), builtin.end(), name) != builtin.end())
      std::replace(name.begin(), name.end(), '-', ' ');
    tools += (tools.empty() ? "" : " and ") + name;
  }
  const char* done = scene.task == scene::Task::kPull      ? " pulled with "
                     : scene.task == scene::Task::kPalpate ? " palpated with "
                     : scene.task == scene::Task::kInsert  ? " entered by "
                                                           : " pressed with ";
  constexpr std::size_t kLongestTitle = 256;  // bytes; the names may be of a foreign recording
  return excerpt(organ + done + tools, kLongestTitle);
}

}  // namespace palpate::app
