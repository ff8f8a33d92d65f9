#pragma once
#include <filesystem>
#include <vector>

#include <sys/types.h>

namespace palpate::app {

/// Viewers of recordings opened from a window. Each is a separate process, so it cannot delay a haptic loop,
/// and it continues after the window closes. All members: [setup], one thread.
class Observers final {
 public:
  Observers() = default;
  ~Observers() { (void)count_running(); }
  Observers(const Observers&) = delete;
  Observers& operator=(const Observers&) = delete;

  /// Runs `program view recording`. @throws InputError naming the file if it is missing or the program does
  /// not start
  void open(const std::filesystem::path& program, const std::filesystem::path& recording);
  /// Number of viewers that still run.
  [[nodiscard]] std::size_t count_running();

 private:
  std::vector<pid_t> children_;
};

}  // namespace palpate::app
