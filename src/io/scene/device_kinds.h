#pragma once
#include <span>
#include <string_view>

namespace palpate::scene {

/// What stands behind a device's path: "kind:PATH" on the command line, `path` in a scene.
enum class DevicePath {
  kToolPath,   // a CSV of poses, optional
  kRecording,  // a recording, required
  kLibrary,    // the vendor's shared library, on the command line alone; optional: DhdLibrary says where else
  kAddress,    // ws://HOST:PORT, optional
  kName,       // the device's name in its vendor's setup, optional
  kNone,       // it takes no path
};

/// One kind of device that a scene can name.
struct DeviceKind {
  std::string_view name;
  DevicePath path;
  bool held;    // a hand, or an emulated one, holds it and moves by its force: the force waits until the hand
                // is ready, and the passivity controller acts
  bool torque;  // it can give torque
  bool window;  // a window feeds it: a run without one cannot use it
};

/// [any] All kinds, in the order in which they are listed to people.
[[nodiscard]] std::span<const DeviceKind> device_kinds() noexcept;

/// [any] The kind of that name; null: there is none.
[[nodiscard]] const DeviceKind* find_device_kind(std::string_view name) noexcept;

}  // namespace palpate::scene
