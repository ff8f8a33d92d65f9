#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/mesh_io/mesh_file.h"

namespace palpate::mesh_io {

/// The JSON and the buffers of a .gltf or .glb file. Declared counts are bounded by the buffers and by
/// kMaxElements in all, and no file outside the mesh's folder is opened. @throws InputError in all members,
/// naming the file, the element, its value and what would be right.
class GltfDocument final {
 public:
  static constexpr std::uint64_t kMaxElements = 20'000'000;  // read from accessors
  using Json = nlohmann::json;

  /// [setup] Parses the JSON; `file` outlives this object.
  explicit GltfDocument(const MeshFile& file);

  /// Rejects extensions that move vertices and are not read, and buffers that must not be opened.
  void check() const;
  /// The names of the buffers that are separate files, without percent-encoding.
  [[nodiscard]] std::vector<std::string> buffer_names() const;

  /// An array of the file or of one of its objects; empty if it is missing or no array.
  [[nodiscard]] const Json& list(const char* name) const { return list_in(root_, name); }
  [[nodiscard]] static const Json& list_in(const Json& owner, const char* name);
  /// A whole number of an object; `otherwise` where it is missing. @param where for messages: "node 3"
  [[nodiscard]] std::uint64_t whole(const Json& owner, const char* name, std::uint64_t otherwise,
                                    std::string_view where) const;
  [[nodiscard]] const Json& root() const noexcept { return root_; }

  /// The components of an accessor's elements, one element after the other; normalized integers from -1 or 0
  /// to 1. @param type "SCALAR", "VEC3", "VEC4" or "MAT4"
  [[nodiscard]] std::vector<double> numbers(std::uint64_t accessor, std::string_view type);
  /// Counts elements that are read, or work of the same size. @throws InputError above kMaxElements in all
  void spend(std::uint64_t elements);
  [[noreturn]] void refuse(const std::string& message) const;

 private:
  struct Layout;
  [[noreturn]] void refuse_accessor(std::uint64_t accessor, const std::string& message) const;
  [[noreturn]] void refuse_extension(const std::string& name) const;
  void check_extensions() const;
  void check_part_extensions(const Json& part) const;
  void check_buffers() const;
  [[nodiscard]] bool leads_out(const std::string& name) const;
  void read(const Layout& layout, const Json& owner, std::uint64_t accessor, std::uint64_t count,
            std::vector<double>& values);
  void read_sparse(const Layout& layout, const Json& sparse, std::uint64_t accessor,
                   std::vector<double>& values);
  [[nodiscard]] std::string_view view_bytes(const Json& view, std::uint64_t accessor);
  [[nodiscard]] std::string_view buffer_bytes(std::uint64_t buffer, std::uint64_t accessor);

  const MeshFile& file_;
  std::string_view text_;
  Json root_;
  std::map<std::uint64_t, std::string> buffers_;  // those that are no part of the file's bytes, by index
  std::uint64_t elements_ = 0;                    // read
};

}  // namespace palpate::mesh_io
