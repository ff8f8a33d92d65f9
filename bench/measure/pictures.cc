#include "bench/measure/pictures.h"

#include <ctime>
#include <vector>

#include "io/system/clock.h"
#include "palpate/scripted_device.h"

#include "bench/measure/bench_scene.h"
#include "bench/measure/one_hand.h"

namespace palpate::bench {
namespace {

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr std::uint64_t kTicksAFrame = 16;  // 1 kHz, about 60 pictures per second
constexpr std::size_t kMaxFrames = 240;
constexpr std::size_t kPictureWarmUp = 3;  // frames: shaders are compiled at their first use
constexpr double kViewTurn = 0.026;        // rad a picture: a turn in 4 s at 60 pictures a second

std::int64_t process_cpu_ns() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

// Snapshots from first contact on, one every kTicksAFrame ticks.
std::vector<haptics::Snapshot> moments_of(const scene::Scene& scene) {
  const Prepared prepared = prepare(scene);
  OneHand hand(prepared.world);
  devices::ScriptedDevice device(scene::default_path(scene, 0));
  std::vector<haptics::Snapshot> moments;
  const std::uint64_t last = device.last_tick(prepared.world.rate_Hz);
  for (std::uint64_t number = 0; number < last && moments.size() < kMaxFrames; ++number) {
    hand.tick(device, number);
    if (number % kTicksAFrame != 0 || hand.tick_state().state.results[0].view_count == 0) continue;
    haptics::make_snapshot(hand.tick_state(), moments.emplace_back());
  }
  return moments;
}

// A renderer and the times of its frames [us].
struct Frames {
  Frames(const render::Subject& subject, render::Quality quality)
      : renderer(subject, kWidth, kHeight, quality) {}

  void time(const haptics::Snapshot& moment, const render::Camera& camera) {
    const std::int64_t begun = monotonic_ns();
    const std::int64_t spent = process_cpu_ns();
    renderer.draw_and_keep(moment, camera);
    renderer.finish();
    wall.push_back(static_cast<double>(monotonic_ns() - begun) / kNanosecondsPerMicrosecond);
    computed.push_back(static_cast<double>(process_cpu_ns() - spent) / kNanosecondsPerMicrosecond);
    deformation.push_back(renderer.update_ms() * 1e3);
  }

  render::OffscreenRenderer renderer;
  std::vector<double> deformation;
  std::vector<double> wall;
  std::vector<double> computed;
};

}  // namespace

PictureAccount time_pictures(const std::string& task, std::size_t organ_triangles, render::Quality quality) {
  const scene::Scene scene = bench_scene(task, 0, 0);
  const std::vector<haptics::Snapshot> moments = moments_of(scene);
  render::Subject drawn{scene.organ, scene.tools, scene.tissue.reach, scene.tissue.name};
  if (organ_triangles > 0) drawn.organ = bench_scene(task, organ_triangles, 0).organ;

  PictureAccount account;
  account.scene = scene.name;
  account.organ_triangles = drawn.organ.triangles.size();
  account.quality = quality == render::Quality::kFast ? "fast" : "balanced";
  Frames changes(drawn, quality);
  Frames redraws(drawn, quality);
  Frames turned(drawn, quality);
  Frames drape(drawn, quality);
  drape.renderer.show_drape(true);
  account.driver = changes.renderer.driver();
  const contact::ToolResult& middle = moments.at(moments.size() / 2).results[0];
  const render::Camera camera =
      render::frame_contact(drawn, moments.at(moments.size() / 2), middle.contact_W, middle.normal_W, false);
  for (std::size_t i = 0; i < kPictureWarmUp; ++i) {
    for (Frames* frames : {&changes, &redraws, &turned, &drape})
      frames->renderer.draw_and_keep(moments.front(), camera);
  }
  render::Camera turning = camera;
  for (const haptics::Snapshot& moment : moments) {
    changes.time(moment, camera);
    redraws.renderer.redraw_all();
    redraws.time(moment, camera);
    const Vec3 to_eye = turning.eye - turning.target;
    turning.eye = turning.target + Eigen::AngleAxisd(kViewTurn, Vec3::UnitZ()) * to_eye;
    turned.time(moment, turning);
    drape.time(moment, turning);
  }
  account.deformation = figures_of(std::move(changes.deformation));
  account.frame = figures_of(std::move(changes.wall));
  account.frame_computed = figures_of(std::move(changes.computed));
  account.redraw_computed = figures_of(std::move(redraws.computed));
  account.turned_computed = figures_of(std::move(turned.computed));
  account.drape_computed = figures_of(std::move(drape.computed));
  return account;
}

}  // namespace palpate::bench
