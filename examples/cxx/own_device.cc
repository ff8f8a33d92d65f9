// A device driver of your own: one class with five functions (docs/first-device.md).
//
// The device is a toy in place of hardware: a handle of 0.2 kg that moves only up and down. A simulated hand
// pulls it to a target 8 mm inside the organ. After 4 s its cable breaks.
#include <algorithm>
#include <atomic>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "palpate/device.h"
#include "palpate/scene.h"
#include "palpate/session.h"
#include "palpate/tool_path.h"

namespace {

using palpate::haptics::DeviceState;
using palpate::haptics::Fault;
using palpate::haptics::ForceCommand;

/// Simulates the handle and the hand, in place of a manufacturer's driver.
class ToyHardware {
 public:
  explicit ToyHardware(double height) : height_(height), start_(height) {}

  /// Advances by one period. The hand waits for a second, moves down at 20 mm/s and stops.
  void live_on(double time, double period) {
    const double aim = start_ - std::clamp(20e-3 * (time - 1.0), 0.0, 18e-3);
    const double force = 300.0 * (aim - height_) - 8.0 * speed_ + motor_force_;
    speed_ += force / 0.2 * period;
    height_ += speed_ * period;
  }
  double height() const { return height_; }
  double speed() const { return speed_; }
  void set_motor(double force) { motor_force_ = force; }

 private:
  double height_;  // m
  double start_;
  double speed_ = 0.0;        // m/s
  double motor_force_ = 0.0;  // N
};

class ToyDevice final : public palpate::haptics::Device {
 public:
  ToyDevice(const palpate::scene::PathRow& start, double period)
      : hardware_(start.position.z()), start_(start), period_(period) {}

  /// [rt] Returns ONE sample: position, velocity and buttons of the same time. Report every error as a fault.
  DeviceState read(std::uint64_t /*tick*/, double time) noexcept override {
    DeviceState sample;
    sample.orientation_D = start_.orientation;
    if (time >= 4.0) {
      broken_.store(true);
      sample.fault = Fault::kDevice;  // "could not be read": the gate ramps the force to zero within 10 ms
      return sample;
    }
    hardware_.live_on(time, period_);
    sample.position_D = {start_.position.x(), start_.position.y(), hardware_.height()};
    sample.velocity_D = {0.0, 0.0, hardware_.speed()};
    return sample;
  }

  /// [rt] Writes the force of the gate, in the device frame. @return false when the hardware rejects it
  bool write(const ForceCommand& command_D) noexcept override {
    if (broken_.load()) return false;
    hardware_.set_motor(command_D.force.z());
    return true;
  }

  /// [any] Sets zero force, from any thread. The watchdog calls it when the loop stalls, so it must not wait
  /// for read() or write().
  void stop() noexcept override { stopped_.store(true); }

  /// [any] Hardware has no last tick: the run ends by Ctrl-C or --duration-s.
  std::uint64_t last_tick(double /*rate_Hz*/) const noexcept override { return ~0ULL; }

  std::string last_error() const override { return broken_.load() ? "the cable is broken" : ""; }
  bool stopped() const { return stopped_.load(); }

 private:
  ToyHardware hardware_;
  palpate::scene::PathRow start_;
  double period_;  // s
  std::atomic<bool> broken_{false};
  std::atomic<bool> stopped_{false};
};

/// Prints a line every half second.
class Diary final : public palpate::haptics::TickObserver {
 public:
  void on_row(const palpate::haptics::TickRow& row) noexcept override {
    if (row.tick % 500 != 0) return;
    std::cout << row.time << " s: share let through " << row.engagement << ", depth " << 1e3 * row.depth
              << " mm, force on the hand " << row.force[2] << " N\n";
  }
};

}  // namespace

int main() {
  palpate::scene::Scene scene = palpate::scene::load({});
  // A device of the kind "host" is held by a hand. The force starts by a ramp after the hand was still
  // outside the tissue, and the passivity controller acts. Never use a kind without a hand for a device that
  // can push.
  scene.devices[0].kind = "host";
  auto toy = std::make_unique<ToyDevice>(palpate::scene::default_path(scene, 0).at(0.0), 1.0 / scene.rate_Hz);
  const ToyDevice& device = *toy;
  palpate::session::SessionOptions options{.duration_s = 5.0};
  options.devices.push_back(std::move(toy));
  palpate::session::Session session(std::move(scene), std::move(options));
  Diary diary;
  // A toy does not need real time. For hardware leave `offline` false.
  const auto result = session.run({.offline = true, .keep_fault = false}, {&diary});

  for (const palpate::haptics::FaultSeen& fault : result.loop.faults) {
    std::cout << "tick " << fault.tick << ": " << palpate::haptics::describe(fault.fault) << ": "
              << device.last_error() << '\n';
  }
  std::cout << (device.stopped() ? "stopped at the end\n" : "never stopped\n");
  return result.loop.fault == Fault::kDevice && device.stopped() ? 0 : 1;
}
