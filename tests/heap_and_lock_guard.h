#pragma once
#include <cstdint>

namespace palpate::tests {

/// Counts what the calling thread does while armed: every use of the heap and every lock. The program's
/// malloc and its kind, pthread_mutex_lock and its kind go through here (heap_and_lock_guard.cc).
void arm_guard() noexcept;
void disarm_guard() noexcept;

/// Since the start of the program, over all threads.
std::uint64_t heap_uses() noexcept;
std::uint64_t lock_uses() noexcept;

}  // namespace palpate::tests
