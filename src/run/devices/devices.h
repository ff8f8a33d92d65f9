#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/device.h"
#include "palpate/scene.h"
#include "run/devices/pose_stream.h"
#include "run/devices/probe.h"
#include "run/devices/reasons.h"

namespace palpate::devices {

/// [setup] Opens the device of one hand, reads its files and connects to it. Kinds:
/// - "scripted", "emulated": follow a path, or the default path;
/// - "replay": the samples of that hand in a recording, whose rate must be the scene's;
/// - "mouse", "gamepad": get their input from the window;
/// - "forcedimension": the connected devices in order, one per hand;
/// - "haply": hands with one address use its arms in order;
/// - "touch": the device with that name in Touch_Setup;
/// - "igtl": waits until a client sends poses, IgtlTimes::opening at most.
/// - "ros": poses from a ROS 2 topic.
/// @param on_wait called while "igtl" and "ros" wait
/// @throws InputError naming the kind, the file or address and the cause.
[[nodiscard]] std::unique_ptr<haptics::Device> open_device(const scene::Scene& scene, std::size_t hand,
                                                           const OnWait& on_wait = {});

/// [setup] Which devices of each kind are available, and why others are not, in the order of
/// scene::device_kinds(). Opens no device. @param machine searched for the reasons
[[nodiscard]] std::vector<Probe> probe_devices(const Machine& machine = {});

/// A device that was opened outside a scene.
struct OpenedDevice {
  std::unique_ptr<haptics::Device> device;
  std::string name;  // the vendor's name of the device, and how it was opened
  bool held_by_person = true;
};

/// [setup] Opens one device that is connected to this computer, outside a scene.
/// @param what KIND or KIND:PATH as on the command line
/// @throws InputError as open_device(), and when a device of this KIND cannot be connected.
[[nodiscard]] OpenedDevice open_connected(const std::string& what);

/// [setup] As open_connected(), for a measurement at `rate_Hz`; "emulated" is an emulated device whose hand
/// stays in one place.
[[nodiscard]] OpenedDevice open_for_test(const std::string& what, double rate_Hz);

}  // namespace palpate::devices
