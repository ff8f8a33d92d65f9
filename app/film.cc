#include "app/film.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <sstream>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/core.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::app {
namespace {

namespace fs = std::filesystem;

// Starts ffmpeg, which reads raw RGB pictures from a pipe. Returns ffmpeg's process id and the end of the
// pipe that the pictures are written to.
std::pair<int, int> start_ffmpeg(const fs::path& file, int width, int height, double frames_a_second) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw InputError(file.string() + ": cannot make a pipe to ffmpeg: " + std::strerror(errno));
  std::istringstream flags(fmt::format(
      "ffmpeg -nostdin -loglevel error -y -f rawvideo -pix_fmt rgb24 -s {}x{} -r {} -i pipe:0 -an "
      "-c:v libx264 -crf 18 -pix_fmt yuv420p -movflags +faststart",
      width, height, shortest(frames_a_second)));
  std::vector<std::string> words(std::istream_iterator<std::string>(flags), {});
  words.push_back(file.string());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  pid_t child = -1;
  const int failed = posix_spawnp(&child, "ffmpeg", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  if (failed != 0) {
    close(ends[1]);
    throw InputError(file.string() + ": cannot start ffmpeg: " + std::strerror(failed));
  }
  return {child, ends[1]};
}

}  // namespace

bool ffmpeg_installed() {
  const char* path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): nothing writes it
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((fs::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

Film::Film(fs::path file, int width, int height, double frames_a_second) : file_(std::move(file)) {
  if (ffmpeg_installed()) {
    std::signal(SIGPIPE, SIG_IGN);  // write() reports an ffmpeg that died, so the message can explain it
    const auto [child, pipe] = start_ffmpeg(file_, width, height, frames_a_second);
    child_ = child;
    pipe_ = pipe;
    return;
  }
  folder_ = file_;
  folder_.replace_extension();
  folder_ += "-frames";
  std::error_code failed;
  fs::create_directories(folder_, failed);
  if (failed) throw InputError(folder_.string() + ": the folder cannot be made: " + failed.message());
}

Film::~Film() {
  if (pipe_ >= 0) close(pipe_);
  if (child_ > 0) waitpid(child_, nullptr, 0);
}

void Film::add(const render::Image& picture) {
  ++frames_;
  if (!folder_.empty()) {
    std::array<char, 24> name{};
    std::snprintf(name.data(), name.size(), "%06zu.png", frames_);
    render::write_png(picture, folder_ / name.data());
    return;
  }
  std::size_t done = 0;
  while (done < picture.rgb.size()) {
    const ssize_t written = write(pipe_, picture.rgb.data() + done, picture.rgb.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0)
      throw InputError(file_.string() +
                       ": ffmpeg stopped before the end of the film; its messages are above");
    done += static_cast<std::size_t>(written);
  }
}

std::string Film::finish() {
  const std::string count = std::to_string(frames_) + " pictures";
  if (!folder_.empty())
    return fmt::format(
        "{} as PNG files in {}: a film needs ffmpeg, which is not installed (Debian package ffmpeg)", count,
        folder_.string());
  close(pipe_);
  pipe_ = -1;
  int status = 0;
  const int child = std::exchange(child_, -1);
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw InputError(file_.string() + ": ffmpeg could not make the film; its messages are above");
  return count + " in " + file_.string();
}

}  // namespace palpate::app
