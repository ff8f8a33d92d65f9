#pragma once

// What CrashStop needs of the system, in posix/ and windows/.
namespace palpate::devices {

/// [setup] Handlers that call stop_devices() before a crash ends the program, and those from before.
void install_crash_handlers();
void restore_crash_handlers();

/// [rt] Sets is_crashing(). @return whether it was set before: a vendor's stop function has crashed, or
/// another thread crashes too
[[nodiscard]] bool begin_crash() noexcept;

/// [rt] Calls the stop functions of all open devices; takes no lock.
void stop_devices() noexcept;

}  // namespace palpate::devices
