#pragma once
#include <atomic>
#include <cstdint>

#include "palpate/device.h"
#include "palpate/triple_buffer.h"

namespace palpate::devices {

/// Passes the newest force and torque from the loop to a device's thread. Neither waits for the other.
class ForceHandover final {
 public:
  /// [rt] Called by the loop. @return false when force or torque are not finite; zero is then passed
  bool write(const haptics::ForceCommand& command_D) noexcept;
  /// [any] Zero until the next write().
  void stop() noexcept;
  /// [rt] Called by the device's thread: the command at a monotonic time [ns]. Zero before the first
  /// write(), after stop(), and when the last write() is older than `write_timeout_ns`, because the loop then
  /// hangs; also when is_crashing().
  [[nodiscard]] haptics::ForceCommand wanted(std::int64_t now_ns, std::int64_t write_timeout_ns) noexcept;

 private:
  struct Command {
    haptics::ForceCommand command_D;
    std::int64_t written_ns = 0;
  };

  TripleBuffer<Command> commands_;
  std::atomic<std::int64_t> stopped_ns_{0};  // commands written before this time are void
};

}  // namespace palpate::devices
