#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hdf5.h>

/// The few HDF5 calls that recordings need, with owned handles and exceptions. Internal to record.
namespace palpate::record::hdf5 {

/// A call failed; the message says what was being done. Turned into InputError, with the file's name, at the
/// module's outside.
class Error final : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Keeps HDF5 from printing its own error stack on this thread, as long as it lives. Also keeps HDF5 from
/// closing files at the program's end: a file whose disk is full crashes it there (HDF5 1.10.8).
class Quiet final {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// Owns one HDF5 identifier of any kind.
class Handle final {
 public:
  Handle() = default;
  /// @throws Error saying `what` failed when `id` is negative.
  Handle(hid_t id, const std::string& what);
  ~Handle() { close(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  [[nodiscard]] hid_t id() const noexcept { return id_; }
  [[nodiscard]] bool valid() const noexcept { return id_ >= 0; }
  /// Gives the identifier up without closing it.
  void abandon() noexcept { id_ = H5I_INVALID_HID; }
  /// @return whether closing went well (it may have to write).
  bool close() noexcept;

 private:
  hid_t id_ = H5I_INVALID_HID;
};

/// @throws Error saying `what` failed when `status` is negative.
void check(herr_t status, const std::string& what);

/// Opens a dataset or a group of the file itself. HDF5 would follow a link to another file, or read a
/// dataset's values from one: a recording from a stranger must not lead to what else its reader may read.
/// @return negative when there is none @throws Error for a dataset whose values are kept in another file.
[[nodiscard]] hid_t open_dataset(hid_t parent, const std::string& name);
[[nodiscard]] hid_t open_group(hid_t parent, const std::string& name);

/// Type of a text of fixed length, UTF-8, filled up with zeros.
[[nodiscard]] Handle text_type(std::size_t bytes);

[[nodiscard]] Handle create_group(hid_t parent, const std::string& name);

// Attributes, for single values; text is of fixed length, UTF-8.
void write_attribute(hid_t object, const std::string& name, const std::string& value);
void write_attribute(hid_t object, const std::string& name, double value);
void write_attribute(hid_t object, const std::string& name, std::int64_t value);
void write_attribute(hid_t object, const std::string& name, std::uint64_t value);
void rewrite_attribute(hid_t object, const std::string& name, std::int64_t value);
[[nodiscard]] std::string read_text_attribute(hid_t object, const std::string& name);
[[nodiscard]] std::int64_t read_integer_attribute(hid_t object, const std::string& name);

/// A dataset of fixed shape, space in the file taken at once; `dimensions` empty for a single value.
[[nodiscard]] Handle create_dataset(hid_t parent, const std::string& name, hid_t type,
                                    const std::vector<hsize_t>& dimensions);
/// A single fixed-length text of `bytes` bytes, filled up with zeros.
[[nodiscard]] Handle create_text(hid_t parent, const std::string& name, std::size_t bytes);
void write_text(hid_t dataset, const std::string& text);
/// @throws Error when there is none, or it is longer than `longest`.
[[nodiscard]] std::string read_text(hid_t parent, const std::string& name, std::size_t longest);

/// An N x 2 dataset of 64-bit integers that is still empty, compressed; takes no space until it is filled.
[[nodiscard]] Handle create_growing_pairs(hid_t parent, const std::string& name);
/// Fills such a dataset, once. @param values first and second of each pair in turn
void fill_pairs(hid_t dataset, const std::string& name, const std::vector<std::int64_t>& values);
/// What fill_pairs() wrote; at most `longest` pairs. @throws Error when there is no such dataset, it has
/// another shape or more pairs.
[[nodiscard]] std::vector<std::int64_t> read_pairs(hid_t parent, const std::string& name,
                                                   std::size_t longest);

/// Keeps the hash of a dataset's values as its attribute, so that flipped bits are found.
void write_content_hash(hid_t dataset, std::span<const std::byte> values);
/// @throws Error naming the dataset when the values are others than those that were written. A dataset of a
/// recording from before there were hashes has none, and passes.
void check_content_hash(hid_t dataset, const std::string& name, std::span<const std::byte> values);

/// Number of rows of an N x 3 dataset. @throws Error when there is none, it has another shape, or it claims
/// more than a file of `file_bytes` bytes can hold.
[[nodiscard]] std::size_t rows_of_three(hid_t dataset, const std::string& name, std::size_t value_bytes,
                                        std::uint64_t file_bytes);

}  // namespace palpate::record::hdf5
