#pragma once
#include <filesystem>
#include <memory>
#include <string>

#include "palpate/offscreen.h"

namespace palpate::app {

/// Writes the pictures of a film in order: to ffmpeg, which encodes them, or as PNG files to a folder.
class Film final {
 public:
  /// [setup] Starts ffmpeg when it is installed; otherwise makes the folder FILE-frames in the file's folder.
  /// @param width, height size of the pictures [px] @param frames_a_second frame rate [Hz]
  /// @throws InputError when ffmpeg cannot be started, or the folder cannot be made.
  Film(std::filesystem::path file, int width, int height, double frames_a_second);
  ~Film();
  Film(const Film&) = delete;
  Film& operator=(const Film&) = delete;

  /// [setup] Writes the next picture. @throws InputError when it cannot be written.
  void add(const render::Image& picture);
  /// [setup] Ends the film. @return a message with the number of pictures and their file or folder
  /// @throws InputError when ffmpeg failed.
  [[nodiscard]] std::string finish();

 private:
  std::filesystem::path file_;
  std::filesystem::path folder_;  // folder of the PNG files; empty: ffmpeg makes the film
  int pipe_ = -1;                 // file descriptor that ffmpeg reads from; -1: none
  int child_ = -1;                // process id of ffmpeg; -1: none
  std::size_t frames_ = 0;
};

/// [any] Whether ffmpeg is on the PATH.
[[nodiscard]] bool ffmpeg_installed();

}  // namespace palpate::app
