#pragma once
#include <filesystem>
#include <vector>

#include <sys/types.h>

namespace palpate::app {

/// Viewers of recordings that a window has opened, each a program of its own: nothing they do can hold up a
/// haptic loop, and they stay when the window goes. All members: [setup], one thread.
class Onlookers final {
 public:
  Onlookers() = default;
  ~Onlookers() { (void)look_after(); }
  Onlookers(const Onlookers&) = delete;
  Onlookers& operator=(const Onlookers&) = delete;

  /// Starts `program view recording`. @throws InputError naming the file when it is not there or the program
  /// does not start.
  void open(const std::filesystem::path& program, const std::filesystem::path& recording);
  /// How many are open. Takes leave of those that have ended.
  [[nodiscard]] std::size_t look_after();

 private:
  std::vector<pid_t> children_;
};

}  // namespace palpate::app
