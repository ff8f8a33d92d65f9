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

/// Names of products and makers, in lower case, that people type as the kind.
struct Product {
  std::string_view start;  // of the name
  std::string_view kind;
};
constexpr Product kProducts[] = {
    {"omega", "forcedimension"},
    {"delta", "forcedimension"},
    {"sigma", "forcedimension"},
    {"lambda", "forcedimension"},
    {"force-dimension", "forcedimension"},
    {"dhd", "forcedimension"},
    {"inverse", "haply"},
    {"verse", "haply"},
    {"geomagic", "touch"},
    {"phantom", "touch"},
    {"omni", "touch"},
    {"openhaptics", "touch"},
    {"3dsystems", "touch"},
    {"joystick", "gamepad"},
    {"xbox", "gamepad"},
    {"controller", "gamepad"},
    {"slicer", "igtl"},
    {"openigtlink", "igtl"},
    {"plus", "igtl"},
    {"ros2", "ros"},
    {"recording", "replay"},
    {"script", "scripted"},
};

}  // namespace

std::span<const DeviceKind> device_kinds() noexcept { return kKinds; }

const DeviceKind* find_device_kind(std::string_view name) noexcept {
  const auto* found = std::find_if(std::begin(kKinds), std::end(kKinds),
                                   [name](const DeviceKind& kind) { return kind.name == name; });
  return found == std::end(kKinds) ? nullptr : found;
}

std::string_view device_kind_of_product(std::string_view product) noexcept {
  const auto matches = [product](const Product& known) {
    if (product.size() < known.start.size()) return false;
    return std::equal(known.start.begin(), known.start.end(), product.begin(), [](char wanted, char typed) {
      return wanted == (typed >= 'A' && typed <= 'Z' ? static_cast<char>(typed - 'A' + 'a') : typed);
    });
  };
  const auto* found = std::find_if(std::begin(kProducts), std::end(kProducts), matches);
  return found == std::end(kProducts) ? std::string_view() : found->kind;
}

}  // namespace palpate::scene
