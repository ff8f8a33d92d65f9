#pragma once
#include <cstdint>
#include <string>

namespace palpate::app {

/// A progress bar on standard error. Without a terminal every call does nothing. For one thread.
class Progress final {
 public:
  /// [setup] @param title text before the bar, e.g. "bench"
  explicit Progress(const std::string& title);
  /// Clears the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// [setup] Redraws the bar, at most twenty times per second. @param share completed fraction, 0 to 1; other
  /// values are clamped @param what short description of the current step
  void update(double share, const std::string& what);

  /// [setup] Removes the bar until the next update(), so that a message can be printed.
  void clear();

 private:
  std::string title_;
  bool terminal_;
  bool drawn_ = false;
  std::int64_t next_draw_ns_ = 0;
};

}  // namespace palpate::app
