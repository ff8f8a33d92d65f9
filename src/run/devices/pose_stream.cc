#include "run/devices/pose_stream.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace palpate::devices {
namespace {

constexpr double kSecondsPerNs = 1e-9;

std::string in_mm(double length) { return fmt::format("{:.0f} mm", 1e3 * length); }

}  // namespace

std::string PoseStream::refusal(const StreamedPose& pose) const {
  const double norm = pose.orientation_D.norm();
  if (!pose.position_D.allFinite() || !std::isfinite(norm) || !std::isfinite(pose.gripper)) {
    return "a pose is not finite";
  }
  if (std::abs(norm - 1.0) > kUnitSlack) {
    return fmt::format("a pose's orientation is no rotation: its quaternion has the norm {:.3g}", norm);
  }
  const double out = pose.position_D.cwiseAbs().maxCoeff();
  if (out > kReach) {
    return fmt::format("a pose is {:.3g} m from the origin, must be within {:.3g} m along each axis", out,
                       kReach);
  }
  if (window_.count == 0) return {};
  const double step = (pose.position_D - newest_.position_D).norm();
  if (step > kLargestStep) {
    return fmt::format("the pose jumped by {}, must be at most {} between two messages", in_mm(step),
                       in_mm(kLargestStep));
  }
  const double cosine = std::abs(pose.orientation_D.dot(newest_.orientation_D)) / norm;
  if (cosine < std::cos(0.5 * kLargestTurn)) return "the pose turned by more than 60 degrees in one message";
  return {};
}

void PoseStream::restart() noexcept {
  window_.count = 0;
  window_.delay_ns = 0;
  learned_ = 0;
}

void PoseStream::keep(const StreamedPose& pose, std::int64_t arrived_ns) noexcept {
  Window& window = window_;
  if (window.count > 0 && arrived_ns - window.kept[window.count - 1].time_ns < kShortestStep) {
    window.kept[window.count - 1].pose = pose;
    return;
  }
  if (window.count == kKept) {
    std::move(window.kept.begin() + 1, window.kept.end(), window.kept.begin());
    --window.count;
  }
  window.kept[window.count++] = {pose, arrived_ns};
}

void PoseStream::publish() noexcept {
  windows_.writable() = window_;
  windows_.publish();
}

std::string PoseStream::add(const StreamedPose& pose, std::int64_t arrived_ns) {
  if (window_.count > 0 && arrived_ns - window_.newest_ns > kSilence) restart();
  if (std::string why = refusal(pose); !why.empty()) {
    break_off();
    return why;
  }
  newest_ = pose;
  newest_.orientation_D.normalize();
  window_.newest_ns = arrived_ns;
  keep(newest_, arrived_ns);
  if (learned_ == 0) began_ns_ = arrived_ns;
  if (++learned_ == kLearned) {
    const std::int64_t period = (arrived_ns - began_ns_) / static_cast<std::int64_t>(kLearned - 1);
    window_.delay_ns = std::clamp(2 * period, kShortestDelay, kLongestDelay);
  }
  publish();
  return {};
}

void PoseStream::break_off() noexcept {
  restart();
  publish();
}

haptics::DeviceState PoseStream::interpolated(const Window& window, std::int64_t time_ns) const noexcept {
  std::size_t after = window.count;  // the first kept pose later than time_ns
  while (after > 1 && window.kept[after - 1].time_ns > time_ns) --after;
  Kept from = window.kept[after - 1];
  // The last sample lies on the way to the next pose, or rested because that pose was late.
  if (after < window.count && running_ && last_ns_ > from.time_ns) {
    from = {{last_.position_D, last_.orientation_D, last_.gripper}, last_ns_};
  }
  haptics::DeviceState sample;
  sample.position_D = from.pose.position_D;
  sample.orientation_D = from.pose.orientation_D;
  sample.gripper = from.pose.gripper;
  if (after == window.count) return sample;  // at rest at the newest pose
  const Kept& to = window.kept[after];
  const double span = kSecondsPerNs * static_cast<double>(to.time_ns - from.time_ns);
  const double u = kSecondsPerNs * static_cast<double>(time_ns - from.time_ns) / span;
  const Vec3 way = to.pose.position_D - from.pose.position_D;
  sample.position_D += u * way;
  sample.velocity_D = way / span;
  sample.orientation_D = slerp(from.pose.orientation_D, to.pose.orientation_D, u);
  sample.gripper += u * (to.pose.gripper - from.pose.gripper);
  return sample;
}

haptics::DeviceState PoseStream::at(std::int64_t now_ns) noexcept {
  windows_.refresh();
  const Window& window = windows_.value();
  const std::int64_t silence = now_ns - window.newest_ns;
  const std::int64_t time_ns = now_ns - window.delay_ns;
  haptics::DeviceState sample = last_;
  sample.velocity_D = Vec3::Zero();
  if (window.count == 0) {
    sample.fault = haptics::Fault::kDevice;
  } else if (silence > kSilence) {
    sample.age = kSecondsPerNs * static_cast<double>(silence);  // over haptics::kStaleAfter
  } else if (window.delay_ns == 0 || time_ns < window.kept[0].time_ns) {
    sample.fault = haptics::Fault::kDevice;
  } else {
    last_ = sample = interpolated(window, time_ns);
    last_ns_ = time_ns;
    running_ = true;
    return sample;
  }
  running_ = false;
  return sample;
}

}  // namespace palpate::devices
