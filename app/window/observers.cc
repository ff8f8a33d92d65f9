#include "app/window/observers.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <system_error>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/system/file_exists.h"
#include "palpate/error.h"

namespace palpate::app {

void Observers::open(const std::filesystem::path& program, const std::filesystem::path& recording) {
  if (!regular_file_exists(recording))
    throw InputError(recording.string() + ": there is no such recording (it appears with the first tick)");
  std::string name = program.string();
  std::string command = "view";
  std::string file = std::filesystem::absolute(recording).string();
  const std::array<char*, 4> words = {name.data(), command.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  // The viewer must not inherit device handles, nor the lock on the recording, which would outlive the
  // writer.
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);
  // Ctrl-C in the terminal ends the run, not the viewer.
  posix_spawnattr_t apart{};
  posix_spawnattr_init(&apart);
  posix_spawnattr_setpgroup(&apart, 0);
  posix_spawnattr_setflags(&apart, POSIX_SPAWN_SETPGROUP);
  pid_t child = -1;
  const int failed = posix_spawn(&child, name.c_str(), &actions, &apart, words.data(), environ);
  posix_spawnattr_destroy(&apart);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw InputError(file + ": the viewer does not start: " + std::strerror(failed));
  children_.push_back(child);
  (void)count_running();
}

std::size_t Observers::count_running() {
  const auto ended = [](pid_t child) { return waitpid(child, nullptr, WNOHANG) != 0; };
  children_.erase(std::remove_if(children_.begin(), children_.end(), ended), children_.end());
  return children_.size();
}

}  // namespace palpate::app
