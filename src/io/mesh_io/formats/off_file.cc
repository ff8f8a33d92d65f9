#include <cstdint>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/mesh_io/formats/surface_builder.h"

namespace palpate::mesh_io {
namespace {

class OffReader final {
 public:
  explicit OffReader(const MeshFile& file) : scan_(file, MeshScan::Lines::kCommented) {}

  ImportedMesh run() {
    read_head();
    const std::size_t vertices = scan_.count("vertices");
    const std::size_t faces = scan_.count("faces");
    constexpr std::size_t kLeast = 4;  // bytes of the shortest vertex or face
    scan_.require_room(vertices, kLeast, "vertices");
    scan_.require_room(faces, kLeast, "faces");
    surface_.expect_vertices(vertices);
    for (std::size_t v = 1; v <= vertices; ++v) {
      next_content();
      surface_.add_vertex(scan_.point(NumberType::kFloat, v, vertices));
    }
    for (std::size_t f = 1; f <= faces; ++f) {
      next_content();
      scan_.reading("face", f, faces);
      const std::size_t corners = scan_.as_count(scan_.whole(NumberType::kInt32), "corners");
      corners_.clear();
      for (std::size_t k = 0; k < corners; ++k) corners_.push_back(scan_.index(NumberType::kInt32, vertices));
      surface_.add_polygon(corners_);
    }
    return surface_.take();
  }

 private:
  void read_head() {
    next_content();
    const std::string_view word = scan_.word();
    if (!word.ends_with("OFF")) {
      scan_.refuse(fmt::format("starts with \"{}\": must be OFF", excerpt(word, 20)));
    }
    if (scan_.rest_of_line().find("BINARY") != std::string_view::npos) {
      scan_.refuse("binary OFF is not read: save it as text");
    }
    if (word.find_first_of("4n") != std::string_view::npos) {
      scan_.refuse(fmt::format("\"{}\" is not a surface in three dimensions", excerpt(word, 20)));
    }
    if (scan_.rest_of_line().empty()) next_content();
  }

  /// Goes to the next line that has more than a comment.
  void next_content() {
    while (scan_.next_line()) {
      if (!scan_.rest_of_line().empty()) return;
    }
    scan_.refuse("truncated: fewer lines than the vertices and faces that it declares");
  }

  MeshScan scan_;
  SurfaceBuilder surface_{scan_};
  std::vector<std::int32_t> corners_;  // of one face
};

}  // namespace

ImportedMesh read_off(const MeshFile& file) { return OffReader(file).run(); }

}  // namespace palpate::mesh_io
