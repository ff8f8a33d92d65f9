#pragma once
#include <cstdint>
#include <string>

#include "palpate/preparation.h"

namespace palpate::app {

/// What a progress bar shows where standard error is no terminal: nothing, a line every ten seconds, or a
/// line at each new step.
enum class WithoutTerminal { kNothing, kLines, kSteps };

/// A progress bar on standard error. For one thread.
class Progress final {
 public:
  /// [setup] @param title text before the bar, e.g. "bench"
  explicit Progress(const std::string& title, WithoutTerminal otherwise = WithoutTerminal::kNothing);
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
  WithoutTerminal otherwise_;
  std::string step_;  // of the last line, with kSteps
  bool drawn_ = false;
  std::int64_t next_draw_ns_ = 0;
};

/// Options for the preparation of an organ: the user's cache, unless it is turned off, and a progress bar,
/// which appears after 0.3 s. Must outlive every use of how().
class OrganPreparation final {
 public:
  /// [setup] @param no_cache the flag --no-cache was given. PALPATE_CACHE=off also turns the cache off.
  explicit OrganPreparation(bool no_cache);
  OrganPreparation(const OrganPreparation&) = delete;
  OrganPreparation& operator=(const OrganPreparation&) = delete;

  [[nodiscard]] const contact::Preparation& how() const noexcept { return how_; }

 private:
  Progress bar_;
  std::int64_t show_from_ns_;
  contact::Preparation how_;
};

/// Help text of --no-cache.
inline constexpr const char* kNoCacheHelp =
    "prepare the organ again and do not cache it (PALPATE_CACHE=off does the same)";

}  // namespace palpate::app
