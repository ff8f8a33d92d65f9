#pragma once
#include <cstdint>

namespace palpate {

/// Remembers the process that made it. A child made by fork() has copies of all objects, but none of their
/// threads, and it shares their open files: it must not use them.
class OwnProcess final {
 public:
  /// [setup]
  OwnProcess();
  /// [rt] False in a child that was made by fork().
  [[nodiscard]] bool is_current() const noexcept;

 private:
  std::uint64_t forks_;
};

}  // namespace palpate
