#pragma once
#include <string>

#include "palpate/device.h"

namespace palpate::devices {

/// [any] The fault for an OpenHaptics error: kForceOff when the arm has switched its force off (0x0200 to
/// 0x0204), else kDevice.
[[nodiscard]] haptics::Fault fault_of_hd_error(unsigned code) noexcept;

/// [any] The meaning of an error and its remedy: "its motors are too warm (OpenHaptics error 0x0200):
/// let ...". Allocates.
[[nodiscard]] std::string describe_hd_error(unsigned code);

}  // namespace palpate::devices
