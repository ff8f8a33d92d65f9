#pragma once
#include <cfenv>

namespace palpate::c_interface {

/// Rounding to nearest and full denormal numbers while this lives, whatever the program around has set (game
/// engines flush denormals to zero): the same samples give the same results bit for bit in every program.
class DefaultFloatEnvironment final {
 public:
  /// [rt]
  DefaultFloatEnvironment() noexcept {
    (void)std::fegetenv(&before_);
    (void)std::fesetenv(FE_DFL_ENV);
  }
  ~DefaultFloatEnvironment() { (void)std::fesetenv(&before_); }
  DefaultFloatEnvironment(const DefaultFloatEnvironment&) = delete;
  DefaultFloatEnvironment& operator=(const DefaultFloatEnvironment&) = delete;

 private:
  std::fenv_t before_{};
};

}  // namespace palpate::c_interface
