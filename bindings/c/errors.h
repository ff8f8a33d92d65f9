#pragma once
// Error handling of the C interface: no exception leaves it.
#include <exception>
#include <stdexcept>

#include "palpate/error.h"

#include "bindings/c/palpate.h"

namespace palpate::c_interface {

/// Invalid use of the interface.
class UseError final : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// [any] Stores the message, truncated if necessary, for palpate_last_error() of this thread.
/// @return `status`
palpate_status refuse(palpate_status status, const char* message) noexcept;

/// [setup] Runs a step and converts its exceptions to a status and a message.
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

/// [setup] @throws UseError naming the argument if it is null.
void require_given(const void* pointer, const char* name);

}  // namespace palpate::c_interface
