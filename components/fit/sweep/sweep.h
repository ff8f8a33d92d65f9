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
#include "run/tasks/communicator.h"

namespace palpate::scene {
enum class KeyType;  // scene_keys.h
}

namespace palpate::sweep {

inline constexpr std::size_t kMaxRuns = 100'000;

/// A scene key that a sweep varies.
struct Axis {
  std::string key;  // path of a SceneKey
  scene::KeyType type;
  std::vector<std::string> values;  // in the syntax of a scene file, at least one

  [[nodiscard]] bool number() const noexcept;
};

/// [setup] Parses an axis: "tissue.k1=10:40:7", "device.mass_kg=0.1:1:5:log" or "organ.tissue=liver,heart".
/// @param flag for messages @throws InputError that names the flag, the text and a valid form
[[nodiscard]] Axis parse_axis(const std::string& flag, const std::string& text);

/// The axes of a sweep and the settings of its runs.
struct SweepRequest {
  scene::Overrides scene;
  std::optional<double> duration_s;  // as in SessionOptions
  std::vector<Axis> axes;
  contact::Preparation preparation;  // called on any thread
  std::filesystem::path record;      // file of finished runs, from which a sweep continues; its folder is
                                     // created
};

/// [setup] The file named by an axis value, if it exists, and the buffers of a glTF file.
[[nodiscard]] std::vector<std::filesystem::path> files_of(const SweepRequest& request, const Axis& axis,
                                                          const std::string& value);

/// One run: a row of the table.
struct SweepRow {
  std::vector<std::string> settings;  // one per axis
  std::vector<double> quantities;     // in the order of kRunQuantities; empty: the run failed
  bool missed_contact = false;        // no tool touched the organ
  std::uint64_t faults = 0;
  std::string fault;  // the first fault: "none", "device", ...
  std::string ended;  // "done", or "failed: " and the reason

  [[nodiscard]] bool failed() const noexcept { return quantities.empty(); }
};

struct SweepResult {
  std::string scene;  // name of the scene
  std::vector<Axis> axes;
  std::vector<SweepRow> rows;  // all combinations; the last axis varies fastest
  std::size_t resumed = 0;     // runs taken from the record
  std::string record_failure;  // on rank 0: why runs were not recorded; empty: all were

  [[nodiscard]] std::size_t failed() const;
  [[nodiscard]] std::size_t missed() const;
  [[nodiscard]] std::size_t with_fault() const;
};

/// Called on rank 0 with the completed fraction, 0..1, and a description of the current step.
using Progress = std::function<void(double, const std::string&)>;

/// [setup] Runs the scene offline with each combination of axis values, distributed over the ranks; the rows
/// do not depend on their number. All ranks must make this call. A run that fails gives a row with its
/// reason, and is repeated by the next call.
/// @throws InputError on all ranks when the scene cannot be loaded or uses a real device, when there are no
/// or too many runs, or when the record belongs to another sweep.
[[nodiscard]] SweepResult run_sweep(const SweepRequest& request, tasks::Communicator& ranks,
                                    const Progress& progress);

/// A column of the table. Columns: run, axes, quantities, missed_contact, faults, fault, ended.
struct Column {
  std::string name;
  scene::KeyType type;
  std::vector<std::string> texts;  // one per run; empty: it failed before it had a value
};

/// [any] Whether a boolean cell is true: "true" for a key, "1" for a result.
[[nodiscard]] bool is_true(const std::string& text);

[[nodiscard]] std::vector<Column> columns_of(const SweepResult& sweep);

/// [setup] The table as CSV.
[[nodiscard]] std::string sweep_csv(const SweepResult& sweep);

/// [setup] The table in an HDF5 file, one dataset per column. Where a run failed, a number is NaN, and a
/// count or boolean the largest value of its unsigned type. The same table gives the same bytes. @throws
/// InputError when the file cannot be written
void write_sweep_hdf5(const SweepResult& sweep, const std::filesystem::path& file);

}  // namespace palpate::sweep
