#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "palpate/base/pose.h"
#include "palpate/geometry/mesh.h"
#include "palpate/geometry/tool.h"
#include "palpate/model/organ_motion.h"
#include "palpate/model/tissue.h"
#include "palpate/noise/touch_noise.h"
#include "palpate/scene/emulated_hand.h"

namespace palpate::scene {

enum class Task { kPress, kPull };

inline constexpr std::size_t kMaxHands = 4;      // tools (and devices) in one scene
inline constexpr std::size_t kMaxToolParts = 3;  // rigid parts of one tool that contact solves

inline constexpr double kSlowestRate = 100.0;  // Hz, of the loop
inline constexpr double kFastestRate = 20000.0;

/// Mechanics of a device by itself, for the stability check (docs/safety.md) and the emulated hand.
/// Empty: not known.
struct DeviceDynamics {
  std::optional<double> damping;     // N s/m, viscous
  std::optional<double> friction;    // N, Coulomb
  std::optional<double> resolution;  // m, of its position sensors
};

/// How the device's sample becomes the tool's pose: translation scaled, then placed by `base`.
struct DeviceSetup {
  std::string kind = "scripted";  // a name of device_kinds.h
  std::string path;               // file or address, resolved; empty: none given
  double workspace_scale = 1.0;   // > 0
  Pose base;
  DeviceDynamics dynamics{};
  EmulatedHand emulated{};                       // of kind "emulated" only
  std::optional<std::uint32_t> clutch_button{};  // bit of DeviceState::buttons; while held the tool stays
};

/// Limits of the gate; SI (slew per second).
struct SafetySetup {
  double max_force = 20.0;        // N
  double max_slew = 5000.0;       // N/s
  double max_torque = 0.2;        // N m
  double max_torque_slew = 50.0;  // N m/s
};

/// One scene, fully resolved and checked: everything the simulation needs, in SI, no file left to read.
struct Setup {
  std::string name;
  Task task = Task::kPress;
  double rate_Hz = 1000.0;
  std::uint64_t seed = 1;
  std::string organ_name;        // built-in name or file, for people
  geometry::TriangleMesh organ;  // organ frame, m
  Pose organ_pose;               // at rest
  std::vector<model::OrganMotionParameters>
      organ_motion;  // all at once, about the middle of its box; empty: it lies still
  model::TissueParameters tissue;
  std::vector<geometry::Tool> tools;  // one a hand
  std::vector<DeviceSetup> devices;   // one a hand
  noise::NoiseSettings noise;
  SafetySetup safety;
  // Told to the user, kept in the recording and shown in the report:
  std::vector<std::string> repairs;  // what was done to meshes from files, each beginning with the file
  std::vector<std::string> remarks;  // defects left, warnings
};

}  // namespace palpate::scene
