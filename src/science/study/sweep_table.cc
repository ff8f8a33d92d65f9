#include <algorithm>
#include <limits>
#include <numeric>
#include <string_view>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/record/hdf5_handle.h"
#include "palpate/error.h"
#include "palpate/version.h"
#include "science/study/sweep.h"

namespace palpate::study {
namespace {

using session::kRunQuantities;
namespace hdf5 = record::hdf5;

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"") == std::string::npos) return text;
  std::string out = "\"";
  for (const char letter : text) out += letter == '"' ? std::string("\"\"") : std::string(1, letter);
  return out + '"';
}

hdf5::Handle create_column(hid_t file, const std::string& name, hid_t type, std::size_t rows) {
  const hsize_t size = rows;
  const hdf5::Handle space(H5Screate_simple(1, &size, nullptr), name);
  const hdf5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), name);
  hdf5::check(H5Pset_obj_track_times(properties.id(), false), name);  // the same bytes at any time
  return {H5Dcreate2(file, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT), name};
}

void write_numbers(hid_t file, const std::string& name, const std::vector<double>& values) {
  const hdf5::Handle column = create_column(file, name, H5T_IEEE_F64LE, values.size());
  hdf5::check(H5Dwrite(column.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
}

void write_texts(hid_t file, const std::string& name, const std::vector<std::string>& values) {
  std::size_t longest = 1;
  for (const std::string& value : values) longest = std::max(longest, value.size());
  std::string padded;
  for (std::string value : values) {
    value.resize(longest);
    padded += value;
  }
  const hdf5::Handle type = hdf5::text_type(longest);
  const hdf5::Handle column = create_column(file, name, type.id(), values.size());
  hdf5::check(H5Dwrite(column.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), name);
}

/// The values of a column, one a row.
template <typename Value>
auto column_of(const SweepResult& sweep, const Value& value) {
  std::vector<std::decay_t<decltype(value(sweep.rows.front()))>> values;
  for (const SweepRow& row : sweep.rows) values.push_back(value(row));
  return values;
}

void write_columns(hid_t file, const SweepResult& sweep) {
  hdf5::write_attribute(file, "scene", sweep.scene);
  hdf5::write_attribute(file, "palpate_version", std::string(kVersion));
  std::vector<double> runs(sweep.rows.size());
  std::iota(runs.begin(), runs.end(), 0.0);
  write_numbers(file, "run", runs);
  for (std::size_t i = 0; i < sweep.axes.size(); ++i) {
    const Axis& axis = sweep.axes[i];
    const auto texts = column_of(sweep, [i](const SweepRow& row) { return row.settings[i]; });
    if (!axis.number) {
      write_texts(file, axis.key, texts);
      continue;
    }
    std::vector<double> values;
    for (const std::string& text : texts) values.push_back(parse_number(text).value());
    write_numbers(file, axis.key, values);
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < kRunQuantities.size(); ++i) {
    write_numbers(file, kRunQuantities[i].name, column_of(sweep, [i](const SweepRow& row) {
                    return row.failed() ? kNone : row.quantities[i];
                  }));
  }
  write_numbers(file, "missed_contact",
                column_of(sweep, [](const SweepRow& row) { return row.missed_contact ? 1.0 : 0.0; }));
  write_numbers(file, "faults",
                column_of(sweep, [](const SweepRow& row) { return static_cast<double>(row.faults); }));
  write_texts(file, "fault", column_of(sweep, [](const SweepRow& row) { return row.fault; }));
  write_texts(file, "ended", column_of(sweep, [](const SweepRow& row) { return row.ended; }));
}

}  // namespace

std::string sweep_csv(const SweepResult& sweep) {
  std::string text = "run";
  for (const Axis& axis : sweep.axes) text += ',' + axis.key;
  for (const session::RunQuantity& quantity : kRunQuantities) text += std::string(",") + quantity.name;
  text += ",missed_contact,faults,fault,ended\n";
  for (std::size_t run = 0; run < sweep.rows.size(); ++run) {
    const SweepRow& row = sweep.rows[run];
    text += std::to_string(run);
    for (const std::string& value : row.settings) text += ',' + quoted(value);
    for (std::size_t i = 0; i < kRunQuantities.size(); ++i) {
      text += ',' + (row.failed() ? std::string() : shortest(row.quantities[i]));
    }
    text += fmt::format(",{:d},{},{},{}\n", row.missed_contact, row.faults, row.fault, quoted(row.ended));
  }
  return text;
}

void write_sweep_hdf5(const SweepResult& sweep, const std::filesystem::path& file) {
  const hdf5::Quiet quiet;
  try {
    hdf5::Handle opened(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "the file");
    write_columns(opened.id(), sweep);
    if (!opened.close()) throw hdf5::Error("the file");
  } catch (const hdf5::Error& error) {
    throw InputError(file.string() + ": cannot be written: " + error.what());
  }
}

}  // namespace palpate::study
