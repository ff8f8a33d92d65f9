#pragma once
#include <span>
#include <string_view>

namespace palpate::scene {

/// What a device's path names: "kind:PATH" on the command line, `path` in a scene.
enum class DevicePath {
  kToolPath,   // a CSV of poses, optional
  kRecording,  // a recording, required
  kLibrary,  // the vendor's shared library, only on the command line; optional: DhdLibrary lists the default
             // paths
  kAddress,  // ws://HOST:PORT, or a ROS 2 topic; optional
  kClient,   // [ADDRESS:]PORT/NAME at which a client connects, required; ADDRESS only on the command line
  kName,     // the device's name in its vendor's setup, optional
  kNone,     // it takes no path
};

/// [any] Whether a device's path is a file, or a name that could be one.
[[nodiscard]] constexpr bool names_file(DevicePath path) noexcept {
  return path != DevicePath::kAddress && path != DevicePath::kClient;
}

/// One kind of device that a scene can name.
struct DeviceKind {
  std::string_view name;
  DevicePath path;
  bool held;    // held by a person or an emulated hand: the force waits for the soft start, and the passivity
                // controller acts
  bool torque;  // can give torque
  bool window;  // needs a window as its input
};

/// [any] All kinds, in the order in which help texts list them.
[[nodiscard]] std::span<const DeviceKind> device_kinds() noexcept;

/// [any] The kind of that name, or null.
[[nodiscard]] const DeviceKind* find_device_kind(std::string_view name) noexcept;

/// [any] The kind that a product or maker of that name belongs to, such as forcedimension for omega; empty:
/// none is known.
[[nodiscard]] std::string_view device_kind_of_product(std::string_view product) noexcept;

}  // namespace palpate::scene
