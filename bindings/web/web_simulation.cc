// Functions of palpate_web.h for a simulation.
#include <cstddef>
#include <cstring>
#include <memory>
#include <string>

#include <malloc.h>

#include "core/haptics/workspace.h"
#include "run/devices/target_follower.h"

#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"
#include "bindings/web/palpate_web.h"

using palpate::Vec3;
using palpate::c_interface::guarded;
using palpate::c_interface::require_given;
using palpate::c_interface::UseError;

namespace {

template <typename Field>
constexpr const char* type_name() {
  using One = std::remove_all_extents_t<Field>;
  if constexpr (std::is_same_v<One, double>) return "f64";
  if constexpr (std::is_same_v<One, std::uint64_t>) return "u64";
  if constexpr (std::is_same_v<One, std::int32_t>) return "i32";
  if constexpr (std::is_same_v<One, const char*>) return "text";
  return "u32";  // uint32_t, size_t
}

template <typename Field>
std::string field_text(const char* name, std::size_t offset) {
  const std::size_t count = sizeof(Field) / sizeof(std::remove_all_extents_t<Field>);
  return std::string("[\"") + name + "\",\"" + type_name<Field>() + "\"," + std::to_string(offset) + "," +
         std::to_string(count) + "],";
}

#define PALPATE_FIELD(name) field_text<decltype(Struct::name)>(#name, offsetof(Struct, name))

std::string struct_text(const char* name, std::size_t size, std::string fields) {
  fields.pop_back();
  return std::string("\"") + name + "\":{\"size\":" + std::to_string(size) + ",\"fields\":[" + fields + "]},";
}

std::string sample_text() {
  using Struct = palpate_sample;
  return struct_text("sample", sizeof(Struct),
                     PALPATE_FIELD(position) + PALPATE_FIELD(orientation) + PALPATE_FIELD(velocity) +
                         PALPATE_FIELD(gripper) + PALPATE_FIELD(age) + PALPATE_FIELD(buttons) +
                         PALPATE_FIELD(fault));
}

/// The first field; the others follow as the class Result of palpate.js has them.
std::string result_text() {
  using Struct = palpate_result;
  return struct_text("result", sizeof(Struct), PALPATE_FIELD(tick));
}

std::string options_text() {
  using Struct = palpate_options;
  return struct_text("options", sizeof(Struct),
                     PALPATE_FIELD(scene_text) + PALPATE_FIELD(scene_folder) + PALPATE_FIELD(task) +
                         PALPATE_FIELD(record_file) + PALPATE_FIELD(record_waits) + PALPATE_FIELD(no_hand) +
                         PALPATE_FIELD(no_cache) + PALPATE_FIELD(surface_edge) +
                         field_text<std::uint32_t>("progress", offsetof(Struct, progress)));
}

std::string info_text() {
  using Struct = palpate_info;
  return struct_text("info", sizeof(Struct),
                     PALPATE_FIELD(hands) + PALPATE_FIELD(held) + PALPATE_FIELD(rate) +
                         PALPATE_FIELD(max_force) + PALPATE_FIELD(max_torque) + PALPATE_FIELD(seed) +
                         PALPATE_FIELD(scripted_ticks) + PALPATE_FIELD(vertices) + PALPATE_FIELD(triangles) +
                         PALPATE_FIELD(remarks));
}

std::string inclusion_text() {
  using Struct = palpate_inclusion;
  return struct_text("inclusion", sizeof(Struct),
                     PALPATE_FIELD(position) + PALPATE_FIELD(radius) + PALPATE_FIELD(stiffness_ratio) +
                         PALPATE_FIELD(name) + PALPATE_FIELD(visible));
}

std::string picture_text() {
  using Struct = palpate_picture;
  return struct_text("picture", sizeof(Struct),
                     PALPATE_FIELD(tick) + PALPATE_FIELD(organ_position) + PALPATE_FIELD(organ_orientation) +
                         PALPATE_FIELD(tool_position) + PALPATE_FIELD(tool_orientation) +
                         PALPATE_FIELD(gripper));
}

std::string response_text() {
  using Struct = palpate_response;
  return struct_text("response", sizeof(Struct),
                     PALPATE_FIELD(depth) + PALPATE_FIELD(force) + PALPATE_FIELD(stiffness) +
                         PALPATE_FIELD(cutoff_layer) + PALPATE_FIELD(saturated));
}

#undef PALPATE_FIELD

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

extern "C" {

const char* palpate_web_layout(void) {
  static const std::string text = [] {
    std::string all = "{" + options_text() + info_text() + sample_text() + result_text() + inclusion_text() +
                      picture_text() + response_text();
    all.back() = '}';
    return all;
  }();
  return text.c_str();
}

size_t palpate_web_snapshot_size(void) { return sizeof(palpate::haptics::Snapshot); }

palpate_status palpate_web_snapshot(palpate_simulation* simulation, void* bytes, size_t capacity) {
  return guarded([&] {
    require_given(simulation, "simulation");
    require_given(bytes, "bytes");
    if (capacity != sizeof(palpate::haptics::Snapshot)) {
      throw UseError("capacity: must be palpate_web_snapshot_size()");
    }
    std::memcpy(bytes, static_cast<const void*>(&simulation->newest_snapshot()), capacity);
  });
}

palpate_status palpate_web_flush_recording(palpate_simulation* simulation) {
  return guarded([&] { simulation->flush_recording(); });
}

palpate_status palpate_web_follower_open(palpate_simulation* simulation, uint32_t hand,
                                         palpate_web_follower** follower) {
  return guarded([&] {
    require_given(simulation, "simulation");
    require_given(follower, "follower");
    *follower = nullptr;
    if (hand >= simulation->hands()) throw UseError("hand: must be less than info.hands");
    palpate_sample first{};
    simulation->scripted_sample(hand, 0, first);
    palpate::scene::PathRow start;
    start.position = Vec3(first.position);
    start.orientation =
        palpate::Quat(first.orientation[0], first.orientation[1], first.orientation[2], first.orientation[3]);
    start.gripper = first.gripper;
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
    const palpate::haptics::DeviceState state = follower->hand.state();
    for (int i = 0; i < 3; ++i) {
      sample->position[i] = state.position_D[i];
      sample->velocity[i] = state.velocity_D[i];
    }
    sample->orientation[0] = state.orientation_D.w();
    sample->orientation[1] = state.orientation_D.x();
    sample->orientation[2] = state.orientation_D.y();
    sample->orientation[3] = state.orientation_D.z();
    sample->gripper = state.gripper;
    sample->age = 0.0;
    sample->buttons = 0;
    sample->fault = 0;
  });
}

void palpate_web_follower_reach(const palpate_web_follower* follower, double target[3]) {
  const Vec3 reached = follower->to_world(follower->hand.within_reach(follower->to_device(Vec3(target))));
  for (int i = 0; i < 3; ++i) target[i] = reached[i];
}

size_t palpate_web_memory_in_use(void) { return static_cast<std::size_t>(mallinfo().uordblks); }
}
