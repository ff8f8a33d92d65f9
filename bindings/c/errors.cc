#include "bindings/c/errors.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "palpate/device.h"
#include "palpate/version.h"

namespace palpate::c_interface {
namespace {

/// Fixed size, so that an error is reported even when no memory is left.
thread_local std::array<char, 1024> last_error{};

}  // namespace

palpate_status refuse(palpate_status status, const char* message) noexcept {
  const std::size_t length = std::min(std::strlen(message), last_error.size() - 1);
  std::memcpy(last_error.data(), message, length);
  last_error[length] = '\0';
  return status;
}

void require_given(const void* pointer, const char* name) {
  if (pointer == nullptr) throw UseError(std::string(name) + ": is null, must be given");
}

}  // namespace palpate::c_interface

extern "C" {

uint32_t palpate_abi_version(void) { return PALPATE_ABI_VERSION; }

const char* palpate_version(void) { return palpate::kVersion; }

const char* palpate_last_error(void) { return palpate::c_interface::last_error.data(); }

const char* palpate_fault_words(uint32_t fault) {
  if (fault > PALPATE_FAULT_UNSTABLE) return "no fault of that number is known";
  return palpate::haptics::describe(static_cast<palpate::haptics::Fault>(fault));
}

}  // extern "C"
