#pragma once
#include <cstdint>

namespace palpate::tests {

/// While armed, counts every heap use and every lock of the calling thread. heap_and_lock_guard.cc replaces
/// malloc, pthread_mutex_lock and related functions of the program.
void arm_guard() noexcept;
void disarm_guard() noexcept;

/// Counts since the start of the program, over all threads.
std::uint64_t heap_uses() noexcept;
std::uint64_t lock_uses() noexcept;

}  // namespace palpate::tests
