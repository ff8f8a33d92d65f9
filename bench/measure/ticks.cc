#include "bench/measure/ticks.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "core/geometry/signed_distance.h"
#include "io/system/clock.h"
#include "palpate/scripted_device.h"

#include "bench/measure/bench_scene.h"
#include "bench/measure/one_hand.h"

namespace palpate::bench {
namespace {

// Ticks back to back are a hundred times faster than the recorder is designed for. Every kTicksAtOnce ticks
// the bench waits for its writer, outside the measured time.
constexpr std::uint64_t kTicksAtOnce = 2000;
constexpr std::chrono::milliseconds kWriterTakes{25};

bool approaching(const haptics::TickRow& row) {
  return row.phase == static_cast<std::uint32_t>(contact::Phase::kApproach);
}

/// Times of identical work that is repeated in the same order.
class RepeatedTimes final {
 public:
  void begin() { next_ = 0; }

  void add(double time_us) {
    all_us_.push_back(time_us);
    if (next_ == least_us_.size()) least_us_.push_back(time_us);
    least_us_[next_] = std::min(least_us_[next_], time_us);
    ++next_;
  }

  [[nodiscard]] TimeStatistics all() const { return figures_of(all_us_); }
  [[nodiscard]] TimeStatistics least() const { return figures_of(least_us_); }

 private:
  std::vector<double> all_us_;
  std::vector<double> least_us_;
  std::size_t next_ = 0;
};

/// Runs the path repeatedly.
class Passes final {
 public:
  Passes(const haptics::SimulationWorld& world, const scene::Scene& scene, const scene::ToolPath& path)
      : world_(world), device_(path), recorder_(scene) {}

  void run(int passes) {
    for (int pass = 0; pass < passes; ++pass)
      go(kTicksAtOnce * static_cast<std::uint64_t>(pass) / static_cast<std::uint64_t>(passes));
  }

  void report(TickAccount& account) const {
    account.contact = contact_.all();
    account.approach = approach_.all();
    account.contact_least = contact_.least();
    account.approach_least = approach_.least();
    account.first = figures_of(first_us_);
  }

 private:
  /// @param shift of the ticks before which the writer is waited for; ticks after a wait are slow, so each
  /// pass uses others
  void go(std::uint64_t shift) {
    contact_.begin();
    approach_.begin();
    OneHand hand(world_);
    const std::uint64_t last = device_.last_tick(world_.rate_Hz);
    hand.warm_up();
    for (std::uint64_t number = 0; number < last; ++number) {
      if ((number + shift) % kTicksAtOnce == 0) std::this_thread::sleep_for(kWriterTakes);
      const std::int64_t begun = thread_cpu_ns();
      const haptics::TickRow& row = hand.tick(device_, number);
      recorder_.on_row(row);
      const double spent = static_cast<double>(thread_cpu_ns() - begun) / kNanosecondsPerMicrosecond;
      if (number == 0) first_us_.push_back(spent);
      if (!approaching(row)) {
        contact_.add(spent);
      } else if (row.distance <= kNear) {
        approach_.add(spent);
      }
    }
  }

  const haptics::SimulationWorld& world_;
  devices::ScriptedDevice device_;
  ScratchRecorder recorder_;
  RepeatedTimes contact_;
  RepeatedTimes approach_;
  std::vector<double> first_us_;
};

}  // namespace

std::vector<PathPoint> run_path(const scene::Scene& scene, const haptics::SimulationWorld& world,
                                const scene::ToolPath& path) {
  OneHand hand(world);
  devices::ScriptedDevice device(path);
  const std::uint64_t last = device.last_tick(world.rate_Hz);
  std::vector<PathPoint> way;
  way.reserve(last);
  for (std::uint64_t number = 0; number < last; ++number) {
    const haptics::TickRow& row = hand.tick(device, number);
    const haptics::DeviceState& sample = hand.sample();
    way.push_back({world.mappings[0].apply(sample.position_D, sample.orientation_D), sample.gripper,
                   static_cast<contact::Phase>(row.phase), row.distance});
  }
  if (way.empty()) throw std::runtime_error("bench: the path of the " + scene.name + " scene is empty");
  return way;
}

TickAccount time_ticks(const scene::Scene& scene, const haptics::SimulationWorld& world,
                       const scene::ToolPath& path, int passes) {
  Passes times(world, scene, path);
  times.run(passes);
  TickAccount account;
  account.scene = scene.name;
  account.phase = scene::to_string(scene.task);
  account.organ_triangles = scene.organ.triangles.size();
  account.tool_triangles = triangle_count(scene.tools[0]);
  account.repeats = passes;
  times.report(account);
  if (account.contact.samples == 0)
    throw std::runtime_error("bench: the " + scene.name + " scene never came into contact");
  return account;
}

std::vector<Vec3> tip_points(const scene::Scene& scene, const std::vector<PathPoint>& way) {
  Vec3 tip = Vec3::Zero();
  for (const geometry::ToolPart& part : scene.tools[0].parts) {
    for (const Vec3& vertex : part.mesh.vertices) {
      if (vertex.z() > tip.z()) tip = vertex;
    }
  }
  const Pose to_organ = scene.organ_pose.inverse();
  std::vector<Vec3> points;
  points.reserve(way.size());
  for (const PathPoint& at : way) points.push_back(to_organ * (at.handle_W * tip));
  return points;
}

NearestAccount time_nearest(const scene::Scene& scene, const std::vector<PathPoint>& way) {
  const geometry::SignedDistance surface(scene.organ);
  const std::vector<Vec3> points = tip_points(scene, way);
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
  return {scene.organ.triangles.size(), figures_of(std::move(times_us))};
}

}  // namespace palpate::bench
