#pragma once
#include <span>

#include "palpate/haptics/live_change.h"
#include "palpate/record/tick_columns.h"

namespace palpate::record {

/// [any] All numbers of a live change, in the order of its memory, of the recording and of the export; its
/// tissue's name, kChangeName, comes after them.
[[nodiscard]] std::span<const Column> change_columns() noexcept;

inline constexpr const char* kChangeName = "tissue";

}  // namespace palpate::record
