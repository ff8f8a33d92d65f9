#pragma once
#include <cfenv>

namespace palpate::c_interface {

/// Sets rounding to nearest and gradual underflow for its lifetime. The calling program may have changed them
/// (game engines flush denormal numbers to zero), but equal samples must give the same results bit for bit.
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
