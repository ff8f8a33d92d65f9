#pragma once
#include <cstdint>
#include <string>

#include "palpate/preparation.h"

#include "app/progress.h"

namespace palpate::app {

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
