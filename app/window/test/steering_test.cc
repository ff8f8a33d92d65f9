// The mouse's tool under the pointer, without a display: rays through a picture, and every tick computed.
#include "app/window/steering.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/contact/state.h"
#include "core/geometry/ray.h"
#include "core/haptics/simulation.h"
#include "io/system/test/own_cache.h"
#include "palpate/scene.h"

namespace palpate::app {
namespace {

constexpr double kAspect = 4.0 / 3.0;
constexpr double kFrame = 0.016;  // s
// Over the liver's upper side in the first picture, as fractions of its width and height.
constexpr double kLeft = 0.3;
constexpr double kRight = 0.62;
constexpr double kUpperSide = 0.26;

/// A run whose ticks and frames a test computes.
class SteeredRun {
 public:
  explicit SteeredRun(const std::string& organ, const std::string& tissue, const std::string& tool,
                      const std::string& task = "press")
      : session_(prepare(scene::load(request_of(organ, tissue, tool, task)), std::nullopt, false)),
        state_(session_->world()) {
    steering.take(*session_);
    const scene::Scene& scene = session_->scene();
    shown.organ_W = scene.organ_pose;
    frames(1);
    camera.look_as(render::frame_contact({scene.organ, scene.tools, scene.tissue.reach, scene.tissue.name},
                                         shown, shown.results[0].nearest_W, shown.results[0].away_W, false),
                   kAspect);
  }

  /// Points at a place of the picture, 0 to 1 from its upper left corner.
  void point(double x, double y) { steering.point_at(ray_through(camera.camera(), kAspect, x, y)); }
  /// The frames of this many pictures, with the ticks in between.
  void frames(int count) {
    for (int i = 0; i < count; ++i) {
      steering.update_devices(camera, shown, kFrame);
      for (int tick = 0; tick < 16; ++tick) this->tick();
    }
  }
  /// Frames until the tool rests, or for 4 s.
  void settle() { frames_while_moving(250, 1); }
  /// At most this many frames: fewer if the tool has not moved for the last `at_rest` of them.
  void frames_while_moving(int most, int at_rest = 8) {
    int unmoved = 0;
    for (int i = 0; i < most && unmoved < at_rest; ++i) {
      const Pose before = shown.tools[0].pose_W;
      frames(1);
      unmoved = (shown.tools[0].pose_W.position - before.position).norm() < 1e-7 ? unmoved + 1 : 0;
    }
  }
  [[nodiscard]] double depth() const { return shown.results[0].depth; }
  [[nodiscard]] const Session& session() const { return *session_; }
  [[nodiscard]] Vec3 tool() const { return shown.tools[0].pose_W.position; }
  /// Distance of a world point from the line of sight through a place of the picture [m].
  [[nodiscard]] double off_sight(const Vec3& point_W, double x, double y) const {
    const geometry::Ray ray = ray_through(camera.camera(), kAspect, x, y);
    return (point_W - ray.origin).cross(ray.direction).norm();
  }
  Steering steering;
  OrbitCamera camera;
  haptics::Snapshot shown;
  double shallowest = 1.0;  // m, over the ticks since reset_extremes()
  double deepest = 0.0;
  double fastest = 0.0;       // m/s, tip of the tool; without a shaft, its centre
  std::uint32_t buttons = 0;  // seen by the ticks
  void reset_extremes() {
    shallowest = 1.0;
    deepest = fastest = 0.0;
  }

 private:
  static scene::Overrides request_of(const std::string& organ, const std::string& tissue,
                                     const std::string& tool, const std::string& task) {
    scene::Overrides request;
    request.organ = organ;
    request.tissue = tissue;
    request.tools = {tool};
    request.task = task;
    request.device = "mouse";
    return request;
  }
  void tick() {
    const haptics::DeviceState sample = session_->devices()[0]->read(tick_, 0.0);
    haptics::tick(session_->world(), state_, tick_, {&sample, 1}, commands_, rows_);
    haptics::make_snapshot({state_, commands_, tick_}, shown);
    ++tick_;
    shallowest = std::min(shallowest, depth());
    deepest = std::max(deepest, depth());
    fastest = std::max(fastest, sample.velocity_D.norm());
    buttons |= sample.buttons;
  }

  std::unique_ptr<Session> session_;
  haptics::SimulationState state_;
  std::vector<haptics::ForceCommand> commands_{1};
  std::vector<haptics::TickRow> rows_{1};
  std::uint64_t tick_ = 0;
};

TEST(Steering, ASweepOverTheLiverStaysAtTheSetDepth) {
  for (const char* tool : {"sphere:5", "straight-forceps"}) {
    SCOPED_TRACE(tool);
    SteeredRun run("liver", "liver", tool);
    run.point(kLeft, kUpperSide);
    run.steering.wheel_turned(10.0, false);  // from 5 mm above to 5 mm deep
    EXPECT_NEAR(run.steering.set_depth(), 5e-3, 1e-12);
    run.settle();
    run.reset_extremes();
    constexpr int kSteps = 300;  // 4.8 s
    for (int step = 0; step <= kSteps; ++step) {
      run.point(kLeft + (kRight - kLeft) * step / kSteps, kUpperSide);
      run.frames(1);
    }
    EXPECT_GT(run.shallowest, 4.7e-3);
    EXPECT_LT(run.deepest, 5.3e-3);
    EXPECT_LT(run.off_sight(run.shown.results[0].contact_W, kRight, kUpperSide), 3e-3) << "it kept up";
  }
}

TEST(Steering, WhereverThePointerJumpsTheToolTouchesNothingBeforeThePress) {
  const auto wander = [](const std::string& organ, const std::string& tool) {
    SteeredRun run(organ, organ, tool);
    double deepest = 0.0;
    for (int i = 0; i < 24; ++i) {  // to and fro over the whole picture
      run.point(std::fmod(0.1 + 0.618 * i, 0.96), std::fmod(0.05 + 0.37 * i, 0.96));
      run.frames_while_moving(i % 4 == 3 ? 15 : 120);  // some jumps come in mid-flight
      deepest = std::max(deepest, run.deepest);
    }
    return deepest;
  };
  EXPECT_LT(wander("liver", "sphere:5"), 0.1e-3);
  EXPECT_LT(wander("heart", "sphere:5"), 0.1e-3);
  EXPECT_LT(wander("liver", "straight-forceps"), 0.1e-3);
  EXPECT_LT(wander("gallbladder", "curved-forceps"), 0.1e-3);
}

TEST(Steering, AToolIsNeverSeenFromItsEndWhereItWouldHideTheContact) {
  SteeredRun run("gallbladder", "gallbladder", "curved-forceps");
  for (const auto& [x, y] : {std::pair{0.4, 0.55}, {0.45, 0.65}, {0.5, 0.7}, {0.55, 0.6}}) {
    run.point(x, y);
    run.settle();
    const Vec3 handle = -(run.shown.tools[0].pose_W.rotation * Vec3::UnitZ());
    const Vec3 to_viewer = ray_through(run.camera.camera(), kAspect, x, y).origin - run.tool();
    EXPECT_LT(handle.dot(to_viewer.normalized()), std::cos(0.35)) << x << ", " << y;
  }
}

TEST(Steering, ALineOfSightMeetsThePlaceThatItIsThrough) {
  const render::Camera camera{Vec3(0.1, -0.3, 0.2), Vec3(0.02, 0.01, 0.0), Vec3::UnitZ(), 28.0};
  const geometry::Ray ray = ray_through(camera, kAspect, 0.2, 0.7);
  const std::optional<PicturePlace> place = place_of(ray.origin + 0.35 * ray.direction, camera, kAspect);
  ASSERT_TRUE(place.has_value());
  EXPECT_NEAR(place->x, 0.2, 1e-12);
  EXPECT_NEAR(place->y, 0.7, 1e-12);
  EXPECT_FALSE(place_of(ray.origin - 0.1 * ray.direction, camera, kAspect).has_value());
}

TEST(Steering, AJumpOfThePointerGoesNeitherDeeperNorFasterThanAHand) {
  SteeredRun run("liver", "liver", "sphere:5");
  run.point(kLeft, kUpperSide);
  run.steering.wheel_turned(10.0, false);
  run.settle();
  for (const auto& [x, y] :
       {std::pair(0.85, 0.25), std::pair(0.25, 0.7), std::pair(0.55, 0.65), std::pair(0.4, 0.25)}) {
    run.point(x, y);
    run.settle();
    EXPECT_LT(run.deepest, 7e-3) << x << ' ' << y;
    EXPECT_LE(run.fastest, 1.001 * devices::TargetFollower::kMaxSpeed) << x << ' ' << y;
    // The third place lies in a gap that is too narrow for the ball: it stays before the gap.
    const bool in_gap = x == 0.55;
    EXPECT_LT(run.off_sight(run.shown.results[0].contact_W, x, y), in_gap ? 10e-3 : 3e-3) << x << ' ' << y;
  }
  EXPECT_NEAR(run.depth(), 5e-3, 0.3e-3);
}

TEST(Steering, BesideTheOrganTheToolGlidesUnderThePointerWithoutTouching) {
  SteeredRun run("liver", "liver", "sphere:5");
  run.point(kLeft, kUpperSide);
  run.steering.wheel_turned(10.0, false);
  run.settle();
  for (const auto& [x, y] : {std::pair(0.3, 0.1), std::pair(0.08, 0.5), std::pair(0.5, 0.95)}) {
    run.point(x, y);
    run.settle();
    EXPECT_EQ(run.shown.results[0].phase, contact::Phase::kApproach);
    EXPECT_GT(run.shown.results[0].distance, devices::SurfaceRider::kHover - 1e-3);
    EXPECT_LT(run.off_sight(run.tool(), x, y), 12e-3) << "in the picture, by the pointer";
  }
  run.reset_extremes();
  run.point(kLeft, kUpperSide);
  run.settle();
  EXPECT_LT(run.deepest, 5.3e-3) << "on the way around the liver";
  EXPECT_NEAR(run.depth(), 5e-3, 0.3e-3) << "back over the organ it is as deep as before";
}

TEST(Steering, OverGapsAndVesselsTheToolStaysNearTheOrgan) {
  SteeredRun run("liver", "liver", "curved-forceps");
  const geometry::TriangleMesh& organ = run.session().scene().organ;
  double farthest = 0.0;
  for (int row = 0; row <= 16; ++row) {
    for (int column = 0; column <= 16; ++column) {
      const double x = 0.15 + 0.045 * (row % 2 == 0 ? column : 16 - column);
      const double y = 0.25 + 0.035 * row;
      if (!geometry::seen_point(organ, ray_through(run.camera.camera(), kAspect, x, y))) continue;
      run.point(x, y);
      run.frames_while_moving(20);
      for (int i = 0; i < 6; ++i) {
        run.frames_while_moving(6, 2);
        farthest = std::max(farthest, run.shown.results[0].distance);
      }
    }
  }
  EXPECT_LT(farthest, 50e-3) << "places behind the hilum's gaps are out of reach";
}

TEST(Steering, AParkedToolLeavesTheOrganAndComesBackToItsDepth) {
  SteeredRun run("ball", "liver", "sphere:5");
  run.point(0.45, 0.5);
  run.steering.wheel_turned(8.0, false);
  run.settle();
  run.steering.toggle_parked();
  run.point(0.55, 0.5);
  run.settle();
  EXPECT_NEAR(run.shown.results[0].distance, devices::SurfaceRider::kParked, 1e-3);
  run.steering.toggle_parked();
  run.settle();
  EXPECT_NEAR(run.depth(), 3e-3, 0.3e-3);
  EXPECT_LT(run.off_sight(run.shown.results[0].contact_W, 0.55, 0.5), 3e-3);
}

TEST(Steering, OnAPanelThePointerLeavesTheToolAsDeepAsItIs) {
  SteeredRun run("ball", "liver", "sphere:5");
  run.point(0.45, 0.5);
  run.steering.wheel_turned(9.0, false);
  run.settle();
  const Vec3 before = run.tool();
  run.steering.freeze();
  run.frames(30);
  EXPECT_LT((run.tool() - before).norm(), 1e-6);
  EXPECT_NEAR(run.depth(), 4e-3, 0.3e-3);
}

TEST(Steering, AGripPullsTheTissueAfterThePointerAndLetsGo) {
  SteeredRun run("gallbladder", "gallbladder", "curved-forceps", "pull");
  const Vec3 start_W = run.shown.results[0].nearest_W;
  run.camera.look_as({start_W + Vec3(0.0, -0.2, 0.1), start_W, Vec3::UnitZ(), 30.0}, kAspect);
  run.point(0.5, 0.5);
  run.steering.wheel_turned(5.5, false);  // half a millimetre deep
  run.settle();
  run.steering.grip(true);
  run.frames(60);
  ASSERT_EQ(run.shown.results[0].phase, contact::Phase::kPull);
  const double height = run.camera.height_at_target();
  run.point(0.5, 0.5 - 10e-3 / height);  // 10 mm upwards in the picture
  run.frames(60);
  ASSERT_EQ(run.shown.results[0].phase, contact::Phase::kPull);
  EXPECT_NEAR(run.depth(), 10e-3, 2e-3) << "the stretch";
  run.steering.grip(false);
  run.settle();
  EXPECT_NE(run.shown.results[0].phase, contact::Phase::kPull);
  EXPECT_LT(run.depth(), 2e-3);
}

TEST(Steering, TheWheelPressesADraggedToolNoDeeperThanAFreeOne) {
  const SteeredRun run("gallbladder", "gallbladder", "curved-forceps", "pull");
  const haptics::SimulationWorld& world = run.session().world();
  devices::SurfaceRider rider(world.contact.data().surface, run.session().scene().tools[0], world.organ_W,
                              run.shown.tools[0].pose_W, 1.0, 0.2);
  rider.point_at(ray_through(run.camera.camera(), kAspect, 0.5, 0.5));
  rider.advance(kFrame, 0.0, true, 1.0);
  const Vec3 gripped_W = rider.target().tip_W;
  for (int i = 0; i < 160; ++i) {
    rider.press(0.5e-3);
    rider.advance(kFrame, 0.0, true, 1.0);
  }
  EXPECT_NEAR((rider.target().tip_W - gripped_W).norm(), devices::SurfaceRider::kMaxDepth, 1e-3);
}

/// A needle through skin and fat into the muscle of a block.
class InsertedNeedle {
 public:
  InsertedNeedle() : run("box", "skin-fat-muscle", "needle", "insert") {
    run.point(0.5, 0.5);
    run.settle();
    for (int notch = 0; notch < 200 && result().needle.layer < 3; ++notch) {
      run.steering.wheel_turned(1.0, false);
      run.settle();
    }
  }
  [[nodiscard]] const contact::ToolResult& result() const { return run.shown.results[0]; }
  /// Unit, from the hub to the tip.
  [[nodiscard]] Vec3 axis() const { return run.shown.tools[0].pose_W.rotation * Vec3::UnitZ(); }

  SteeredRun run;
};

TEST(Steering, ANotchInwardsMovesANeedleLessWhereItMeetsMoreForce) {
  SteeredRun free("box", "skin-fat-muscle", "needle", "insert");
  free.point(0.5, 0.5);
  free.settle();
  const double above = free.steering.set_depth();
  free.steering.wheel_turned(1.0, false);
  EXPECT_NEAR(free.steering.set_depth() - above, 1e-3, 1e-12) << "in the air a whole millimetre";

  InsertedNeedle needle;
  ASSERT_EQ(needle.result().needle.layer, 3U);
  const double force = -needle.result().force_W.dot(needle.axis());
  ASSERT_GT(force, 1.0);
  double before = needle.run.steering.set_depth();
  needle.run.steering.wheel_turned(1.0, false);
  EXPECT_NEAR(needle.run.steering.set_depth() - before, 1e-3 * 3.0 / (3.0 + force), 1e-8);
  before = needle.run.steering.set_depth();
  needle.run.steering.wheel_turned(-1.0, false);
  EXPECT_NEAR(before - needle.run.steering.set_depth(), 1e-3, 1e-12);
}

TEST(Steering, ANeedleInTheTissueKeepsToItsAxisWhereverThePointerIs) {
  InsertedNeedle needle;
  const Vec3 axis = needle.axis();
  const Vec3 start = needle.run.tool();
  const double inside = needle.result().needle.length;
  for (const double x : {0.6, 0.3, 0.02}) {  // the last is beside the organ
    needle.run.point(x, 0.4);
    needle.run.steering.wheel_turned(4.0, false);
    needle.run.settle();
    const Vec3 moved = needle.run.tool() - start;
    EXPECT_LT((moved - moved.dot(axis) * axis).norm(), 1e-5) << x;
    EXPECT_LT(needle.axis().cross(axis).norm(), 1e-5) << x;
  }
  EXPECT_GT(needle.result().needle.length, inside + 3e-3);
  needle.run.steering.wheel_turned(-200.0, false);
  needle.run.point(0.5, 0.45);
  needle.run.settle();
  EXPECT_EQ(needle.result().phase, contact::Phase::kApproach);
  EXPECT_EQ(needle.result().needle.length, 0.0);
}

TEST(Steering, ANeedleGoesInByMoreThanATool) {
  SteeredRun run("box", "skin-fat-muscle", "needle", "insert");
  run.steering.wheel_turned(1000.0, false);
  EXPECT_NEAR(run.steering.set_depth(), 90e-3, 1e-9) << "its length";
}

TEST(Steering, AClickThatEndsWithinOnePictureStillCounts) {
  SteeredRun run("ball", "liver", "sphere:5", "press");
  run.steering.grip(true);
  run.steering.grip(false);
  run.buttons = 0;
  run.frames(1);
  EXPECT_EQ(run.buttons, 1U);
  run.frames(MouseHand::kClickFrames + 1);
  run.buttons = 0;
  run.frames(1);
  EXPECT_EQ(run.buttons, 0U) << "released again";
}

}  // namespace
}  // namespace palpate::app
