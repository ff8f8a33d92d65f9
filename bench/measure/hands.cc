#include "bench/measure/hands.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/spsc_queue.h"
#include "palpate/scripted_device.h"
#include "run/realtime/realtime.h"
#include "run/realtime/schedule.h"

#include "bench/measure/bench_scene.h"
#include "bench/measure/one_hand.h"
#include "bench/measure/ticks.h"

namespace palpate::bench {
namespace {

constexpr std::uint64_t kWarmUp = 50;     // periods that are not counted
constexpr std::size_t kGaugedHands = 20;  // their median period bounds the search
constexpr std::uint64_t kGaugedPeriods = 500;
constexpr double kFirstTry = 0.75;        // of that bound
constexpr std::size_t kPeriodsKept = 64;  // capacity of the ring, in periods
constexpr std::size_t kHandsForMemory = 64;

/// Ticks of the path with contact, [first, last].
struct Window {
  std::uint64_t first = 0;
  std::uint64_t last = 0;

  /// Tick of the path at step `step`, going back and forth.
  [[nodiscard]] std::uint64_t at(std::uint64_t step) const noexcept {
    const std::uint64_t length = last - first;
    const std::uint64_t place = step % (2 * length);
    return first + (place <= length ? place : 2 * length - place);
  }
};

Window contact_window(const std::vector<PathPoint>& way) {
  const auto touches = [](const PathPoint& at) { return at.phase != contact::Phase::kApproach; };
  const auto first = std::find_if(way.begin(), way.end(), touches);
  const auto end = std::find_if_not(first, way.end(), touches);
  if (end - first < 2) throw std::runtime_error("bench: the hands never came into contact");
  return {static_cast<std::uint64_t>(first - way.begin()), static_cast<std::uint64_t>(end - way.begin()) - 1};
}

/// One of many hands, at some tick of the path.
class Hand final {
 public:
  /// [setup] Follows the path to its first contact.
  Hand(const haptics::SimulationWorld& world, const Window& window, haptics::Device& device)
      : window_(window), hand_(world) {
    for (std::uint64_t number = 0; number < window.first; ++number) hand_.tick(device, number);
  }

  /// [setup] Advances to step `offset` of the window, which becomes its start.
  void go_to(haptics::Device& device, std::uint64_t offset) {
    while (offset_ < offset) hand_.tick(device, window_.at(offset_++));
  }

  /// [rt]
  const haptics::TickRow& go_on(haptics::Device& device, std::uint64_t step) noexcept {
    return hand_.tick(device, window_.at(offset_ + step));
  }

 private:
  Window window_;
  std::uint64_t offset_ = 0;
  OneHand hand_;
};

/// Hands distributed evenly over the window: one hand advances and is copied at each start.
std::vector<Hand> make_hands(const haptics::SimulationWorld& world, const Window& window,
                             const scene::ToolPath& path, std::size_t count) {
  devices::ScriptedDevice device(path);
  Hand walker(world, window, device);
  std::vector<Hand> hands;
  hands.reserve(count);
  const std::uint64_t length = 2 * (window.last - window.first);
  for (std::size_t i = 0; i < count; ++i) {
    walker.go_to(device, i * length / count);
    hands.push_back(walker);
  }
  return hands;
}

/// A thread that consumes the rows of one thread's hands, like a recorder's thread.
class RowTaker final {
 public:
  explicit RowTaker(std::size_t hands) : ring_(hands * kPeriodsKept), thread_([this] { run(); }) {}
  ~RowTaker() {
    done_.store(true, std::memory_order_release);
    thread_.join();
  }
  RowTaker(const RowTaker&) = delete;
  RowTaker& operator=(const RowTaker&) = delete;
  void put(const haptics::TickRow& row) noexcept { lost_ += ring_.push(row) ? 0 : 1; }
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

 private:
  void run() {
    haptics::TickRow row;
    while (!done_.load(std::memory_order_acquire)) {
      while (ring_.pop(row)) {
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  SpscQueue<haptics::TickRow> ring_;
  std::uint64_t lost_ = 0;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

/// Times of one thread's periods.
struct Rounds {
  std::vector<double> times_us;  // CPU time
  std::vector<double> wall_us;
  std::uint64_t missed = 0;
  std::uint64_t lost = 0;
};

double limit_us() { return kPeriodShare * 1e6 / kHandsRate; }

/// The same number of hands on every core at once, as far as the number divides evenly.
class ParallelHands final {
 public:
  ParallelHands(const haptics::SimulationWorld& world, const Window& window, const scene::ToolPath& path,
                haptics::Waiting waiting)
      : world_(world), window_(window), path_(path), waiting_(waiting), cores_(realtime::usable_cores()) {
    if (cores_.empty()) cores_.push_back(-1);  // cores unknown: one thread without affinity
  }

  [[nodiscard]] std::size_t cores() const noexcept { return cores_.size(); }

  /// @param give_up ends the run once a thread exceeds the limit too often
  HandsRun run(std::size_t hands, std::uint64_t periods, bool give_up) {
    stop_.store(false, std::memory_order_relaxed);
    const std::size_t threads = std::min(cores_.size(), hands);
    std::vector<Rounds> rounds(threads);
    std::vector<std::thread> running;
    for (std::size_t t = 0; t < threads; ++t) {
      const std::size_t mine = hands / threads + (t < hands % threads ? 1 : 0);
      running.emplace_back(
          [this, t, mine, periods, give_up, &rounds] { rounds[t] = go(cores_[t], mine, periods, give_up); });
    }
    for (std::thread& thread : running) thread.join();
    return run_of(hands, rounds);
  }

  /// Whether the last run ended early.
  [[nodiscard]] bool gave_up() const noexcept { return stop_.load(std::memory_order_relaxed); }

 private:
  /// Runs all hands once a period on the calling thread, in real time.
  Rounds go(int core, std::size_t count, std::uint64_t periods, bool give_up) {
    std::vector<Hand> hands = make_hands(world_, window_, path_, count);
    devices::ScriptedDevice device(path_);
    RowTaker taker(hands.size());  // started first, so that it does not inherit this thread's priority and
                                   // core
    (void)realtime::pin_to_core(core);
    (void)realtime::request_priority(realtime::Urgency::kLoop);
    Rounds rounds;
    rounds.times_us.reserve(periods);
    rounds.wall_us.reserve(periods);
    std::uint64_t over = 0;
    realtime::TickWait wait(waiting_, kHandsRate);
    realtime::Schedule schedule(kHandsRate, monotonic_ns() + 1'000'000);
    for (std::uint64_t step = 0; step < kWarmUp + periods && !gave_up(); ++step) {
      wait.until(schedule.due());
      const std::int64_t woken = monotonic_ns();
      const bool missed = schedule.begin(woken).missed;
      const std::int64_t begun = thread_cpu_ns();
      for (Hand& hand : hands) taker.put(hand.go_on(device, step));
      const std::int64_t spent = thread_cpu_ns() - begun;
      if (step < kWarmUp) continue;
      rounds.times_us.push_back(static_cast<double>(spent) / kNanosecondsPerMicrosecond);
      rounds.wall_us.push_back(static_cast<double>(monotonic_ns() - woken) / kNanosecondsPerMicrosecond);
      if (missed) ++rounds.missed;
      if (rounds.times_us.back() > limit_us() && ++over > kPeriodsExceeded && give_up) stop_ = true;
    }
    rounds.lost = taker.lost();
    return rounds;
  }

  static HandsRun run_of(std::size_t hands, const std::vector<Rounds>& rounds) {
    HandsRun run;
    run.hands = hands;
    run.threads = rounds.size();
    std::vector<double> times_us;
    std::vector<double> wall_us;
    for (const Rounds& each : rounds) {
      times_us.insert(times_us.end(), each.times_us.begin(), each.times_us.end());
      wall_us.insert(wall_us.end(), each.wall_us.begin(), each.wall_us.end());
      run.missed += each.missed;
      run.lost += each.lost;
      run.worst_p999_us = std::max(run.worst_p999_us, figures_of(each.times_us).p999_us);
    }
    run.periods = times_us.size();
    run.round = figures_of(std::move(times_us));
    run.wall = figures_of(std::move(wall_us));
    return run;
  }

  const haptics::SimulationWorld& world_;
  const Window& window_;
  const scene::ToolPath& path_;
  haptics::Waiting waiting_;
  std::vector<int> cores_;
  std::atomic<bool> stop_{false};
};

double bytes_per_hand(const haptics::SimulationWorld& world, const Window& window,
                      const scene::ToolPath& path) {
  const std::size_t before = bytes_in_use();
  const std::vector<Hand> hands = make_hands(world, window, path, kHandsForMemory);
  const std::size_t after = bytes_in_use();
  return after > before ? static_cast<double>(after - before) / static_cast<double>(kHandsForMemory) : 0.0;
}

}  // namespace

std::size_t greatest_that_fits(std::size_t first, std::size_t too_many,
                               const std::function<bool(std::size_t)>& fits) {
  std::size_t most = 0;
  std::size_t tried = first;
  while (most + 1 < too_many) {
    tried = std::clamp(tried, most + 1, too_many - 1);
    (fits(tried) ? most : too_many) = tried;
    tried = (most + too_many) / 2;
  }
  return most;
}

HandsAccount hand_capacity(const scene::Scene& scene, const haptics::SimulationWorld& world,
                           const scene::ToolPath& path, haptics::Waiting waiting, const Watch& watch) {
  const Window window = contact_window(run_path(scene, world, path));
  HandsAccount account;
  account.bytes_per_hand = bytes_per_hand(world, window, path);
  ParallelHands parallel(world, window, path, waiting);
  const std::string where = " hands on each of " + std::to_string(parallel.cores()) + " cores";
  const HandsRun gauged = parallel.run(kGaugedHands * parallel.cores(), kGaugedPeriods, false);
  // With more hands even the median period exceeds the limit.
  const double bound = std::min(limit_us() / gauged.round.p50_us * static_cast<double>(kGaugedHands),
                                static_cast<double>(kMaxHandsTried));
  const auto too_many = static_cast<std::size_t>(bound) + 1;
  const double halvings = std::log2(bound + 1.0) + 1.0;
  double done = 0.0;
  const auto fits = [&](std::size_t count) {
    watch(std::min(1.0, done / halvings), std::to_string(count) + where);
    done += 1.0;
    for (int turn = 0; turn < 2; ++turn) {  // a second try, because other load may have disturbed the first
      const HandsRun run = parallel.run(count * parallel.cores(), kPeriodsHeld, true);
      if (parallel.gave_up()) continue;
      account.most = run;
      return true;
    }
    return false;
  };
  account.hands_per_core = greatest_that_fits(static_cast<std::size_t>(kFirstTry * bound), too_many, fits);
  return account;
}

HandsRun run_hands(const scene::Scene& scene, const haptics::SimulationWorld& world,
                   const scene::ToolPath& path, haptics::Waiting waiting, std::size_t hands,
                   std::uint64_t periods) {
  if (hands == 0) throw std::invalid_argument("bench: 0 hands: must be at least 1");
  const Window window = contact_window(run_path(scene, world, path));
  return ParallelHands(world, window, path, waiting).run(hands, periods, false);
}

}  // namespace palpate::bench
