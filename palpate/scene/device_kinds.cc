#include "palpate/scene/device_kinds.h"

#include <algorithm>

namespace palpate::scene {
namespace {

constexpr DeviceKind kKinds[] = {
    {"scripted", DevicePath::kToolPath, false, true}, {"replay", DevicePath::kRecording, false, true},
    {"emulated", DevicePath::kToolPath, true, true},  {"forcedimension", DevicePath::kLibrary, true, true},
    {"haply", DevicePath::kAddress, true, false},     {"host", DevicePath::kToolPath, true, true},
};

}  // namespace

std::span<const DeviceKind> device_kinds() noexcept { return kKinds; }

const DeviceKind* find_device_kind(std::string_view name) noexcept {
  const auto* found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [name](const DeviceKind& kind) { return kind.name == name; });
  return found == std::end(kKinds) ? nullptr : found;
}

}  // namespace palpate::scene
