#pragma once
#include <cstdint>
#include <span>

#include "core/haptics/tick_fields.h"

namespace palpate::record {

using haptics::column_size;
using haptics::ColumnType;

/// One column of the ticks: its name outside, with its unit, and its place in a TickRow.
struct Column {
  const char* name;
  ColumnType type;
  std::size_t offset;        // bytes
  bool added_later = false;  // an old file without the column has the default
};

/// [any] All columns, in the order of a TickRow's memory, of the recording and of the export; together they
/// cover a row without gaps.
[[nodiscard]] std::span<const Column> tick_columns() noexcept;

/// [any] Whether a column is a measured time, which differs from run to run (tick_ns, late_ns).
[[nodiscard]] bool is_measured_time(const Column& column) noexcept;

}  // namespace palpate::record
