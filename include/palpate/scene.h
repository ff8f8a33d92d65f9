#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/device.h"
#include "palpate/inclusion.h"
#include "palpate/mesh.h"
#include "palpate/organ_motion.h"
#include "palpate/pose.h"
#include "palpate/preparation.h"
#include "palpate/support.h"
#include "palpate/tissue.h"
#include "palpate/tool.h"
#include "palpate/touch_noise.h"

namespace palpate::scene {

/// Faults that an emulated device can simulate.
enum class EmulatedFaultKind : std::uint8_t {
  kFreeze,      // repeats the last good sample, which grows old
  kDropOut,     // cannot be read
  kNotANumber,  // a NaN position
  kSpike,       // the position is wrong by 50 mm, along the device's -z
  kLate,        // every sample has the age `age`
  kWrongUnits,  // positions in mm instead of m
  kForceOff,    // the device switches its force off and reports it
  kRefuse,      // refuses all commands
};

struct EmulatedFaultName {
  std::string_view name;  // as in a scene
  EmulatedFaultKind kind;
};

/// [any] All kinds with their names, in the order of help texts.
[[nodiscard]] std::span<const EmulatedFaultName> emulated_fault_names() noexcept;

/// [any] The name of a kind, as in a scene.
[[nodiscard]] std::string_view name_of(EmulatedFaultKind kind) noexcept;

/// [any] The kind with this name; empty for an unknown name.
[[nodiscard]] std::optional<EmulatedFaultKind> find_emulated_fault(std::string_view name) noexcept;

inline constexpr double kLongestFaultAge = 1.0;  // s, of late samples

/// A fault and its time in the run.
struct EmulatedFault {
  EmulatedFaultKind kind = EmulatedFaultKind::kFreeze;
  double time = 0.0;      // s, >= 0: the fault starts at the first tick at or after this time
  double duration = 0.0;  // s, >= 0; 0: one tick
  double age = 8e-3;      // s, age of late samples; > 0, at most kLongestFaultAge
};

/// Spring and damper with which the hand holds the device.
struct HandGrip {
  double stiffness = 0.0;  // N/m, >= 0
  double damping = 0.0;    // N s/m, >= 0
};

// A firmer grip has a higher stiffness and damping [Hasser and Cutkosky 2002]; the measured stiffness of a
// finger is some hundred N/m [Hajian and Howe 1997]. The damping is low on purpose, so that a stable run does
// not depend on the hand's damping.
inline constexpr HandGrip kLightGrip{50.0, 1.0};
inline constexpr HandGrip kFirmGrip{500.0, 5.0};

// Defaults of an emulated device, which is a well-damped desktop device.
inline constexpr double kEmulatedDamping = 1.5;      // N s/m: every built-in tissue is stable at 1 kHz
inline constexpr double kEmulatedFriction = 0.05;    // N
inline constexpr double kEmulatedResolution = 1e-5;  // m

/// Properties that only the emulated hand has, in addition to DeviceDynamics.
struct EmulatedHand {
  double mass = 0.25;  // kg, > 0: the moving part of the device and of the hand
  HandGrip grip = kFirmGrip;
  std::vector<EmulatedFault> faults{};
};

/// Axes of a patient's coordinates: x points to the patient's right and y to the front (RAS), or x to the
/// left and y to the back (LPS). z points to the head in both.
enum class OrganFrame : std::uint8_t { kRas, kLps };

/// [any] "ras" or "lps", as in a scene.
[[nodiscard]] const char* to_string(OrganFrame frame) noexcept;
/// [any] The frame with this name; empty for an unknown name.
[[nodiscard]] std::optional<OrganFrame> find_organ_frame(std::string_view name) noexcept;

enum class Task { kPress, kPull, kPalpate, kInsert };

/// [any] "press", "pull", "palpate" or "insert", as in a scene.
[[nodiscard]] const char* to_string(Task task) noexcept;
/// [any] The task with this name; empty for an unknown name.
[[nodiscard]] std::optional<Task> find_task(std::string_view name) noexcept;

inline constexpr double kSlowestRate = 100.0;    // Hz, lowest rate of the loop
inline constexpr double kFastestRate = 20000.0;  // Hz

/// Mechanics of a device, for the stability check (docs/safety.md) and the emulated hand. Empty: unknown.
struct DeviceDynamics {
  std::optional<double> damping;     // N s/m, viscous
  std::optional<double> friction;    // N, Coulomb
  std::optional<double> resolution;  // m, of its position sensors
};

/// Interpolation of positions between the rows of a tool path.
enum class PathInterpolation : std::uint8_t {
  kLinear,  // velocity and damping force have a step at each row
  kCubic    // continuous velocity, no overshoot beyond neighbouring rows
};

/// [any] "linear" or "cubic", as in a scene file.
[[nodiscard]] const char* to_string(PathInterpolation interpolation) noexcept;
/// [any] The interpolation with this name; empty for an unknown name.
[[nodiscard]] std::optional<PathInterpolation> interpolation_of(std::string_view name) noexcept;

inline constexpr std::uint32_t kLastButton = 31;  // bit of DeviceState::buttons

/// Device of a hand. The tool's pose follows from the device's sample: the translation times workspace_scale,
/// then the rigid transform `base`.
struct DeviceSetup {
  std::string kind = "scripted";  // "emulated", "haply", ...: all names are in docs/devices.md
  std::string path;               // resolved file or address; empty: not given
  double workspace_scale = 1.0;   // > 0
  Pose base;
  DeviceDynamics dynamics{};
  EmulatedHand emulated{};  // only for kind "emulated"
  std::optional<std::uint32_t>
      clutch_button{};  // bit of DeviceState::buttons for clutching: the tool stays while it is set
  bool fit = false;     // lowers force_scale to the device's largest stiffness
  haptics::DeviceAbilities abilities{};  // of the opened device
  double force_scale = 1.0;              // factor of the tissue force at the hand; below 1 only with `fit`
  PathInterpolation interpolation = PathInterpolation::kLinear;  // of a tool path that is read from a file
  double path_speed = 1.0;               // > 0: the duration of tool paths is divided by it
  std::optional<double> earliest_row{};  // s: `earliest` of read_tool_path()
};

/// Saturation and slew limits of the gate, SI units. The constants are the largest values that a scene may
/// set: 2.5 times those of the strongest device in docs/devices.md.
struct SafetySetup {
  static constexpr double kMaxForce = 50.0;      // N
  static constexpr double kMaxSlew = 50e3;       // N/s: kMaxForce within 1 ms
  static constexpr double kMaxTorque = 5.0;      // N m
  static constexpr double kMaxTorqueSlew = 5e3;  // N m/s

  double max_force = 20.0;        // N
  double max_slew = 5000.0;       // N/s
  double max_torque = 0.2;        // N m
  double max_torque_slew = 50.0;  // N m/s
};

/// An inclusion of the scene's organ.
struct InclusionSetup {
  std::string name;
  bool visible = true;  // in pictures; false: hidden until a task shows it
  model::Inclusion inclusion{};

  bool operator==(const InclusionSetup&) const = default;
};

/// The task palpate: hidden inclusions are to be found (docs/lumps.md).
struct SearchSetup {
  double tolerance = 10e-3;  // m, from the surface above an inclusion: a mark within it finds the inclusion
  std::uint32_t mark_button = 0;  // bit of DeviceState::buttons that sets a mark
};

/// The task insert: where the needle's tip is to go, and where not (docs/needle.md).
struct TargetSetup {
  std::string layer{};                   // name of a tissue layer; empty: the hidden inclusions, else all
  std::vector<std::string> forbidden{};  // names of tissue layers
};

/// [setup] The inclusions that pictures show.
[[nodiscard]] std::vector<model::Inclusion> visible_inclusions(const std::vector<InclusionSetup>& inclusions);

/// A file that was read for a scene, with the flag or line that names it.
struct SourceFile {
  std::string named_by;  // "--organ", "FILE:LINE: organ.mesh"
  std::filesystem::path path;
};

/// Where the library keeps the signed distance of a scene's organ, which it builds once. Copies share it.
class OrganDistance final {
 public:
  struct Built;  // opaque
  OrganDistance();
  [[nodiscard]] Built& built() const noexcept { return *built_; }

 private:
  std::shared_ptr<Built> built_;
};

/// One scene, resolved and checked. It holds everything that the simulation needs, in SI units; no further
/// file is read.
struct Scene {
  std::string name;
  Task task = Task::kPress;
  double rate_Hz = 1000.0;
  std::uint64_t seed = 1;
  std::string organ_name;                     // built-in name or file, for messages
  geometry::TriangleMesh organ;               // organ frame, m
  OrganDistance organ_distance;               // of `organ`, which may be replaced
  OrganFrame organ_frame = OrganFrame::kRas;  // of the world; OpenIGTLink clients get RAS
  Pose organ_pose;                            // at rest
  std::vector<model::OrganMotionParameters>
      organ_motion;  // their sum, about the centre of the bounding box; empty: no motion
  model::TissueParameters tissue;
  std::vector<InclusionSetup> inclusions;        // at most model::kMaxInclusions
  std::vector<model::StiffnessPoint> stiffness;  // of the stiffness map; empty: the factor is 1
  std::optional<geometry::Support>
      support;  // what holds the organ; empty: only the surface near a contact moves
  std::shared_ptr<const contact::OrganStore> store;  // for the organ's response under `support`; null: none
  SearchSetup search;                                // only for task palpate
  TargetSetup target;                                // only for task insert
  std::vector<geometry::Tool> tools;                 // one per hand
  std::vector<DeviceSetup> devices;                  // one per hand
  noise::NoiseSettings noise;
  SafetySetup safety;
  // Shown to the user, stored in recordings, printed in reports:
  std::vector<std::string> repairs;  // repairs of mesh files; each begins with the file's name
  std::vector<std::string> remarks;  // remaining defects of meshes, and warnings
  std::vector<SourceFile> files;     // all files that were read; no output file may overwrite them
};

/// A scene given as text instead of a file.
struct SceneText {
  std::string toml;
  std::filesystem::path folder;  // folder that relative paths in the text start from
};

/// Replaces a value of the scene file or of its tissue: {"device.mass_kg", "0.25"}.
struct Setting {
  std::string key;    // "TABLE.KEY" as in docs/file-formats.md; "tissue.KEY" for a number of the tissue
  std::string value;  // as in a scene file; strings without quotes
};

/// The scene file and the flags of a command line; flags override the file.
struct Overrides {
  std::optional<std::filesystem::path>
      scene;                            // empty: the gallbladder press (pull: the heart; palpate: the liver)
  std::optional<SceneText> scene_text;  // instead of `scene`
  std::optional<std::string> task;      // press | pull | palpate
  std::optional<std::string> organ;     // built-in name or path
  std::optional<std::string> organ_unit;
  std::optional<std::string> organ_frame;  // ras | lps
  bool igtl = false;  // the run has an OpenIGTLink server, so remarks about organ_frame matter
  std::vector<std::string> organ_motion;   // breathing, heartbeat, none; replaces the scene's motions
  std::vector<std::string> inclusions;     // presets, or none; replace the scene's inclusions
  std::vector<std::string> organ_support;  // bed:.., faces:.., at:.., none; replace the scene's support
  std::optional<std::string> tissue;       // built-in name or tissue file
  std::vector<std::string> tools;          // one entry: the tool; several: the jaws of one tool
  std::optional<std::string> tool_unit;
  std::optional<std::string> device;  // KIND[:PATH]
  std::optional<double> rate_Hz;
  std::optional<std::uint64_t> seed;
  std::vector<Setting> settings;  // requires `scene` or `scene_text`
  bool no_noise = false;
  bool fit_device = false;  // sets `fit` of all devices
  // If set, the scene and all its files must be inside this folder after links and `..` are resolved. Set it
  // for scenes from untrusted sources. Empty: no restriction.
  std::filesystem::path files_below;
  // Keeps the meshes of large organ files that were read and repaired: that of use_organ_cache(). Null: none.
  std::shared_ptr<const contact::OrganStore> store = {};
};

/// [setup] Reads and checks the scene and all its files, and fills in defaults. Paths in a scene file are
/// relative to its folder, paths in the request to the working folder. It writes no files but those of
/// `store`. @throws InputError
/// with one line that names the file, the field or line, the value and the valid values. For an unknown key
/// it names the nearest valid key.
[[nodiscard]] Scene load(const Overrides& request);

/// [setup] Returns a built-in tissue or reads a tissue file. @throws InputError as load().
[[nodiscard]] model::TissueParameters load_tissue(const std::string& name_or_file);

/// [setup] Reads and checks a tissue file. @throws InputError with one line: FILE:LINE: field = value: valid
/// values. For an unknown key it names the nearest valid key.
[[nodiscard]] model::TissueParameters read_tissue_file(const std::filesystem::path& file);

/// [setup] The tissue as the text of a tissue file. Reading the text gives equal parameters; lengths may
/// differ by one rounding of the last digit.
[[nodiscard]] std::string to_toml(const model::TissueParameters& tissue);

}  // namespace palpate::scene
