#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "palpate/tick_row.h"

// The table of a row's values. Recordings, their export, replay, the live interface, Python and
// docs/file-formats.md go over it: a value that has a line here is known to all of them.
namespace palpate::haptics {

/// How a number is kept, in memory and in a recording.
enum class ColumnType : std::uint8_t { kU32, kU64, kI64, kF64 };

/// [any] Bytes of one number.
[[nodiscard]] constexpr std::size_t column_size(ColumnType type) noexcept {
  return type == ColumnType::kU32 ? 4 : 8;
}

/// A value of a TickRow: a number, or the components of a vector or rotation.
struct TickField {
  std::array<const char*, 4> columns;  // in recordings and their export, a name a number, the rest null
  ColumnType type;
  std::size_t offset;     // in a TickRow [bytes]; the numbers stand one behind the other
  const char* live;       // in a message of the live interface; null: it is not in one
  const char* attribute;  // of a hand's state in Python; null: it is not there, or not as it is here
  const char* meaning;    // for people, one line

  /// [any] How many numbers.
  [[nodiscard]] constexpr std::size_t size() const noexcept {
    std::size_t count = 1;
    while (count < columns.size() && columns[count] != nullptr) ++count;
    return count;
  }
};

/// Every value of a row, in the order of a TickRow's memory, of a recording and of its export.
inline constexpr std::array kTickFields{
    TickField{
        {"tick"}, ColumnType::kU64, offsetof(TickRow, tick), nullptr, nullptr, "number of the tick, from 0"},
    TickField{{"time_s"}, ColumnType::kF64, offsetof(TickRow, time), nullptr, nullptr, "tick / rate"},
    TickField{{"hand"}, ColumnType::kU32, offsetof(TickRow, hand), "hand", nullptr, "0 for the first hand"},
    TickField{{"phase"},
              ColumnType::kU32,
              offsetof(TickRow, phase),
              "phase",
              nullptr,
              "`approach`, `press` or `pull`"},
    TickField{{"distance_m"},
              ColumnType::kF64,
              offsetof(TickRow, distance),
              "distance_m",
              "distance",
              "approach: tool to organ, negative inside; pressed: minus the depth; held: 0"},
    TickField{{"depth_m"},
              ColumnType::kF64,
              offsetof(TickRow, depth),
              "depth_m",
              "depth",
              "of the contact with the largest force; 0 without contact"},
    TickField{{"cutoff_layer"},
              ColumnType::kU32,
              offsetof(TickRow, cutoff_layer),
              "cutoff_layer",
              "cutoff_layer",
              "layer that fills at that depth; 0 without contact"},
    TickField{{"saturated"},
              ColumnType::kU32,
              offsetof(TickRow, saturated),
              "saturated",
              nullptr,
              "past the last layer: the force holds"},
    TickField{{"tissue_force_N"},
              ColumnType::kF64,
              offsetof(TickRow, tissue_force),
              "tissue_force_N",
              "tissue_force",
              "norm before the gate, friction and damping included"},
    TickField{{"noise_force_N"},
              ColumnType::kF64,
              offsetof(TickRow, noise_force),
              "noise_force_N",
              "noise_force",
              "signed along the normal, + away from the tissue"},
    TickField{{"friction_N"},
              ColumnType::kF64,
              offsetof(TickRow, friction),
              "friction_N",
              "friction",
              "tangential part"},
    TickField{{"force_x_N", "force_y_N", "force_z_N"},
              ColumnType::kF64,
              offsetof(TickRow, force),
              "force_N",
              "force",
              "what went to the device, after the gate"},
    TickField{{"torque_x_N_m", "torque_y_N_m", "torque_z_N_m"},
              ColumnType::kF64,
              offsetof(TickRow, torque),
              "torque_N_m",
              "torque",
              "what went to the device, after the gate"},
    TickField{{"gripper_force_N"},
              ColumnType::kF64,
              offsetof(TickRow, gripper_force),
              "gripper_force_N",
              "gripper_force",
              "what went to the device"},
    TickField{{"tool_x_m", "tool_y_m", "tool_z_m"},
              ColumnType::kF64,
              offsetof(TickRow, tool),
              "tool_m",
              "position",
              "of the handle"},
    TickField{{"tool_qw", "tool_qx", "tool_qy", "tool_qz"},
              ColumnType::kF64,
              offsetof(TickRow, tool_q),
              "tool_wxyz",
              "orientation",
              "of the handle, a unit quaternion"},
    TickField{{"gripper"},
              ColumnType::kF64,
              offsetof(TickRow, gripper),
              "gripper",
              "gripper",
              "0 closed to 1 open"},
    TickField{
        {"contact_x_m", "contact_y_m", "contact_z_m"},
        ColumnType::kF64,
        offsetof(TickRow, contact),
        "contact_m",
        "contact",
        "on the rest surface, of the contact with the largest force; without contact the nearest point"},
    TickField{{"normal_x", "normal_y", "normal_z"},
              ColumnType::kF64,
              offsetof(TickRow, normal),
              "normal",
              "normal",
              "of the surface there, unit"},
    TickField{{"tick_ns"},
              ColumnType::kI64,
              offsetof(TickRow, tick_ns),
              "tick_ns",
              "tick_ns",
              "the tick's own computing time (0 offline)"},
    TickField{{"late_ns"},
              ColumnType::kI64,
              offsetof(TickRow, late_ns),
              "late_ns",
              "late_ns",
              "how late it began (0 offline)"},
    TickField{{"status"}, ColumnType::kU32, offsetof(TickRow, status), "status", "status", "bits, below"},
    TickField{{"fault"},
              ColumnType::kU32,
              offsetof(TickRow, fault),
              "fault",
              nullptr,
              "`0`, `not-finite`, `device`, `stale-sample`, `stalled-loop` or `force-off`"},
    TickField{{"energy_J"},
              ColumnType::kF64,
              offsetof(TickRow, energy),
              "energy_J",
              "energy",
              "what the hand has put into the tissue's force so far and not got back"},
    TickField{{"engagement"},
              ColumnType::kF64,
              offsetof(TickRow, engagement),
              "engagement",
              "engagement",
              "share of force and noise that is let through, 0 to 1"},
    TickField{{"device_x_m", "device_y_m", "device_z_m"},
              ColumnType::kF64,
              offsetof(TickRow, device),
              nullptr,
              nullptr,
              "the device's own sample, in its frame"},
    TickField{{"device_qw", "device_qx", "device_qy", "device_qz"},
              ColumnType::kF64,
              offsetof(TickRow, device_q),
              nullptr,
              nullptr,
              "of the device's sample, a unit quaternion"},
    TickField{{"device_vx_m_per_s", "device_vy_m_per_s", "device_vz_m_per_s"},
              ColumnType::kF64,
              offsetof(TickRow, device_velocity),
              nullptr,
              nullptr,
              "of the device's sample"},
    TickField{{"device_gripper"},
              ColumnType::kF64,
              offsetof(TickRow, device_gripper),
              nullptr,
              nullptr,
              "of the device's sample"},
    TickField{{"device_age_s"},
              ColumnType::kF64,
              offsetof(TickRow, device_age),
              nullptr,
              nullptr,
              "how old the sample was"},
    TickField{{"device_buttons"},
              ColumnType::kU32,
              offsetof(TickRow, buttons),
              nullptr,
              "buttons",
              "a bit a button"},
    TickField{{"device_valid"},
              ColumnType::kU32,
              offsetof(TickRow, device_valid),
              nullptr,
              nullptr,
              "0: the device could not be read"},
    TickField{{"device_fault"},
              ColumnType::kU32,
              offsetof(TickRow, device_fault),
              nullptr,
              nullptr,
              "fault that came with the sample"},
    TickField{{"events"},
              ColumnType::kU32,
              offsetof(TickRow, events),
              nullptr,
              nullptr,
              "bit 0: a fault was reset; bit 1: tissue or noise changed"},
};

/// [any] Whether every member of TickRow has its line, in order and without gaps.
[[nodiscard]] constexpr bool fields_cover_a_row() noexcept {
  std::size_t end = 0;
  for (const TickField& field : kTickFields) {
    if (field.offset != end) return false;
    end += field.size() * column_size(field.type);
  }
  return end == sizeof(TickRow);
}
static_assert(fields_cover_a_row());

}  // namespace palpate::haptics
