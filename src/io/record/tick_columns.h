#pragma once
#include <span>

#include "core/haptics/tick_fields.h"

namespace palpate::record {

using haptics::column_size;
using haptics::ColumnType;

/// A column of the ticks: its public name with unit, and its offset in a TickRow.
struct Column {
  const char* name;
  ColumnType type;
  std::size_t offset;        // bytes
  bool added_later = false;  // a file without it has the default
};

/// [any] All columns in the order of a TickRow's memory, for recording and export. They cover a row without
/// gaps.
[[nodiscard]] std::span<const Column> tick_columns() noexcept;

/// [any] Whether a column is a measured time (tick_ns, late_ns), which differs between runs.
[[nodiscard]] bool is_measured_time(const Column& column) noexcept;

}  // namespace palpate::record
