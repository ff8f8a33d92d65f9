#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/spsc_queue.h"
#include "palpate/tick_observer.h"
#include "palpate/tool.h"
#include "run/ros/ros_node.h"

namespace palpate::ros {

/// [setup] Names of the jaws of a hand's tool, "hand0_jaw1"; empty: it has none.
[[nodiscard]] std::vector<std::string> joint_names(const geometry::Tool& tool, std::size_t hand);

/// What was published in a run.
struct PublisherStatistics {
  std::uint64_t messages = 0;
  std::uint64_t failed = 0;   // messages that CycloneDDS refused
  std::uint64_t skipped = 0;  // ticks that were due while the queue was full
};

/// Publishes a run to ROS 2 from its own thread: pose, wrench and joint states of each hand at a fixed rate,
/// and its fault when it changes and once per second. The loop puts the ticks that are due into a queue and
/// never waits.
class RosPublisher final : public haptics::TickObserver {
 public:
  static constexpr double kFastestRate = 1000.0;  // Hz
  static constexpr std::size_t kQueued = 256;     // ticks

  /// [setup] Advertises the topics and starts the thread. @param rate_Hz of the loop @param publish_Hz at
  /// most this many ticks per second are published @throws std::runtime_error
  RosPublisher(Node& node, const std::vector<geometry::Tool>& tools, double rate_Hz, double publish_Hz);
  ~RosPublisher() override;
  RosPublisher(const RosPublisher&) = delete;
  RosPublisher& operator=(const RosPublisher&) = delete;

  /// [rt]
  void on_row(const haptics::TickRow& row) noexcept override;
  /// [rt]
  void on_tick(const haptics::TickState& now) noexcept override;

  /// [setup] Publishes the ticks that are still queued and ends the thread. Call it after the run.
  PublisherStatistics finish();
  /// [any] Every how many ticks one is published.
  [[nodiscard]] std::uint64_t every() const noexcept { return every_; }

 private:
  /// One hand's part of a row.
  struct QueuedHand {
    Pose pose;
    Vec3 force = Vec3::Zero();
    Vec3 torque = Vec3::Zero();
    double gripper = 0.0;
    std::uint32_t fault = 0;
  };
  struct QueuedTick {
    std::int64_t taken_ns = 0;  // monotonic clock
    std::array<QueuedHand, kMaxHands> hands{};
  };
  /// One hand's topics and jaws. Only the thread uses it once it runs.
  struct Hand {
    std::unique_ptr<HandTopics> topics;
    std::vector<double> open_angles;  // of the jaws [rad], at gripper 1
    std::vector<double> angles;
    std::uint32_t fault = ~0U;  // the published one
  };

  void run();
  void publish_queued();
  void publish(Hand& hand, const QueuedHand& queued, std::int64_t unix_ns);
  void publish_fault(Hand& hand);
  void count(std::size_t published, std::size_t tried) noexcept;

  const std::uint64_t every_;
  const std::int64_t pause_ns_;
  std::vector<Hand> hands_;
  SpscQueue<QueuedTick> queue_{kQueued};
  QueuedTick tick_;             // the loop's thread: the current tick
  bool fault_changed_ = false;  // the loop's thread
  std::atomic<std::uint64_t> skipped_{0};
  std::atomic<bool> ending_{false};
  std::uint64_t messages_ = 0;
  std::uint64_t failed_ = 0;
  std::thread thread_;  // last: it uses all of the above
};

}  // namespace palpate::ros
