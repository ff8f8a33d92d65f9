#include "io/system/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

namespace palpate {

int start_process(const ChildProcess& child, std::error_code& error) {
  std::vector<std::string> words = child.arguments;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files{};
  posix_spawn_file_actions_init(&files);
  if (!child.messages.empty()) {
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, child.messages.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
  }
  if (child.input >= 0) posix_spawn_file_actions_adddup2(&files, child.input, STDIN_FILENO);
  if (!child.folder.empty()) posix_spawn_file_actions_addchdir_np(&files, child.folder.c_str());
  if (child.apart) posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
  posix_spawnattr_t attributes{};
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setpgroup(&attributes, 0);
  if (child.apart) posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t id = -1;
  error.assign(posix_spawnp(&id, arguments[0], &files, &attributes, arguments.data(), environ),
               std::generic_category());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return id;
}

}  // namespace palpate
