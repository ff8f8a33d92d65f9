#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "io/record/tick_columns.h"
#include "io/record/update_columns.h"
#include "io/system/output_file.h"
#include "palpate/error.h"
#include "palpate/recording.h"

namespace palpate::record {
namespace {

constexpr std::size_t kBlockRows = 4096;
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
  return std::to_chars(at, at + kLongestValue, value).ptr;
}

template <typename Row>
char* append_column(char* at, const Row& row, const Column& column) {
  return haptics::with_number(row, column.type, column.offset,
                              [at](auto number) { return append_number(at, number); });
}

char* append_phase(char* at, std::uint32_t phase) {
  static constexpr std::string_view kWords[] = {"approach", "press", "pull"};
  return phase < 3 ? append(at, kWords[phase]) : append_number(at, phase);
}

char* append_fault(char* at, std::uint32_t fault) {
  if (fault == 0) return append(at, "0");
  if (fault > static_cast<std::uint32_t>(haptics::Fault::kForceOff)) return append_number(at, fault);
  return append(at, haptics::name_of(static_cast<haptics::Fault>(fault)));
}

char* append_value(char* at, const haptics::TickRow& row, const Column& column) {
  if (column.offset == offsetof(haptics::TickRow, phase)) return append_phase(at, row.phase);
  if (column.offset == offsetof(haptics::TickRow, fault)) return append_fault(at, row.fault);
  return append_column(at, row, column);
}

/// Writes one CSV line; `at` must have space for all columns.
char* append_row(char* at, const haptics::TickRow& row) {
  for (const Column& column : tick_columns()) {
    at = append_value(at, row, column);
    *at++ = ',';
  }
  at[-1] = '\n';
  return at;
}

std::string header_line() {
  std::string line;
  for (const Column& column : tick_columns()) line += std::string(column.name) + ",";
  line.back() = '\n';
  return line;
}

/// A name in quotes, so that it may contain commas.
std::string quoted(std::string_view name) {
  std::string text = "\"";
  for (const char c : name.substr(0, name.find('\0')))
    text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + '"';
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
  return line + quoted({row.name.data(), row.name.size()}) + '\n';
}

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw InputError(file.string() + ": cannot be written: " + std::strerror(errno));
}

void write_all(std::FILE* out, const Recording& recording, const std::filesystem::path& file,
               const Progress& progress) {
  const auto write = [&](const char* text, std::size_t bytes) {
    if (std::fwrite(text, 1, bytes, out) != bytes) refuse(file);
  };
  const std::string header = header_line();
  write(header.data(), header.size());
  std::vector<char> block(kBlockRows * tick_columns().size() * kLongestValue);
  for (std::size_t start = 0; start < recording.rows.size(); start += kBlockRows) {
    const std::size_t end = std::min(start + kBlockRows, recording.rows.size());
    char* at = block.data();
    for (std::size_t i = start; i < end; ++i) at = append_row(at, recording.rows[i]);
    write(block.data(), static_cast<std::size_t>(at - block.data()));
    if (progress) progress(static_cast<double>(end) / static_cast<double>(recording.rows.size()));
  }
}

/// Opens `file`, lets `fill` write it and closes it; removes a file that cannot be completed.
template <typename Fill>
void write_file(const std::filesystem::path& file, const Fill& fill) {
  std::unique_ptr<std::FILE, CloseFile> out(std::fopen(file.c_str(), "w"));
  if (!out) refuse(file);
  try {
    fill(out.get());
    if (std::fclose(out.release()) != 0) refuse(file);
  } catch (...) {
    std::error_code ignored;
    if (!is_special_file(file)) std::filesystem::remove(file, ignored);
    throw;
  }
}

}  // namespace

void export_csv(const Recording& recording, const std::filesystem::path& file, const Progress& progress) {
  write_file(file, [&](std::FILE* out) { write_all(out, recording, file, progress); });
}

std::filesystem::path changes_csv_path(const std::filesystem::path& csv) {
  return csv.parent_path() / (csv.stem().string() + "-changes.csv");
}

void export_changes_csv(const Recording& recording, const std::filesystem::path& file) {
  std::string text = changes_header();
  for (const haptics::ParameterUpdate& change : recording.changes) text += change_line(change);
  write_file(file, [&](std::FILE* out) {
    if (std::fwrite(text.data(), 1, text.size(), out) != text.size()) refuse(file);
  });
}

}  // namespace palpate::record
