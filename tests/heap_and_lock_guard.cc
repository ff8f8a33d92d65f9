#include "tests/heap_and_lock_guard.h"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <ctime>

#include <dlfcn.h>
#include <pthread.h>

namespace {

thread_local bool armed = false;
std::atomic<std::uint64_t> heap_count{0};
std::atomic<std::uint64_t> lock_count{0};

void count_heap() noexcept {
  if (armed) heap_count.fetch_add(1, std::memory_order_relaxed);
}

/// The C library's function with this name, looked up once.
template <typename Function>
Function* next(std::atomic<void*>& found, const char* name) noexcept {
  void* address = found.load(std::memory_order_acquire);
  if (address == nullptr) {
    address = dlsym(RTLD_NEXT, name);
    found.store(address, std::memory_order_release);
  }
  return reinterpret_cast<Function*>(address);
}

template <typename Object>
int forward_lock(std::atomic<void*>& found, const char* name, Object* object) noexcept {
  if (armed) lock_count.fetch_add(1, std::memory_order_relaxed);
  return next<int(Object*)>(found, name)(object);
}

}  // namespace

extern "C" {

// The C library's heap functions under their internal names.
// NOLINTBEGIN(bugprone-reserved-identifier)
void* __libc_malloc(std::size_t size) noexcept;
void* __libc_calloc(std::size_t count, std::size_t size) noexcept;
void* __libc_realloc(void* block, std::size_t size) noexcept;
void* __libc_memalign(std::size_t alignment, std::size_t size) noexcept;
void __libc_free(void* block) noexcept;
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
  count_heap();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  count_heap();
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  count_heap();
  return __libc_realloc(block, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  count_heap();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count_heap();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  count_heap();
  *block = __libc_memalign(alignment, size);
  return *block == nullptr ? ENOMEM : 0;
}
void free(void* block) noexcept {
  if (block != nullptr) count_heap();
  __libc_free(block);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  static std::atomic<void*> found{nullptr};
  return forward_lock(found, "pthread_mutex_lock", mutex);
}
int pthread_mutex_trylock(pthread_mutex_t* mutex) noexcept {
  static std::atomic<void*> found{nullptr};
  return forward_lock(found, "pthread_mutex_trylock", mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) noexcept {
  static std::atomic<void*> found{nullptr};
  return forward_lock(found, "pthread_rwlock_rdlock", lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) noexcept {
  static std::atomic<void*> found{nullptr};
  return forward_lock(found, "pthread_rwlock_wrlock", lock);
}
int pthread_spin_lock(pthread_spinlock_t* lock) noexcept {
  static std::atomic<void*> found{nullptr};
  return forward_lock(found, "pthread_spin_lock", lock);
}

}  // extern "C"

namespace palpate::tests {

void arm_guard() noexcept { armed = true; }
void disarm_guard() noexcept { armed = false; }
std::uint64_t heap_uses() noexcept { return heap_count.load(); }
std::uint64_t lock_uses() noexcept { return lock_count.load(); }

}  // namespace palpate::tests
