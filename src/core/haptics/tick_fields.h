#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "palpate/tick_row.h"

// The table of a row's values. Recordings, export, replay, the live interface, Python and
// docs/file-formats.md iterate over it, so one line adds a value to all of them.
namespace palpate::haptics {

/// The type of a number, in memory and in a recording.
enum class ColumnType : std::uint8_t { kU32, kU64, kI64, kF64 };

/// [any] Size of a number [bytes].
[[nodiscard]] constexpr std::size_t column_size(ColumnType type) noexcept {
  return type == ColumnType::kU32 ? 4 : 8;
}

/// [any] Calls `use` with the number at byte `offset` of `row`. @return the result of `use`, which has one
/// type for all numbers
template <typename Row, typename Use>
auto with_number(const Row& row, ColumnType type, std::size_t offset, Use use) {
  const auto read = [&](auto number) {
    std::memcpy(&number, reinterpret_cast<const std::byte*>(&row) + offset, sizeof number);
    return use(number);
  };
  switch (type) {
    case ColumnType::kU32:
      return read(std::uint32_t{});
    case ColumnType::kU64:
      return read(std::uint64_t{});
    case ColumnType::kI64:
      return read(std::int64_t{});
    case ColumnType::kF64:
      break;
  }
  return read(double{});
}

/// One value of a TickRow: a number, or the components of a vector or rotation.
struct TickField {
  std::array<const char*, 4> columns;  // names in recordings and export, one per number; unused ones null
  ColumnType type;
  std::size_t offset;        // in a TickRow [bytes]; the numbers are contiguous
  const char* live;          // name in a message of the live interface; null: not sent
  const char* attribute;     // name in Python's HandState; null: absent, or bound by hand
  const char* meaning;       // one line for users
  bool added_later = false;  // recordings without it have 0, and a 0 does not count in hash_rows()

  /// [any] Number of components.
  [[nodiscard]] constexpr std::size_t size() const noexcept {
    std::size_t count = 1;
    while (count < columns.size() && columns[count] != nullptr) ++count;
    return count;
  }
};

/// Every value of a row, in the order of a TickRow's memory, of recordings and of their export.
// clang-format off
inline constexpr auto kTickFields = [] {
  using enum ColumnType;
  return std::to_array<TickField>({
    {{"tick"}, kU64, offsetof(TickRow, tick), nullptr, nullptr, "number of the tick, from 0"},
    {{"time_s"}, kF64, offsetof(TickRow, time), nullptr, nullptr, "tick / rate"},
    {{"hand"}, kU32, offsetof(TickRow, hand), "hand", nullptr, "0 for the first hand"},
    {{"phase"}, kU32, offsetof(TickRow, phase), "phase", nullptr, "`approach`, `press`, `pull` or `insert`"},
    {{"distance_m"}, kF64, offsetof(TickRow, distance), "distance_m", "distance",
     "approach: tool to organ, negative inside; pressed: minus the depth; held: 0"},
    {{"depth_m"}, kF64, offsetof(TickRow, depth), "depth_m", "depth",
     "of the contact with the largest force; 0 without contact"},
    {{"cutoff_layer"}, kU32, offsetof(TickRow, cutoff_layer), "cutoff_layer", "cutoff_layer",
     "layer that fills at that depth; 0 without contact"},
    {{"saturated"}, kU32, offsetof(TickRow, saturated), "saturated", nullptr, "past the last layer: the force holds"},
    {{"tissue_force_N"}, kF64, offsetof(TickRow, tissue_force), "tissue_force_N", "tissue_force",
     "norm before the gate, friction and damping included"},
    {{"noise_force_N"}, kF64, offsetof(TickRow, noise_force), "noise_force_N", "noise_force",
     "signed along the normal, + away from the tissue"},
    {{"friction_N"}, kF64, offsetof(TickRow, friction), "friction_N", "friction", "tangential part"},
    {{"force_x_N", "force_y_N", "force_z_N"}, kF64, offsetof(TickRow, force), "force_N", "force",
     "what went to the device, after the gate"},
    {{"torque_x_N_m", "torque_y_N_m", "torque_z_N_m"}, kF64, offsetof(TickRow, torque), "torque_N_m", "torque",
     "what went to the device, after the gate"},
    {{"gripper_force_N"}, kF64, offsetof(TickRow, gripper_force), "gripper_force_N", "gripper_force",
     "what went to the device"},
    {{"tool_x_m", "tool_y_m", "tool_z_m"}, kF64, offsetof(TickRow, tool), "tool_m", "position", "of the handle"},
    {{"tool_qw", "tool_qx", "tool_qy", "tool_qz"}, kF64, offsetof(TickRow, tool_q), "tool_wxyz", "orientation",
     "of the handle, a unit quaternion"},
    {{"gripper"}, kF64, offsetof(TickRow, gripper), "gripper", "gripper", "0 closed to 1 open"},
    {{"contact_x_m", "contact_y_m", "contact_z_m"}, kF64, offsetof(TickRow, contact), "contact_m", "contact",
     "on the rest surface, of the contact with the largest force; without contact the nearest point"},
    {{"normal_x", "normal_y", "normal_z"}, kF64, offsetof(TickRow, normal), "normal", "normal",
     "of the surface there, unit"},
    {{"tick_ns"}, kI64, offsetof(TickRow, tick_ns), "tick_ns", "tick_ns", "the tick's own computing time (0 offline)"},
    {{"late_ns"}, kI64, offsetof(TickRow, late_ns), "late_ns", "late_ns", "how late it began (0 offline)"},
    {{"status"}, kU32, offsetof(TickRow, status), "status", "status", "bits, below"},
    {{"fault"}, kU32, offsetof(TickRow, fault), "fault", nullptr,
     "`0`, `not-finite`, `device`, `stale-sample`, `stalled-loop`, `force-off` or `unstable`"},
    {{"energy_J"}, kF64, offsetof(TickRow, energy), "energy_J", "energy",
     "net energy that the hand and the organ's own motion have put into the tissue force; outside the tissue a "
     "surplus is reset to 0, a deficit stays"},
    {{"engagement"}, kF64, offsetof(TickRow, engagement), "engagement", "engagement",
     "gain of force and noise (force ramp), 0 to 1"},
    {{"device_x_m", "device_y_m", "device_z_m"}, kF64, offsetof(TickRow, device), nullptr, nullptr,
     "the device's own sample, in its frame"},
    {{"device_qw", "device_qx", "device_qy", "device_qz"}, kF64, offsetof(TickRow, device_q), nullptr, nullptr,
     "of the device's sample, a unit quaternion"},
    {{"device_vx_m_per_s", "device_vy_m_per_s", "device_vz_m_per_s"}, kF64, offsetof(TickRow, device_velocity), nullptr, nullptr,
     "of the device's sample"},
    {{"device_gripper"}, kF64, offsetof(TickRow, device_gripper), nullptr, nullptr, "of the device's sample"},
    {{"device_age_s"}, kF64, offsetof(TickRow, device_age), nullptr, nullptr, "how old the sample was"},
    {{"device_buttons"}, kU32, offsetof(TickRow, buttons), nullptr, "buttons", "a bit a button"},
    {{"device_valid"}, kU32, offsetof(TickRow, device_valid), nullptr, nullptr, "0: the device could not be read"},
    {{"device_fault"}, kU32, offsetof(TickRow, device_fault), nullptr, nullptr, "fault that came with the sample"},
    {{"events"}, kU32, offsetof(TickRow, events), nullptr, nullptr,
     "bit 0: a fault was reset; bit 1: a parameter update; bit 2: the device's motors are warm; bit 3: a stimulus "
     "interval began; bit 4: one ended; bit 5: a needle punctured a layer; bit 6: a needle left the tissue"},
    {{"stimulus_force_N"}, kF64, offsetof(TickRow, stimulus_force), nullptr, "stimulus_force",
     "commanded force, signed like the noise", true},
    {{"layer"}, kU64, offsetof(TickRow, layer), "layer", "layer",
     "layer of the tissue in which a needle's tip is, from 1; 0: in none", true},
    {{"inserted_mm"}, kF64, offsetof(TickRow, inserted_mm), "inserted_mm", "inserted_mm",
     "length of the needle's shaft past its entry, also what is out of the far side", true},
    {{"slip"}, kI64, offsetof(TickRow, slip), "slip", "slip",
     "1: the shaft slips inwards through the tissue, -1: outwards, 0: the tissue moves with it", true},
    {{"tip_force_N"}, kF64, offsetof(TickRow, tip_force), "tip_force_N", "tip_force",
     "on the needle's tip in the tissue; the rest of the force is friction on the shaft, or the hub's push", true},
  });
}();
// clang-format on

/// [any] Whether the table covers every member of TickRow, in order and without gaps.
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
