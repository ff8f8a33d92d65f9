#include "palpate/record/tick_columns.h"

#include <cstddef>
#include <iterator>
#include <type_traits>

namespace palpate::record {
namespace {

using haptics::TickRow;

static_assert(std::is_standard_layout_v<TickRow> && std::is_trivially_copyable_v<TickRow>);

constexpr Column one(const char* name, ColumnType type, std::size_t offset) { return {name, type, offset}; }

/// Entry `index` of an array of doubles.
constexpr Column entry(const char* name, std::size_t offset, std::size_t index) {
  return {name, ColumnType::kF64, offset + index * sizeof(double)};
}

constexpr Column kColumns[] = {
    one("tick", ColumnType::kU64, offsetof(TickRow, tick)),
    one("time_s", ColumnType::kF64, offsetof(TickRow, time)),
    one("hand", ColumnType::kU32, offsetof(TickRow, hand)),
    one("phase", ColumnType::kU32, offsetof(TickRow, phase)),
    one("distance_m", ColumnType::kF64, offsetof(TickRow, distance)),
    one("depth_m", ColumnType::kF64, offsetof(TickRow, depth)),
    one("cutoff_layer", ColumnType::kU32, offsetof(TickRow, cutoff_layer)),
    one("saturated", ColumnType::kU32, offsetof(TickRow, saturated)),
    one("tissue_force_N", ColumnType::kF64, offsetof(TickRow, tissue_force)),
    one("noise_force_N", ColumnType::kF64, offsetof(TickRow, noise_force)),
    one("friction_N", ColumnType::kF64, offsetof(TickRow, friction)),
    entry("force_x_N", offsetof(TickRow, force), 0),
    entry("force_y_N", offsetof(TickRow, force), 1),
    entry("force_z_N", offsetof(TickRow, force), 2),
    entry("torque_x_N_m", offsetof(TickRow, torque), 0),
    entry("torque_y_N_m", offsetof(TickRow, torque), 1),
    entry("torque_z_N_m", offsetof(TickRow, torque), 2),
    one("gripper_force_N", ColumnType::kF64, offsetof(TickRow, gripper_force)),
    entry("tool_x_m", offsetof(TickRow, tool), 0),
    entry("tool_y_m", offsetof(TickRow, tool), 1),
    entry("tool_z_m", offsetof(TickRow, tool), 2),
    entry("tool_qw", offsetof(TickRow, tool_q), 0),
    entry("tool_qx", offsetof(TickRow, tool_q), 1),
    entry("tool_qy", offsetof(TickRow, tool_q), 2),
    entry("tool_qz", offsetof(TickRow, tool_q), 3),
    one("gripper", ColumnType::kF64, offsetof(TickRow, gripper)),
    entry("contact_x_m", offsetof(TickRow, contact), 0),
    entry("contact_y_m", offsetof(TickRow, contact), 1),
    entry("contact_z_m", offsetof(TickRow, contact), 2),
    entry("normal_x", offsetof(TickRow, normal), 0),
    entry("normal_y", offsetof(TickRow, normal), 1),
    entry("normal_z", offsetof(TickRow, normal), 2),
    one("tick_ns", ColumnType::kI64, offsetof(TickRow, tick_ns)),
    one("late_ns", ColumnType::kI64, offsetof(TickRow, late_ns)),
    one("status", ColumnType::kU32, offsetof(TickRow, status)),
    one("fault", ColumnType::kU32, offsetof(TickRow, fault)),
    one("energy_J", ColumnType::kF64, offsetof(TickRow, energy)),
    one("engagement", ColumnType::kF64, offsetof(TickRow, engagement)),
    entry("device_x_m", offsetof(TickRow, device), 0),
    entry("device_y_m", offsetof(TickRow, device), 1),
    entry("device_z_m", offsetof(TickRow, device), 2),
    entry("device_qw", offsetof(TickRow, device_q), 0),
    entry("device_qx", offsetof(TickRow, device_q), 1),
    entry("device_qy", offsetof(TickRow, device_q), 2),
    entry("device_qz", offsetof(TickRow, device_q), 3),
    entry("device_vx_m_per_s", offsetof(TickRow, device_velocity), 0),
    entry("device_vy_m_per_s", offsetof(TickRow, device_velocity), 1),
    entry("device_vz_m_per_s", offsetof(TickRow, device_velocity), 2),
    one("device_gripper", ColumnType::kF64, offsetof(TickRow, device_gripper)),
    one("device_age_s", ColumnType::kF64, offsetof(TickRow, device_age)),
    one("device_buttons", ColumnType::kU32, offsetof(TickRow, buttons)),
    one("device_valid", ColumnType::kU32, offsetof(TickRow, device_valid)),
    one("device_fault", ColumnType::kU32, offsetof(TickRow, device_fault)),
    one("events", ColumnType::kU32, offsetof(TickRow, events)),
};

constexpr bool columns_cover_a_row() {
  std::size_t end = 0;
  for (const Column& column : kColumns) {
    if (column.offset != end) return false;
    end += column_size(column.type);
  }
  return end == sizeof(TickRow);
}
static_assert(columns_cover_a_row(), "every member of TickRow is a column, and there is no padding");

}  // namespace

std::span<const Column> tick_columns() noexcept { return kColumns; }

bool is_measured_time(const Column& column) noexcept {
  return column.offset == offsetof(TickRow, tick_ns) || column.offset == offsetof(TickRow, late_ns);
}

}  // namespace palpate::record
