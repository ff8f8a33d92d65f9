#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::learning {

enum class Element : std::uint8_t {
  kNumber,  // 8-byte floating point
  kWhole,   // 8-byte signed integer
  kTruth,   // 1 byte, 0 or 1
};

/// A named array whose rows are appended.
struct ArraySpec {
  std::string name;
  Element element = Element::kNumber;
  std::size_t columns = 0;  // 0: one-dimensional
};

/// Writes arrays of unknown length and a text to one file: HDF5 (.h5) or NumPy's archive (.npz), whose text
/// is the array "metadata". Rows are kept in temporary files beside it until finish(). The same rows give the
/// same bytes. [setup], one thread.
class EpisodeFile final {
 public:
  /// Most bytes that an .npz file may have: NumPy's archive is written without the 64-bit extension of ZIP.
  static constexpr std::uint64_t kMaxNpzBytes = 0xffff'ffffU;

  /// @throws InputError when the name ends in neither .h5 nor .npz, or the folder cannot be written
  EpisodeFile(std::filesystem::path file, std::vector<ArraySpec> arrays);
  ~EpisodeFile();
  EpisodeFile(const EpisodeFile&) = delete;
  EpisodeFile& operator=(const EpisodeFile&) = delete;

  /// Whether the name ends in .npz. @throws InputError when it ends in neither .h5 nor .npz
  [[nodiscard]] static bool is_npz(const std::filesystem::path& file);

  /// Appends whole rows to an array. @throws InputError when the disk is full
  void append(std::size_t array, std::string_view bytes);
  /// Writes the file. @param metadata ASCII @throws InputError when it cannot be written
  void finish(const std::string& metadata);

 private:
  struct Array;

  void write_hdf5(const std::string& metadata);
  void write_npz(const std::string& metadata);

  std::filesystem::path file_;
  bool npz_ = false;
  std::vector<Array> arrays_;
};

}  // namespace palpate::learning
