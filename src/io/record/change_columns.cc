#include "io/record/change_columns.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <type_traits>
#include <vector>

namespace palpate::record {
namespace {

using haptics::LiveChange;
using model::kMostRelaxationTerms;
using model::kTissueFields;

static_assert(std::is_standard_layout_v<ChangeRow> && std::is_trivially_copyable_v<ChangeRow>);
static_assert(sizeof(ChangeRow) == (6 + ChangeRow::kTissueNumbers) * 8 + LiveChange::kNameBytes,
              "no padding");

// The terms of relaxation stand behind the numbers of [tissue] itself.
constexpr std::size_t kOwnNumbers = [] {
  std::size_t count = 0;
  while (kTissueFields[count].section.empty()) ++count;
  return count;
}();
static_assert(std::none_of(kTissueFields.begin() + kOwnNumbers, kTissueFields.end(),
                           [](const model::TissueField& field) { return field.section.empty(); }));
constexpr std::size_t kShares = kOwnNumbers;
constexpr std::size_t kTimes = kShares + kMostRelaxationTerms;

/// Where a row has a field's number.
constexpr std::size_t index_of(std::size_t field) {
  return field < kOwnNumbers ? field : field + 2 * kMostRelaxationTerms;
}

constexpr std::array<const char*, 2 * kMostRelaxationTerms> kTermColumns{
    "relaxation_1_share",  "relaxation_2_share",  "relaxation_3_share",
    "relaxation_1_time_s", "relaxation_2_time_s", "relaxation_3_time_s"};

std::vector<Column> all_columns() {
  std::vector<Column> columns{{"tick", ColumnType::kU64, offsetof(ChangeRow, tick)},
                              {"number", ColumnType::kU64, offsetof(ChangeRow, number)},
                              {"what", ColumnType::kU32, offsetof(ChangeRow, what)},
                              {"law", ColumnType::kU32, offsetof(ChangeRow, law)}};
  const auto add = [&](const char* name, bool old_lack_it) {
    columns.push_back(
        {name, ColumnType::kF64, columns.back().offset + column_size(columns.back().type), old_lack_it});
  };
  for (std::size_t i = 0; i < kTissueFields.size(); ++i) {
    if (i == kOwnNumbers)
      std::for_each(kTermColumns.begin(), kTermColumns.end(), [&](auto name) { add(name, false); });
    add(kTissueFields[i].si_key, kTissueFields[i].old_lack_it);
  }
  columns.push_back({"noise_enabled", ColumnType::kU64, offsetof(ChangeRow, noise_enabled)});
  columns.push_back({"noise_gain_N_m", ColumnType::kF64, offsetof(ChangeRow, noise_gain)});
  columns.push_back({"noise_threshold_m", ColumnType::kF64, offsetof(ChangeRow, noise_threshold)});
  return columns;
}

}  // namespace

ChangeRow row_of(const LiveChange& change) noexcept {
  ChangeRow row{.tick = change.tick, .number = change.number, .what = change.what};
  row.law = static_cast<std::uint32_t>(change.tissue.law);
  for (std::size_t i = 0; i < kTissueFields.size(); ++i) {
    row.tissue[index_of(i)] = kTissueFields[i].at.get(change.tissue).value_or(0.0);
  }
  for (std::size_t i = 0; i < change.tissue.relaxation.size(); ++i) {
    row.tissue[kShares + i] = change.tissue.relaxation[i].share;
    row.tissue[kTimes + i] = change.tissue.relaxation[i].time;
  }
  row.noise_enabled = change.noise.enabled ? 1 : 0;
  row.noise_gain = change.noise.gain;
  row.noise_threshold = change.noise.threshold;
  row.name = change.name;
  return row;
}

LiveChange change_of(const ChangeRow& row) {
  LiveChange change;
  change.tick = row.tick;
  change.number = row.number;
  change.what = row.what;
  change.tissue.law = static_cast<model::LawKind>(row.law);
  for (std::size_t i = 0; i < kTissueFields.size(); ++i) {
    const double value = row.tissue[index_of(i)];
    const bool given = value != 0.0 || !kTissueFields[i].optional();
    kTissueFields[i].at.set(change.tissue, given ? std::optional(value) : std::nullopt);
  }
  for (std::size_t i = 0; i < kMostRelaxationTerms && row.tissue[kShares + i] != 0.0; ++i) {
    change.tissue.relaxation.push_back({row.tissue[kShares + i], row.tissue[kTimes + i]});
  }
  change.noise = {row.noise_enabled != 0, row.noise_gain, row.noise_threshold};
  change.name = row.name;
  return change;
}

std::span<const Column> change_columns() {
  static const std::vector<Column> kAll = all_columns();
  return kAll;
}

}  // namespace palpate::record
