#pragma once
// Xvfb, an X server that draws to memory, for one test process.
#include <csignal>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::app {

/// Starts Xvfb and uses it; the destructor stops it.
class VirtualDisplay final {
 public:
  VirtualDisplay() {
    int ends[2];
    if (pipe(ends) != 0) return;
    child_ = fork();
    if (child_ == 0) {
      const int nothing = open("/dev/null", O_WRONLY);
      dup2(nothing, 2);
      close(ends[0]);
      const std::string number = std::to_string(ends[1]);
      execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "3840x2160x24", "-noreset",
             "-nolisten", "tcp", nullptr);
      _exit(127);
    }
    close(ends[1]);
    char letter = 0;
    std::string number;
    while (read(ends[0], &letter, 1) == 1 && letter != '\n') number += letter;
    close(ends[0]);
    if (number.empty()) return;  // Xvfb is missing or did not start
    name_ = ":" + number;
    use();
  }
  ~VirtualDisplay() { end(SIGTERM); }
  /// Opens the process's windows on this display from now on.
  void use() const {
    if (!there()) return;
    setenv("DISPLAY", name_.c_str(), 1);
    unsetenv("WAYLAND_DISPLAY");
    setenv("SDL_VIDEODRIVER", "x11", 1);
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  }
  /// Kills the server, as in a crash.
  void crash() { end(SIGKILL); }
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;

  [[nodiscard]] bool there() const noexcept { return !name_.empty(); }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  void end(int signal) {
    if (child_ <= 0) return;
    kill(child_, signal);
    waitpid(child_, nullptr, 0);
    child_ = -1;
  }

  pid_t child_ = -1;
  std::string name_;
};

}  // namespace palpate::app
