#include "ros/publisher/ros_publisher.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <sys/resource.h>

#include "io/system/clock.h"
#include "run/realtime/realtime.h"

namespace palpate::ros {
namespace {

constexpr std::int64_t kFaultPeriod = 1'000'000'000;  // ns between two messages of an unchanged fault
constexpr std::int64_t kReceiptLimit = 300'000'000;   // ns, for subscribers to receive the last messages
/// Nice value of the thread, as that of the other servers. The rest of the run has a higher priority.
constexpr int kPublisherNiceness = 5;

std::uint64_t ticks_per_message(double rate_Hz, double publish_Hz) {
  return static_cast<std::uint64_t>(std::max(1.0, std::ceil(rate_Hz / publish_Hz - 1e-9)));
}

Vec3 vector_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

const char* fault_name(std::uint32_t fault) { return haptics::name_of(static_cast<haptics::Fault>(fault)); }

}  // namespace

std::vector<std::string> joint_names(const geometry::Tool& tool, std::size_t hand) {
  std::vector<std::string> names;
  for (const geometry::ToolPart& part : tool.parts) {
    if (part.is_jaw) names.push_back(fmt::format("hand{}_jaw{}", hand, names.size()));
  }
  return names;
}

RosPublisher::RosPublisher(Node& node, const std::vector<geometry::Tool>& tools, double rate_Hz,
                           double publish_Hz)
    : every_(ticks_per_message(rate_Hz, publish_Hz)),
      // A quarter of the period between messages, so that they are at most that late.
      pause_ns_(std::clamp(static_cast<std::int64_t>(0.25e9 * static_cast<double>(every_) / rate_Hz),
                           std::int64_t{250'000}, std::int64_t{2'500'000})) {
  for (std::size_t i = 0; i < tools.size(); ++i) {
    Hand hand;
    hand.topics = node.advertise(topic_prefix(i), joint_names(tools[i], i));
    for (const geometry::ToolPart& part : tools[i].parts) {
      if (part.is_jaw) hand.open_angles.push_back(part.open_angle);
    }
    hand.angles = hand.open_angles;
    hands_.push_back(std::move(hand));
  }
  const realtime::BlockedSignals held;
  thread_ = std::thread([this] { run(); });
}

RosPublisher::~RosPublisher() {
  if (thread_.joinable()) (void)finish();
}

void RosPublisher::on_row(const haptics::TickRow& row) noexcept {
  QueuedHand& hand = tick_.hands[row.hand];
  hand.pose = {Quat(row.tool_q[0], row.tool_q[1], row.tool_q[2], row.tool_q[3]), vector_of(row.tool)};
  hand.force = vector_of(row.force);
  hand.torque = vector_of(row.torque);
  hand.gripper = row.gripper;
  fault_changed_ = fault_changed_ || hand.fault != row.fault;
  hand.fault = row.fault;
}

void RosPublisher::on_tick(const haptics::TickState& now) noexcept {
  if (now.tick % every_ != 0 && !fault_changed_) return;
  tick_.taken_ns = now.taken_ns;
  if (queue_.push(tick_)) {
    fault_changed_ = false;
  } else {
    skipped_.fetch_add(1, std::memory_order_relaxed);
  }
}

PublisherStatistics RosPublisher::finish() {
  ending_.store(true);
  thread_.join();
  return {messages_, failed_, skipped_.load()};
}

void RosPublisher::run() {
  (void)setpriority(PRIO_PROCESS, 0, kPublisherNiceness);  // Linux changes this thread alone
  std::int64_t fault_due = 0;
  bool ending = false;
  while (!ending) {
    ending = ending_.load();  // read first: the last ticks are in the queue then
    publish_queued();
    const std::int64_t now = monotonic_ns();
    if (now >= fault_due) {
      for (Hand& hand : hands_) {
        if (hand.fault != ~0U) publish_fault(hand);
      }
      fault_due = now + kFaultPeriod;
    }
    if (!ending) sleep_until_ns(now + pause_ns_);
  }
  const std::int64_t until = monotonic_ns() + kReceiptLimit;
  for (Hand& hand : hands_) hand.topics->wait_for_receipt(std::max<std::int64_t>(0, until - monotonic_ns()));
}

void RosPublisher::publish_queued() {
  QueuedTick tick;
  while (queue_.pop(tick)) {
    const std::int64_t unix_time = wall_time_of(tick.taken_ns);
    for (std::size_t i = 0; i < hands_.size(); ++i) publish(hands_[i], tick.hands[i], unix_time);
  }
}

void RosPublisher::publish(Hand& hand, const QueuedHand& queued, std::int64_t unix_time) {
  for (std::size_t jaw = 0; jaw < hand.angles.size(); ++jaw) {
    hand.angles[jaw] = queued.gripper * hand.open_angles[jaw];
  }
  count(hand.topics->publish({unix_time, queued.pose, queued.force, queued.torque}, hand.angles),
        hand.angles.empty() ? 2 : 3);
  if (hand.fault == queued.fault) return;
  hand.fault = queued.fault;
  publish_fault(hand);
}

void RosPublisher::publish_fault(Hand& hand) {
  count(hand.topics->publish_fault(fault_name(hand.fault)) ? 1 : 0, 1);
}

void RosPublisher::count(std::size_t published, std::size_t tried) noexcept {
  messages_ += published;
  failed_ += tried - published;
}

}  // namespace palpate::ros
