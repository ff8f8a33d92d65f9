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

/// Writes named arrays of plain elements to one file, under a temporary name first; commit() renames it, so
/// that no reader ever sees half of it. Without commit() nothing is left. Whatever fails (full disk, a folder
/// that is not there or not writable) makes commit() return false and does nothing else.
/// Layout and reasons: docs/decisions/0006-preparation.md.
class ArrayFileWriter final {
 public:
  /// [setup] @param key says what the content was made from; a reader must ask for the same.
  ArrayFileWriter(std::filesystem::path file, const ContentHash& key);
  ~ArrayFileWriter();
  ArrayFileWriter(const ArrayFileWriter&) = delete;
  ArrayFileWriter& operator=(const ArrayFileWriter&) = delete;

  /// [setup] Adds an array. @param name at most 31 bytes, each once a file.
  template <PlainElement T>
  void put(std::string_view name, std::span<const T> values) {
    put_bytes(name, std::as_bytes(values), sizeof(T));
  }
  template <PlainElement T>
  void put(std::string_view name, const std::vector<T>& values) {
    put(name, std::span<const T>(values));
  }

  /// [setup] Whether the whole file now stands under its name. Once.
  [[nodiscard]] bool commit();

 private:
  void put_bytes(std::string_view name, std::span<const std::byte> bytes, std::size_t element_size);
  void write(std::span<const std::byte> bytes);

  std::filesystem::path file_;
  std::string temporary_;  // empty: none is there
  ContentHash key_;
  int descriptor_ = -1;
  bool failed_ = false;
  std::uint64_t written_ = 0;
  std::vector<std::byte> directory_;
};

/// Reads what ArrayFileWriter wrote. Whatever is wrong (no file, one that another user owns or may write to,
/// another key, version or program, cut off, a bit flipped) is an empty optional; no size in the file is
/// believed before it is seen to fit.
class ArrayFileReader final {
 public:
  /// [setup]
  [[nodiscard]] static std::optional<ArrayFileReader> open(const std::filesystem::path& file,
                                                           const ContentHash& key);
  ~ArrayFileReader();
  ArrayFileReader(ArrayFileReader&& other) noexcept;
  ArrayFileReader& operator=(ArrayFileReader&&) = delete;

  /// [setup] The array put under that name with elements of T's size, if its checksum is right.
  template <PlainElement T>
  [[nodiscard]] std::optional<std::vector<T>> get(std::string_view name) const {
    const std::optional<std::size_t> size = size_of(name, sizeof(T));
    if (!size) return std::nullopt;
    std::vector<T> values(*size);
    if (!read_array(name, std::as_writable_bytes(std::span<T>(values)))) return std::nullopt;
    return values;
  }

  /// [setup] As above into `values`; whether it went well.
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
