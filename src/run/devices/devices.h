#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/device.h"
#include "palpate/scene.h"
#include "run/devices/probe.h"
#include "run/devices/reasons.h"

namespace palpate::devices {

/// [setup] Opens the device of one hand: "scripted" or "emulated" (with or without a path), "replay" (a
/// recording; its samples of that hand), "mouse" and "gamepad" (a window feeds them), "forcedimension" (the
/// vendor's library; the first such hand has the first device connected, the next the second), "haply"
/// (hands with one address take its arms in order) or "touch" (a name of Touch_Setup's). Reads its files and
/// connects now. @throws InputError naming the kind, the file or address and what is wrong (a replayed
/// recording's rate must be the scene's).
[[nodiscard]] std::unique_ptr<haptics::Device> open_device(const scene::Scene& setup, std::size_t hand);

/// [setup] What is there of every kind of device and why something is not, in the order of
/// scene::device_kinds(). Opens no device. @param machine looked at for reasons
[[nodiscard]] std::vector<Probe> probe_devices(const Machine& machine = {});

/// A device opened to be looked at.
struct Opened {
  std::unique_ptr<haptics::Device> device;
  std::string name;  // its maker's, with what it was opened by
};

/// [setup] Opens one device that is connected to this computer, outside any scene.
/// @param what KIND or KIND:PATH as on the command line @throws InputError as open_device(), and when KIND is
/// none that can be connected.
[[nodiscard]] Opened open_connected(const std::string& what);

}  // namespace palpate::devices
