#pragma once

namespace palpate::identify {

/// [setup] Silences Ceres's messages about steps without a finite result, which cost_of() reports as well.
class QuietLibrary final {
 public:
  QuietLibrary();
  ~QuietLibrary();
  QuietLibrary(const QuietLibrary&) = delete;
  QuietLibrary& operator=(const QuietLibrary&) = delete;
};

}  // namespace palpate::identify
