#include "app/served_devices.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "io/scene/device_kinds.h"
#include "net/live_protocol.h"
#include "palpate/error.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

/// Whether a device opens nothing but a tool path.
bool is_simulated(const scene::DeviceKind& kind) { return kind.path == scene::DevicePath::kToolPath; }

bool is_same_path(const std::string& one, const std::string& other, scene::DevicePath kind) {
  if (kind != scene::DevicePath::kRecording) return one == other;
  std::error_code error;
  return fs::equivalent(one, other, error);
}

}  // namespace

void require_windowless(const scene::Scene& scene) {
  for (const scene::DeviceSetup& device : scene.devices) {
    const scene::DeviceKind* kind = scene::find_device_kind(device.kind);
    if (kind == nullptr || !kind->window) continue;
    throw InputError("device " + device.kind + ": needs the window of `palpate run`; serve has no window");
  }
}

bool is_made_up(const std::string& device) { return device == "scripted" || device == "emulated"; }

void require_made_up(const std::string& device) {
  if (is_made_up(device)) return;
  throw net::LiveError("refused",
                       "device = \"" + device +
                           "\": must be \"scripted\" or \"emulated\"; other devices are chosen "
                           "where the server is started",
                       "device");
}

void require_named(const scene::Scene& scene, const std::vector<scene::DeviceSetup>& named) {
  for (const scene::DeviceSetup& device : scene.devices) {
    const scene::DeviceKind* const kind = scene::find_device_kind(device.kind);  // load() knows it
    if (is_simulated(*kind)) continue;
    const bool is_named = std::any_of(named.begin(), named.end(), [&](const scene::DeviceSetup& own) {
      if (own.kind != device.kind) return false;
      return kind->path == scene::DevicePath::kLibrary || is_same_path(own.path, device.path, kind->path);
    });
    if (is_named) continue;
    const std::string what = device.kind + (device.path.empty() ? "" : ":" + device.path);
    throw InputError("device " + what +
                     ": a client's scene must name \"scripted\", \"emulated\" or a device with which the "
                     "server was started (palpate serve --device " +
                     what + ")");
  }
}

}  // namespace palpate::app
