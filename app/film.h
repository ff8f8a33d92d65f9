#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "palpate/offscreen.h"

namespace palpate::app {

/// Where the pictures of a film go, in order: to ffmpeg, or to a folder as PNG files.
class Film final {
 public:
  /// [setup] Starts ffmpeg when it is installed; otherwise makes the folder FILE-frames beside the file.
  /// @throws InputError when neither can be written.
  Film(std::filesystem::path file, int width, int height, double frames_a_second);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// [setup] The next picture. @throws InputError when it cannot be written.
  void add(const render::Image& picture);
  /// [setup] Ends the film. @return what was made, in words. @throws InputError when ffmpeg failed.
  [[nodiscard]] std::string finish();

 private:
  std::filesystem::path file_;
  std::filesystem::path folder_;  // of the frames; empty: ffmpeg
  int pipe_ = -1;
  int child_ = -1;
  std::size_t frames_ = 0;
};

/// [any] Whether ffmpeg is on the PATH.
[[nodiscard]] bool ffmpeg_installed();

}  // namespace palpate::app
