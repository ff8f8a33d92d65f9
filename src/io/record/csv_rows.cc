#include "io/record/csv_rows.h"

#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "core/base/charconv.h"
#include "io/record/tick_columns.h"
#include "io/record/update_columns.h"
#include "io/system/csv_table.h"
#include "io/system/path_text.h"
#include "palpate/tool_contact.h"

namespace palpate::record {
namespace {

constexpr std::size_t kLongestValue = 32;  // characters of one number or word, with its comma

char* append(char* at, std::string_view word) {
  std::memcpy(at, word.data(), word.size());
  return at + word.size();
}

template <typename T>
char* append_number(char* at, T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) return append(at, "nan");
  }
  return to_chars(at, at + kLongestValue, value).ptr;
}

template <typename Row>
char* append_column(char* at, const Row& row, const Column& column) {
  return haptics::with_number(row, column.type, column.offset,
                              [at](auto number) { return append_number(at, number); });
}

char* append_phase(char* at, std::uint32_t phase) {
  return phase < contact::kPhaseNames.size() ? append(at, contact::kPhaseNames[phase])
                                             : append_number(at, phase);
}

char* append_fault(char* at, std::uint32_t fault) {
  if (fault == 0) return append(at, "0");
  if (fault > static_cast<std::uint32_t>(haptics::kLastFault)) return append_number(at, fault);
  return append(at, haptics::name_of(static_cast<haptics::Fault>(fault)));
}

char* append_value(char* at, const haptics::TickRow& row, const Column& column) {
  if (column.offset == offsetof(haptics::TickRow, phase)) return append_phase(at, row.phase);
  if (column.offset == offsetof(haptics::TickRow, fault)) return append_fault(at, row.fault);
  return append_column(at, row, column);
}

std::string changes_header() {
  std::string line;
  for (const Column& column : update_columns()) line += std::string(column.name) + ",";
  return line + kUpdateName + '\n';
}

char* append_value(char* at, const UpdateRow& row, const Column& column) {
  if (column.offset == offsetof(UpdateRow, what)) {
    if ((row.what & haptics::kStimulusChanged) != 0) return append(at, "stimulus");
    if ((row.what & haptics::kInclusionChanged) != 0) return append(at, "inclusion");
    return append(at, (row.what & haptics::kTissueChanged) != 0 ? "tissue" : "noise");
  }
  if (column.offset == offsetof(UpdateRow, law)) return append(at, row.law == 0 ? "layered" : "smooth");
  return append_column(at, row, column);
}

std::string change_line(const haptics::ParameterUpdate& change) {
  const UpdateRow row = row_of(change);
  std::string line;
  for (const Column& column : update_columns()) {
    char text[kLongestValue];
    line.append(text, append_value(text, row, column));
    line += ',';
  }
  const std::string_view name(row.name.data(), row.name.size());
  return line + csv_quoted(name.substr(0, name.find('\0'))) + '\n';
}

}  // namespace

std::string csv_header() {
  std::string line;
  for (const Column& column : tick_columns()) line += std::string(column.name) + ",";
  line.back() = '\n';
  return line;
}

std::size_t longest_csv_row() noexcept { return tick_columns().size() * kLongestValue; }

char* append_csv_row(char* at, const haptics::TickRow& row) {
  for (const Column& column : tick_columns()) {
    at = append_value(at, row, column);
    *at++ = ',';
  }
  at[-1] = '\n';
  return at;
}

std::string changes_csv(std::span<const haptics::ParameterUpdate> changes) {
  std::string text = changes_header();
  for (const haptics::ParameterUpdate& change : changes) text += change_line(change);
  return text;
}

std::filesystem::path changes_csv_path(const std::filesystem::path& csv) {
  return csv.parent_path() / to_path(to_text(csv.stem()) + "-changes.csv");
}

}  // namespace palpate::record
