#include "io/record/update_columns.h"

#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "palpate/inclusion.h"

namespace palpate::record {
namespace {

using haptics::ParameterUpdate;
using model::kMaxRelaxationTerms;
using model::kTissueFields;

static_assert(std::is_standard_layout_v<UpdateRow> && std::is_trivially_copyable_v<UpdateRow>);
static_assert(sizeof(UpdateRow) ==
                  (15 + kTissueFields.size() + 2 * kMaxRelaxationTerms) * 8 + ParameterUpdate::kNameBytes,
              "no padding");

constexpr std::array<const char*, kMaxRelaxationTerms> kShareColumns{
    "relaxation_1_share", "relaxation_2_share", "relaxation_3_share"};
constexpr std::array<const char*, kMaxRelaxationTerms> kTimeColumns{
    "relaxation_1_time_s", "relaxation_2_time_s", "relaxation_3_time_s"};

std::vector<Column> all_columns() {
  std::vector<Column> columns{{"tick", ColumnType::kU64, offsetof(UpdateRow, tick)},
                              {"number", ColumnType::kU64, offsetof(UpdateRow, number)},
                              {"what", ColumnType::kU32, offsetof(UpdateRow, what)},
                              {"law", ColumnType::kU32, offsetof(UpdateRow, law)}};
  const auto add = [&](const char* name, std::size_t array, std::size_t index, bool added_later = false) {
    columns.push_back({name, ColumnType::kF64, array + index * sizeof(double), added_later});
  };
  const auto add_tissue = [&](bool sections) {
    for (std::size_t i = 0; i < kTissueFields.size(); ++i) {
      const model::TissueField& field = kTissueFields[i];
      if (field.section.empty() == sections) continue;
      add(field.column(), offsetof(UpdateRow, tissue), i, field.added_later);
    }
  };
  add_tissue(false);
  for (std::size_t i = 0; i < kMaxRelaxationTerms; ++i) add(kShareColumns[i], offsetof(UpdateRow, share), i);
  for (std::size_t i = 0; i < kMaxRelaxationTerms; ++i) add(kTimeColumns[i], offsetof(UpdateRow, time), i);
  add_tissue(true);
  columns.push_back({"noise_enabled", ColumnType::kU64, offsetof(UpdateRow, noise_enabled)});
  add("noise_gain_N_m", offsetof(UpdateRow, noise_gain), 0);
  add("noise_threshold_m", offsetof(UpdateRow, noise_threshold), 0);
  columns.push_back({"inclusion", ColumnType::kU64, offsetof(UpdateRow, inclusion), true});
  add("inclusion_x_m", offsetof(UpdateRow, inclusion_centre), 0, true);
  add("inclusion_y_m", offsetof(UpdateRow, inclusion_centre), 1, true);
  add("inclusion_z_m", offsetof(UpdateRow, inclusion_centre), 2, true);
  add("inclusion_stiffness_ratio", offsetof(UpdateRow, inclusion_ratio), 0, true);
  add("stimulus_force_N", offsetof(UpdateRow, stimulus_force), 0, true);
  add("stimulus_ramp_s", offsetof(UpdateRow, stimulus_ramp), 0, true);
  columns.push_back({"stimulus_interval", ColumnType::kU64, offsetof(UpdateRow, stimulus_interval), true});
  add("source_radius_m", offsetof(UpdateRow, source_radius), 0, true);
  return columns;
}

}  // namespace

UpdateRow row_of(const ParameterUpdate& change) noexcept {
  UpdateRow row{.tick = change.tick, .number = change.number, .what = change.what};
  row.law = static_cast<std::uint32_t>(change.tissue.law);
  for (std::size_t i = 0; i < kTissueFields.size(); ++i) {
    row.tissue[i] = kTissueFields[i].at.get(change.tissue).value_or(0.0);
  }
  for (std::size_t i = 0; i < change.tissue.relaxation.size(); ++i) {
    row.share[i] = change.tissue.relaxation[i].g;
    row.time[i] = change.tissue.relaxation[i].tau;
  }
  row.noise_enabled = change.noise.enabled ? 1 : 0;
  row.noise_gain = change.noise.gain;
  row.noise_threshold = change.noise.threshold;
  if ((change.what & haptics::kInclusionChanged) != 0) {
    row.inclusion = change.inclusion.index + std::uint64_t{1};
    row.inclusion_centre = change.inclusion.centre_S;
    row.inclusion_ratio = change.inclusion.ratio;
  }
  if ((change.what & haptics::kStimulusChanged) != 0) {
    row.stimulus_force = change.stimulus.force;
    row.stimulus_ramp = change.stimulus.ramp;
    row.stimulus_interval = change.stimulus.interval;
  }
  row.source_radius = change.source_radius;
  row.name = change.name;
  return row;
}

std::string defect_of(const UpdateRow& row) {
  constexpr std::uint32_t kAll = haptics::kTissueChanged | haptics::kNoiseChanged |
                                 haptics::kInclusionChanged | haptics::kStimulusChanged;
  constexpr auto kLastLaw = static_cast<std::uint32_t>(model::LawKind::kSmooth);
  const auto want = [](const char* name, std::uint64_t value, const std::string& right) {
    return std::string("has ") + name + ' ' + std::to_string(value) + ", want " + right;
  };
  if ((row.what & ~kAll) != 0) return want("what", row.what, "bits up to " + std::to_string(kAll));
  if (row.law > kLastLaw) return want("law", row.law, "0 or 1");
  if (row.noise_enabled > 1) return want("noise_enabled", row.noise_enabled, "0 or 1");
  if (row.inclusion > model::kMaxInclusions) {
    return want("inclusion", row.inclusion, "at most " + std::to_string(model::kMaxInclusions));
  }
  if (row.inclusion == 0 && (row.what & haptics::kInclusionChanged) != 0) {
    return want("inclusion", row.inclusion, "the number of the one that changes");
  }
  if (!std::in_range<std::uint32_t>(row.stimulus_interval)) {
    return want("stimulus_interval", row.stimulus_interval, "0, 1 or 2");
  }
  return {};
}

ParameterUpdate update_of(const UpdateRow& row) {
  ParameterUpdate change;
  change.tick = row.tick;
  change.number = row.number;
  change.what = row.what;
  change.tissue.law = static_cast<model::LawKind>(row.law);
  for (std::size_t i = 0; i < kTissueFields.size(); ++i) {
    const bool given = row.tissue[i] != 0.0 || !kTissueFields[i].optional();
    kTissueFields[i].at.set(change.tissue, given ? std::optional(row.tissue[i]) : std::nullopt);
  }
  for (std::size_t i = 0; i < kMaxRelaxationTerms && row.share[i] != 0.0; ++i) {
    change.tissue.relaxation.push_back({row.share[i], row.time[i]});
  }
  change.noise = {row.noise_enabled != 0, row.noise_gain, row.noise_threshold};
  if (row.inclusion > 0) {
    change.inclusion = {static_cast<std::uint32_t>(row.inclusion - 1), row.inclusion_centre,
                        row.inclusion_ratio};
  }
  if ((row.what & haptics::kStimulusChanged) != 0) {
    change.stimulus = {row.stimulus_force, row.stimulus_ramp,
                       static_cast<std::uint32_t>(row.stimulus_interval)};
  }
  change.source_radius = row.source_radius;
  change.name = row.name;
  return change;
}

std::span<const Column> update_columns() {
  static const std::vector<Column> kAll = all_columns();
  return kAll;
}

}  // namespace palpate::record
