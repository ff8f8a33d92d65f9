#include "bench/measure/hands.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <vector>

#include "palpate/base/fetch_list.h"
#include "palpate/base/ring.h"
#include "palpate/devices/scripted.h"
#include "palpate/haptics/realtime.h"
#include "palpate/haptics/schedule.h"
#include "palpate/haptics/simulation.h"

#include "bench/measure/preparation.h"
#include "bench/measure/ticks.h"

namespace palpate::bench {
namespace {

constexpr std::uint64_t kPeriods = 3000;  // of one trial: three seconds
constexpr std::uint64_t kWarmUp = 50;     // of them, not counted
constexpr std::size_t kFirstTry = 20;
constexpr std::size_t kMostHands = 4000;
constexpr int kTries = 7;
constexpr std::size_t kHandsForMemory = 64;

/// The ticks of the way in which the tool is in contact, [first, last].
struct Window {
  std::uint64_t first = 0;
  std::uint64_t last = 0;

  /// There and back, for ever: the tick of the way at step `step`.
  [[nodiscard]] std::uint64_t at(std::uint64_t step) const noexcept {
    const std::uint64_t length = last - first;
    const std::uint64_t place = step % (2 * length);
    return first + (place <= length ? place : 2 * length - place);
  }
};

Window contact_window(const std::vector<WayPoint>& way) {
  const auto touches = [](const WayPoint& at) { return at.phase != contact::Phase::kApproach; };
  const auto first = std::find_if(way.begin(), way.end(), touches);
  const auto end = std::find_if_not(first, way.end(), touches);
  if (end - first < 2) throw std::runtime_error("bench: the hands never came into contact");
  return {static_cast<std::uint64_t>(first - way.begin()), static_cast<std::uint64_t>(end - way.begin()) - 1};
}

/// What goes into a tick and comes out of it: the hands of a thread take turns with one.
struct Exchange {
  std::array<haptics::DeviceState, 1> samples{};
  std::array<haptics::ForceCommand, 1> commands{};
  std::array<haptics::TickRow, 1> rows{};
};

/// One of many: its own state, somewhere on the way.
class Hand final {
 public:
  Hand(const haptics::SimulationWorld& world, const Window& window, std::uint64_t offset)
      : world_(&world), window_(window), offset_(offset), state_(world) {}

  /// Follows the way from its begin to where this hand shall be. [setup]
  void approach(haptics::Device& device, Exchange& exchange) {
    for (std::uint64_t way = 0; way < window_.first; ++way) tick(device, way, exchange);
    for (std::uint64_t step = 0; step < offset_; ++step) tick(device, window_.at(step), exchange);
    list_ = haptics::memory_of(state_);
  }

  /// [rt] Its turn is next.
  void expect() const noexcept { list_.fetch(); }

  /// [rt]
  const haptics::TickRow& go_on(haptics::Device& device, std::uint64_t step, Exchange& exchange) noexcept {
    return tick(device, window_.at(offset_ + step), exchange);
  }

 private:
  const haptics::TickRow& tick(haptics::Device& device, std::uint64_t way, Exchange& exchange) noexcept {
    exchange.samples[0] = device.read(way, static_cast<double>(way) / world_->rate_Hz);
    haptics::tick(*world_, state_, number_++, exchange.samples, exchange.commands, exchange.rows);
    return exchange.rows[0];
  }

  const haptics::SimulationWorld* world_;
  Window window_;
  std::uint64_t offset_;
  std::uint64_t number_ = 0;
  haptics::SimulationState state_;
  FetchList list_;
};

std::vector<Hand> make_hands(const haptics::SimulationWorld& world, const Window& window, std::size_t count) {
  std::vector<Hand> hands;
  hands.reserve(count);
  const std::uint64_t length = 2 * (window.last - window.first);
  for (std::size_t i = 0; i < count; ++i) hands.emplace_back(world, window, i * length / count);
  return hands;
}

/// What takes the rows of one thread's hands, as a recorder's thread does.
class RowTaker final {
 public:
  explicit RowTaker(std::size_t hands) : ring_(hands * 256), thread_([this] { run(); }) {}
  ~RowTaker() {
    done_.store(true, std::memory_order_release);
    thread_.join();
  }
  RowTaker(const RowTaker&) = delete;
  RowTaker& operator=(const RowTaker&) = delete;
  void put(const haptics::TickRow& row) noexcept { static_cast<void>(ring_.push(row)); }

 private:
  void run() {
    haptics::TickRow row;
    while (!done_.load(std::memory_order_acquire)) {
      while (ring_.pop(row)) {
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  Ring<haptics::TickRow> ring_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

struct Rounds {
  std::vector<double> times_us;
  std::uint64_t missed = 0;
};

/// All hands once a period, on the calling thread, in real time.
Rounds run_rounds(std::vector<Hand>& hands, const scene::ToolPath& path) {
  devices::ScriptedDevice device(path);
  Exchange exchange;
  for (Hand& hand : hands) hand.approach(device, exchange);
  RowTaker taker(hands.size());
  (void)haptics::ask_for_priority(haptics::Urgency::kLoop);
  Rounds rounds;
  rounds.times_us.reserve(kPeriods);
  haptics::Schedule schedule(kHandsRate, monotonic_ns() + 1'000'000);
  for (std::uint64_t step = 0; step < kWarmUp + kPeriods; ++step) {
    sleep_until_ns(schedule.due());
    const bool missed = schedule.begin(monotonic_ns()).missed;
    const std::int64_t begun = thread_cpu_ns();
    for (std::size_t i = 0; i < hands.size(); ++i) {
      if (i + 1 < hands.size()) hands[i + 1].expect();
      taker.put(hands[i].go_on(device, step, exchange));
    }
    const std::int64_t spent = thread_cpu_ns() - begun;
    if (step < kWarmUp) continue;
    rounds.times_us.push_back(static_cast<double>(spent) / kNanosecondsPerMicrosecond);
    if (missed) ++rounds.missed;
  }
  return rounds;
}

double limit_us() { return kPeriodShare * 1e6 / kHandsRate; }

/// p99.9 of one period's work for so many hands [us], on a thread of its own.
double try_hands(const haptics::SimulationWorld& world, const Window& window, const scene::ToolPath& path,
                 std::size_t count) {
  Rounds rounds;
  std::thread thread([&] {
    std::vector<Hand> hands = make_hands(world, window, count);
    rounds = run_rounds(hands, path);
  });
  thread.join();
  return figures_of(std::move(rounds.times_us)).p999_us;
}

double bytes_per_hand(const haptics::SimulationWorld& world, const Window& window) {
  const std::size_t before = bytes_in_use();
  const std::vector<Hand> hands = make_hands(world, window, kHandsForMemory);
  const std::size_t after = bytes_in_use();
  return after > before ? static_cast<double>(after - before) / static_cast<double>(kHandsForMemory) : 0.0;
}

}  // namespace

std::size_t next_hands(std::size_t hands, double p999_us, double limit_us) noexcept {
  const double count = static_cast<double>(hands);
  const double scaled = std::floor(p999_us > 0.0 ? count * limit_us / p999_us : count);
  const double bounded = std::min(scaled, static_cast<double>(kMostHands));
  if (p999_us <= limit_us) return std::max(hands + 1, static_cast<std::size_t>(bounded));
  return std::max<std::size_t>(1, std::min(hands - 1, static_cast<std::size_t>(bounded)));
}

HandsAccount most_hands(const scene::Setup& setup, const haptics::SimulationWorld& world,
                        const scene::ToolPath& path, const Watch& watch) {
  const Window window = contact_window(walk(setup, world, path));
  HandsAccount account;
  account.bytes_per_hand = bytes_per_hand(world, window);
  std::size_t count = kFirstTry;
  std::size_t fits = 0;
  std::size_t too_many = kMostHands + 1;
  for (int i = 0; i < kTries && fits + 1 < too_many; ++i) {
    watch(static_cast<double>(i) / kTries, std::to_string(count) + " hands on one core");
    double p999_us = try_hands(world, window, path, count);
    // Once more where something else on the machine may have been in the way.
    if (p999_us > limit_us()) p999_us = std::min(p999_us, try_hands(world, window, path, count));
    if (p999_us <= limit_us()) {
      fits = std::max(fits, count);
    } else {
      too_many = std::min(too_many, count);
    }
    count = next_hands(count, p999_us, limit_us());
    if (count <= fits || count >= too_many) count = (fits + too_many) / 2;
  }
  account.hands_per_core = fits;
  return account;
}

void run_hands(const scene::Setup& setup, const haptics::SimulationWorld& world, const scene::ToolPath& path,
               std::size_t hands, HandsAccount& account) {
  const Window window = contact_window(walk(setup, world, path));
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t threads = std::min(cores, hands);
  std::vector<Rounds> rounds(threads);
  std::vector<std::thread> running;
  for (std::size_t t = 0; t < threads; ++t) {
    const std::size_t mine = hands / threads + (t < hands % threads ? 1 : 0);
    running.emplace_back([&world, &window, &path, mine, &result = rounds[t]] {
      std::vector<Hand> own = make_hands(world, window, mine);
      result = run_rounds(own, path);
    });
  }
  for (std::thread& thread : running) thread.join();
  std::vector<double> times_us;
  for (const Rounds& each : rounds) {
    times_us.insert(times_us.end(), each.times_us.begin(), each.times_us.end());
    account.missed += each.missed;
  }
  account.hands = hands;
  account.threads = threads;
  account.periods = times_us.size();
  account.round = figures_of(std::move(times_us));
}

}  // namespace palpate::bench
