#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

/// The HDF5 calls that recordings need, with owned handles and exceptions. Only for the module record.
namespace palpate::record::hdf5 {

/// A failed call; the message names the operation. The module's public functions turn it into an InputError
/// with the file's name.
class Error final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// While it exists, HDF5 does not print its error stack on this thread. Also stops HDF5 from closing files at
/// exit: that crashes for a file on a full disk (HDF5 1.10.8).
class SilenceErrors final {
 public:
  SilenceErrors();
  ~SilenceErrors();
  SilenceErrors(const SilenceErrors&) = delete;
  SilenceErrors& operator=(const SilenceErrors&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// Owns an HDF5 identifier of any kind.
class Handle final {
 public:
  Handle() = default;
  /// @throws Error naming the operation `what` when `id` is negative.
  Handle(hid_t id, const std::string& what);
  ~Handle() { close(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  [[nodiscard]] hid_t id() const noexcept { return id_; }
  [[nodiscard]] bool valid() const noexcept { return id_ >= 0; }
  /// Gives up the identifier without closing it.
  void abandon() noexcept { id_ = H5I_INVALID_HID; }
  /// @return whether closing succeeded (it may have to write)
  bool close() noexcept;

 private:
  hid_t id_ = H5I_INVALID_HID;
};

/// @throws Error naming the operation `what` when `status` is negative.
void check(herr_t status, const std::string& what);

/// Opens a dataset or a group of this file only. HDF5 would follow links to other files and read external
/// values: a recording from a stranger must not read the user's other files. @return negative when it does
/// not exist @throws Error for a dataset whose values are in another file.
[[nodiscard]] hid_t open_dataset(hid_t parent, const std::string& name);
[[nodiscard]] hid_t open_group(hid_t parent, const std::string& name);
/// Whether a group of this file has a link of this name; false without the group.
[[nodiscard]] bool has_link(hid_t parent, const std::string& group, const std::string& name);

/// Type of a text of fixed length: UTF-8, padded with zeros.
[[nodiscard]] Handle text_type(std::size_t bytes);

[[nodiscard]] Handle create_group(hid_t parent, const std::string& name);

// Attributes hold single values; text has a fixed length in UTF-8.
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, std::uint64_t value);
void rewrite_attribute(hid_t object, const std::string& name, std::int64_t value);
[[nodiscard]] std::string read_text_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::int64_t read_integer_attribute(hid_t object, const std::string& name);

/// A dataset of fixed shape whose space is allocated at once; empty `dimensions` mean a single value.
[[nodiscard]] Handle create_dataset(hid_t parent, const std::string& name, hid_t type,
                                    const std::vector<hsize_t>& dimensions);
/// A single text of `bytes` bytes, padded with zeros.
[[nodiscard]] Handle create_text(hid_t parent, const std::string& name, std::size_t bytes);
void write_text(hid_t dataset, const std::string& text);
/// @throws Error when it is missing or longer than `longest`.
[[nodiscard]] std::string read_text(hid_t parent, const std::string& name, std::size_t longest);

/// An empty, compressed N x 2 dataset of 64-bit integers; it needs no space until it is filled.
[[nodiscard]] Handle create_growing_pairs(hid_t parent, const std::string& name);
/// Fills a dataset of create_growing_pairs(), once. @param values first and second of each pair, alternating
void fill_pairs(hid_t dataset, const std::string& name, const std::vector<std::int64_t>& values);
/// Reads the pairs that fill_pairs() wrote. @throws Error when the dataset is missing, has another shape or
/// more than `longest` pairs.
[[nodiscard]] std::vector<std::int64_t> read_pairs(hid_t parent, const std::string& name,
                                                   std::size_t longest);

/// Whether an object has an attribute, or a group a link. @throws Error when that cannot be found out
[[nodiscard]] bool has_attribute(hid_t object, const std::string& name);
[[nodiscard]] bool has_link(hid_t parent, const std::string& name);

/// Stores the hash of a dataset's values as its attribute, to detect flipped bits.
void write_content_hash(hid_t dataset, std::span<const std::byte> values);
/// @throws Error naming the dataset when the values do not match its hash. Older recordings without a hash
/// pass.
void check_content_hash(hid_t dataset, const std::string& name, std::span<const std::byte> values);

/// Number of rows of an N x 3 dataset. @throws Error when it is missing, has another shape, or declares more
/// rows than a file of `file_bytes` bytes can hold.
[[nodiscard]] std::size_t rows_of_three(hid_t dataset, const std::string& name, std::size_t value_bytes,
                                        std::uint64_t file_bytes);

}  // namespace palpate::record::hdf5
