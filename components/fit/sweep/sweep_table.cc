#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/base/text.h"
#include "io/record/hdf5_handle.h"
#include "io/scene/scene_keys.h"
#include "io/system/csv_table.h"
#include "io/system/path_text.h"
#include "palpate/error.h"
#include "palpate/version.h"

#include "fit/sweep/sweep.h"

namespace palpate::sweep {
namespace {

using scene::KeyType;
using session::kRunQuantities;
namespace hdf5 = record::hdf5;

void write_dataset(hid_t file, const Column& column, hid_t type, const void* values) {
  const hsize_t rows = column.texts.size();
  const hdf5::Handle space(H5Screate_simple(1, &rows, nullptr), column.name);
  const hdf5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), column.name);
  hdf5::check(H5Pset_obj_track_times(properties.id(), false), column.name);  // no time stamps, for
                                                                             // reproducible bytes
  const hdf5::Handle dataset(
      H5Dcreate2(file, column.name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
      column.name);
  hdf5::check(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), column.name);
}

template <typename T, typename Read>
void write_values(hid_t file, const Column& column, hid_t type, T none, const Read& read) {
  std::vector<T> values;
  for (const std::string& text : column.texts)
    values.push_back(text.empty() ? none : static_cast<T>(read(text)));
  write_dataset(file, column, type, values.data());
}

/// Writes strings, padded with zeros to the longest.
void write_texts(hid_t file, const Column& column) {
  std::string texts;
  std::size_t longest = 1;
  for (const std::string& text : column.texts) longest = std::max(longest, text.size());
  for (std::string text : column.texts) {
    text.resize(longest);
    texts += text;
  }
  write_dataset(file, column, hdf5::text_type(longest).id(), texts.data());
}

void write_column(hid_t file, const Column& column) {
  switch (column.type) {
    case KeyType::kNumber:
      return write_values(file, column, H5T_NATIVE_DOUBLE, std::numeric_limits<double>::quiet_NaN(),
                          [](const std::string& text) { return parse_number(text).value(); });
    case KeyType::kWhole:
      return write_values(file, column, H5T_NATIVE_UINT64, std::numeric_limits<std::uint64_t>::max(),
                          [](const std::string& text) { return std::stoull(text); });
    case KeyType::kTruth:
      return write_values(file, column, H5T_NATIVE_UINT8, std::numeric_limits<std::uint8_t>::max(), is_true);
    case KeyType::kText:
      return write_texts(file, column);
  }
}

}  // namespace

bool is_true(const std::string& text) { return text == "true" || text == "1"; }

std::vector<Column> columns_of(const SweepResult& sweep) {
  std::vector<Column> columns;
  const auto add = [&](const std::string& name, KeyType type, const auto& text_of) {
    Column& column = columns.emplace_back(Column{name, type, {}});
    for (const SweepRow& row : sweep.rows) column.texts.push_back(text_of(row));
  };
  const auto add_result = [&](const std::string& name, KeyType type, const auto& text_of) {
    add(name, type, [&](const SweepRow& row) { return row.failed() ? std::string() : text_of(row); });
  };
  add("run", KeyType::kWhole,
      [&sweep](const SweepRow& row) { return std::to_string(&row - sweep.rows.data()); });
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    add(sweep.axes[i].key, sweep.axes[i].type, [i](const SweepRow& row) { return row.settings[i]; });
  }
  for (std::size_t i = 0; i < kRunQuantities.size(); ++i) {
    add_result(kRunQuantities[i].name, KeyType::kNumber,
               [i](const SweepRow& row) { return shortest(row.quantities[i]); });
  }
  add_result("missed_contact", KeyType::kTruth,
             [](const SweepRow& row) { return std::string(row.missed_contact ? "1" : "0"); });
  add_result("faults", KeyType::kWhole, [](const SweepRow& row) { return std::to_string(row.faults); });
  add_result("fault", KeyType::kText, [](const SweepRow& row) { return row.fault; });
  add("ended", KeyType::kText, [](const SweepRow& row) { return row.ended; });
  return columns;
}

std::string sweep_csv(const SweepResult& sweep) {
  const std::vector<Column> columns = columns_of(sweep);
  std::string text;
  for (const Column& column : columns) text += (text.empty() ? "" : ",") + column.name;
  for (std::size_t run = 0; run < sweep.rows.size(); ++run) {
    for (const Column& column : columns)
      text += (&column == columns.data() ? '\n' : ',') + csv_cell(column.texts[run]);
  }
  return text + '\n';
}

void write_sweep_hdf5(const SweepResult& sweep, const std::filesystem::path& file) {
  const hdf5::SilenceErrors quiet;
  try {
    hdf5::Handle opened(H5Fcreate(to_text(file).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT),
                        "the file");
    hdf5::write_attribute(opened.id(), "scene", sweep.scene);
    hdf5::write_attribute(opened.id(), "palpate_version", std::string(kVersion));
    for (const Column& column : columns_of(sweep)) write_column(opened.id(), column);
    if (!opened.close()) throw hdf5::Error("the file");
  } catch (const hdf5::Error& error) {
    throw InputError(to_text(file) + ": cannot be written: " + error.what());
  }
}

}  // namespace palpate::sweep
