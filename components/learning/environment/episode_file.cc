#include "learning/environment/episode_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include <fmt/core.h>
#include <unistd.h>
#include <zlib.h>

#include "io/record/hdf5_handle.h"
#include "io/system/temporary.h"
#include "palpate/error.h"

namespace palpate::learning {

struct CloseFile {
  void operator()(std::FILE* file) const noexcept { (void)std::fclose(file); }
};

namespace {

namespace fs = std::filesystem;
namespace hdf5 = record::hdf5;

constexpr std::size_t kBlock = std::size_t{1} << 20U;  // bytes that are copied at once, about

[[noreturn]] void fail(const fs::path& file) {
  throw InputError(file.string() + ": cannot be written: " + std::strerror(errno));
}

/// A file without a name, which the system removes when it is closed.
std::unique_ptr<std::FILE, CloseFile> nameless_file(const fs::path& beside) {
  std::string path = beside.string() + ".part";
  const int descriptor = open_temporary_file(path);
  if (descriptor < 0) fail(beside);
  (void)unlink(path.c_str());
  std::unique_ptr<std::FILE, CloseFile> file(fdopen(descriptor, "w+b"));
  if (!file) {
    (void)close(descriptor);
    fail(beside);
  }
  return file;
}

std::uint32_t crc_of(std::uint32_t before, std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

template <typename Unsigned>
void put(std::string& to, Unsigned value) {
  for (std::size_t i = 0; i < sizeof value; ++i) {
    to += static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
  }
}

/// The header of an array in NumPy's format, version 1.0. @param shape without brackets: "3, 2"
std::string npy_header(const std::string& type, const std::string& shape) {
  constexpr std::size_t kBefore = 10;  // bytes
  constexpr std::size_t kAligned = 64;
  std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, shape);
  text.append(kAligned - 1 - (kBefore + text.size()) % kAligned, ' ');
  text += '\n';
  std::string header = "\x93NUMPY";
  header += {'\1', '\0'};
  put(header, static_cast<std::uint16_t>(text.size()));
  return header + text;
}

/// A ZIP archive without compression.
class ZipWriter final {
 public:
  explicit ZipWriter(const fs::path& file) : out_(file, std::ios::binary) {}

  /// Writes the head of an entry; its bytes follow by write().
  void begin(const std::string& name, std::uint32_t crc, std::uint64_t bytes) {
    constexpr std::uint16_t kFirstOf1980 = 0x21;
    std::string common;
    put(common, std::uint16_t{20});  // version 2.0
    put(common, std::uint32_t{0});   // no flags, stored
    put(common, std::uint16_t{0});   // time
    put(common, kFirstOf1980);
    put(common, crc);
    put(common, static_cast<std::uint32_t>(bytes));
    put(common, static_cast<std::uint32_t>(bytes));
    put(common, static_cast<std::uint16_t>(name.size()));
    put(common, std::uint16_t{0});  // no extra field
    directory_ += "PK\1\2" + std::string("\x14\0", 2) + common;
    directory_.append(10, '\0');  // no comment, disk 0, no attributes
    put(directory_, static_cast<std::uint32_t>(at_));
    directory_ += name;
    ++entries_;
    write("PK\3\4" + common + name);
  }

  void write(std::string_view bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    at_ += bytes.size();
  }

  /// @return whether everything is written
  bool finish() {
    std::string end = "PK\5\6";
    put(end, std::uint32_t{0});  // one disk
    put(end, entries_);
    put(end, entries_);
    put(end, static_cast<std::uint32_t>(directory_.size()));
    put(end, static_cast<std::uint32_t>(at_));
    put(end, std::uint16_t{0});  // no comment
    write(directory_ + end);
    out_.close();
    return !out_.fail();
  }

 private:
  std::ofstream out_;
  std::string directory_;
  std::uint64_t at_ = 0;
  std::uint16_t entries_ = 0;
};

/// h5py's type of a boolean.
hdf5::Handle truth_type() {
  hdf5::Handle type(H5Tenum_create(H5T_NATIVE_INT8), "truth type");
  for (const auto& [name, value] : {std::pair<const char*, std::int8_t>{"FALSE", 0}, {"TRUE", 1}}) {
    hdf5::check(H5Tenum_insert(type.id(), name, &value), "truth type");
  }
  return type;
}

}  // namespace

struct EpisodeFile::Array {
  ArraySpec spec;
  std::unique_ptr<std::FILE, CloseFile> rows;
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;

  [[nodiscard]] std::size_t row_bytes() const {
    return (spec.element == Element::kTruth ? 1 : 8) * std::max<std::size_t>(spec.columns, 1);
  }
  [[nodiscard]] std::uint64_t count() const { return bytes / row_bytes(); }

  /// Calls `take(first row, rows, bytes)` with blocks of rows, in order. @return whether all could be read
  template <typename Take>
  bool read(const Take& take) const {
    if (std::fflush(rows.get()) != 0 || std::fseek(rows.get(), 0, SEEK_SET) != 0) return false;
    const std::uint64_t at_once = std::max<std::uint64_t>(kBlock / row_bytes(), 1);
    std::string block;
    for (std::uint64_t row = 0; row < count(); row += at_once) {
      const std::uint64_t these = std::min(at_once, count() - row);
      block.resize(these * row_bytes());
      if (std::fread(block.data(), 1, block.size(), rows.get()) != block.size()) return false;
      take(row, these, block);
    }
    return true;
  }
};

EpisodeFile::EpisodeFile(fs::path file, std::vector<ArraySpec> arrays)
    : file_(std::move(file)), npz_(is_npz(file_)) {
  for (ArraySpec& spec : arrays) arrays_.push_back({std::move(spec), nameless_file(file_)});
}

EpisodeFile::~EpisodeFile() = default;

bool EpisodeFile::is_npz(const fs::path& file) {
  if (file.extension() == ".npz") return true;
  if (file.extension() == ".h5") return false;
  throw InputError(file.string() + ": must end in .h5 (HDF5) or .npz (NumPy)");
}

void EpisodeFile::append(std::size_t array, std::string_view bytes) {
  Array& to = arrays_[array];
  if (std::fwrite(bytes.data(), 1, bytes.size(), to.rows.get()) != bytes.size()) fail(file_);
  to.bytes += bytes.size();
  to.crc = crc_of(to.crc, bytes);
}

void EpisodeFile::finish(const std::string& metadata) {
  errno = 0;
  if (npz_) {
    write_npz(metadata);
    return;
  }
  const hdf5::SilenceErrors quiet;
  try {
    write_hdf5(metadata);
  } catch (const hdf5::Error& error) {
    throw InputError(file_.string() + ": cannot be written: " + error.what());
  }
}

void EpisodeFile::write_npz(const std::string& metadata) {
  ZipWriter zip(file_);
  for (const Array& array : arrays_) {
    const char* type = array.spec.element == Element::kNumber  ? "<f8"
                       : array.spec.element == Element::kWhole ? "<i8"
                                                               : "|b1";
    const std::string columns = array.spec.columns > 0 ? std::to_string(array.spec.columns) : "";
    const std::string header = npy_header(type, fmt::format("{}, {}", array.count(), columns));
    const uLong crc = crc32_combine(crc_of(0, header), array.crc, static_cast<z_off_t>(array.bytes));
    zip.begin(array.spec.name + ".npy", static_cast<std::uint32_t>(crc), header.size() + array.bytes);
    zip.write(header);
    const auto copy = [&zip](std::uint64_t, std::uint64_t, const std::string& block) { zip.write(block); };
    if (!array.read(copy)) fail(file_);
  }
  std::string text = npy_header("<U" + std::to_string(metadata.size()), "");
  for (const char letter : metadata) put(text, static_cast<std::uint32_t>(letter));
  zip.begin("metadata.npy", crc_of(0, text), text.size());
  zip.write(text);
  if (!zip.finish()) fail(file_);
}

void EpisodeFile::write_hdf5(const std::string& metadata) {
  hdf5::Handle file(H5Fcreate(file_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "the file");
  const hdf5::Handle truth = truth_type();
  const hdf5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), "properties");
  hdf5::check(H5Pset_obj_track_times(properties.id(), false), "properties");  // for reproducible bytes
  const auto dataset = [&](const std::string& name, hid_t type, int rank, const hsize_t* shape) {
    const hdf5::Handle space(rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, shape, nullptr),
                             name);
    return hdf5::Handle(
        H5Dcreate2(file.id(), name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
        name);
  };
  for (const Array& array : arrays_) {
    const std::string& name = array.spec.name;
    const hid_t type = array.spec.element == Element::kNumber  ? H5T_NATIVE_DOUBLE
                       : array.spec.element == Element::kWhole ? H5T_NATIVE_INT64
                                                               : truth.id();
    const int rank = array.spec.columns > 0 ? 2 : 1;
    const hsize_t shape[2] = {array.count(), array.spec.columns};
    const hdf5::Handle made = dataset(name, type, rank, shape);
    const hdf5::Handle space(H5Dget_space(made.id()), name);
    const auto copy = [&](std::uint64_t row, std::uint64_t rows, const std::string& block) {
      const hsize_t start[2] = {row, 0};
      const hsize_t size[2] = {rows, array.spec.columns};
      const hdf5::Handle memory(H5Screate_simple(rank, size, nullptr), name);
      hdf5::check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start, nullptr, size, nullptr), name);
      hdf5::check(H5Dwrite(made.id(), type, memory.id(), space.id(), H5P_DEFAULT, block.data()), name);
    };
    if (!array.read(copy)) fail(file_);
  }
  hdf5::write_text(dataset("metadata", hdf5::text_type(metadata.size()).id(), 0, nullptr).id(), metadata);
  if (!file.close()) throw hdf5::Error("the file");
}

}  // namespace palpate::learning
