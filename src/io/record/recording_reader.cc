#include "io/record/recording_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <sstream>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/record/blind.h"
#include "io/record/recording_writer.h"
#include "io/record/scene_json.h"
#include "io/record/tick_columns.h"
#include "io/record/update_columns.h"
#include "io/system/file_content.h"
#include "io/system/files.h"
#include "io/system/input_file.h"
#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/error.h"
#include "palpate/tool_contact.h"

namespace palpate::record {
namespace {

using hdf5::check;
using hdf5::Handle;

constexpr std::size_t kLongestScene = std::size_t{64} << 20;   // bytes
constexpr std::size_t kLongestRemarks = std::size_t{1} << 20;  // bytes
constexpr hsize_t kMaxChanges = hsize_t{1} << 20;
constexpr std::size_t kMaxBuckets = std::size_t{1} << 17;  // per histogram
constexpr std::array<unsigned char, 8> kHdf5Signature = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
// Superblock of versions 2 and 3: signature, version, two sizes, flags, base, extension, end of file.
constexpr std::size_t kEndOfFileOffset = 28;
constexpr std::size_t kSuperblockBytes = 48;

/// Closes a descriptor at the end of its scope.
struct Descriptor {
  int fd = -1;
  explicit Descriptor(int descriptor) : fd(descriptor) {}
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

/// Whether the superblock says that a program writes the file, not as one does that others may read
/// meanwhile.
bool is_marked_as_open(int descriptor) {
  constexpr std::size_t kVersion = 8;
  constexpr std::size_t kFlags = 11;
  constexpr unsigned char kWrites = 1;
  std::array<unsigned char, kSuperblockBytes> start{};
  return read_at(descriptor, start.data(), start.size(), 0) == static_cast<std::ptrdiff_t>(start.size()) &&
         start[kVersion] == 3 && start[kFlags] == kWrites;
}

/// Copies the first bytes of a file to the same place of another.
bool copy_bytes(int from, int to, std::uint64_t count) {
  std::vector<char> block(std::size_t{1} << 20U);
  for (std::uint64_t done = 0; done < count;) {
    const std::size_t wanted = std::min<std::uint64_t>(block.size(), count - done);
    const std::ptrdiff_t part = read_at(from, block.data(), wanted, done);
    if (part <= 0 || write_at(to, block.data(), static_cast<std::size_t>(part), done) != part) return false;
    done += static_cast<std::uint64_t>(part);
  }
  return true;
}

Handle open_dataset(hid_t parent, const std::string& name, const std::string& path) {
  return Handle(hdf5::open_dataset(parent, name), fmt::format("no {}/{}", path, name));
}

geometry::TriangleMesh read_mesh(hid_t file, const std::string& path, std::uint64_t file_bytes) {
  const Handle group(hdf5::open_group(file, path), "no " + path);
  const Handle vertices = open_dataset(group.id(), "vertices", path);
  const Handle triangles = open_dataset(group.id(), "triangles", path);
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(hdf5::rows_of_three(vertices.id(), path + "/vertices", sizeof(double), file_bytes));
  mesh.triangles.resize(
      hdf5::rows_of_three(triangles.id(), path + "/triangles", sizeof(std::int32_t), file_bytes));
  if (!mesh.vertices.empty()) {
    check(H5Dread(vertices.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, mesh.vertices.data()),
          path + "/vertices cannot be read");
  }
  if (!mesh.triangles.empty()) {
    check(H5Dread(triangles.id(), H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, mesh.triangles.data()),
          path + "/triangles cannot be read");
  }
  for (const Vec3& v : mesh.vertices) {
    if (!v.allFinite()) throw hdf5::Error(path + "/vertices has a value that is not finite");
  }
  const auto count = static_cast<std::int64_t>(mesh.vertices.size());
  for (const geometry::Triangle& triangle : mesh.triangles) {
    for (const std::int32_t index : triangle) {
      if (index < 0 || index >= count) {
        throw hdf5::Error(fmt::format("{}/triangles has index {}, want 0 to {}", path, index, count - 1));
      }
    }
  }
  hdf5::check_content_hash(vertices.id(), path + "/vertices", std::as_bytes(std::span(mesh.vertices)));
  hdf5::check_content_hash(triangles.id(), path + "/triangles", std::as_bytes(std::span(mesh.triangles)));
  return mesh;
}

/// Values of /run; 0 when they cannot be read (a truncated file).
template <std::size_t kCount>
std::array<std::int64_t, kCount> run_values(hid_t file, const char* name) {
  std::array<std::int64_t, kCount> values{};
  const std::string path = std::string("/run/") + name;
  const hid_t id = hdf5::open_dataset(file, path);
  if (id < 0) return {};
  const Handle dataset(id, path);
  const Handle space(H5Dget_space(id), path);
  if (H5Sget_simple_extent_npoints(space.id()) != kCount) return {};
  if (H5Dread(id, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) return {};
  return values;
}

/// A count of /run, as run_values(). @throws hdf5::Error when it is negative
std::uint64_t run_count(hid_t file, const char* name) {
  const std::int64_t value = run_values<1>(file, name)[0];
  if (value < 0) throw hdf5::Error(fmt::format("/run/{} is {}, want at least 0", name, value));
  return static_cast<std::uint64_t>(value);
}

TimeStatistics run_figures(hid_t file, const char* name) {
  const std::array<std::int64_t, 4> values = run_values<4>(file, name);
  return {values[0], values[1], values[2], values[3]};
}

/// A histogram of /run, with rising edges and counts above 0. Empty when it is invalid or cannot be read (a
/// truncated or older file).
TimeHistogram run_histogram(hid_t file, const char* name) {
  TimeHistogram histogram;
  try {
    const std::vector<std::int64_t> pairs = hdf5::read_pairs(file, std::string("run/") + name, kMaxBuckets);
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
      const std::int64_t before = histogram.empty() ? -1 : histogram.back().upper;
      if (pairs[i] <= before || pairs[i + 1] <= 0) return {};
      histogram.push_back({pairs[i], static_cast<std::uint64_t>(pairs[i + 1])});
    }
  } catch (const hdf5::Error&) {
    histogram.clear();
  }
  return histogram;
}

std::vector<std::string> run_remarks(hid_t file) {
  std::vector<std::string> remarks;
  try {
    std::istringstream lines(
        hdf5::read_text(file, std::string("run/") + run_names::kRemarks, kLongestRemarks));
    for (std::string line; std::getline(lines, line);) remarks.push_back(line);
  } catch (const hdf5::Error&) {
    remarks.clear();  // a truncated file
  }
  return remarks;
}

StudyMark read_study(hid_t file) {
  if (!hdf5::has_attribute(file, kStudyAttribute)) return {};
  StudyMark study{hdf5::read_text_attribute(file, kStudyAttribute), {}};
  if (study.name.empty()) throw hdf5::Error("attribute study_blind is empty");
  if (hdf5::has_attribute(file, kCommitmentAttribute)) {
    study.commitment = hdf5::read_text_attribute(file, kCommitmentAttribute);
  }
  return study;
}

RunFacts read_facts(hid_t file) {
  RunFacts facts;
  facts.version = hdf5::read_text_attribute(file, "version");
  facts.study = read_study(file);
  facts.compiler = hdf5::read_text_attribute(file, "compiler");
  facts.machine = hdf5::read_text_attribute(file, "machine");
  facts.started_unix_ns = hdf5::read_integer_attribute(file, "started_unix_ns");
  facts.offline = hdf5::read_integer_attribute(file, "offline") != 0;
  facts.complete = run_values<1>(file, run_names::kComplete)[0] == 1;
  facts.missed_deadlines = run_count(file, run_names::kMissedDeadlines);
  facts.longest_gap_ns = run_values<1>(file, run_names::kLongestGap)[0];
  facts.realtime_priority = run_values<1>(file, run_names::kRealtimePriority)[0] != 0;
  facts.memory_locked = run_values<1>(file, run_names::kMemoryLocked)[0] != 0;
  facts.polled =
      run_values<1>(file, run_names::kPolled)[0] != 0;  // 0 in older files, which had no such option
  facts.tick_time = run_figures(file, run_names::kTickTime);
  facts.lateness = run_figures(file, run_names::kLateness);
  facts.tick_histogram = run_histogram(file, run_names::kTickHistogram);
  facts.late_histogram = run_histogram(file, run_names::kLateHistogram);
  facts.watchdog_stops = run_count(file, run_names::kWatchdogStops);
  facts.remarks = run_remarks(file);
  return facts;
}

scene::Scene read_setup(hid_t file, std::uint64_t file_bytes) {
  scene::Scene scene = scene_from_json(hdf5::read_text(file, "scene", kLongestScene));
  if (scene.tools.empty() || scene.devices.size() != scene.tools.size()) {
    throw InputError(fmt::format("scene: {} tools and {} devices, must be one of each per hand",
                                 scene.tools.size(), scene.devices.size()));
  }
  scene.organ = read_mesh(file, "/organ", file_bytes);
  for (std::size_t t = 0; t < scene.tools.size(); ++t) {
    for (std::size_t p = 0; p < scene.tools[t].parts.size(); ++p) {
      const std::string path = fmt::format("/tools/{}/parts/{}", t, p);
      scene.tools[t].parts[p].mesh = read_mesh(file, path, file_bytes);
    }
  }
  return scene;
}

/// Checks that a list of rows has these columns; others may follow. @throws hdf5::Error naming a missing one.
void check_columns(hid_t dataset, const std::string& name, std::span<const Column> columns) {
  const Handle type(H5Dget_type(dataset), name);
  if (H5Tget_class(type.id()) != H5T_COMPOUND) throw hdf5::Error(name + " has no columns");
  for (const Column& column : columns) {
    const int index = H5Tget_member_index(type.id(), column.name);
    if (index < 0 && column.added_later) continue;
    if (index < 0) throw hdf5::Error(name + " has no column " + column.name);
    const H5T_class_t kind = H5Tget_member_class(type.id(), static_cast<unsigned>(index));
    if (kind != (column.type == ColumnType::kF64 ? H5T_FLOAT : H5T_INTEGER)) {
      throw hdf5::Error(fmt::format("{} has a column {} of another type", name, column.name));
    }
  }
}

bool is_fault(std::uint32_t number) {
  const auto fault = static_cast<haptics::Fault>(number);
  return number == 0 || (static_cast<std::uint32_t>(fault) == number &&
                         std::strcmp(haptics::name_of(fault), haptics::name_of(haptics::Fault::kNone)) != 0);
}

/// Why a row cannot be one of a recording; empty when it can. @param before the previous row; null: none
std::string defect_of(const haptics::TickRow& row, const haptics::TickRow* before, std::size_t hands) {
  if (row.phase >= contact::kPhaseNames.size()) return fmt::format("has the phase {}", row.phase);
  if (!is_fault(row.fault)) return fmt::format("has the fault {}", row.fault);
  if (!is_fault(row.device_fault)) return fmt::format("has the device_fault {}", row.device_fault);
  const bool follows =
      before == nullptr || row.tick > before->tick || (row.tick == before->tick && row.hand > before->hand);
  return row.hand < hands && follows ? "" : "is out of order";
}

/// The number of rows before the first that has a defect.
std::size_t rows_without_defect(std::span<const haptics::TickRow> rows, const haptics::TickRow* before,
                                std::size_t hands) {
  const auto* row = rows.data();
  const auto* const end = row + rows.size();
  while (row != end && defect_of(*row, before, hands).empty()) before = row++;
  return static_cast<std::size_t>(row - rows.data());
}

/// Number of rows up to the last tick that has all its hands.
std::size_t whole_ticks(const std::vector<haptics::TickRow>& rows, std::size_t hands) {
  std::size_t count = rows.size();
  while (count > 0 && rows[count - 1].hand + 1 != hands) --count;
  return count;
}

}  // namespace

RecordingReader::RecordingReader(std::filesystem::path file) : path_(std::move(file)) {
  open();
  try {
    read_all_but_ticks();
  } catch (const InputError& error) {
    refuse(error.what());
  } catch (const hdf5::Error& error) {
    refuse(std::string("not a palpate recording: ") + error.what());
  } catch (const std::bad_alloc&) {
    refuse("too large for this machine's memory");
  }
  facts_.blind = !facts_.study.name.empty() && !is_unblinded(path_, facts_.study);
}

void RecordingReader::refuse(const std::string& why) const { throw InputError(to_text(path_) + ": " + why); }

void RecordingReader::open() {
  const InputFile in(path_, kRecordingInput);
  std::array<unsigned char, 8> start{};
  if (read_at(in.descriptor(), start.data(), start.size(), 0) != static_cast<std::ptrdiff_t>(start.size()) ||
      start != kHdf5Signature) {
    refuse_other_content(path_, FileContent::kRecording, "a palpate recording");
    refuse("not a palpate recording: not an HDF5 file");
  }
  file_bytes_ = in.size();
  if (open_as_is(in.descriptor())) return;
  // HDF5 locks a file that it opens for writing, and cannot say that this is why it does not open it.
  if (!lock_file(in.descriptor(), FileLock::kShared)) {
    refuse("is open in another program, which may write to it: close it there first");
  }
  unlock_file(in.descriptor());
  if (open_filled_up(in.descriptor())) return;
  if (is_marked_as_open(in.descriptor())) {
    refuse(
        "is marked as open for writing: it is open in another program, which must close it first, or that "
        "program has ended without closing it (h5clear -s FILE removes the mark)");
  }
  refuse("not a palpate recording: a damaged HDF5 file");
}

bool RecordingReader::open_as_is(int descriptor) {
  std::string name = path_of_open_file(descriptor);  // nobody can exchange this file
  if (name.empty()) name = to_text(path_);
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
  // Later tries wait longer for a block that a truncated file does not have.
  constexpr unsigned kTries = 10;
  check(H5Pset_metadata_read_attempts(access.id(), kTries), "file access");
  check(H5Pset_file_locking(access.id(), kLocksAreAdvisory, 1), "file access");
  hid_t id = H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id());
  if (id < 0) {
    id = H5Fopen(name.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, access.id());
    cut_off_ = id >= 0;
  }
  if (id >= 0) file_ = Handle(id, "file");
  return id >= 0;
}

/// Opens a file that was closed properly but lost its end: a temporary copy, with zeros for the missing
/// bytes.
bool RecordingReader::open_filled_up(int descriptor) {
  std::array<unsigned char, kSuperblockBytes> superblock{};
  if (read_at(descriptor, superblock.data(), superblock.size(), 0) !=
      static_cast<std::ptrdiff_t>(superblock.size())) {
    return false;
  }
  std::int64_t end = 0;
  std::memcpy(&end, superblock.data() + kEndOfFileOffset, sizeof(end));
  if (end <= 0 || static_cast<std::uint64_t>(end) <= file_bytes_) return false;
  std::error_code error;
  std::string name = to_text(std::filesystem::temp_directory_path(error) / "palpate-");
  const Descriptor copy(open_temporary_file(name));
  if (copy.fd < 0) return false;
  hid_t id = H5I_INVALID_HID;
  if (copy_bytes(descriptor, copy.fd, file_bytes_) &&
      set_length(copy.fd, static_cast<std::uint64_t>(end)) == 0) {
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
    check(H5Pset_file_locking(access.id(), kLocksAreAdvisory, 1), "file access");
    id = H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.id());
  }
  std::filesystem::remove(to_path(name), error);  // the open file remains
  if (id < 0) return false;
  file_ = Handle(id, "file");
  cut_off_ = true;
  return true;
}

void RecordingReader::read_all_but_ticks() {
  if (hdf5::read_text_attribute(file_.id(), "format") != kFormatName) {
    throw hdf5::Error("attribute format has another value");
  }
  if (const std::int64_t version = hdf5::read_integer_attribute(file_.id(), "format_version");
      version != kFormatVersion) {
    throw InputError(fmt::format("recording of format version {}; this palpate reads version {}", version,
                                 kFormatVersion));
  }
  ticks_ = Handle(hdf5::open_dataset(file_.id(), "ticks"), "no /ticks");
  const Handle space(H5Dget_space(ticks_.id()), "/ticks");
  hsize_t rows = 0;
  if (H5Sget_simple_extent_ndims(space.id()) != 1 ||
      H5Sget_simple_extent_dims(space.id(), &rows, nullptr) < 0) {
    throw hdf5::Error("/ticks is not a list of rows");
  }
  rows_claimed_ = rows;
  row_type_ = tick_row_type();
  check_columns(ticks_.id(), "/ticks", tick_columns());
  row_bytes_ = H5Tget_size(Handle(H5Dget_type(ticks_.id()), "/ticks").id());
  scene_ = read_setup(file_.id(), file_bytes_);
  facts_ = read_facts(file_.id());
  rows_lost_ = run_count(file_.id(), run_names::kRowsLost);
  if (facts_.complete && hdf5::has_link(file_.id(), "/run", run_names::kRows)) {
    rows_written_ = run_count(file_.id(), run_names::kRows);
  }
  read_changes();
  if (cut_off_) facts_.complete = false;
}

/// Older recordings have no updates. In a truncated file they end at the damage.
void RecordingReader::read_changes() {
  if (!hdf5::has_link(file_.id(), "changes")) return;
  try {
    const Handle dataset(hdf5::open_dataset(file_.id(), "changes"), "no /changes");
    check_columns(dataset.id(), "/changes", update_columns());
    const Handle space(H5Dget_space(dataset.id()), "/changes");
    hsize_t count = 0;
    if (H5Sget_simple_extent_ndims(space.id()) != 1 ||
        H5Sget_simple_extent_dims(space.id(), &count, nullptr) < 0) {
      throw hdf5::Error("/changes is not a list of rows");
    }
    if (count > kMaxChanges) throw hdf5::Error("/changes is too long");
    if (count == 0) return;
    std::vector<UpdateRow> rows(count, row_of({}));  // a missing column keeps its default
    const Handle type = update_row_type();
    check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()),
          "/changes cannot be read");
    for (const UpdateRow& row : rows) {
      const bool follows = row.number != 0 && (changes_.empty() || row.tick > changes_.back().tick);
      const std::string defect = follows ? defect_of(row) : "is out of order";
      if (!defect.empty()) throw hdf5::Error(fmt::format("row {} of /changes {}", changes_.size(), defect));
      changes_.push_back(update_of(row));
    }
  } catch (const hdf5::Error&) {
    if (!cut_off_) throw;
  }
}

/// @throws hdf5::Error also when a checksum does not match. In a truncated file the last block may lack its
/// end or its checksum: it is read without a check.
void RecordingReader::read_block(std::uint64_t start, std::span<haptics::TickRow> rows) {
  const bool may_be_torn = cut_off_ && (start + rows.size() >= rows_claimed_ ||
                                        rows_within_file(start, rows.size()) < rows.size());
  const Handle transfer(H5Pcreate(H5P_DATASET_XFER), "/ticks");
  if (may_be_torn) check(H5Pset_edc_check(transfer.id(), H5Z_DISABLE_EDC), "/ticks");
  const hsize_t first = start;
  const hsize_t count = rows.size();
  const Handle in_file(H5Dget_space(ticks_.id()), "/ticks");
  check(H5Sselect_hyperslab(in_file.id(), H5S_SELECT_SET, &first, nullptr, &count, nullptr), "/ticks");
  const Handle in_memory(H5Screate_simple(1, &count, nullptr), "/ticks");
  check(H5Dread(ticks_.id(), row_type_.id(), in_memory.id(), in_file.id(), transfer.id(), rows.data()),
        "rows cannot be read");
}

/// The number of the `count` rows from `start` that lie completely within the file; `start` begins a chunk.
std::size_t RecordingReader::rows_within_file(std::uint64_t start, std::size_t count) const {
  const hsize_t first = start;
  unsigned filters = 0;
  haddr_t address = HADDR_UNDEF;
  hsize_t bytes = 0;
  if (H5Dget_chunk_info_by_coord(ticks_.id(), &first, &filters, &address, &bytes) < 0) return count;
  // Not the layout of RecordingWriter: compressed, or other chunk sizes.
  const hsize_t chunk_bytes = RecordingWriter::kChunkRows * row_bytes_;
  constexpr hsize_t kChecksumBytes = 4;  // older recordings have no checksums
  if (bytes != chunk_bytes && bytes != chunk_bytes + kChecksumBytes) return count;
  if (address == HADDR_UNDEF || address >= file_bytes_) return 0;
  return std::min<std::uint64_t>(count, (file_bytes_ - address) / row_bytes_);
}

std::uint64_t RecordingReader::for_each_block(
    bool strict, const std::function<void(std::span<const haptics::TickRow>)>& use) {
  strict = strict && facts_.complete;
  if (strict && rows_missing()) {
    refuse(fmt::format("/ticks has {}, /run says {}: palpate repair keeps those that are there",
                       counted(rows_claimed_, "row", "rows"), *rows_written_));
  }
  const std::size_t hands = scene_.tools.size();
  std::vector<haptics::TickRow> rows;  // rows of an incomplete tick, then the block
  haptics::TickRow last;
  std::uint64_t given = 0;
  bool intact = true;
  for (std::uint64_t start = 0; start < rows_claimed_ && intact;) {
    const std::uint64_t count = std::min<std::uint64_t>(RecordingWriter::kChunkRows, rows_claimed_ - start);
    const std::size_t kept = rows.size();
    rows.resize(kept + count);
    const std::span<haptics::TickRow> block = std::span(rows).subspan(kept);
    std::size_t good = 0;
    try {
      read_block(start, block);
      good = rows_without_defect(block, start == 0 ? nullptr : &last, hands);
      // If a power failure left zeros, the row before them may be incomplete.
      if (cut_off_ && good > 0 && good < count) --good;
      if (cut_off_) good = std::min(good, rows_within_file(start, count));
    } catch (const hdf5::Error& error) {
      if (strict) {
        refuse(fmt::format(
            "rows from {} on cannot be read: they are damaged; palpate repair keeps those before", start));
      }
    }
    intact = good == count;
    if (!intact && strict) {
      const haptics::TickRow* const before = good > 0 ? &block[good - 1] : start == 0 ? nullptr : &last;
      refuse(fmt::format("row {} of /ticks {}", start + good, defect_of(block[good], before, hands)));
    }
    rows.resize(kept + good);
    if (good > 0) last = rows.back();
    start += count;
    const bool at_end = !intact || start >= rows_claimed_;
    const std::size_t whole = at_end && strict ? rows.size() : whole_ticks(rows, hands);
    use(std::span(rows).first(whole));
    given += whole;
    rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(whole));
  }
  return given;
}

}  // namespace palpate::record
