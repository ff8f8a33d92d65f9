#include "palpate/haptics/loop.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <stdexcept>
#include <thread>

#include "palpate/base/clock.h"
#include "palpate/haptics/realtime.h"
#include "palpate/haptics/schedule.h"

namespace palpate::haptics {
namespace {

/// Zero force on every device when a run ends, however it ends.
struct StopAtEnd {
  std::span<Device* const> devices;
  ~StopAtEnd() {
    for (Device* device : devices) device->stop();
  }
};

class Loop final {
 public:
  Loop(const SimulationWorld& world, SimulationState& state, std::span<Device* const> devices, TickSink* sink,
       const LoopOptions& options, LoopReport& report)
      : world_(world),
        state_(state),
        devices_(devices),
        sink_(sink),
        options_(options),
        report_(report),
        samples_(devices.size()),
        commands_(devices.size()),
        rows_(devices.size()),
        refused_(devices.size(), 0) {}

  /// All ticks, on the calling thread; nothing is allocated from here on.
  void run() noexcept {
    const auto period = static_cast<std::int64_t>(1e9 / world_.rate_Hz);
    Schedule schedule(world_.rate_Hz, monotonic_ns() + period);
    for (std::uint64_t number = 0; number < options_.ticks; ++number) {
      if (stop_wanted()) break;
      if (!options_.offline) sleep_until_ns(schedule.due());
      if (stop_wanted()) break;
      if (number == 0 && sink_ != nullptr) sink_->begin(unix_ns());
      const std::int64_t late = options_.offline ? 0 : begin_in_time(schedule, number);
      run_tick(number, late);
    }
    report_.stopped_early = report_.ticks < options_.ticks;
  }

 private:
  [[nodiscard]] bool stop_wanted() const noexcept {
    return options_.stop != nullptr && options_.stop->load(std::memory_order_relaxed);
  }

  /// Accounts for when a tick begins. @return how late it is [ns].
  std::int64_t begin_in_time(Schedule& schedule, std::uint64_t number) noexcept {
    const std::int64_t now = monotonic_ns();
    const Schedule::Begin begin = schedule.begin(now);
    report_.lateness.add(begin.late_ns);
    if (begin.missed) ++report_.missed_deadlines;
    if (number > 0) report_.longest_gap_ns = std::max(report_.longest_gap_ns, now - last_begin_);
    last_begin_ = now;
    return begin.late_ns;
  }

  void run_tick(std::uint64_t number, std::int64_t late) noexcept {
    const double time = static_cast<double>(number) / world_.rate_Hz;
    const std::int64_t before = thread_cpu_ns();
    for (std::size_t hand = 0; hand < devices_.size(); ++hand) {
      samples_[hand] = devices_[hand]->read(number, time);
      if (refused_[hand] != 0) samples_[hand].fault = Fault::kDevice;
    }
    tick(world_, state_, number, samples_, commands_, rows_);
    for (std::size_t hand = 0; hand < devices_.size(); ++hand) {
      refused_[hand] = devices_[hand]->write(commands_[hand]) ? 0 : 1;
    }
    const std::int64_t spent = thread_cpu_ns() - before;
    report_.tick_time.add(spent);
    hand_over(number, options_.offline ? 0 : spent, late);
  }

  /// Rows to the sink, the newest state to the picture, the count to whoever shows progress.
  void hand_over(std::uint64_t number, std::int64_t spent, std::int64_t late) noexcept {
    for (TickRow& row : rows_) {
      row.tick_ns = spent;
      row.late_ns = late;
      if (report_.fault == Fault::kNone) report_.fault = static_cast<Fault>(row.fault);
      if (sink_ != nullptr) sink_->put(row);
    }
    report_.ticks = number + 1;
    if (options_.snapshots != nullptr) publish(number);
    if (options_.progress != nullptr) options_.progress->store(number + 1, std::memory_order_relaxed);
  }

  void publish(std::uint64_t number) noexcept {
    Snapshot& snapshot = options_.snapshots->writable();
    const std::size_t hands = std::min(devices_.size(), Snapshot::kMaxHands);
    snapshot.tick = number;
    snapshot.taken_ns = options_.offline ? 0 : last_begin_;
    snapshot.organ_W = state_.organ_W;
    snapshot.hands = static_cast<std::uint32_t>(hands);
    std::copy_n(state_.inputs.begin(), hands, snapshot.tools.begin());
    std::copy_n(state_.results.begin(), hands, snapshot.results.begin());
    std::copy_n(commands_.begin(), hands, snapshot.commands.begin());
    options_.snapshots->publish();
  }

  const SimulationWorld& world_;
  SimulationState& state_;
  std::span<Device* const> devices_;
  TickSink* sink_;
  const LoopOptions& options_;
  LoopReport& report_;
  std::vector<DeviceState> samples_;
  std::vector<ForceCommand> commands_;
  std::vector<TickRow> rows_;
  std::vector<char> refused_;  // a hand's last command was
  std::int64_t last_begin_ = 0;
};

}  // namespace

LoopReport run_loop(const SimulationWorld& world, SimulationState& state, std::span<Device* const> devices,
                    TickSink* sink, const LoopOptions& options) {
  const StopAtEnd stop_at_end{devices};
  if (devices.size() != world.hands()) {
    throw std::invalid_argument("run_loop: " + std::to_string(devices.size()) + " devices for " +
                                std::to_string(world.hands()) + " hands");
  }
  LoopReport report;
  Loop loop(world, state, devices, sink, options, report);
  std::optional<MemoryLock> memory;
  if (!options.offline) report.memory_locked = memory.emplace(report.remarks).granted();

  std::exception_ptr failure;
  std::optional<SignalsHeld> signals(std::in_place);
  std::thread thread([&] {
    try {
      if (!options.offline) {
        report.realtime_priority = ask_for_priority(report.remarks);
        touch_stack();
      }
      loop.run();
    } catch (...) {
      failure = std::current_exception();
    }
  });
  signals.reset();
  thread.join();
  if (failure) std::rethrow_exception(failure);
  return report;
}

}  // namespace palpate::haptics
