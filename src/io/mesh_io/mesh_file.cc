#include "io/mesh_io/mesh_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/mesh_io/gltf_check.h"
#include "io/mesh_io/ply_check.h"
#include "io/mesh_io/text_scan.h"
#include "io/system/input_file.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr std::array<std::pair<std::string_view, MeshFormat>, 8> kEndings{{{".stl", MeshFormat::kStl},
                                                                           {".obj", MeshFormat::kObj},
                                                                           {".ply", MeshFormat::kPly},
                                                                           {".off", MeshFormat::kOff},
                                                                           {".3ds", MeshFormat::k3ds},
                                                                           {".gltf", MeshFormat::kGltf},
                                                                           {".glb", MeshFormat::kGlb},
                                                                           {".vtk", MeshFormat::kVtk}}};

MeshFormat format_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const auto& [known, format] : kEndings) {
    if (ending == known) return format;
  }
  throw InputError(path.string() + ": unknown ending \"" + ending +
                   "\": must be .stl, .obj, .ply, .off, .3ds, .gltf, .glb or .vtk");
}

std::uint32_t little_endian_32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void check_ascii_stl(const MeshFile& file) {
  std::size_t facets = 0;
  std::size_t vertices = 0;
  std::size_t closed_facets = 0;
  bool ends = false;
  LineReader lines(file.bytes);
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view word = next_word(rest);
    if (word == "vertex") {
      ++vertices;
      (void)read_point(rest, fmt::format("{}, line {}", file.path.string(), lines.number()), vertices);
    }
    facets += word == "facet" ? 1 : 0;
    closed_facets += word == "endfacet" ? 1 : 0;
    if (!word.empty()) ends = word == "endsolid";
  }
  if (facets == 0) throw InputError(file.path.string() + ": no triangles");
  if (closed_facets != facets || !ends) {
    throw InputError(fmt::format("{}: truncated: {} facets begun, {} ended{}", file.path.string(), facets,
                                 closed_facets, ends ? "" : ", and no endsolid at the end"));
  }
  if (vertices != 3 * facets) {
    throw InputError(fmt::format("{}: {} facets have {} vertices: must be three each", file.path.string(),
                                 facets, vertices));
  }
}

/// Binary by its size, since many a binary file starts with "solid"; then ASCII by its first word.
void check_stl(const MeshFile& file) {
  constexpr std::size_t kHeader = 84;
  constexpr std::size_t kTriangle = 50;
  const std::string& bytes = file.bytes;
  std::size_t declared = 0;
  if (bytes.size() >= kHeader) {
    declared = little_endian_32(bytes, 80);
    if (bytes.size() == kHeader + kTriangle * declared) {
      if (declared == 0) throw InputError(file.path.string() + ": no triangles");
      return;
    }
  }
  std::string_view start(bytes);
  const bool is_text = bytes.find('\0') == std::string::npos;
  if (is_text && next_word(start) == "solid") return check_ascii_stl(file);
  if (bytes.size() < kHeader) {
    throw InputError(fmt::format("{}: truncated: a binary STL has at least 84 bytes, this has {}",
                                 file.path.string(), bytes.size()));
  }
  throw InputError(
      fmt::format("{}: truncated or damaged: a binary STL of {} triangles has {} bytes, this has {}",
                  file.path.string(), declared, kHeader + kTriangle * declared, bytes.size()));
}

/// Reads the vertices and faces of an OBJ file and writes them anew, in plain numbers and indices from 1:
/// what else such a file may hold (textures, normals, materials, groups) is nothing to a mesh and much to go
/// wrong.
class ObjCheck final {
 public:
  explicit ObjCheck(const MeshFile& file) : file_(file) {}

  FileFacts run() {
    LineReader lines(file_.bytes, /*join_backslash=*/true);
    while (lines.next()) {
      line_ = lines.number();
      std::string_view rest = lines.line();
      const std::string_view word = next_word(rest);
      if (word == "v") {
        take_vertex(rest);
      } else if (word == "f") {
        take_face(rest);
      } else if (word == "l" || word == "p" || word == "curv") {
        ++left_out_;
      }
    }
    if (largest_ > static_cast<std::int64_t>(points_.count)) {
      line_ = largest_line_;
      refuse(largest_);
    }
    FileFacts facts = points_.facts();
    facts.cleaned = std::move(vertices_) + faces_;
    facts.lines = left_out_;
    return facts;
  }

 private:
  [[nodiscard]] std::string where() const { return fmt::format("{}, line {}", file_.path.string(), line_); }

  [[noreturn]] void refuse(std::int64_t index) const {
    throw InputError(
        fmt::format("{}: vertex index {} is out of range: the file has {} vertices, the first is 1", where(),
                    index, points_.count));
  }

  void take_vertex(std::string_view rest) {
    ++points_.count;
    const Point point = read_point(rest, where(), points_.count);
    points_.add(point);
    vertices_ += 'v';
    for (const float x : point) {
      std::array<char, 32> digits{};
      const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), x);
      vertices_ += ' ';
      vertices_.append(digits.data(), written.ptr);
    }
    vertices_ += '\n';
  }

  /// Indices count from 1, or backwards from the last vertex when negative; later vertices may be named too.
  void take_face(std::string_view rest) {
    std::string face = "f";
    std::size_t corners = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      if (word.front() == '#') break;
      const std::string_view index_word = word.substr(0, word.find('/'));
      const std::optional<std::int64_t> index = whole_number(index_word);
      if (!index) throw InputError(fmt::format("{}: \"{}\" is not a vertex index", where(), index_word));
      if (*index == 0 || *index < -static_cast<std::int64_t>(points_.count)) refuse(*index);
      const std::int64_t absolute =
          *index > 0 ? *index : static_cast<std::int64_t>(points_.count) + 1 + *index;
      if (absolute > largest_) {
        largest_ = absolute;
        largest_line_ = line_;
      }
      face += ' ' + std::to_string(absolute);
      ++corners;
    }
    polygons_.take(corners, where());
    if (corners < 3) {
      ++left_out_;
    } else {
      faces_ += face + '\n';
    }
  }

  const MeshFile& file_;
  PointSet points_;
  PolygonBudget polygons_;
  std::string vertices_;
  std::string faces_;
  std::size_t line_ = 0;
  std::size_t left_out_ = 0;
  std::int64_t largest_ = 0;
  std::size_t largest_line_ = 0;
};

class OffCheck final {
 public:
  explicit OffCheck(const MeshFile& file) : file_(file), lines_(file.bytes) {}

  FileFacts run() {
    std::string_view header = next_content();
    std::string_view rest = header;
    const std::string_view word = next_word(rest);
    const bool has_name = word.size() >= 3 && word.substr(word.size() - 3) == "OFF";
    if (!has_name) refuse("starts with \"" + std::string(word.substr(0, 20)) + "\": must be OFF");
    if (rest.find("BINARY") != std::string_view::npos) refuse("binary OFF is not read: save it as text");
    if (word.find('4') != std::string_view::npos || word.find('n') != std::string_view::npos) {
      refuse("\"" + std::string(word) + "\" is not a surface in three dimensions");
    }
    if (trimmed(rest).empty()) rest = next_content();
    const std::size_t vertices = count_of(rest, "vertices");
    const std::size_t faces = count_of(rest, "faces");
    for (std::size_t v = 1; v <= vertices; ++v) {
      const std::string_view content = next_content();
      const Point point = read_point(content, where(), v);
      points_.add(point);
      text_.add_point(point);
    }
    points_.count = vertices;
    for (std::size_t f = 0; f < faces; ++f) check_face(vertices);
    FileFacts facts = points_.facts();
    facts.cleaned = text_.take();
    return facts;
  }

 private:
  [[nodiscard]] std::string where() const {
    return fmt::format("{}, line {}", file_.path.string(), lines_.number());
  }
  [[noreturn]] void refuse(const std::string& words) const { throw InputError(where() + ": " + words); }

  /// The next line that holds something besides a comment.
  std::string_view next_content() {
    while (lines_.next()) {
      const std::string_view content = trimmed(lines_.line().substr(0, lines_.line().find('#')));
      if (!content.empty()) return content;
    }
    refuse("truncated: fewer lines than the vertices and faces that it declares");
  }

  std::size_t count_of(std::string_view& rest, const char* what) const {
    const std::string_view word = next_word(rest);
    const std::optional<std::int64_t> count = whole_number(word);
    if (!count || *count < 0) refuse(fmt::format("\"{}\" is not a number of {}", word, what));
    // The shortest vertex or face takes four bytes.
    if (static_cast<std::uint64_t>(*count) > file_.bytes.size() / 4) {
      refuse(
          fmt::format("declares {} {}, more than its {} bytes can hold", *count, what, file_.bytes.size()));
    }
    return static_cast<std::size_t>(*count);
  }

  void check_face(std::size_t vertices) {
    std::string_view rest = next_content();
    const std::optional<std::int64_t> corners = whole_number(next_word(rest));
    if (!corners || *corners < 0) refuse("a face must start with its number of corners");
    polygons_.take(static_cast<std::size_t>(*corners), where());
    for (std::int64_t k = 0; k < *corners; ++k) {
      const std::string_view word = next_word(rest);
      const std::optional<std::int64_t> index = whole_number(word);
      if (!index) {
        refuse(fmt::format("a face of {} corners has \"{}\" for vertex index {}", *corners, word, k + 1));
      }
      if (*index < 0 || static_cast<std::uint64_t>(*index) >= vertices) {
        refuse(fmt::format("vertex index {} is out of range: the file has {} vertices, the first is 0",
                           *index, vertices));
      }
      text_.add_corner(static_cast<std::uint64_t>(*index));
    }
    text_.end_face();
  }

  const MeshFile& file_;
  LineReader lines_;
  PointSet points_;
  ObjText text_;
  PolygonBudget polygons_;
};

/// Calls visit(id, begin, end) for each chunk between two bytes of a 3DS file. A chunk that is longer than
/// what is left of the one around it is refused: the importer would read it to its end, and only then give
/// up.
template <typename Visit>
void each_3ds_chunk(const MeshFile& file, std::size_t begin, std::size_t end, const Visit& visit) {
  constexpr std::size_t kHead = 6;
  while (begin + kHead <= end) {
    const std::size_t length = little_endian_32(file.bytes, begin + 2);
    if (length < kHead || length > end - begin) {
      throw InputError(fmt::format(
          "{}, byte {}: a chunk declares {} bytes, must be 6 to {}, which are left of the one around it",
          file.path.string(), begin, length, end - begin));
    }
    const auto low = static_cast<unsigned char>(file.bytes[begin]);
    const auto high = static_cast<unsigned char>(file.bytes[begin + 1]);
    visit(256U * high + low, begin + kHead, begin + length);
    begin += length;
  }
}

/// The importer believes how many keys a track declares.
void check_3ds_track(const MeshFile& file, std::size_t begin, std::size_t end) {
  constexpr std::size_t kBeforeCount = 10;  // flags and what is not used
  constexpr std::size_t kLeastKey = 6;      // bytes
  const std::string where = fmt::format("{}, byte {}: a track of key frames ", file.path.string(), begin);
  if (end - begin < kBeforeCount + 4) throw InputError(where + "is too short");
  const std::size_t keys = little_endian_32(file.bytes, begin + kBeforeCount);
  if (keys > (end - begin) / kLeastKey) {
    throw InputError(fmt::format("{}declares {} keys in {} bytes", where, keys, end - begin));
  }
}

/// The tracks of every node of the key frames.
void check_3ds_key_frames(const MeshFile& file, std::size_t begin, std::size_t end) {
  constexpr unsigned kFirstNode = 0xB001;
  constexpr unsigned kLastNode = 0xB007;
  constexpr unsigned kFirstTrack = 0xB020;
  constexpr unsigned kLastTrack = 0xB029;
  each_3ds_chunk(file, begin, end, [&](unsigned node, std::size_t node_begin, std::size_t node_end) {
    if (node < kFirstNode || node > kLastNode) return;
    each_3ds_chunk(file, node_begin, node_end, [&](unsigned id, std::size_t from, std::size_t to) {
      if (id >= kFirstTrack && id <= kLastTrack) check_3ds_track(file, from, to);
    });
  });
}

void check_3ds(const MeshFile& file) {
  const std::string& bytes = file.bytes;
  if (bytes.size() < 6 || bytes.compare(0, 2, "MM") != 0) {
    throw InputError(file.path.string() + ": not a 3DS file: must start with the chunk 4D4D");
  }
  const std::size_t declared = little_endian_32(bytes, 2);
  if (declared > bytes.size()) {
    throw InputError(
        fmt::format("{}: truncated: declares {} bytes, has {}", file.path.string(), declared, bytes.size()));
  }
  constexpr unsigned kMain = 0x4D4D;
  constexpr unsigned kProject = 0xC23D;
  constexpr unsigned kKeyFrames = 0xB000;
  each_3ds_chunk(file, 0, bytes.size(), [&](unsigned whole, std::size_t whole_begin, std::size_t whole_end) {
    if (whole != kMain && whole != kProject) return;
    each_3ds_chunk(file, whole_begin, whole_end, [&](unsigned id, std::size_t begin, std::size_t end) {
      if (id == kKeyFrames) check_3ds_key_frames(file, begin, end);
    });
  });
}

}  // namespace

MeshFile open_mesh_file(const std::filesystem::path& path) {
  InputFile input(path, kMeshInput);
  MeshFile file{path, format_of(path), input.read_rest()};
  if (file.bytes.empty()) throw InputError(path.string() + ": empty");
  return file;
}

FileFacts check_mesh_file(const MeshFile& file) {
  switch (file.format) {
    case MeshFormat::kStl:
      check_stl(file);
      return {};
    case MeshFormat::kObj:
      return ObjCheck(file).run();
    case MeshFormat::kPly:
      return check_ply(file);
    case MeshFormat::kOff:
      return OffCheck(file).run();
    case MeshFormat::k3ds:
      check_3ds(file);
      return {};
    case MeshFormat::kGlb:
    case MeshFormat::kGltf:
      check_gltf(file);
      return {};
    case MeshFormat::kVtk:  // its own reader checks as it goes
      return {};
  }
  return {};
}

}  // namespace palpate::geometry
