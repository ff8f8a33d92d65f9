#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "palpate/device.h"
#include "palpate/pose.h"
#include "palpate/scene.h"
#include "palpate/tool_path.h"
#include "run/devices/hand_mass.h"
#include "run/devices/target_follower.h"

#include "study/session/simulated_person.h"
#include "study/session/trial_loop.h"

namespace palpate::study {

/// The hand of a simulated observer: a firm grip on an emulated device that moves along the line of the
/// scene's default press.
class ObserverHand final : public haptics::Device {
 public:
  /// [setup] @throws InputError when the organ's mesh is not closed
  explicit ObserverHand(const scene::Scene& scene);

  /// [rt]
  haptics::DeviceState read(std::uint64_t tick, double time) noexcept override;
  bool write(const haptics::ForceCommand& command_D) noexcept override;
  void stop() noexcept override { stopped_.store(true, std::memory_order_relaxed); }

  /// [any] Where the hand wants to be: 0 at the start, 1 at the deepest point of the default press.
  void move_to(double share) noexcept { wanted_.store(share, std::memory_order_relaxed); }
  /// [any] Length of the line [m].
  [[nodiscard]] double length() const noexcept { return line_.norm(); }

 private:
  ObserverHand(const scene::ToolPath& path, double period);

  Vec3 start_;
  Vec3 line_;
  devices::TargetFollower target_;
  devices::HandMass hand_;
  double period_;
  double gripper_;
  Vec3 force_ = Vec3::Zero();
  std::atomic<double> wanted_{0.0};
  std::atomic<bool> stopped_{false};
};

/// Moves the hand of a simulated observer through a trial and samples the rendered force in its intervals.
class ObserverAgent final {
 public:
  static constexpr int kSamples = 10;        // of an interval
  static constexpr double kSpacing = 80e-3;  // s

  /// [setup] @param rate_Hz of the loop
  ObserverAgent(ObserverHand& hand, double rate_Hz) : hand_(hand), rate_Hz_(rate_Hz) {}

  /// [setup] A trial begins. @param random of the hand's tremor. Without tremor the forces of all trials
  /// without noise are the same, and the log shows which they are.
  void begin(Random random);
  /// [setup] Takes a row of hand 0, after the trial loop did.
  void row(const haptics::TickRow& row, const TrialLoop& loop, const Study& study);
  /// [any] The press of a search for an inclusion is over.
  [[nodiscard]] bool has_searched() const noexcept { return searched_; }
  /// [any] Rendered force along the surface's normal beyond the tissue's [N], of each interval.
  [[nodiscard]] const std::array<std::vector<double>, 2>& samples() const noexcept { return samples_; }

 private:
  void follow_force(double wanted, double force) noexcept;
  [[nodiscard]] double next_tremor() noexcept;

  ObserverHand& hand_;
  double rate_Hz_;
  double place_ = 0.0;  // share of the line
  Random random_{0, 0, 0};
  std::array<double, 2> tremor_{};  // m, of the two stages of its filter
  TrialState last_state_ = TrialState::kIdle;
  std::uint64_t interval_began_ = 0;
  bool pressed_ = false;   // in this interval, to the depth
  bool searched_ = false;  // pressed and out again
  std::array<std::vector<double>, 2> samples_;
};

/// [setup] The answer of an observer to the rendered force: as answer_by_formula(), but detection tasks by
/// the samples, and stiffness by the measured forces and depths.
void answer_by_force(const Study& study, SimulatedPerson& person, const Trial& trial,
                     const std::array<std::vector<double>, 2>& samples, double progress,
                     std::uint32_t participant, TrialRecord& record);

}  // namespace palpate::study
