#pragma once
// Devices that runs of `palpate serve` may open.
#include <string>
#include <vector>

#include "palpate/scene.h"

namespace palpate::app {

/// [setup] Rejects a scene with a mouse or a gamepad, because they need the window of `palpate run`.
/// @throws InputError
void require_windowless(const scene::Scene& scene);

/// [any] Whether a kind of device is simulated, so that it opens nothing on the server.
[[nodiscard]] bool is_made_up(const std::string& device);
/// [setup] A client may select a simulated device, but no device that opens something on the server.
/// @throws LiveError
void require_made_up(const std::string& device);

/// [setup] Rejects devices of a client's scene that open a port, a service, an arm or a recording, unless the
/// server was started with them: only its operator may open something. @throws InputError
void require_named(const scene::Scene& scene, const std::vector<scene::DeviceSetup>& named);

}  // namespace palpate::app
