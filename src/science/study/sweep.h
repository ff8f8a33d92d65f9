#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "palpate/preparation.h"
#include "palpate/scene.h"
#include "run/session/run_quantities.h"
#include "science/tasks/ranks.h"

namespace palpate::scene {
enum class KeyType;  // scene_keys.h
}

namespace palpate::study {

inline constexpr std::size_t kMostRuns = 100'000;

/// A key of the scene that a sweep varies.
struct Axis {
  std::string key;  // a SceneKey's path
  scene::KeyType type;
  std::vector<std::string> values;  // as a scene file would have them, at least one

  [[nodiscard]] bool number() const noexcept;
};

/// [setup] "tissue.k1=10:40:7", "device.mass_kg=0.1:1:5:log" or "organ.tissue=liver,heart". @param flag for
/// messages @throws InputError naming flag, text and what would be right
[[nodiscard]] Axis parse_axis(const std::string& flag, const std::string& text);

/// What is swept, and how each run is made.
struct SweepRequest {
  scene::Request scene;
  std::optional<double> duration_s;  // as SessionOptions
  std::vector<Axis> axes;
  contact::Preparation preparation;  // called on any thread
  std::filesystem::path record;      // of the finished runs, to go on from; its folder is made
};

/// [setup] The file that a value of an axis names, if it exists, and the buffers that a glTF file names.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const SweepRequest& request, const Axis& axis,
                                                          const std::string& value);

/// One run, a row of the table.
struct SweepRow {
  std::vector<std::string> settings;  // one an axis
  std::vector<double> quantities;     // in the order of kRunQuantities; empty: the run failed
  bool missed_contact = false;        // no tool touched the organ
  std::uint64_t faults = 0;
  std::string fault;  // the first: "none", "device", ...
  std::string ended;  // "done", or "failed: " and why

  [[nodiscard]] bool failed() const noexcept { return quantities.empty(); }
};

struct SweepResult {
  std::string scene;  // its name
  std::vector<Axis> axes;
  std::vector<SweepRow> rows;  // all combinations; the last axis varies fastest
  std::size_t resumed = 0;     // taken from the record
  std::string record_failure;  // on rank 0: why runs were not recorded; empty: all were

  [[nodiscard]] std::size_t failed() const;
  [[nodiscard]] std::size_t missed() const;
  [[nodiscard]] std::size_t with_fault() const;
};

/// Called on rank 0 with the share that is done, 0..1, and what is being done.
using Progress = std::function<void(double, const std::string&)>;

/// [setup] Runs the scene offline with every combination of the axes' values, shared out among ranks: the
/// same rows on any number of them. A run that fails is a row with its reason, and is tried again by the next
/// call. Every rank makes the same call.
/// @throws InputError on every rank alike: the scene itself cannot be loaded or needs a device that a sweep
/// cannot have, there are no or too many runs, or the record is of another sweep.
[[nodiscard]] SweepResult run_sweep(const SweepRequest& request, tasks::Ranks& ranks,
                                    const Progress& progress);

/// A column of the table: run, one an axis, one a quantity, missed_contact, faults, fault, ended.
struct Column {
  std::string name;
  scene::KeyType type;
  std::vector<std::string> texts;  // of each run; empty: it failed before it had one
};

/// [any] Of a column of truths: "true" of a key, "1" of a result.
[[nodiscard]] bool is_true(const std::string& text);

[[nodiscard]] std::vector<Column> columns_of(const SweepResult& sweep);

/// [setup] The table as CSV.
[[nodiscard]] std::string sweep_csv(const SweepResult& sweep);

/// [setup] The same table in an HDF5 file, a dataset a column. Where a run failed, a number is NaN, a count
/// or a truth the largest value of its unsigned type. The same table gives the same bytes. @throws InputError
/// when the file cannot be written
void write_sweep_hdf5(const SweepResult& sweep, const std::filesystem::path& file);

}  // namespace palpate::study
