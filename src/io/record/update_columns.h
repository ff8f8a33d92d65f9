#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "core/model/tissue_fields.h"
#include "io/record/tick_columns.h"
#include "palpate/parameter_updates.h"

namespace palpate::record {

/// A parameter update as a recording stores it: SI units, no padding.
struct UpdateRow {
  std::uint64_t tick = 0;
  std::uint64_t number = 0;
  std::uint32_t what = 0;
  std::uint32_t law = 0;                                     // model::LawKind
  std::array<double, model::kTissueFields.size()> tissue{};  // 0 for an optional number without a value
  std::array<double, model::kMaxRelaxationTerms> share{};    // 0: no such relaxation term
  std::array<double, model::kMaxRelaxationTerms> time{};     // s
  std::uint64_t noise_enabled = 0;                           // 0 or 1
  double noise_gain = 0.0;                                   // N m
  double noise_threshold = 0.0;                              // m
  std::uint64_t inclusion = 0;                               // 0: none; otherwise its number from 1
  std::array<double, 3> inclusion_centre{};                  // organ frame [m]
  double inclusion_ratio = 0.0;
  double stimulus_force = 0.0;          // N
  double stimulus_ramp = 0.0;           // s
  std::uint64_t stimulus_interval = 0;  // 0: none
  double source_radius = 0.0;           // m, of a tissue with size exponent
  std::array<char, haptics::ParameterUpdate::kNameBytes> name{};
};

/// [any] The row of a parameter update.
[[nodiscard]] UpdateRow row_of(const haptics::ParameterUpdate& change) noexcept;
/// [setup] The first number of a row from a file that no update has, with what would be right: "has law 7,
/// want 0 or 1". Empty: the row is an update; its tissue, noise, inclusion and stimulus are not validated.
[[nodiscard]] std::string defect_of(const UpdateRow& row);
/// [setup] The parameter update of a row without a defect.
[[nodiscard]] haptics::ParameterUpdate update_of(const UpdateRow& row);

/// [setup] The columns of a UpdateRow, in the order of recording and export. The tissue's name, kUpdateName,
/// follows them.
[[nodiscard]] std::span<const Column> update_columns();

inline constexpr const char* kUpdateName = "tissue";

}  // namespace palpate::record
