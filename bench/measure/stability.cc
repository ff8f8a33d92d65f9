#include "bench/measure/stability.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/haptics/passivity.h"
#include "io/scene/make_world.h"
#include "io/scene/minimum_jerk.h"
#include "palpate/mesh.h"
#include "palpate/spring_law.h"
#include "run/devices/emulated.h"
#include "run/realtime/loop.h"

namespace palpate::bench {
namespace {

constexpr double kBallRadius = 5e-3;  // m
constexpr double kClear = 5e-3;       // m, above the block at start and end
// Path of the hand [s]: rest for the soft start, down, hold for 2 s, up.
constexpr double kDown = 1.0;
constexpr double kHoldBegin = 2.0;
constexpr double kMeasureBegin = 3.0;
constexpr double kHoldEnd = 4.0;
constexpr double kUpEnd = 5.0;
constexpr double kEncoder = 1e-5;  // m
constexpr double kSweepRowSpacing = 5e-3;

/// Desired path of the hand: from kClear above the block to `lowest` [m] below its top and back.
scene::ToolPath press_and_let_go(double lowest) {
  std::vector<scene::PathRow> rows;
  const auto steps = static_cast<int>(std::lround(kUpEnd / kSweepRowSpacing));
  for (int i = 0; i <= steps; ++i) {
    const double time = i * kSweepRowSpacing;
    const double in = scene::minimum_jerk(std::clamp((time - kDown) / (kHoldBegin - kDown), 0.0, 1.0));
    const double out = scene::minimum_jerk(std::clamp((time - kHoldEnd) / (kUpEnd - kHoldEnd), 0.0, 1.0));
    const double height = kClear - (in - out) * (kClear + lowest);
    rows.push_back({time, Vec3(0.0, 0.0, kBallRadius + height), Quat::Identity(), 0.0});
  }
  return scene::ToolPath(std::move(rows));
}

scene::Scene block_of(const model::TissueParameters& tissue, double rate_Hz) {
  scene::Scene scene;
  scene.name = "stability";
  scene.rate_Hz = rate_Hz;
  scene.organ_name = "box";
  scene.organ = geometry::make_box(Vec3(0.08, 0.08, 0.06), 0.02);
  scene.organ_pose.position = Vec3(0, 0, -0.03);
  scene.tissue = tissue;
  scene.tools.push_back(
      {"ball", {{.name = "ball", .mesh = geometry::make_ball(kBallRadius, 320)}}, kBallRadius});
  scene.devices.emplace_back().kind = "emulated";
  scene.noise.enabled = false;
  return scene;
}

/// Observes the rows and the hand model.
class ForceWatch final : public haptics::TickObserver {
 public:
  explicit ForceWatch(const devices::EmulatedDevice& device) : device_(device) {}
  void on_row(const haptics::TickRow& row) noexcept override {
    const double work = device_.hand().work_of_force();
    result_.given_beyond_taken = std::max(result_.given_beyond_taken, work);
    result_.most_in_a_tick = std::max(result_.most_in_a_tick, std::abs(work - work_));
    work_ = work;
    result_.observed_deficit = std::max(result_.observed_deficit, -row.energy);
    if (row.fault != 0) result_.faulted = true;
    if ((row.status & haptics::kEnergyDamped) != 0) result_.controlled = true;
    if (row.time < kMeasureBegin || row.time >= kHoldEnd) return;
    const Vec3& place = device_.hand().position();
    low_ = low_.cwiseMin(place);
    high_ = high_.cwiseMax(place);
    result_.force += Vec3(row.force[0], row.force[1], row.force[2]).norm();
    result_.depth += row.depth;
    ++ticks_;
  }
  [[nodiscard]] StabilityResult result() const {
    StabilityResult all = result_;
    const double ticks = std::max(1.0, static_cast<double>(ticks_));
    all.force /= ticks;
    all.depth /= ticks;
    all.peak_to_peak = (high_ - low_).maxCoeff();
    return all;
  }

 private:
  const devices::EmulatedDevice& device_;
  StabilityResult result_;
  Vec3 low_ = Vec3::Constant(1e9);
  Vec3 high_ = Vec3::Constant(-1e9);
  std::uint64_t ticks_ = 0;
  double work_ = 0.0;
};

}  // namespace

double energy_bound(const StabilityResult& result) noexcept {
  return haptics::kEnergyTolerance + 2.0 * result.most_in_a_tick;
}

model::TissueParameters linear_tissue(double stiffness) {
  model::TissueParameters tissue = model::tissue_preset("gallbladder");
  tissue.name = "linear";
  tissue.k1 = stiffness;
  tissue.rest_length = 50e-3;
  tissue.min_length = 20e-3;  // the first layer's limit is 30 mm, so the next layer is not reached
  tissue.max_length = 80e-3;
  tissue.contact.friction = 0.0;
  return tissue;
}

StabilityBlock::StabilityBlock(const model::TissueParameters& tissue, double rate_Hz,
                               const contact::Preparation& how)
    : scene_(block_of(tissue, rate_Hz)), world_(scene::make_world(scene_, how)) {
  const model::SpringLaw law(tissue, model::Direction::kPress, 1.0 / rate_Hz);
  depth_at_hold_ = std::min(haptics::kDepthWithinReach, law.deformation_under(kMaxHoldForce).depth);
  const model::ContactResponse there = law.force_at(depth_at_hold_);
  force_at_hold_ = there.force;
  stiffness_at_hold_ = there.stiffness;
}

StabilityResult StabilityBlock::run(const StabilityCase& the_case) const {
  scene::DeviceSetup device_setup = scene_.devices.front();
  device_setup.dynamics = {the_case.device.damping, the_case.device.friction, the_case.device.resolution};
  device_setup.emulated.grip = the_case.grip;
  const double lowest = depth_at_hold_ + force_at_hold_ / the_case.grip.stiffness;
  devices::EmulatedDevice device(press_and_let_go(lowest), device_setup, world_.rate_Hz);
  haptics::SimulationState state(world_);
  ForceWatch watch(device);
  realtime::LoopOptions options;
  options.ticks = device.last_tick(world_.rate_Hz);
  options.offline = true;
  std::array<haptics::Device*, 1> devices = {&device};
  static_cast<void>(realtime::run_loop(world_, state, devices, {&watch}, options));
  StabilityResult result = watch.result();
  result.stiffness = stiffness_at_hold_;
  result.check = haptics::check_stability(
      scene_.tissue, {.period = 1.0 / world_.rate_Hz, .max_force = scene_.safety.max_force}, the_case.device);
  return result;
}

std::vector<StabilityCase> tissue_cases() {
  constexpr scene::HandGrip kMiddleGrip{150.0, 2.0};
  std::vector<StabilityCase> cases;
  for (const char* name : {"gallbladder", "heart", "liver", "kidney"}) {
    const model::TissueParameters tissue = model::tissue_preset(name);
    for (const double rate : {1000.0, 4000.0}) {
      for (const double damping : {0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0}) {
        for (const double friction : {0.0, 0.002, 0.005, 0.01, 0.05, 0.1, 0.2}) {
          for (const scene::HandGrip& grip : {scene::kLightGrip, kMiddleGrip, scene::kFirmGrip}) {
            cases.push_back({tissue, rate, {damping, friction, kEncoder}, grip});
          }
        }
      }
    }
  }
  return cases;
}

std::vector<StabilityCase> wall_cases() {
  std::vector<StabilityCase> cases;
  for (const double rate : {1000.0, 4000.0}) {
    for (const double stiffness : {250.0, 500.0, 1e3, 2e3, 4e3, 8e3, 16e3, 32e3}) {
      for (const double damping : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0}) {
        for (const double friction : {0.0, 0.01, 0.1}) {
          for (const scene::HandGrip& grip : {scene::kLightGrip, scene::kFirmGrip}) {
            cases.push_back({linear_tissue(stiffness), rate, {damping, friction, kEncoder}, grip});
          }
        }
      }
    }
  }
  return cases;
}

}  // namespace palpate::bench
