#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "io/record/csv_rows.h"
#include "io/system/output_file.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/recording.h"

namespace palpate::record {
namespace {

constexpr std::size_t kBlockRows = 4096;

[[noreturn]] void refuse(const std::filesystem::path& file) {
  throw InputError(to_text(file) + ": cannot be written: " + std::strerror(errno));
}

void write_all(std::ofstream& out, const Recording& recording, const Progress& progress) {
  out << csv_header();
  std::vector<char> block(kBlockRows * longest_csv_row());
  for (std::size_t start = 0; start < recording.rows.size() && out; start += kBlockRows) {
    const std::size_t end = std::min(start + kBlockRows, recording.rows.size());
    char* at = block.data();
    for (std::size_t i = start; i < end; ++i) at = append_csv_row(at, recording.rows[i]);
    out.write(block.data(), at - block.data());
    if (progress) progress(static_cast<double>(end) / static_cast<double>(recording.rows.size()));
  }
}

/// Opens `file`, lets `fill` write it and closes it; removes a file that cannot be completed.
template <typename Fill>
void write_file(const std::filesystem::path& file, const Fill& fill) {
  std::ofstream out(file, std::ios::binary);
  if (!out) refuse(file);
  try {
    fill(out);
    if (out) out.close();
    if (!out) refuse(file);
  } catch (...) {
    std::error_code ignored;
    if (!is_special_file(file)) std::filesystem::remove(file, ignored);
    throw;
  }
}

}  // namespace

void export_csv(const Recording& recording, const std::filesystem::path& file, const Progress& progress) {
  write_file(file, [&](std::ofstream& out) { write_all(out, recording, progress); });
}

void export_changes_csv(const Recording& recording, const std::filesystem::path& file) {
  write_file(file, [&](std::ofstream& out) { out << changes_csv(recording.changes); });
}

}  // namespace palpate::record
