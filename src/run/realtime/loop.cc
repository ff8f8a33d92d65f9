// The real-time loop: one thread that calls haptics::tick() once a period and nothing else may delay.
// run_loop() prepares it (memory lock, watchdog, priority, core, warm caches), waits for its end and writes
// the remarks of the report.
//
//     wait until due -> begin -> update -> read -> tick -> write -> hand over -+
//          ^                                                                  |
//          +------------------------------------------------------------------+
//
// - wait: until an absolute deadline, an anchor plus whole periods (schedule.h). A tick that begins a full
//   period or more late moves the anchor. No tick number is skipped, and no burst makes up for lost time.
// - begin: notes the lateness, shows the watchdog a sign of life and finds out whether the loop had
//   stalled.
// - update: takes at most one parameter update that waits for this tick (take_change).
// - read: one sample per hand. Faults that the loop found, and resets that a user asked for, become part
//   of the sample. So the recorded row has them, and a replay repeats them.
// - tick: computes commands and rows. It is a pure function of world, state, samples and tick number.
// - write: one command per hand, in the device's frame. A device that refuses has Fault::kDevice in the
//   next tick.
// - hand over: passes rows and state to the observers, which must not block.
//
// The vectors have their sizes before the first tick, and run() is noexcept. Requests of other threads
// come through RunControl.
//
// A stall. The watchdog is a second thread. When no tick has begun for too long, it stops the devices
// itself. The loop may then be in the middle of a tick, with a force ready to be written:
//
//     watchdog   -------- stop() ----------------------------------------------------------
//     loop       .. hangs .......... writes zero | next tick: kStalled, zero until the gate is at 0
//
// A stop before the writes replaces them by zero. A stop during the writes is repeated after them
// (write_commands), because the last call must leave no force. The next tick latches Fault::kStalled on
// every hand without another fault. Zero is written until the gate's own command is zero, so that the
// force does not jump back.
//
// A pause exists only in real time without a watchdog, which means that nobody holds a device. The devices
// are stopped, and the schedule starts again afterwards, so that no tick is late because of it. Offline
// the loop waits for nothing and writes no times into the rows: the same scene gives the same rows.
//
// However the loop ends, StopAtEnd stops every device.

#include "run/realtime/loop.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>
#include <stdexcept>
#include <thread>

#include "core/base/text.h"
#include "core/haptics/prepared_update.h"
#include "core/haptics/warm_up.h"
#include "io/system/clock.h"
#include "run/realtime/realtime.h"
#include "run/realtime/schedule.h"
#include "run/realtime/watchdog.h"

namespace palpate::realtime {
namespace {

bool is_zero(const haptics::ForceCommand& command) noexcept {
  return command.force.isZero(0.0) && command.torque.isZero(0.0) && command.gripper_force == 0.0;
}

/// Gap between two ticks that counts as a stall [ns]; 0: never.
std::int64_t stalled_after_ns(const LoopOptions& options, double rate_Hz) noexcept {
  if (options.offline || options.stalled_after_ns <= 0) return 0;
  return std::max(options.stalled_after_ns, static_cast<std::int64_t>(kStalledPeriods * 1e9 / rate_Hz));
}

/// Zero force on every device when a run ends, however it ends.
struct StopAtEnd {
  std::span<haptics::Device* const> devices;
  ~StopAtEnd() {
    for (haptics::Device* device : devices) device->stop();
  }
};

class Loop final {
 public:
  /// @param watchdog null: none
  Loop(const haptics::SimulationWorld& world, haptics::SimulationState& state,
       std::span<haptics::Device* const> devices, const std::vector<haptics::TickObserver*>& observers,
       const LoopOptions& options, Watchdog* watchdog, haptics::LoopReport& report)
      : world_(world),
        state_(state),
        devices_(devices),
        observers_(observers),
        options_(options),
        watchdog_(watchdog),
        stalled_after_ns_(stalled_after_ns(options, world.rate_Hz)),
        report_(report),
        wait_(options.thread.waiting, world.rate_Hz),
        samples_(devices.size()),
        commands_(devices.size()),
        rows_(devices.size()),
        refused_(devices.size(), 0),
        latched_(devices.size()) {}

  /// All ticks, on the calling thread; nothing is allocated from here on.
  void run() noexcept {
    const auto period = static_cast<std::int64_t>(1e9 / world_.rate_Hz);
    Schedule schedule(world_.rate_Hz, monotonic_ns() + period);
    for (std::uint64_t number = 0; number < options_.ticks; ++number) {
      if (pause_wanted()) {
        wait_through_pause();
        schedule = Schedule(world_.rate_Hz, monotonic_ns() + period);
      }
      if (stop_wanted()) break;
      if (!options_.offline) wait_.until(schedule.due());
      if (stop_wanted()) break;
      if (number == 0) start();
      const std::int64_t late = options_.offline ? 0 : begin_in_time(schedule, number);
      run_tick(number, late);
    }
    if (watchdog_ != nullptr) watchdog_->rest();
    report_.stopped_early = report_.ticks < options_.ticks;
  }

 private:
  /// Latched fault of a hand, from its rows.
  struct Latched {
    haptics::Fault fault = haptics::Fault::kNone;
    std::size_t entry = haptics::LoopReport::kMaxFaults;  // in report_.faults
  };

  void start() noexcept {
    const std::int64_t now = unix_ns();
    for (haptics::TickObserver* observer : observers_) observer->on_start(now);
  }

  [[nodiscard]] bool stop_wanted() const noexcept {
    return options_.control != nullptr && options_.control->stopping();
  }

  [[nodiscard]] bool pause_wanted() const noexcept {
    return options_.control != nullptr && watchdog_ == nullptr && !options_.offline &&
           options_.control->pausing();
  }

  /// Zero force on every device until the run resumes or ends. A pause makes no tick late.
  void wait_through_pause() noexcept {
    constexpr std::int64_t kLookEvery = 2'000'000;  // ns
    for (haptics::Device* device : devices_) device->stop();
    const std::int64_t from = monotonic_ns();
    while (pause_wanted() && !stop_wanted()) sleep_until_ns(monotonic_ns() + kLookEvery);
    const std::int64_t lasted = monotonic_ns() - from;
    ++report_.pauses;
    report_.paused_ns += lasted;
    last_begin_ += lasted;
  }

  /// Records the begin of a tick and detects a stall. @return lateness [ns].
  std::int64_t begin_in_time(Schedule& schedule, std::uint64_t number) noexcept {
    const std::int64_t now = monotonic_ns();
    if (watchdog_ != nullptr) watchdog_->beat(number, now);
    const Schedule::Begin begin = schedule.begin(now);
    report_.lateness.add(begin.late_ns);
    if (begin.missed) ++report_.missed_deadlines;
    const std::int64_t gap = number > 0 ? now - last_begin_ : 0;
    report_.longest_gap_ns = std::max(report_.longest_gap_ns, gap);
    last_begin_ = now;
    const bool stopped = stopped_meanwhile();
    stalled_ = stopped || (watchdog_ != nullptr && gap > stalled_after_ns_);
    if (stopped) {
      stops_known_ = watchdog_->stops();
      held_at_zero_ = true;
    }
    return begin.late_ns;
  }

  /// Whether the watchdog has stopped the devices since the last call.
  [[nodiscard]] bool stopped_meanwhile() const noexcept {
    return watchdog_ != nullptr && watchdog_->stops() != stops_known_;
  }

  void run_tick(std::uint64_t number, std::int64_t late) noexcept {
    // Offline, to read the thread's clock around each tick could take a third of the run.
    constexpr std::uint64_t kTimedOffline = 17;  // one tick in so many
    const bool timed = !options_.offline || number % kTimedOffline == 0;
    const std::int64_t before = timed ? thread_cpu_ns() : 0;
    const bool changed = take_change(number);
    read_samples(number, changed);
    haptics::tick(world_, state_, number, samples_, commands_, rows_);
    write_commands();
    const std::int64_t spent = timed ? thread_cpu_ns() - before : 0;
    if (timed) report_.tick_time.add(spent);
    hand_over(number, options_.offline ? 0 : spent, late);
  }

  /// Applies the oldest parameter update that waits for this tick. @return whether there was one
  bool take_change(std::uint64_t number) noexcept {
    haptics::ParameterUpdates* updates = options_.control == nullptr ? nullptr : options_.control->updates();
    const haptics::PreparedUpdate* change = updates == nullptr ? nullptr : updates->waiting(number);
    if (change == nullptr) return false;
    haptics::apply_update(world_, state_, *change);
    haptics::ParameterUpdate noted = change->values;
    noted.tick = number;
    updates->taken();
    for (haptics::TickObserver* observer : observers_) observer->on_update(noted);
    return true;
  }

  /// Reads one sample per hand and adds faults found by the loop and resets asked for by the user. The row
  /// records them, so that a replay repeats them.
  void read_samples(std::uint64_t number, bool changed) noexcept {
    const double time = static_cast<double>(number) / world_.rate_Hz;
    const std::uint32_t resets = options_.control == nullptr ? 0 : options_.control->take_resets();
    for (std::size_t hand = 0; hand < devices_.size(); ++hand) {
      haptics::DeviceState& sample = samples_[hand];
      sample = devices_[hand]->read(number, time);
      sample.events =
          (sample.events & ~haptics::kParameterUpdated) | (changed ? haptics::kParameterUpdated : 0U);
      if (refused_[hand] != 0) sample.fault = haptics::Fault::kDevice;
      if (stalled_ && sample.fault == haptics::Fault::kNone) sample.fault = haptics::Fault::kStalled;
      if (((resets >> hand) & 1U) != 0) sample.events |= haptics::kResetFault;
    }
  }

  void write_commands() noexcept {
    const bool zero = held_at_zero_ || stopped_meanwhile();
    for (std::size_t hand = 0; hand < devices_.size(); ++hand) {
      const haptics::ForceCommand command_D =
          zero ? haptics::ForceCommand{} : world_.mappings[hand].to_device(commands_[hand]);
      refused_[hand] = devices_[hand]->write(command_D) ? 0 : 1;
    }
    if (held_at_zero_ && std::all_of(commands_.begin(), commands_.end(), is_zero)) held_at_zero_ = false;
    // A stop during these writes must prevail; the next tick latches the fault.
    if (!zero && stopped_meanwhile()) {
      for (haptics::Device* device : devices_) device->stop();
    }
  }

  /// Passes the rows and the finished tick to the observers.
  void hand_over(std::uint64_t number, std::int64_t spent, std::int64_t late) noexcept {
    for (haptics::TickRow& row : rows_) {
      row.tick_ns = spent;
      row.late_ns = late;
      for (haptics::TickObserver* observer : observers_) observer->on_row(row);
      follow_fault(row);
    }
    report_.ticks = number + 1;
    const haptics::TickState now{state_, commands_, number, options_.offline ? 0 : last_begin_};
    for (haptics::TickObserver* observer : observers_) observer->on_tick(now);
  }

  /// Records when a fault is latched or cleared. A fault that persists in the tick of its reset is latched
  /// again.
  void follow_fault(const haptics::TickRow& row) noexcept {
    Latched& latched = latched_[row.hand];
    const auto fault = static_cast<haptics::Fault>(row.fault);
    const bool reset = (row.events & haptics::kResetFault) != 0;
    if (fault == latched.fault && (fault == haptics::Fault::kNone || !reset)) return;
    if (latched.entry < report_.faults.size()) report_.faults[latched.entry].reset_tick = row.tick;
    latched = {fault, haptics::LoopReport::kMaxFaults};
    if (fault == haptics::Fault::kNone) return;
    if (report_.fault == haptics::Fault::kNone) report_.fault = fault;
    const haptics::FaultSeen seen{row.tick, row.hand, fault};
    for (haptics::TickObserver* observer : observers_) observer->on_fault(seen);
    if (report_.faults.size() == haptics::LoopReport::kMaxFaults) {
      ++report_.further_faults;
      return;
    }
    latched.entry = report_.faults.size();
    report_.faults.push_back(seen);  // capacity is reserved
  }

  const haptics::SimulationWorld& world_;
  haptics::SimulationState& state_;
  std::span<haptics::Device* const> devices_;
  const std::vector<haptics::TickObserver*>& observers_;
  const LoopOptions& options_;
  Watchdog* watchdog_;
  std::int64_t stalled_after_ns_;
  haptics::LoopReport& report_;
  TickWait wait_;
  std::vector<haptics::DeviceState> samples_;
  std::vector<haptics::ForceCommand> commands_;
  std::vector<haptics::TickRow> rows_;
  std::vector<char> refused_;     // per hand: the last command was refused
  std::vector<Latched> latched_;  // of each hand
  std::int64_t last_begin_ = 0;
  std::uint64_t stops_known_ = 0;  // stops by the watchdog that were handled
  bool stalled_ = false;           // this tick began after a stall
  bool held_at_zero_ = false;      // from a stop by the watchdog until the gate's command is zero
};

void check_core(const LoopOptions& options) {
  if (!options.thread.core) return;
  const std::vector<int> cores = usable_cores();
  if (std::find(cores.begin(), cores.end(), *options.thread.core) == cores.end()) {
    throw std::invalid_argument("run_loop: core " + std::to_string(*options.thread.core) + " cannot be used");
  }
}

/// Real-time settings that the loop's thread requests before its first tick.
void prepare_thread(const LoopOptions& options, haptics::LoopReport& report) {
  if (options.thread.core && !pin_to_core(*options.thread.core)) {
    report.remarks.push_back("the loop was not pinned to core " + std::to_string(*options.thread.core));
  }
  if (options.offline) return;
  const std::optional<std::string> refusal = request_priority(Urgency::kLoop);
  report.realtime_priority = !refusal;
  if (refusal) report.remarks.push_back(*refusal);
  prefault_stack();
}

std::string milliseconds(std::int64_t ns) { return shortest(std::round(static_cast<double>(ns) * 1e-6)); }

/// "the watchdog stopped the devices 2 times, as no tick had begun for 20 ms: after tick 12, after tick 90".
std::string describe_stops(std::uint64_t number, const std::vector<haptics::WatchdogStop>& stops,
                           std::int64_t stalled_after) {
  constexpr std::size_t kMaxListed = 5;
  std::string text = "the watchdog stopped the devices " +
                     (number == 1 ? std::string("once") : std::to_string(number) + " times") +
                     ", as no tick had begun for " + milliseconds(stalled_after) + " ms:";
  for (std::size_t i = 0; i < std::min(kMaxListed, stops.size()); ++i) {
    const std::int64_t after_ms = stops[i].after_ns / 1'000'000;
    text += std::string(i == 0 ? "" : ",") + " after tick " + std::to_string(stops[i].tick) + " (" +
            shortest(static_cast<double>(after_ms) / 1e3) + " s)";
  }
  if (number > kMaxListed) text += " and " + std::to_string(number - kMaxListed) + " more";
  return text;
}

}  // namespace

std::int64_t stall_limit_ns(const haptics::SimulationWorld& world) noexcept {
  const bool held = std::any_of(world.mappings.begin(), world.mappings.end(),
                                [](const haptics::WorkspaceMapping& mapping) { return mapping.held; });
  return held ? LoopOptions{}.stalled_after_ns : 0;
}

haptics::LoopReport run_loop(const haptics::SimulationWorld& world, haptics::SimulationState& state,
                             std::span<haptics::Device* const> devices,
                             const std::vector<haptics::TickObserver*>& observers,
                             const LoopOptions& options) {
  const StopAtEnd stop_at_end{devices};
  if (devices.size() != world.hands()) {
    throw std::invalid_argument("run_loop: " + std::to_string(devices.size()) + " devices for " +
                                std::to_string(world.hands()) + " hands");
  }
  check_core(options);
  haptics::LoopReport report;
  report.polled = !options.offline && options.thread.waiting == haptics::Waiting::kPoll;
  if (report.polled && usable_cores().size() == 1) {
    report.remarks.emplace_back(
        "the loop polled on the only core that this program may use: all else had to wait");
  }
  report.faults.reserve(haptics::LoopReport::kMaxFaults);
  std::optional<MemoryLock> memory;
  std::optional<Watchdog> watchdog;
  if (!options.offline) report.memory_locked = memory.emplace(report.remarks).granted();
  const std::int64_t stalled_after = stalled_after_ns(options, world.rate_Hz);
  if (stalled_after > 0) watchdog.emplace(devices, stalled_after);
  Loop loop(world, state, devices, observers, options, watchdog ? &*watchdog : nullptr, report);

  std::exception_ptr failure;
  std::optional<BlockedSignals> signals(std::in_place);
  std::thread thread([&] {
    try {
      prepare_thread(options, report);
      if (!options.offline) haptics::warm_up(world, state);
      loop.run();
    } catch (...) {
      failure = std::current_exception();
    }
  });
  signals.reset();
  thread.join();
  if (failure) std::rethrow_exception(failure);
  if (watchdog) {
    report.stops = watchdog->finish();
    report.watchdog_stops = watchdog->stops();
  }
  if (report.pauses > 0) report.remarks.push_back(describe_pauses(report.pauses, report.paused_ns));
  if (report.watchdog_stops > 0) {
    report.remarks.push_back(describe_stops(report.watchdog_stops, report.stops, stalled_after));
  }
  return report;
}

std::string describe_pauses(std::uint64_t pauses, std::int64_t paused_ns) {
  const std::string times = pauses == 1 ? "once" : std::to_string(pauses) + " times";
  const double tenths = std::round(static_cast<double>(paused_ns) * 1e-8);
  const std::string time = tenths < 1.0 ? "less than 0.1 s" : shortest(tenths / 10.0) + " s";
  return "the run was paused " + times + ", for " + time + "; its times leave that out";
}

}  // namespace palpate::realtime
