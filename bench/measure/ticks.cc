#include "bench/measure/ticks.h"

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

#include "palpate/base/clock.h"
#include "palpate/devices/scripted.h"
#include "palpate/geometry/surface_distance.h"

#include "bench/measure/one_hand.h"
#include "bench/measure/subjects.h"

namespace palpate::bench {
namespace {

// Back to back, ticks come a hundred times as fast as the recorder is made for: after so many the bench
// waits, outside the measured time, until its writer has taken them.
constexpr std::uint64_t kTicksAtOnce = 2000;
constexpr std::chrono::milliseconds kWriterTakes{25};

bool approaching(const haptics::TickRow& row) {
  return row.phase == static_cast<std::uint32_t>(contact::Phase::kApproach);
}

void time_pass(const haptics::SimulationWorld& world, devices::ScriptedDevice& device,
               ScratchRecorder& recorder, std::vector<double>& contact_us, std::vector<double>& approach_us) {
  OneHand hand(world);
  const std::uint64_t last = device.last_tick(world.rate_Hz);
  for (std::uint64_t number = 0; number < last; ++number) {
    if (number % kTicksAtOnce == 0) std::this_thread::sleep_for(kWriterTakes);
    const std::int64_t begun = thread_cpu_ns();
    const haptics::TickRow& row = hand.tick(device, number);
    recorder.put(row);
    const double spent = static_cast<double>(thread_cpu_ns() - begun) / kNanosecondsPerMicrosecond;
    if (!approaching(row)) {
      contact_us.push_back(spent);
    } else if (row.distance <= kNear) {
      approach_us.push_back(spent);
    }
  }
}

}  // namespace

std::vector<WayPoint> walk(const scene::Setup& setup, const haptics::SimulationWorld& world,
                           const scene::ToolPath& path) {
  OneHand hand(world);
  devices::ScriptedDevice device(path);
  const std::uint64_t last = device.last_tick(world.rate_Hz);
  std::vector<WayPoint> way;
  way.reserve(last);
  for (std::uint64_t number = 0; number < last; ++number) {
    const haptics::TickRow& row = hand.tick(device, number);
    const haptics::DeviceState& sample = hand.sample();
    way.push_back({world.mappings[0].apply(sample.position_D, sample.orientation_D), sample.gripper,
                   static_cast<contact::Phase>(row.phase), row.distance});
  }
  if (way.empty()) throw std::runtime_error("bench: the way of the " + setup.name + " scene is empty");
  return way;
}

TickAccount time_ticks(const scene::Setup& setup, const haptics::SimulationWorld& world,
                       const scene::ToolPath& path, int passes) {
  std::vector<double> contact_us;
  std::vector<double> approach_us;
  ScratchRecorder recorder(setup);
  devices::ScriptedDevice device(path);
  for (int pass = 0; pass < passes; ++pass) {
    time_pass(world, device, recorder, contact_us, approach_us);
  }
  if (contact_us.empty())
    throw std::runtime_error("bench: the " + setup.name + " scene never came into contact");
  TickAccount account;
  account.scene = setup.name;
  account.phase = setup.task == scene::Task::kPull ? "pull" : "press";
  account.organ_triangles = setup.organ.triangles.size();
  account.tool_triangles = triangle_count(setup.tools[0]);
  account.contact = figures_of(std::move(contact_us));
  account.approach = figures_of(std::move(approach_us));
  return account;
}

std::vector<Vec3> tip_points(const scene::Setup& setup, const std::vector<WayPoint>& way) {
  Vec3 tip = Vec3::Zero();
  for (const geometry::ToolPart& part : setup.tools[0].parts) {
    for (const Vec3& vertex : part.mesh.vertices) {
      if (vertex.z() > tip.z()) tip = vertex;
    }
  }
  const Pose to_organ = setup.organ_pose.inverse();
  std::vector<Vec3> points;
  points.reserve(way.size());
  for (const WayPoint& at : way) points.push_back(to_organ * (at.handle_W * tip));
  return points;
}

NearestAccount time_nearest(const scene::Setup& setup, const std::vector<WayPoint>& way) {
  const geometry::SurfaceDistance surface(setup.organ);
  const std::vector<Vec3> points = tip_points(setup, way);
  std::vector<double> times_us;
  std::int32_t guess = -1;
  double sum = 0.0;
  for (std::size_t first = 0; first + kPointsAtOnce <= points.size(); first += kPointsAtOnce) {
    const std::int64_t begun = thread_cpu_ns();
    for (std::size_t i = first; i < first + kPointsAtOnce; ++i) {
      const geometry::NearestPoint nearest = surface.nearest(points[i], guess);
      guess = nearest.triangle;
      sum += nearest.distance;
    }
    times_us.push_back(static_cast<double>(thread_cpu_ns() - begun) / kNanosecondsPerMicrosecond /
                       static_cast<double>(kPointsAtOnce));
  }
  volatile double kept = sum;
  static_cast<void>(kept);
  return {setup.organ.triangles.size(), figures_of(std::move(times_us))};
}

}  // namespace palpate::bench
