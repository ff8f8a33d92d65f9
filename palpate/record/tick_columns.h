#pragma once
#include <cstdint>
#include <span>

#include "palpate/haptics/tick_row.h"

namespace palpate::record {

/// How a column is kept, in memory and in the file.
enum class ColumnType { kU32, kU64, kI64, kF64 };

/// One column of the ticks: its name outside (contract, with its unit) and its place in a TickRow.
struct Column {
  const char* name;
  ColumnType type;
  std::size_t offset;        // bytes
  bool old_lack_it = false;  // a file from before the column was written: the default stays
};

/// [any] Bytes of one value.
[[nodiscard]] constexpr std::size_t column_size(ColumnType type) noexcept {
  return type == ColumnType::kU32 ? 4 : 8;
}

/// [any] All columns, in the order of a TickRow's memory, of the recording and of the export; together they
/// cover a row without gaps.
[[nodiscard]] std::span<const Column> tick_columns() noexcept;

/// [any] Whether a column is a measured time, which differs from run to run (tick_ns, late_ns).
[[nodiscard]] bool is_measured_time(const Column& column) noexcept;

}  // namespace palpate::record
