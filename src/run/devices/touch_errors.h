#pragma once
#include <string>

#include "palpate/device.h"

namespace palpate::devices {

/// [any] What the loop makes of an error of OpenHaptics: kForceOff when the arm takes its force away by
/// itself (0x0200 to 0x0204), else kDevice.
[[nodiscard]] haptics::Fault fault_of_hd_error(unsigned code) noexcept;

/// [any] What an error means and what to do about it: "its motors are too warm (OpenHaptics error 0x0200):
/// let ...". Allocates.
[[nodiscard]] std::string describe_hd_error(unsigned code);

}  // namespace palpate::devices
