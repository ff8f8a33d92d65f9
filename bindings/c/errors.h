#pragma once
// How the C interface tells what went wrong: nothing is thrown across it.
#include <exception>
#include <stdexcept>
#include <string>

#include "palpate/error.h"

#include "bindings/c/palpate.h"

namespace palpate::c_interface {

/// A call that the interface does not allow.
class UseError final : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// [any] Keeps the message for palpate_last_error() of this thread, cut to what fits. @return `status`
palpate_status refuse(palpate_status status, const char* message) noexcept;

/// [setup] Runs a step; what it throws becomes a status and a message.
template <typename Step>
palpate_status guarded(const Step& step) noexcept {
  try {
    step();
    return PALPATE_OK;
  } catch (const UseError& error) {
    return refuse(PALPATE_ERROR_USE, error.what());
  } catch (const InputError& error) {
    return refuse(PALPATE_ERROR_INPUT, error.what());
  } catch (const std::exception& error) {
    return refuse(PALPATE_ERROR_OTHER, error.what());
  } catch (...) {
    return refuse(PALPATE_ERROR_OTHER, "an exception that is none of the standard library's");
  }
}

/// [setup] @throws UseError naming the argument when it is null.
void require_given(const void* pointer, const char* name);

/// [setup] @throws UseError naming the struct when its size is not this library's.
void require_size(std::size_t given, std::size_t right, const char* name);

}  // namespace palpate::c_interface
