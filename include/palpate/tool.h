#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "palpate/mesh.h"

namespace palpate {

inline constexpr std::size_t kMaxHands = 4;  // tools (and devices) in one scene
inline constexpr std::size_t kMaxParts = 3;  // rigid parts of one tool

}  // namespace palpate

namespace palpate::geometry {

/// One rigid part of an instrument with the jaws closed. Handle frame, metres.
struct ToolPart {
  std::string name;
  TriangleMesh mesh;  // need not be closed
  bool is_jaw = false;
  Vec3 pivot = Vec3::Zero();  // a point on the jaw's axis [m]
  Vec3 axis = Vec3::UnitY();  // unit
  double open_angle = 0.0;    // [rad], rotation about the axis at gripper 1; may be negative
};

/// A straight needle's tip and shaft, in the handle frame.
struct Needle {
  Vec3 tip = Vec3::Zero();    // [m]
  Vec3 axis = Vec3::UnitZ();  // unit, from the hub to the tip
  double diameter = 1.27e-3;  // [m]
  double length = 90e-3;      // [m], of the shaft from the tip to the hub
};

/// An instrument and its rigid parts. Pose and torque refer to the origin of the handle frame.
struct Tool {
  std::string name;
  std::vector<ToolPart> parts;
  std::optional<double> tip_radius;  // [m], radius of curvature that the user sets
  std::optional<Needle> needle{};    // its tip punctures a tissue that has layers
};

/// [rt] Pose of a part in the handle frame at a gripper opening (0 closed .. 1 open).
[[nodiscard]] Pose part_pose(const ToolPart& part, double gripper) noexcept;

}  // namespace palpate::geometry
