#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// What a file holds.
enum class FileContent { kUnknown, kMesh, kRecording, kTable, kTissue, kScene, kStudy, kOther };

/// The content of a file, as its first 64 KiB show it, whatever the file's name.
struct ContentFacts {
  FileContent content = FileContent::kUnknown;
  std::string name;       // "a mesh (binary STL)"
  std::string use;        // what reads it: "palpate inspect, --organ and --tool read it"
  std::string extension;  // of a mesh: ".stl"
};

/// [setup] Empty facts for a file that is unknown or cannot be read.
[[nodiscard]] ContentFacts find_content(const std::filesystem::path& file);

/// [setup] What a table with these columns is; empty facts for columns of no known table.
[[nodiscard]] ContentFacts table_of(std::span<const std::string> columns);

/// [setup] For a reader that has failed: rejects a file whose content is known and another than `wanted`.
/// @param must_be for the message: "a mesh file" @return the content of any other file @throws InputError
/// "FILE: is a recording (HDF5), must be a mesh file; palpate view, ... read it"
ContentFacts refuse_other_content(const std::filesystem::path& file, FileContent wanted,
                                  std::string_view must_be);

}  // namespace palpate
