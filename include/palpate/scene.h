#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/device.h"
#include "palpate/mesh.h"
#include "palpate/organ_motion.h"
#include "palpate/pose.h"
#include "palpate/tissue.h"
#include "palpate/tool.h"
#include "palpate/touch_noise.h"

namespace palpate::scene {

/// What can be made to go wrong with an emulated device.
enum class EmulatedFaultKind : std::uint8_t {
  kFreeze,      // the last good sample again and again, growing old
  kDropOut,     // it cannot be read
  kNotANumber,  // a position that is no number
  kSpike,       // the position 50 mm off, along the device's -z
  kLate,        // every sample is `age` old
  kWrongUnits,  // positions in mm where m are due: a thousand times too far
  kForceOff,    // the device says that it switched its force off, and does
  kRefuse,      // it refuses every command
};

struct EmulatedFaultName {
  std::string_view name;  // as in a scene
  EmulatedFaultKind kind;
};

/// [any] All kinds with their names, in the order in which they are listed to people.
[[nodiscard]] std::span<const EmulatedFaultName> emulated_fault_names() noexcept;

/// [any]
[[nodiscard]] std::string_view name_of(EmulatedFaultKind kind) noexcept;

/// [any] The kind of that name, if there is one.
[[nodiscard]] std::optional<EmulatedFaultKind> find_emulated_fault(std::string_view name) noexcept;

inline constexpr double kLongestFaultAge = 1.0;  // s, of late samples

/// One fault and when it happens, in the time of the ticks.
struct EmulatedFault {
  EmulatedFaultKind kind = EmulatedFaultKind::kFreeze;
  double time = 0.0;      // s, >= 0: the first tick at or after it
  double duration = 0.0;  // s, >= 0; 0: one tick
  double age = 8e-3;      // s, of late samples; > 0, at most kLongestFaultAge
};

/// The hand's pull towards where it wants to be.
struct HandGrip {
  double stiffness = 0.0;  // N/m, >= 0
  double damping = 0.0;    // N s/m, >= 0
};

// A hand that holds harder is stiffer and better damped [Hasser and Cutkosky 2002]; a finger's measured
// stiffness is some hundred N/m [Hajian and Howe 1997]. The damping is chosen low, so that what is stable
// here does not owe it to the hand.
inline constexpr HandGrip kLightGrip{50.0, 1.0};
inline constexpr HandGrip kFirmGrip{500.0, 5.0};

// A calm device of the desk-top kind, unless a scene says otherwise.
inline constexpr double kEmulatedDamping = 1.5;      // N s/m: enough for every built-in tissue at 1 kHz
inline constexpr double kEmulatedFriction = 0.05;    // N
inline constexpr double kEmulatedResolution = 1e-5;  // m

/// What only the emulated hand has, beside DeviceDynamics.
struct EmulatedHand {
  double mass = 0.25;  // kg, > 0: the moving part of the device and of the hand
  HandGrip grip = kFirmGrip;
  std::vector<EmulatedFault> faults{};
};

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

/// How positions of a tool path go between its rows.
enum class PathInterpolation : std::uint8_t {
  kLinear,  // velocity steps at each row, and the damping force with it
  kCubic    // continuous velocity, never beyond two neighbouring rows
};

/// [any] "linear", "cubic".
[[nodiscard]] const char* to_string(PathInterpolation interpolation) noexcept;
[[nodiscard]] std::optional<PathInterpolation> interpolation_of(std::string_view name) noexcept;

/// How the device's sample becomes the tool's pose: translation scaled, then placed by `base`.
struct DeviceSetup {
  std::string kind = "scripted";  // a name of device_kinds.h
  std::string path;               // file or address, resolved; empty: none given
  double workspace_scale = 1.0;   // > 0
  Pose base;
  DeviceDynamics dynamics{};
  EmulatedHand emulated{};                       // of kind "emulated" only
  std::optional<std::uint32_t> clutch_button{};  // bit of DeviceState::buttons; while held the tool stays
  bool fit = false;                              // the force is scaled to the stiffness that the device bears
  haptics::DeviceAbilities abilities{};          // of the device that was opened
  double force_scale = 1.0;  // of the tissue's force on the hand; 1 unless `fit` lowered it
  PathInterpolation interpolation = PathInterpolation::kLinear;  // of a tool path's file
  double path_speed = 1.0;  // > 0: tool paths, the default one too, take 1 / path_speed of their time
};

/// Limits of the gate; SI (slew per second). A scene may ask for at most 2.5 times the force of the strongest
/// arm that docs/devices.md names: kMostForce and so on.
struct SafetySetup {
  static constexpr double kMostForce = 50.0;      // N
  static constexpr double kMostSlew = 50e3;       // N/s: all of it in a millisecond
  static constexpr double kMostTorque = 5.0;      // N m
  static constexpr double kMostTorqueSlew = 5e3;  // N m/s

  double max_force = 20.0;        // N
  double max_slew = 5000.0;       // N/s
  double max_torque = 0.2;        // N m
  double max_torque_slew = 50.0;  // N m/s
};

/// A file that a scene was read from, and the flag or the line of a scene file that names it.
struct SourceFile {
  std::string named_by;  // "--organ", "FILE:LINE: organ.mesh"
  std::filesystem::path path;
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
  std::vector<SourceFile> files;     // all that it was read from; no output may replace one of them
};

/// A scene that stands in no file.
struct SceneText {
  std::string toml;
  std::filesystem::path folder;  // that relative paths in it start from
};

/// A value that takes the place of one in the scene file, or of the tissue's: {"device.mass_kg", "0.25"}.
struct Setting {
  std::string key;    // as docs/file-formats.md lists them, "TABLE.KEY"; of a tissue's number "tissue.KEY"
  std::string value;  // as a scene file has it; a text without its quotes
};

/// What a user asked for on the command line; what is set overrides the scene file.
struct Request {
  std::optional<std::filesystem::path> scene;  // none: the gallbladder press (task pull: the heart)
  std::optional<SceneText> scene_text;         // in place of `scene`
  std::optional<std::string> task;             // press | pull
  std::optional<std::string> organ;            // built-in name or path
  std::optional<std::string> organ_unit;
  std::vector<std::string> organ_motion;  // breathing, heartbeat, none; they replace all of the scene's
  std::optional<std::string> tissue;      // built-in name or tissue file
  std::vector<std::string> tools;         // one: the tool; several: its jaws
  std::optional<std::string> tool_unit;
  std::optional<std::string> device;  // KIND[:PATH]
  std::optional<double> rate_Hz;
  std::optional<std::uint64_t> seed;
  std::vector<Setting> settings;  // of a scene that has a file or a text
  bool no_noise = false;
  bool fit_device = false;  // as `fit` of every device
  // The scene and every file that it names must lie below this folder, once links and `..` are resolved: for
  // a scene that somebody else asked for. Empty: anywhere.
  std::filesystem::path files_below;
};

/// [setup] Reads and checks the scene and every file it names, and resolves defaults. Paths inside a scene
/// are relative to the scene, in the request to the working folder. Reads only.
/// @throws InputError: one line with file, field or line, value and what would be right (unknown keys too,
/// with the nearest known one).
[[nodiscard]] Setup load(const Request& request);

/// [setup] A tissue by built-in name or from a tissue file. @throws InputError as load().
[[nodiscard]] model::TissueParameters load_tissue(const std::string& name_or_file);

/// [setup] Reads and checks a tissue file. @throws InputError: one line, FILE:LINE: field = value: what would
/// be right; unknown keys too, with the nearest known one.
[[nodiscard]] model::TissueParameters read_tissue_file(const std::filesystem::path& file);

/// [setup] The text of a tissue file that reads back to the same parameters (lengths within one rounding of
/// their last digit).
[[nodiscard]] std::string to_toml(const model::TissueParameters& tissue);

}  // namespace palpate::scene
