// Hashes contact results on 32 tool paths, to show that a change of src/core/contact changes no bit. One and
// three tools of 968 to 97,000 triangles press the gallbladder or pull the heart, on the scene's path and on
// a shaken path with jumps, with the organ at rest and moving. Takes about a quarter of a minute a task.
// Usage: palpate_contact_hash [tests/contact_hashes.txt [press|pull]]
// Exits with 1 when a hash differs from its line in the file.
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/base/philox.h"
#include "core/base/portable_math.h"
#include "core/contact/contact.h"
#include "core/haptics/simulation.h"
#include "io/scene/make_world.h"
#include "palpate/organ_motion.h"
#include "palpate/scene.h"

#include "bench/measure/bench_scene.h"
#include "tests/hash_file.h"

namespace palpate::tests {
namespace {

constexpr std::size_t kDenseTool = 97'000;
constexpr std::size_t kFineTool = 30'000;

/// FNV-1a over the bits of numbers, 64 at a time.
class BitHash final {
 public:
  void add(std::uint64_t bits) noexcept { hash_ = (hash_ ^ bits) * 1099511628211ULL; }
  void add(double value) noexcept { add(std::bit_cast<std::uint64_t>(value)); }
  void add(const Vec3& v) noexcept {
    for (const double value : v) add(value);
  }

  void add(const contact::ContactView& view) noexcept {
    for (const Vec3& v : {view.point_S, view.direction_S}) add(v);
    for (const double value : {view.depth, view.tip_radius, view.half_width}) add(value);
    add(static_cast<std::uint64_t>(view.triangle));
    add(std::uint64_t{view.pull});
  }

  void add(const contact::ToolResult& result) noexcept {
    for (const Vec3& v : {result.nearest_W, result.away_W, result.force_W, result.torque_W, result.contact_W,
                          result.normal_W}) {
      add(v);
    }
    for (const double value : {result.distance, result.friction, result.depth}) add(value);
    add(static_cast<std::uint64_t>(result.phase));
    add(static_cast<std::uint64_t>(result.cutoff_layer));
    add(std::uint64_t{result.saturated});
    add(std::uint64_t{result.status});
    add(static_cast<std::uint64_t>(result.view_count));
    for (int i = 0; i < result.view_count; ++i) add(result.views[static_cast<std::size_t>(i)]);
  }

  [[nodiscard]] std::uint64_t hash() const noexcept { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

/// Adds to a pose: 3 mm and 0.03 rad of slow shaking, 20 um of jitter and jumps. A jump comes every 997 ticks
/// and lasts five: 12 mm down through the organ, 12 mm up out of it, and every fourth time 60 mm, which is
/// faster than a hand (DistanceCache::move).
Pose shaken(const Pose& pose, std::uint64_t tick, std::size_t hand) noexcept {
  const double time = 1e-3 * static_cast<double>(tick) + static_cast<double>(hand);
  const auto wave = [time](double rate_Hz) {
    return portable::sin_cos(2.0 * portable::kPi * rate_Hz * time);
  };
  const PhiloxCounter jitter =
      philox4x32({static_cast<std::uint32_t>(tick), static_cast<std::uint32_t>(hand), 0, 0}, {7, 11});
  const auto share = [&jitter](std::size_t i) { return static_cast<double>(jitter[i]) / 4294967296.0 - 0.5; };
  Pose moved = pose;
  moved.position += 3e-3 * Vec3(wave(3.1).sine, wave(4.3).sine, wave(5.7).sine);
  moved.position += 20e-6 * Vec3(share(0), share(1), share(2));
  moved.rotation = (rotation_about(Vec3::UnitX(), 0.03 * wave(2.3).sine) *
                    rotation_about(Vec3::UnitY(), 0.03 * wave(1.9).sine) * pose.rotation)
                       .normalized();
  if (tick % 997 >= 5) return moved;
  constexpr std::array<double, 4> kLeaps{12e-3, -12e-3, 12e-3, 60e-3};  // m, downwards
  moved.position += kLeaps[tick / 997 % kLeaps.size()] * Vec3(0.6, 0.0, -0.8);
  return moved;
}

/// Moves each hand aside, so that the contacts are close together and share the load.
Pose beside(const Pose& pose, std::size_t hand) noexcept {
  constexpr std::array<double, 3> kAside{0.0, 6e-3, -9e-3};  // m
  constexpr std::array<double, 3> kTurned{0.0, 0.7, -1.3};   // rad about the vertical
  return {(rotation_about(Vec3::UnitZ(), kTurned[hand]) * pose.rotation).normalized(),
          pose.position + Vec3(kAside[hand], 0.5 * kAside[hand], 0.0)};
}

/// "TICKS HASH" of the whole path.
std::string hash_of(const haptics::SimulationWorld& world, const scene::ToolPath& path, bool shake,
                    bool organ_moves) {
  contact::State state(world.contact);
  std::vector<contact::ToolInput> inputs(world.hands());
  std::vector<contact::ToolResult> results(world.hands());
  BitHash hash;
  const auto ticks = static_cast<std::uint64_t>(path.end_time() * world.rate_Hz);
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    const scene::PathRow row = path.at(static_cast<double>(tick) / world.rate_Hz);
    for (std::size_t hand = 0; hand < inputs.size(); ++hand) {
      const Pose pose = beside(world.mappings[hand].apply(row.position, row.orientation, Vec3::Zero()), hand);
      inputs[hand] = {shake ? shaken(pose, tick, hand) : pose, row.gripper};
    }
    const Pose organ_W =
        organ_moves ? world.organ_motion.pose_at(world.organ_W, tick, world.rate_Hz) : world.organ_W;
    contact::advance(world.contact, organ_W, inputs, state, results);
    for (const contact::ToolResult& result : results) hash.add(result);
  }
  return std::to_string(ticks) + " " + hexadecimal(hash.hash());
}

/// The tools of one world by number of triangles; 0: the built-in mesh.
struct Tools {
  const char* name;
  std::vector<std::size_t> triangles;
};

/// @param wanted task; empty: both
int run(const char* expected_file, const std::string& wanted) {
  const std::vector<Tools> all = {{"one-tool", {0}},
                                  {"one-dense-tool", {kDenseTool}},
                                  {"three-tools", {0, 0, 0}},
                                  {"three-unlike-tools", {0, kFineTool, kDenseTool}}};
  int differing = 0;
  for (const std::string task : {"press", "pull"}) {
    if (!wanted.empty() && task != wanted) continue;
    for (const Tools& tools : all) {
      scene::Scene scene = bench::bench_scene(task, 0, tools.triangles[0]);
      scene.tissue.max_depth.reset();  // shaken and moving tools go deeper
      const scene::ToolPath path = bench::hand_path(scene);
      for (std::size_t hand = 1; hand < tools.triangles.size(); ++hand) {
        scene.tools.push_back(bench::bench_scene(task, 0, tools.triangles[hand]).tools[0]);
        scene.devices.push_back(scene.devices[0]);
      }
      for (const auto kind : {model::OrganMotionKind::kBreathing, model::OrganMotionKind::kHeartbeat}) {
        scene.organ_motion.push_back(model::organ_motion_preset(kind));
      }
      const haptics::SimulationWorld world = scene::make_world(scene);
      for (const bool shake : {false, true}) {
        for (const bool organ_moves : {false, true}) {
          const std::string name = task + "-" + tools.name + (shake ? "-shaken" : "-on-path") +
                                   (organ_moves ? "-organ-moving" : "-organ-still");
          if (!check_hash(name, hash_of(world, path, shake, organ_moves), expected_file)) ++differing;
        }
      }
    }
  }
  return differing == 0 ? 0 : 1;
}

}  // namespace
}  // namespace palpate::tests

int main(int argc, char** argv) {
  return palpate::tests::run(argc > 1 ? argv[1] : nullptr, argc > 2 ? argv[2] : "");
}
