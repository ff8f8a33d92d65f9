#include "io/system/array_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "io/system/cache_folder.h"
#include "io/system/files.h"
#include "io/system/path_text.h"
#include "io/system/temporary.h"
#include "palpate/version.h"

namespace palpate {
namespace {

constexpr std::size_t kLongestName = 31;
constexpr std::uint64_t kMaxArrays = 256;
constexpr std::uint64_t kAlignment = 64;

/// The start of the file; written last, when the rest is complete.
struct Header {
  std::array<char, 8> magic{'P', 'A', 'L', 'P', 'A', 'R', 'R', '\n'};
  std::uint32_t format = 1;
  std::uint32_t byte_order = 0x01020304;
  std::array<char, 16> program{};  // palpate's version
  ContentHash key;
  std::uint64_t file_size = 0;
  std::uint64_t directory_offset = 0;
  std::uint64_t directory_size = 0;  // number of entries
  ContentHash directory_checksum;
  ContentHash header_checksum;  // of all fields above
};
static_assert(sizeof(Header) == 104 && sizeof(Header) <= 2 * kAlignment);
constexpr std::uint64_t kFirstArray = 2 * kAlignment;

struct DirectoryEntry {
  std::array<char, kLongestName + 1> name{};
  std::uint64_t offset = 0;
  std::uint64_t element_size = 0;
  std::uint64_t size = 0;  // number of elements
  ContentHash checksum;
};
static_assert(sizeof(DirectoryEntry) == 72);

template <typename T>
std::span<const std::byte> bytes_of(const T& value) {
  return std::as_bytes(std::span<const T>(&value, 1));
}

ContentHash hash_of(std::span<const std::byte> bytes) { return ContentHasher().add(bytes).hash(); }

ContentHash checksum_of(const Header& header) {
  return hash_of(bytes_of(header).first(sizeof(Header) - sizeof(ContentHash)));
}

std::array<char, 16> program_version() {
  std::array<char, 16> text{};
  std::strncpy(text.data(), kVersion, text.size() - 1);
  return text;
}

bool write_whole(int descriptor, std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::ptrdiff_t count = palpate::write_at(descriptor, bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    offset += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

}  // namespace

ArrayFileWriter::ArrayFileWriter(std::filesystem::path file, const ContentHash& key)
    : file_(std::move(file)), temporary_(to_text(file_) + "."), key_(key), written_(kFirstArray) {
  descriptor_ = open_temporary_file(temporary_);
  if (descriptor_ < 0) {
    temporary_.clear();
    failed_ = true;
  }
}

ArrayFileWriter::~ArrayFileWriter() {
  if (descriptor_ >= 0) close(descriptor_);
  std::error_code ignored;
  if (!temporary_.empty()) std::filesystem::remove(to_path(temporary_), ignored);
}

void ArrayFileWriter::write(std::span<const std::byte> bytes) {
  if (!failed_ && !write_whole(descriptor_, written_, bytes)) failed_ = true;
  written_ += bytes.size();
}

void ArrayFileWriter::put_bytes(std::string_view name, std::span<const std::byte> bytes,
                                std::size_t element_size) {
  if (name.empty() || name.size() > kLongestName ||
      directory_.size() / sizeof(DirectoryEntry) == kMaxArrays) {
    failed_ = true;
  }
  if (failed_) return;
  written_ = (written_ + kAlignment - 1) / kAlignment * kAlignment;
  DirectoryEntry entry;
  name.copy(entry.name.data(), kLongestName);
  entry.offset = written_;
  entry.element_size = element_size;
  entry.size = bytes.size() / element_size;
  entry.checksum = hash_of(bytes);
  const std::span<const std::byte> entry_bytes = bytes_of(entry);
  directory_.insert(directory_.end(), entry_bytes.begin(), entry_bytes.end());
  write(bytes);
}

bool ArrayFileWriter::commit() {
  Header header;
  header.program = program_version();
  header.key = key_;
  header.directory_offset = written_;
  header.directory_size = directory_.size() / sizeof(DirectoryEntry);
  header.directory_checksum = hash_of(directory_);
  write(directory_);
  header.file_size = written_;
  header.header_checksum = checksum_of(header);
  if (failed_ || !write_whole(descriptor_, 0, bytes_of(header))) return false;
  const bool closed = close(std::exchange(descriptor_, -1)) == 0;
  std::error_code error;
  if (closed) std::filesystem::rename(to_path(temporary_), file_, error);
  if (!closed || error) return false;
  temporary_.clear();
  return true;
}

std::optional<ArrayFileReader> ArrayFileReader::open(const std::filesystem::path& file,
                                                     const ContentHash& key) {
  ArrayFileReader reader;
  reader.descriptor_ = open_file(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (reader.descriptor_ < 0 || !reader.read_directory(key)) return std::nullopt;
  return reader;
}

ArrayFileReader::~ArrayFileReader() {
  if (descriptor_ >= 0) close(descriptor_);
}

ArrayFileReader::ArrayFileReader(ArrayFileReader&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), arrays_(std::move(other.arrays_)) {}

bool ArrayFileReader::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  while (!bytes.empty()) {
    const std::ptrdiff_t count = palpate::read_at(descriptor_, bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    offset += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

bool ArrayFileReader::read_directory(const ContentHash& key) {
  FileStatus facts{};
  if (status_of(descriptor_, facts) != 0 || !S_ISREG(facts.st_mode) || !is_private(facts)) return false;
  const auto file_size = static_cast<std::uint64_t>(facts.st_size);
  Header header;
  if (!read_at(0, std::as_writable_bytes(std::span(&header, 1)))) return false;
  const Header wanted;
  if (header.magic != wanted.magic || header.format != wanted.format ||
      header.byte_order != wanted.byte_order || header.program != program_version() || header.key != key ||
      header.file_size != file_size || header.header_checksum != checksum_of(header)) {
    return false;
  }
  if (header.directory_size > kMaxArrays || header.directory_offset > file_size ||
      header.directory_size * sizeof(DirectoryEntry) != file_size - header.directory_offset) {
    return false;
  }
  std::vector<DirectoryEntry> entries(header.directory_size);
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(entries));
  if (!read_at(header.directory_offset, bytes) || hash_of(bytes) != header.directory_checksum) return false;
  for (DirectoryEntry& entry : entries) {
    entry.name.back() = '\0';
    if (entry.offset > file_size || entry.element_size == 0 ||
        entry.size > (file_size - entry.offset) / entry.element_size) {
      return false;
    }
    arrays_.push_back({entry.name.data(), entry.offset, entry.element_size, entry.size, entry.checksum});
  }
  return true;
}

const ArrayFileReader::Array* ArrayFileReader::find(std::string_view name) const noexcept {
  for (const Array& array : arrays_) {
    if (array.name == name) return &array;
  }
  return nullptr;
}

std::optional<std::size_t> ArrayFileReader::size_of(std::string_view name, std::size_t element_size) const {
  const Array* array = find(name);
  if (array == nullptr || array->element_size != element_size) return std::nullopt;
  return array->size;
}

bool ArrayFileReader::read_array(std::string_view name, std::span<std::byte> bytes) const {
  const Array* array = find(name);
  return array != nullptr && read_at(array->offset, bytes) && hash_of(bytes) == array->checksum;
}

}  // namespace palpate
