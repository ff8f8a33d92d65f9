// Writes a recording as one HDF5 file, so that a killed process or a full disk costs at most the last
// rows.
//
//     /           attributes: format, version, compiler, machine, start time, seed, rate.
//     /scene      the scene as JSON, with a content hash; a replay reads it.
//     /organ      vertices and triangles, each with a content hash.
//     /tools/T/parts/P    likewise, for each rigid part of each tool
//     /tissue     attributes: the tissue's values again, for other programs.
//     /run        summary; every value is created at the beginning and filled at the end, `complete` last.
//     /ticks      one row per hand and tick, in chunks of 1,024 rows, each chunk with a checksum.
//     /changes    parameter updates, with the tick from which they apply
//
//     constructor -> start() -> append(), flush() ... -> write_summary() -> close()
//                                    | a write failed
//                                    +--------------------> abandon()
//
// Killed. start() switches to HDF5's SWMR mode, in which the file on disk can be read at any time. In this
// mode no dataset, group or attribute can be added: this is why the constructor creates all of them. Rows
// reach the system with flush(), and the disk with flush(true). Updates are flushed before rows, so that a
// file that ends early has the updates of all its ticks. A reader takes a file without `complete` for one
// that ended early.
//
// Disk full. HDF5 1.10.8 corrupts a file when one of its writes fails. So reserve_space() takes disk space
// from the file system ahead of every append. At least 4 MiB are reserved at any time, enough for HDF5's
// caches and the summary. When no more can be had, append() throws before it writes, and the reserve still
// holds the end of the file. close() returns the rest of the reserve.
//
// Failed write. `damaged_` is set during each step that writes, and stays set when the step throws. To
// close the file would then corrupt it. abandon() forgets the HDF5 objects instead: the file stays as a
// killed process would have left it, with all rows of the last flush.
//
// In SWMR mode HDF5 gives its lock up. start() takes another one, which shows `palpate repair` that the
// file is still being written. One thread uses the writer (recorder.cc); the loop never waits for it in
// real time.

#include "io/record/recording_writer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <vector>

#include "io/record/scene_json.h"
#include "io/record/tick_columns.h"
#include "io/record/update_columns.h"
#include "io/system/files.h"
#include "io/system/path_text.h"

namespace palpate::record {
namespace {

using hdf5::check;
using hdf5::Handle;

// Disk space is reserved ahead, because HDF5 (1.10.8) corrupts a file when a write fails. When the disk is
// full, the reserve must hold HDF5's caches (1 MiB of rows, some metadata) and the summary.
constexpr std::int64_t kReserveLeast = std::int64_t{4} << 20;  // bytes
constexpr std::int64_t kReserveStep = std::int64_t{8} << 20;   // bytes
constexpr std::size_t kRemarkBytes = 4096;                     // of /run/remarks, filled at the end

static_assert(sizeof(geometry::Triangle) == 3 * sizeof(std::int32_t));
static_assert(sizeof(Vec3) == 3 * sizeof(double));

hid_t native_type(ColumnType type) {
  switch (type) {
    case ColumnType::kU32:
      return H5T_NATIVE_UINT32;
    case ColumnType::kU64:
      return H5T_NATIVE_UINT64;
    case ColumnType::kI64:
      return H5T_NATIVE_INT64;
    case ColumnType::kF64:
      return H5T_NATIVE_DOUBLE;
  }
  return H5T_NATIVE_DOUBLE;
}

template <typename Row>
void write_rows_of_three(hid_t group, const char* name, hid_t type, const std::vector<Row>& rows) {
  const Handle dataset = hdf5::create_dataset(group, name, type, {rows.size(), 3});
  if (rows.empty()) return;
  check(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), name);
  hdf5::write_content_hash(dataset.id(), std::as_bytes(std::span(rows)));
}

void write_mesh(hid_t group, const geometry::TriangleMesh& mesh) {
  write_rows_of_three(group, "vertices", H5T_NATIVE_DOUBLE, mesh.vertices);
  write_rows_of_three(group, "triangles", H5T_NATIVE_INT32, mesh.triangles);
}

std::int64_t mesh_bytes(const geometry::TriangleMesh& mesh) {
  return static_cast<std::int64_t>(mesh.vertices.size() * sizeof(Vec3) +
                                   mesh.triangles.size() * sizeof(geometry::Triangle));
}

std::int64_t mesh_bytes(const scene::Scene& scene) {
  std::int64_t bytes = mesh_bytes(scene.organ);
  for (const geometry::Tool& tool : scene.tools) {
    for (const geometry::ToolPart& part : tool.parts) bytes += mesh_bytes(part.mesh);
  }
  return bytes;
}

void write_tools(hid_t file, const std::vector<geometry::Tool>& tools) {
  const Handle group = hdf5::create_group(file, "tools");
  for (std::size_t t = 0; t < tools.size(); ++t) {
    const Handle tool = hdf5::create_group(group.id(), std::to_string(t));
    hdf5::write_attribute(tool.id(), "name", tools[t].name);
    const Handle parts = hdf5::create_group(tool.id(), "parts");
    for (std::size_t p = 0; p < tools[t].parts.size(); ++p) {
      const Handle part = hdf5::create_group(parts.id(), std::to_string(p));
      hdf5::write_attribute(part.id(), "name", tools[t].parts[p].name);
      write_mesh(part.id(), tools[t].parts[p].mesh);
    }
  }
}

/// Writes the tissue a second time, for other tools; a replay reads /scene.
void write_tissue(hid_t file, const model::TissueParameters& tissue) {
  const Handle group = hdf5::create_group(file, "tissue");
  hdf5::write_attribute(group.id(), "name", tissue.name);
  for (const model::TissueField& field : model::kTissueFields) {
    hdf5::write_attribute(group.id(), field.column(), field.in_force(tissue));
  }
  hdf5::write_attribute(group.id(), "law", std::string(model::to_string(tissue.law)));
  for (std::size_t i = 0; i < tissue.relaxation.size(); ++i) {
    const std::string term = "relaxation_" + std::to_string(i + 1);
    hdf5::write_attribute(group.id(), term + "_share", tissue.relaxation[i].g);
    hdf5::write_attribute(group.id(), term + "_time_s", tissue.relaxation[i].tau);
  }
}

void write_facts(hid_t file, const scene::Scene& scene, const RunFacts& facts) {
  hdf5::write_attribute(file, "format", std::string(kFormatName));
  hdf5::write_attribute(file, "format_version", kFormatVersion);
  hdf5::write_attribute(file, "version", facts.version);
  hdf5::write_attribute(file, "compiler", facts.compiler);
  hdf5::write_attribute(file, "machine", facts.machine);
  hdf5::write_attribute(file, "started_unix_ns", facts.started_unix_ns);
  hdf5::write_attribute(file, "offline", std::int64_t{facts.offline ? 1 : 0});
  hdf5::write_attribute(file, "seed", scene.seed);
  hdf5::write_attribute(file, "rate_Hz", scene.rate_Hz);
  if (facts.study.name.empty()) return;
  hdf5::write_attribute(file, kStudyAttribute, facts.study.name);
  hdf5::write_attribute(file, kCommitmentAttribute, facts.study.commitment);
}

void create_summary(hid_t file) {
  using namespace run_names;
  const Handle run = hdf5::create_group(file, "run");
  for (const char* name : {kComplete, kMissedDeadlines, kLongestGap, kRealtimePriority, kMemoryLocked,
                           kPolled, kRows, kRowsLost, kWatchdogStops}) {
    (void)hdf5::create_dataset(run.id(), name, H5T_NATIVE_INT64, {});
  }
  for (const char* name : {kTickTime, kLateness}) {
    const Handle figures = hdf5::create_dataset(run.id(), name, H5T_NATIVE_INT64, {4});
    hdf5::write_attribute(figures.id(), "order", std::string("p50, p99, p99.9, max"));
  }
  for (const char* name : {kTickHistogram, kLateHistogram}) {
    const Handle histogram = hdf5::create_growing_pairs(run.id(), name);
    hdf5::write_attribute(histogram.id(), "columns",
                          std::string("largest value of the bucket [ns], count; empty buckets left out"));
  }
  (void)hdf5::create_text(run.id(), kRemarks, kRemarkBytes);
}

/// An empty list of rows that can grow, with a checksum for each chunk.
Handle create_rows(hid_t file, const std::string& name, hid_t row_type, hsize_t chunk) {
  const hsize_t none = 0;
  const hsize_t unlimited = H5S_UNLIMITED;
  const Handle space(H5Screate_simple(1, &none, &unlimited), "space of /" + name);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), "/" + name);
  check(H5Pset_chunk(properties.id(), 1, &chunk), "chunks of /" + name);
  check(H5Pset_fletcher32(properties.id()), "checksums of /" + name);
  return {H5Dcreate2(file, name.c_str(), row_type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
          "/" + name};
}

Handle create_ticks(hid_t file, hid_t row_type) {
  Handle ticks = create_rows(file, "ticks", row_type, RecordingWriter::kChunkRows);
  hdf5::write_attribute(ticks.id(), "phase", std::string("0 approach, 1 press, 2 pull"));
  hdf5::write_attribute(
      ticks.id(), "fault",
      std::string("0 none, 1 not finite, 2 device, 3 stale sample, 4 stalled loop, 5 force off"));
  return ticks;
}

/// The dataset of parameter updates; it stays empty in most runs.
Handle create_changes(hid_t file, hid_t change_type) {
  constexpr hsize_t kChunk = 16;
  Handle changes = create_rows(file, "changes", change_type, kChunk);
  hdf5::write_attribute(changes.id(), "what", std::string("1 tissue, 2 noise, 4 inclusion, 8 stimulus"));
  hdf5::write_attribute(changes.id(), "law", std::string("0 layered, 1 smooth"));
  return changes;
}

Handle create_file(const std::filesystem::path& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
  check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "file version");
  // A file system without locks is no reason not to record.
  check(H5Pset_file_locking(access.id(), kLocksAreAdvisory, 1), "file locking");
  return Handle(H5Fcreate(to_text(path).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), "cannot be made");
}

void fill(hid_t run, const char* name, const void* values) {
  const Handle dataset(H5Dopen2(run, name, H5P_DEFAULT), name);
  check(H5Dwrite(dataset.id(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
}

void fill(hid_t run, const char* name, const TimeStatistics& figures) {
  const std::array<std::int64_t, 4> values = {figures.p50_ns, figures.p99_ns, figures.p999_ns,
                                              figures.max_ns};
  fill(run, name, static_cast<const void*>(values.data()));
}

void fill(hid_t run, const char* name, std::int64_t value) {
  fill(run, name, static_cast<const void*>(&value));
}

void fill(hid_t run, const char* name, const TimeHistogram& histogram) {
  std::vector<std::int64_t> pairs;
  for (const haptics::Histogram::Bucket& bucket : histogram) {
    pairs.insert(pairs.end(), {bucket.upper, static_cast<std::int64_t>(bucket.count)});
  }
  const Handle dataset(H5Dopen2(run, name, H5P_DEFAULT), name);
  hdf5::fill_pairs(dataset.id(), name, pairs);
}

}  // namespace

Handle tick_row_type() {
  Handle type(H5Tcreate(H5T_COMPOUND, sizeof(haptics::TickRow)), "row type");
  for (const Column& column : tick_columns()) {
    check(H5Tinsert(type.id(), column.name, column.offset, native_type(column.type)), column.name);
  }
  return type;
}

Handle update_row_type() {
  Handle type(H5Tcreate(H5T_COMPOUND, sizeof(UpdateRow)), "change type");
  for (const Column& column : update_columns()) {
    check(H5Tinsert(type.id(), column.name, column.offset, native_type(column.type)), column.name);
  }
  const Handle name = hdf5::text_type(haptics::ParameterUpdate::kNameBytes);
  check(H5Tinsert(type.id(), kUpdateName, offsetof(UpdateRow, name), name.id()), kUpdateName);
  return type;
}

RecordingWriter::RecordingWriter(const std::filesystem::path& file, const scene::Scene& scene,
                                 const RunFacts& facts)
    : path_(file), file_(create_file(file)), row_type_(tick_row_type()), change_type_(update_row_type()) {
  const std::string scene_text = scene_to_json(scene);
  reserve_space(static_cast<std::int64_t>(scene_text.size()) + mesh_bytes(scene));
  write_facts(file_.id(), scene, facts);
  const Handle text = hdf5::create_text(file_.id(), "scene", scene_text.size());
  hdf5::write_text(text.id(), scene_text);
  hdf5::write_content_hash(text.id(), std::as_bytes(std::span(scene_text)));
  const Handle organ = hdf5::create_group(file_.id(), "organ");
  hdf5::write_attribute(organ.id(), "name", scene.organ_name);
  write_mesh(organ.id(), scene.organ);
  write_tools(file_.id(), scene.tools);
  write_tissue(file_.id(), scene.tissue);
  create_summary(file_.id());
  ticks_ = create_ticks(file_.id(), row_type_.id());
  changes_ = create_changes(file_.id(), change_type_.id());
  check(H5Fflush(file_.id(), H5F_SCOPE_LOCAL), "cannot be written");
  damaged_ = false;
}

void RecordingWriter::start(std::int64_t started_unix_ns) {
  damaged_ = true;
  hdf5::rewrite_attribute(file_.id(), "started_unix_ns", started_unix_ns);
  check(H5Fstart_swmr_write(file_.id()), "cannot be written");
  damaged_ = false;
  // HDF5 has released its lock; this lock shows `repair` that the file is still being written.
  const int fd = descriptor();
  if (fd >= 0) (void)lock_file(fd, FileLock::kShared);
}

int RecordingWriter::descriptor() const {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file_.id(), H5P_DEFAULT, &handle) < 0 || handle == nullptr) return -1;
  return *static_cast<int*>(handle);
}

void RecordingWriter::reserve_space(std::int64_t extra_bytes) {
  const int fd = descriptor();
  FileStatus facts{};
  if (fd < 0 || status_of(fd, facts) != 0) return;
  if (reserved_end_ - facts.st_size >= kReserveLeast + extra_bytes) return;
  const std::int64_t bytes = kReserveStep + extra_bytes;
  const int why = palpate::reserve_space(fd, facts.st_size, bytes);
  if (why == 0) {
    reserved_end_ = facts.st_size + bytes;
  } else if (is_disk_full(why)) {
    throw hdf5::Error(std::string("the disk is full (") + std::strerror(why) + ")");
  }
  // Otherwise the file system cannot reserve space, and a write may fail later.
}

void RecordingWriter::append_to(hid_t dataset, hid_t type, hsize_t start, hsize_t count, const void* data) {
  if (count == 0) return;
  reserve_space(0);
  damaged_ = true;
  const hsize_t end = start + count;
  check(H5Dset_extent(dataset, &end), "rows cannot be written");
  const Handle in_file(H5Dget_space(dataset), "rows");
  check(H5Sselect_hyperslab(in_file.id(), H5S_SELECT_SET, &start, nullptr, &count, nullptr), "rows");
  const Handle in_memory(H5Screate_simple(1, &count, nullptr), "rows");
  check(H5Dwrite(dataset, type, in_memory.id(), in_file.id(), H5P_DEFAULT, data), "rows cannot be written");
  damaged_ = false;
}

void RecordingWriter::append(std::span<const haptics::TickRow> rows) {
  append_to(ticks_.id(), row_type_.id(), rows_, rows.size(), rows.data());
  rows_ += rows.size();
}

void RecordingWriter::append(std::span<const haptics::ParameterUpdate> changes) {
  std::vector<UpdateRow> rows(changes.size());
  std::transform(changes.begin(), changes.end(), rows.begin(), row_of);
  append_to(changes_.id(), change_type_.id(), change_rows_, rows.size(), rows.data());
  change_rows_ += changes.size();
  change_unflushed_ = change_unflushed_ || !changes.empty();
}

void RecordingWriter::flush(bool to_disk) {
  damaged_ = true;
  if (change_unflushed_) check(H5Dflush(changes_.id()), "changes cannot be written");
  change_unflushed_ = false;
  check(H5Dflush(ticks_.id()), "rows cannot be written");
  damaged_ = false;
  if (const int fd = descriptor(); to_disk && fd >= 0 && flush_content(fd) != 0 && errno != EINVAL) {
    throw hdf5::Error(std::string("rows cannot be written (") + std::strerror(errno) + ")");
  }
}

void RecordingWriter::write_summary(const RunFacts& facts, std::uint64_t rows_lost) {
  using namespace run_names;
  const Handle run(H5Gopen2(file_.id(), "run", H5P_DEFAULT), "/run");
  fill(run.id(), kMissedDeadlines, static_cast<std::int64_t>(facts.missed_deadlines));
  fill(run.id(), kLongestGap, facts.longest_gap_ns);
  fill(run.id(), kRealtimePriority, std::int64_t{facts.realtime_priority ? 1 : 0});
  fill(run.id(), kMemoryLocked, std::int64_t{facts.memory_locked ? 1 : 0});
  fill(run.id(), kPolled, std::int64_t{facts.polled ? 1 : 0});
  fill(run.id(), kRows, static_cast<std::int64_t>(rows_));
  fill(run.id(), kRowsLost, static_cast<std::int64_t>(rows_lost));
  fill(run.id(), kTickTime, facts.tick_time);
  fill(run.id(), kLateness, facts.lateness);
  fill(run.id(), kTickHistogram, facts.tick_histogram);
  fill(run.id(), kLateHistogram, facts.late_histogram);
  fill(run.id(), kWatchdogStops, static_cast<std::int64_t>(facts.watchdog_stops));
  std::string remarks;
  for (const std::string& remark : facts.remarks) remarks += remark + "\n";
  const Handle text(H5Dopen2(run.id(), kRemarks, H5P_DEFAULT), "/run/remarks");
  hdf5::write_text(text.id(), remarks);
  fill(run.id(), kComplete, std::int64_t{facts.complete ? 1 : 0});
}

void RecordingWriter::close() {
  ticks_.close();
  changes_.close();
  change_type_.close();
  row_type_.close();
  if (!file_.close()) throw hdf5::Error("cannot be closed");
  // Returns the reserved space to the disk.
  FileStatus facts{};
  if (reserved_end_ > 0 && status_of(path_, facts) == 0) release_space(path_, facts.st_size);
}

void RecordingWriter::abandon() noexcept {
  ticks_.abandon();
  changes_.abandon();
  change_type_.abandon();
  row_type_.abandon();
  file_.abandon();
}

}  // namespace palpate::record
