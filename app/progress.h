#pragma once
#include <cstdint>
#include <string>

namespace palpate::app {

/// A progress bar on standard error, drawn only when that is a terminal; elsewhere every call does nothing.
/// One thread.
class Progress final {
 public:
  /// [setup] @param title stands before the bar, e.g. "bench"
  explicit Progress(std::string title);
  /// Clears the bar's line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// [setup] Redraws, at most twenty times a second. @param share done, clamped to 0..1
  /// @param what a few words on what is being done now
  void update(double share, const std::string& what);

  /// [setup] Makes room for a message: the bar is away until the next update().
  void clear();

 private:
  std::string title_;
  bool terminal_;
  bool drawn_ = false;
  std::int64_t next_draw_ns_ = 0;
};

}  // namespace palpate::app
