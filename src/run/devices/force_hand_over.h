#pragma once
#include <atomic>
#include <cstdint>

#include "palpate/pose.h"
#include "palpate/triple_buffer.h"

namespace palpate::devices {

/// Passes the newest force from the loop to a device's thread. Neither waits for the other.
class ForceHandover final {
 public:
  /// [rt] Called by the loop. @return false when the force [N] is not finite; zero is then passed
  bool write(const Vec3& force_D) noexcept;
  /// [any] Zero until the next write().
  void stop() noexcept;
  /// [rt] Called by the device's thread: the force [N] at a monotonic time [ns]. Zero before the first
  /// write(), after stop(), and when the last write() is older than `write_timeout_ns`, because the loop then
  /// hangs.
  [[nodiscard]] Vec3 wanted(std::int64_t now_ns, std::int64_t write_timeout_ns) noexcept;

 private:
  struct Command {
    Vec3 force_D = Vec3::Zero();
    std::int64_t written_ns = 0;
  };

  TripleBuffer<Command> commands_;
  std::atomic<std::int64_t> stopped_ns_{0};  // commands written before this time are void
};

}  // namespace palpate::devices
