#pragma once
// The ticks and parameter updates of a run as CSV (docs/file-formats.md).
#include <cstddef>
#include <span>
#include <string>

#include "palpate/parameter_updates.h"
#include "palpate/recording.h"
#include "palpate/tick_row.h"

namespace palpate::record {

/// [setup] The line of the column names.
[[nodiscard]] std::string csv_header();

/// [any] Largest number of characters of a row.
[[nodiscard]] std::size_t longest_csv_row() noexcept;

/// [any] Writes one line; `at` must have space for longest_csv_row() characters. @return its end
char* append_csv_row(char* at, const haptics::TickRow& row);

/// [setup] The header and one line per parameter update.
[[nodiscard]] std::string changes_csv(std::span<const haptics::ParameterUpdate> changes);

}  // namespace palpate::record
