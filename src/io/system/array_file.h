#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/content_hash.h"

namespace palpate {

/// Writes named arrays of plain elements to one file under a temporary name; commit() renames it, so that no
/// reader sees an incomplete file. Without commit() the file is removed. After any failure (full disk,
/// missing or read-only folder) commit() returns false. Layout and reasons:
/// docs/decisions/0006-preparation.md.
class ArrayFileWriter final {
 public:
  /// [setup] @param key identifies the input of the arrays; a reader must give the same key
  ArrayFileWriter(std::filesystem::path file, const ContentHash& key);
  ~ArrayFileWriter();
  ArrayFileWriter(const ArrayFileWriter&) = delete;
  ArrayFileWriter& operator=(const ArrayFileWriter&) = delete;

  /// [setup] Adds an array. @param name at most 31 bytes, unique in the file
  template <PlainElement T>
  void put(std::string_view name, std::span<const T> values) {
    put_bytes(name, std::as_bytes(values), sizeof(T));
  }
  template <PlainElement T>
  void put(std::string_view name, const std::vector<T>& values) {
    put(name, std::span<const T>(values));
  }

  /// [setup] Completes the file. Call once. @return whether the complete file has its final name
  [[nodiscard]] bool commit();

 private:
  void put_bytes(std::string_view name, std::span<const std::byte> bytes, std::size_t element_size);
  void write(std::span<const std::byte> bytes);

  std::filesystem::path file_;
  std::string temporary_;  // empty: no temporary file
  ContentHash key_;
  int descriptor_ = -1;
  bool failed_ = false;
  std::uint64_t written_ = 0;
  std::vector<std::byte> directory_;
};

/// Reads a file of ArrayFileWriter. Any defect gives an empty optional: no file, one that another user owns
/// or may write to, another key, version or program, a truncated file, a flipped bit. Sizes in the file are
/// checked against its length before use.
class ArrayFileReader final {
 public:
  /// [setup]
  [[nodiscard]] static std::optional<ArrayFileReader> open(const std::filesystem::path& file,
                                                           const ContentHash& key);
  ~ArrayFileReader();
  ArrayFileReader(ArrayFileReader&& other) noexcept;
  ArrayFileReader& operator=(ArrayFileReader&&) = delete;

  /// [setup] The array of that name with elements of T's size; empty if missing or its checksum is wrong.
  template <PlainElement T>
  [[nodiscard]] std::optional<std::vector<T>> get(std::string_view name) const {
    const std::optional<std::size_t> size = size_of(name, sizeof(T));
    if (!size) return std::nullopt;
    std::vector<T> values(*size);
    if (!read_array(name, std::as_writable_bytes(std::span<T>(values)))) return std::nullopt;
    return values;
  }

  /// [setup] Reads the array of that name into `values`. @return whether it exists and its checksum is right
  template <PlainElement T>
  [[nodiscard]] bool get(std::string_view name, std::vector<T>& values) const {
    std::optional<std::vector<T>> found = get<T>(name);
    if (found) values = std::move(*found);
    return found.has_value();
  }

 private:
  struct Array {
    std::string name;
    std::uint64_t offset = 0;
    std::uint64_t element_size = 0;
    std::uint64_t size = 0;
    ContentHash checksum;
  };

  ArrayFileReader() = default;
  [[nodiscard]] const Array* find(std::string_view name) const noexcept;
  [[nodiscard]] std::optional<std::size_t> size_of(std::string_view name, std::size_t element_size) const;
  [[nodiscard]] bool read_array(std::string_view name, std::span<std::byte> bytes) const;
  [[nodiscard]] bool read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  [[nodiscard]] bool read_directory(const ContentHash& key);

  int descriptor_ = -1;
  std::vector<Array> arrays_;
};

}  // namespace palpate
