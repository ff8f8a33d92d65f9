#include "io/record/tick_columns.h"

#include <array>
#include <cstddef>
#include <type_traits>

namespace palpate::record {
namespace {

using haptics::kTickFields;
using haptics::TickRow;

static_assert(std::is_standard_layout_v<TickRow> && std::is_trivially_copyable_v<TickRow>);

constexpr std::size_t kCount = [] {
  std::size_t count = 0;
  for (const haptics::TickField& field : kTickFields) count += field.size();
  return count;
}();

constexpr std::array<Column, kCount> kColumns = [] {
  std::array<Column, kCount> columns{};
  std::size_t next = 0;
  for (const haptics::TickField& field : kTickFields) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      columns[next++] = {field.columns[i], field.type, field.offset + i * column_size(field.type),
                         field.added_later};
    }
  }
  return columns;
}();

}  // namespace

std::span<const Column> tick_columns() noexcept { return kColumns; }

bool is_measured_time(const Column& column) noexcept {
  return column.offset == offsetof(TickRow, tick_ns) || column.offset == offsetof(TickRow, late_ns);
}

}  // namespace palpate::record
