// Functions of palpate_web.h for hands that follow a pointer.
#include <cstdint>
#include <memory>

#include "core/contact/state.h"
#include "core/haptics/simulation.h"
#include "core/haptics/workspace.h"
#include "run/devices/surface_rider.h"
#include "run/devices/target_follower.h"

#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"
#include "bindings/web/palpate_web.h"

using palpate::Pose;
using palpate::Vec3;
using palpate::c_interface::guarded;
using palpate::c_interface::require_given;
using palpate::c_interface::UseError;

namespace {

/// Start of the scripted motion.
palpate::scene::PathRow start_of(palpate_simulation& simulation, std::uint32_t hand) {
  if (hand >= simulation.hands()) throw UseError("hand: must be less than info.hands");
  palpate_sample first{};
  simulation.scripted_sample(hand, 0, first);
  palpate::scene::PathRow start;
  start.position = Vec3(first.position);
  start.orientation =
      palpate::Quat(first.orientation[0], first.orientation[1], first.orientation[2], first.orientation[3]);
  start.gripper = first.gripper;
  return start;
}

void give(const palpate::haptics::DeviceState& state, palpate_sample& sample) {
  for (int i = 0; i < 3; ++i) {
    sample.position[i] = state.position_D[i];
    sample.velocity[i] = state.velocity_D[i];
  }
  sample.orientation[0] = state.orientation_D.w();
  sample.orientation[1] = state.orientation_D.x();
  sample.orientation[2] = state.orientation_D.y();
  sample.orientation[3] = state.orientation_D.z();
  sample.gripper = state.gripper;
  sample.age = 0.0;
  sample.buttons = 0;
  sample.fault = 0;
}

}  // namespace

struct palpate_web_follower {
  palpate_web_follower(const palpate::scene::DeviceSetup& device, const palpate::scene::PathRow& start,
                       double period)
      : base(device.base), scale(device.workspace_scale), hand(start, period) {}

  [[nodiscard]] Vec3 to_device(const Vec3& point_W) const { return base.inverse() * point_W / scale; }
  [[nodiscard]] Vec3 to_world(const Vec3& point_D) const { return base * Vec3(scale * point_D); }

  palpate::Pose base;
  double scale;
  palpate::devices::TargetFollower hand;
};

struct palpate_web_rider {
  palpate_web_rider(palpate_simulation& moved, std::uint32_t held, const palpate::scene::PathRow& start)
      : simulation(moved),
        which(held),
        mapping(simulation.world().mappings[which]),
        hand(start, 1.0 / simulation.scene().rate_Hz),
        rider(simulation.world().contact.data().surface, simulation.scene().tools[which],
              simulation.world().organ_W, mapping.apply(start.position, start.orientation), start.gripper,
              mapping.scale * palpate::devices::TargetFollower::kMaxDistance) {
    hand.hold_at(rider.tip() / mapping.scale);
  }

  palpate_simulation& simulation;
  std::uint32_t which;  // hand
  palpate::haptics::WorkspaceMapping mapping;
  palpate::devices::TargetFollower hand;
  palpate::devices::SurfaceRider rider;
};

extern "C" {

palpate_status palpate_web_follower_open(palpate_simulation* simulation, uint32_t hand,
                                         palpate_web_follower** follower) {
  return guarded([&] {
    require_given(simulation, "simulation");
    require_given(follower, "follower");
    *follower = nullptr;
    const palpate::scene::PathRow start = start_of(*simulation, hand);
    const palpate::scene::Scene& scene = simulation->scene();
    *follower =
        std::make_unique<palpate_web_follower>(scene.devices[hand], start, 1.0 / scene.rate_Hz).release();
  });
}

void palpate_web_follower_close(palpate_web_follower* follower) {
  std::unique_ptr<palpate_web_follower>{follower}.reset();
}

void palpate_web_follower_start(const palpate_web_follower* follower, double start[7]) {
  const Vec3 position = follower->to_world(follower->hand.start());
  const Vec3 axis = follower->base.rotation * follower->hand.orientation() * Vec3::UnitZ();
  for (int i = 0; i < 3; ++i) {
    start[i] = position[i];
    start[3 + i] = axis[i];
  }
  start[6] = follower->hand.gripper();
}

palpate_status palpate_web_follower_advance(palpate_web_follower* follower, const double target[3],
                                            double gripper, palpate_sample* sample) {
  return guarded([&] {
    follower->hand.advance(follower->to_device(Vec3(target)), gripper);
    give(follower->hand.state(), *sample);
  });
}

void palpate_web_follower_reach(const palpate_web_follower* follower, double target[3]) {
  const Vec3 reached = follower->to_world(follower->hand.within_reach(follower->to_device(Vec3(target))));
  for (int i = 0; i < 3; ++i) target[i] = reached[i];
}

palpate_status palpate_web_rider_open(palpate_simulation* simulation, uint32_t hand,
                                      palpate_web_rider** rider) {
  return guarded([&] {
    *rider = nullptr;
    *rider = std::make_unique<palpate_web_rider>(*simulation, hand, start_of(*simulation, hand)).release();
  });
}

void palpate_web_rider_close(palpate_web_rider* rider) { std::unique_ptr<palpate_web_rider>{rider}.reset(); }

void palpate_web_rider_point_at(palpate_web_rider* rider, const double ray[6]) {
  if (ray == nullptr) {
    rider->rider.freeze();
  } else {
    rider->rider.point_at({Vec3(ray), Vec3(ray + 3)});
  }
}

void palpate_web_rider_press(palpate_web_rider* rider, double deeper) { rider->rider.press(deeper); }

void palpate_web_rider_park(palpate_web_rider* rider, int32_t parked) { rider->rider.park(parked != 0); }

double palpate_web_rider_depth(const palpate_web_rider* rider) { return rider->rider.depth(); }

void palpate_web_rider_move(palpate_web_rider* rider, double seconds, int32_t dragging, double pace) {
  const palpate::contact::ToolResult& result = rider->simulation.newest_snapshot().results[rider->which];
  rider->rider.feel_needle(result.phase == palpate::contact::Phase::kInsert, result.force_W);
  rider->rider.advance(seconds, rider->hand.gripper(), dragging != 0, pace);
  const Pose device_W = rider->mapping.base.inverse();
  rider->hand.turn_to(device_W.rotation * rider->rider.target().orientation_W);
}

palpate_status palpate_web_rider_advance(palpate_web_rider* rider, double gripper, palpate_sample* sample) {
  return guarded([&] {
    const palpate::haptics::WorkspaceMapping& mapping = rider->mapping;
    rider->hand.advance(mapping.base.inverse() * rider->rider.target().tip_W / mapping.scale, gripper);
    give(rider->hand.state(), *sample);
  });
}
}
