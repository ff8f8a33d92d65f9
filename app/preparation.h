#pragma once
#include <cstdint>
#include <string>

#include "palpate/preparation.h"

#include "app/progress.h"

namespace palpate::app {

/// How the program prepares an organ: with the user's cache, unless it is turned off, and with a progress bar
/// once it takes a while. Keep it alive as long as what how() returned is used.
class OrganPreparation final {
 public:
  /// [setup] @param no_cache the user said --no-cache; PALPATE_CACHE=off says the same.
  explicit OrganPreparation(bool no_cache);
  OrganPreparation(const OrganPreparation&) = delete;
  OrganPreparation& operator=(const OrganPreparation&) = delete;

  [[nodiscard]] const contact::Preparation& how() const noexcept { return how_; }

 private:
  Progress bar_;
  std::int64_t show_from_ns_;
  contact::Preparation how_;
};

/// What --help says of --no-cache.
inline constexpr const char* kNoCacheHelp =
    "prepare the organ anew, and do not keep it (PALPATE_CACHE=off does the same)";

}  // namespace palpate::app
