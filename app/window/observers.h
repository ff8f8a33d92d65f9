#pragma once
#include <filesystem>
#include <vector>

#include <sys/types.h>

namespace palpate::app {

/// Viewers of recordings that a window has opened, each a program of its own: nothing they do can hold up a
/// haptic loop, and they stay when the window goes. All members: [setup], one thread.
class Observers final {
 public:
  Observers() = default;
  ~Observers() { (void)count_running(); }
  Observers(const Observers&) = delete;
  Observers& operator=(const Observers&) = delete;

  /// Starts `program view recording`. @throws InputError naming the file when it is not there or the program
  /// does not start.
  void open(const std::filesystem::path& program, const std::filesystem::path& recording);
  /// How many are open. Takes leave of those that have ended.
  [[nodiscard]] std::size_t count_running();

 private:
  std::vector<pid_t> children_;
};

}  // namespace palpate::app
