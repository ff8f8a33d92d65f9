#include "io/scene/device_kinds.h"

#include <algorithm>

namespace palpate::scene {
namespace {

constexpr DeviceKind kKinds[] = {
    {"scripted", DevicePath::kToolPath, false, true, false},
    {"replay", DevicePath::kRecording, false, true, false},
    {"emulated", DevicePath::kToolPath, true, true, false},
    {"mouse", DevicePath::kNone, false, true, true},
    {"gamepad", DevicePath::kNone, false, true, true},
    {"forcedimension", DevicePath::kLibrary, true, true, false},
    {"haply", DevicePath::kAddress, true, false, false},
    {"touch", DevicePath::kName, true, false, false},
    // A hand: behind the client may be an arm that displays the force.
    {"igtl", DevicePath::kClient, true, true, false},
    // A hand: the program that publishes the poses may read them from an arm that displays the published
    // force.
    {"ros", DevicePath::kAddress, true, true, false},
    {"host", DevicePath::kToolPath, true, true, false},
};

}  // namespace

std::span<const DeviceKind> device_kinds() noexcept { return kKinds; }

const DeviceKind* find_device_kind(std::string_view name) noexcept {
  const auto* found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [name](const DeviceKind& kind) { return kind.name == name; });
  return found == std::end(kKinds) ? nullptr : found;
}

}  // namespace palpate::scene
