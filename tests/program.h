#pragma once
// The program in a child process, for tests of its outputs. PALPATE_PROGRAM is its path, or in the
// environment that of another one, for example of palpate.exe under Wine (tools/check_windows).
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/system/test/temporary_folder.h"

namespace palpate::tests {

namespace fs = std::filesystem;

inline std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// Folder of one test, removed by the destructor. Its paths can be arguments of the program.
class Folder final : public test::TemporaryFolder {
 public:
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path() / name).string(); }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(path())) all.push_back(entry.path().filename().string());
    std::sort(all.begin(), all.end());
    return all;
  }
};

/// Environment without OpenGL: a report then has no pictures of organ and tool, which take most of its time.
inline const std::map<std::string, std::string> kNoPictures{{"__EGL_VENDOR_LIBRARY_FILENAMES", "none"}};

struct Outcome {
  int exit_code = -1;  // -1: ended by a signal
  std::string out;
  std::string err;
};

inline std::string tested_program() {
  const char* other = std::getenv("PALPATE_PROGRAM");
  return other == nullptr ? PALPATE_PROGRAM : other;
}

/// The program in a child process, with its output in files of another folder. The cache is that of all tests
/// (palpate_add_suites), or off where CTest does not run the test, unless the test sets one.
class Program final {
 public:
  Program(const fs::path& working_folder, std::vector<std::string> words,
          const std::map<std::string, std::string>& environment = {}) {
    words.insert(words.begin(), tested_program());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string out = output_ / "out";
    const std::string err = output_ / "err";
    child_ = fork();
    if (child_ != 0) return;
    setenv("PALPATE_CACHE", "off", 0);
    for (const char* display : {"DISPLAY", "WAYLAND_DISPLAY"}) unsetenv(display);  // no windows
    for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
    const int out_file = open(out.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    const int err_file = open(err.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600);
    if (chdir(working_folder.c_str()) == 0 && dup2(out_file, 1) == 1 && dup2(err_file, 2) == 2) {
      execv(argv[0], argv.data());
    }
    _exit(127);
  }
  [[nodiscard]] pid_t id() const { return child_; }
  void signal(int number) const { kill(child_, number); }
  /// Standard output up to now.
  [[nodiscard]] std::string out_so_far() const { return text_of(output_ / "out"); }
  [[nodiscard]] std::string err_so_far() const { return text_of(output_ / "err"); }
  /// Whether the program has ended by itself.
  [[nodiscard]] bool ended() const {
    siginfo_t how{};
    return waitid(P_PID, static_cast<id_t>(child_), &how, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           how.si_pid == child_;
  }
  Outcome wait() {
    int status = 0;
    waitpid(child_, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(output_ / "out"), text_of(output_ / "err")};
  }

 private:
  Folder output_;
  pid_t child_ = -1;
};

inline Outcome run(const Folder& folder, std::vector<std::string> words,
                   const std::map<std::string, std::string>& environment = {}) {
  return Program(folder.path(), std::move(words), environment).wait();
}

/// Whether a process handles SIGUSR1, which resets the faults of a run.
inline bool takes_resets(pid_t process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("SigCgt:", 0) != 0) continue;
    return (std::stoull(line.substr(7), nullptr, 16) >> (SIGUSR1 - 1) & 1U) != 0;
  }
  return false;
}

inline std::size_t lines(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace palpate::tests
