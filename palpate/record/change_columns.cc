#include "palpate/record/change_columns.h"

#include <cstddef>
#include <type_traits>

namespace palpate::record {
namespace {

using haptics::LiveChange;

static_assert(std::is_standard_layout_v<LiveChange> && std::is_trivially_copyable_v<LiveChange>);

constexpr Column number(const char* name, std::size_t offset, std::size_t index = 0) {
  return {name, ColumnType::kF64, offset + index * sizeof(double)};
}

constexpr Column kChangeColumns[] = {
    {"tick", ColumnType::kU64, offsetof(LiveChange, tick)},
    {"number", ColumnType::kU64, offsetof(LiveChange, number)},
    {"what", ColumnType::kU32, offsetof(LiveChange, what)},
    {"law", ColumnType::kU32, offsetof(LiveChange, law)},
    number("k1_N_per_m", offsetof(LiveChange, k1)),
    number("beta", offsetof(LiveChange, beta)),
    number("q", offsetof(LiveChange, q)),
    number("rest_length_m", offsetof(LiveChange, rest_length)),
    number("max_length_m", offsetof(LiveChange, max_length)),
    number("min_length_m", offsetof(LiveChange, min_length)),
    number("t1_s", offsetof(LiveChange, t1)),
    number("relaxation_1_share", offsetof(LiveChange, share), 0),
    number("relaxation_2_share", offsetof(LiveChange, share), 1),
    number("relaxation_3_share", offsetof(LiveChange, share), 2),
    number("relaxation_1_time_s", offsetof(LiveChange, time), 0),
    number("relaxation_2_time_s", offsetof(LiveChange, time), 1),
    number("relaxation_3_time_s", offsetof(LiveChange, time), 2),
    number("contact_ratio", offsetof(LiveChange, contact_ratio)),
    number("first_bar_ratio", offsetof(LiveChange, first_bar_ratio)),
    number("bar_ratio", offsetof(LiveChange, bar_ratio)),
    number("weight_ratio", offsetof(LiveChange, weight_ratio)),
    {"depth_exponent", ColumnType::kF64, offsetof(LiveChange, depth_exponent), true},
    number("friction", offsetof(LiveChange, friction)),
    number("tangential_N_per_m", offsetof(LiveChange, tangential_stiffness)),
    number("damping_N_s_per_m", offsetof(LiveChange, damping)),
    number("reference_radius_m", offsetof(LiveChange, reference_radius)),
    number("grip_limit_N", offsetof(LiveChange, grip_limit)),
    {"noise_enabled", ColumnType::kU64, offsetof(LiveChange, noise_enabled)},
    number("noise_gain_N_m", offsetof(LiveChange, noise_gain)),
    number("noise_threshold_m", offsetof(LiveChange, noise_threshold)),
};

constexpr bool columns_cover_a_change() {
  std::size_t end = 0;
  for (const Column& column : kChangeColumns) {
    if (column.offset != end) return false;
    end += column_size(column.type);
  }
  return end == offsetof(LiveChange, tissue) && end + LiveChange::kNameBytes == sizeof(LiveChange);
}
static_assert(columns_cover_a_change(), "every member of LiveChange is a column, and there is no padding");

}  // namespace

std::span<const Column> change_columns() noexcept { return kChangeColumns; }

}  // namespace palpate::record
