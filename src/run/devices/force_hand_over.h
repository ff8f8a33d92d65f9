#pragma once
#include <atomic>
#include <cstdint>

#include "palpate/pose.h"
#include "palpate/triple_buffer.h"

namespace palpate::devices {

/// The loop's newest force on its way to the thread that gives it to a device; neither waits for the other.
class ForceHandOver final {
 public:
  /// [rt] The loop's. @return false, and zero is left, when the force [N] is not finite
  bool write(const Vec3& force_D) noexcept;
  /// [any] Zero until the next write().
  void stop() noexcept;
  /// [rt] The other thread's: the force [N] at a monotonic time [ns]. Zero before the first write(), after
  /// stop(), and when the last write() is older than `no_write_ns`: the loop is dead.
  [[nodiscard]] Vec3 wanted(std::int64_t now_ns, std::int64_t no_write_ns) noexcept;

 private:
  struct Command {
    Vec3 force_D = Vec3::Zero();
    std::int64_t written_ns = 0;
  };

  TripleBuffer<Command> commands_;
  std::atomic<std::int64_t> stopped_ns_{0};  // no command written before counts
};

}  // namespace palpate::devices
