#pragma once
// Structs of callers that were compiled with an older palpate.h: shorter, without the newest fields at the
// end.
#include <cstddef>
#include <cstring>
#include <string>

#include "bindings/c/errors.h"

namespace palpate::c_interface {

/// [rt] Whether a size is that of a struct of this or an older header, with one field at least. New fields
/// begin where an older struct ended, its padding included, so sizes are multiples of the alignment.
template <typename Struct>
[[nodiscard]] bool is_known_size(std::size_t size) noexcept {
  return size > sizeof(std::size_t) && size <= sizeof(Struct) && size % alignof(Struct) == 0;
}

/// [setup] @throws UseError naming the struct if its size is not known
template <typename Struct>
void require_size(const Struct& given, const char* name) {
  if (is_known_size<Struct>(given.struct_size)) return;
  throw UseError(
      std::string(name) + ".struct_size = " + std::to_string(given.struct_size) + ": must be " +
      std::to_string(sizeof(Struct)) +
      ", or less in an older version; set it to sizeof the struct, and compile with a palpate.h that "
      "is not newer than the library");
}

/// [rt] The caller's struct; the fields that it lacks are those of `rest`. @param given of a known size
template <typename Struct>
[[nodiscard]] Struct taken(const Struct* given, Struct rest = {}) noexcept {
  std::size_t size = 0;
  std::memcpy(&size, given, sizeof size);
  std::memcpy(static_cast<void*>(&rest), given, size);
  rest.struct_size = sizeof rest;
  return rest;
}

/// [rt] Gives the caller the fields that its struct has. @param to of a known size
template <typename Struct>
void give(const Struct& from, Struct* to) noexcept {
  const std::size_t size = to->struct_size;
  std::memcpy(static_cast<void*>(to), &from, size);
  to->struct_size = size;
}

}  // namespace palpate::c_interface
