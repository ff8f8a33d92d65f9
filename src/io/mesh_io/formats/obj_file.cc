#include <cstdint>
#include <optional>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/surface_builder.h"

namespace palpate::mesh_io {
namespace {

class ObjReader final {
 public:
  explicit ObjReader(const MeshFile& file) : scan_(file, MeshScan::Lines::kCommented) {}

  ImportedMesh run() {
    while (scan_.next_line()) {
      const std::string_view word = scan_.word();
      if (word == "v") {
        surface_.add_vertex(scan_.point(NumberType::kFloat, surface_.vertices.size() + 1));
      } else if (word == "f") {
        read_face();
      } else if (word == "l" || word == "p" || word == "curv") {
        surface_.add_lines(1);
      }
    }
    if (largest_ > count()) {
      scan_.reading("face", largest_face_);
      scan_.refuse_index(largest_, surface_.vertices.size(), 1, largest_at_);
    }
    return surface_.take();
  }

 private:
  [[nodiscard]] std::int64_t count() const { return static_cast<std::int64_t>(surface_.vertices.size()); }

  /// Indices count from 1; negative ones count backwards from the last vertex. Faces may use later vertices.
  void read_face() {
    corners_.clear();
    scan_.reading("face", ++faces_);
    for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word()) {
      const std::string_view index_word = word.substr(0, word.find('/'));
      const std::optional<std::int64_t> index = whole_number(index_word);
      if (!index) scan_.refuse(fmt::format("\"{}\" is not a vertex index", excerpt(index_word, 40)));
      const bool is_named = *index != 0 && *index >= -count() && *index < INT32_MAX;
      if (!is_named) scan_.refuse_index(*index, surface_.vertices.size(), 1, scan_.offset());
      const std::int64_t absolute = *index > 0 ? *index : count() + 1 + *index;
      if (absolute > largest_) {
        largest_ = absolute;
        largest_face_ = faces_;
        largest_at_ = scan_.offset();
      }
      corners_.push_back(static_cast<std::int32_t>(absolute - 1));
    }
    surface_.add_polygon(corners_);
  }

  MeshScan scan_;
  SurfaceBuilder surface_{scan_};
  std::vector<std::int32_t> corners_;  // of one face
  std::size_t faces_ = 0;
  std::int64_t largest_ = 0;
  std::size_t largest_face_ = 0;
  std::size_t largest_at_ = 0;
};

}  // namespace

ImportedMesh read_obj(const MeshFile& file) { return ObjReader(file).run(); }

}  // namespace palpate::mesh_io
