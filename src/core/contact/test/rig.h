#pragma once
// Test fixture of the contact tests: a tool, an organ and a hand that moves the tool.
#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/contact/contact.h"
#include "core/contact/test/prepared_once.h"
#include "palpate/mesh.h"

namespace palpate::contact::test {

/// The tissue of the example in docs/model.md with a first layer of 8 mm, without friction and damping.
inline model::TissueParameters plain_tissue() {
  model::TissueParameters tissue;
  tissue.name = "plain";
  tissue.k1 = 18.0;
  tissue.beta = 1.6;
  tissue.q = 0.7;
  tissue.rest_length = 14e-3;
  tissue.max_length = 22e-3;
  tissue.min_length = 6e-3;
  tissue.t1 = 1e-6;
  tissue.contact.friction = 0.0;
  tissue.contact.damping = 0.0;
  return tissue;
}

inline geometry::Tool one_part_tool(geometry::TriangleMesh mesh) {
  geometry::Tool tool;
  tool.name = "test tool";
  tool.parts.emplace_back();
  tool.parts.front().name = "body";
  tool.parts.front().mesh = std::move(mesh);
  return tool;
}

inline geometry::TriangleMesh turned(geometry::TriangleMesh mesh, const Quat& rotation) {
  geometry::transform(mesh, Pose{rotation, Vec3::Zero()});
  return mesh;
}

inline geometry::TriangleMesh moved(geometry::TriangleMesh mesh, const Vec3& by) {
  geometry::transform(mesh, Pose{Quat::Identity(), by});
  return mesh;
}

inline double lowest_z(const geometry::TriangleMesh& mesh) { return geometry::bounds(mesh).low.z(); }

/// A box whose top face has its middle at the origin.
inline geometry::TriangleMesh block(const Vec3& size, double longest) {
  return moved(geometry::make_box(size, longest), Vec3(0.0, 0.0, -0.5 * size.z()));
}

inline Pose place(const Vec3& position) { return {Quat::Identity(), position}; }

/// One tool on one organ; the test runs the ticks.
class Rig final {
 public:
  Rig(const geometry::TriangleMesh& organ, const geometry::Tool& tool, const model::TissueParameters& tissue,
      double rate_Hz = 1000.0)
      : world_(organ, {tool}, tissue, 1.0 / rate_Hz, prepared_once()), state_(world_), rate_Hz_(rate_Hz) {}

  const ToolResult& tick(const Pose& pose, double gripper = 0.0) {
    pose_ = pose;
    gripper_ = gripper;
    const ToolInput input{pose, gripper};
    advance(world_, organ_W, {&input, 1}, state_, {&result_, 1});
    if (watch_) watch_(result_);
    return result_;
  }

  /// Moves straight to `goal` at `speed` [m/s].
  const ToolResult& move_to(const Vec3& goal, double speed) {
    const Pose from = pose_;
    const double length = (goal - from.position).norm();
    const int ticks = std::max(1, static_cast<int>(length / speed * rate_Hz_));
    for (int i = 1; i <= ticks; ++i) {
      tick({from.rotation, from.position + (goal - from.position) * (static_cast<double>(i) / ticks)},
           gripper_);
    }
    return result_;
  }

  const ToolResult& hold(double seconds) {
    const int ticks = static_cast<int>(seconds * rate_Hz_);
    for (int i = 0; i < ticks; ++i) tick(pose_, gripper_);
    return result_;
  }

  void each_tick(std::function<void(const ToolResult&)> watch) { watch_ = std::move(watch); }

  [[nodiscard]] const World& world() const { return world_; }
  [[nodiscard]] const ToolResult& result() const { return result_; }
  [[nodiscard]] const Pose& pose() const { return pose_; }

  Pose organ_W;

 private:
  World world_;
  State state_;
  double rate_Hz_;
  Pose pose_;
  double gripper_ = 0.0;
  ToolResult result_;
  std::function<void(const ToolResult&)> watch_;
};

/// Largest change of force and torque between ticks, and their peaks.
class StepMeter final {
 public:
  void operator()(const ToolResult& result) {
    if (started_) {
      force_step_ = std::max(force_step_, (result.force_W - force_).norm());
      torque_step_ = std::max(torque_step_, (result.torque_W - torque_).norm());
    }
    started_ = true;
    force_ = result.force_W;
    torque_ = result.torque_W;
    peak_force_ = std::max(peak_force_, force_.norm());
  }

  /// Largest force step, relative to the peak force.
  [[nodiscard]] double force_step() const { return force_step_ / peak_force_; }
  /// Largest torque step, relative to peak force x 10 mm.
  [[nodiscard]] double torque_step() const { return torque_step_ / (peak_force_ * 10e-3); }
  [[nodiscard]] double peak_force() const { return peak_force_; }

 private:
  bool started_ = false;
  Vec3 force_ = Vec3::Zero();
  Vec3 torque_ = Vec3::Zero();
  double force_step_ = 0.0;
  double torque_step_ = 0.0;
  double peak_force_ = 0.0;
};

}  // namespace palpate::contact::test
