#include "io/scene/support_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string_view>

#include <fmt/core.h>

#include "core/base/index.h"
#include "core/base/text.h"
#include "io/mesh_io/formats/ply_vertices.h"
#include "io/mesh_io/mesh_file.h"
#include "io/scene/scene_keys.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::scene {
namespace {

constexpr Range kCoordinate{-1e6, 1e6};  // mm, or of a direction
constexpr const char* kForms =
    "must be bed:X,Y,Z or bed:X,Y,Z,SHARE (a direction), faces:X,Y,Z (a direction), at:X,Y,Z,RADIUS (mm), "
    "painted:FILE (PLY) or none";

Vec3 required_direction(const TomlTable& table, const char* key, const std::string& what) {
  const std::optional<Vec3> given = table.vector(key, kCoordinate);
  if (!given) table.fail_missing(key, what);
  if (given->norm() < 1e-9) table.fail(key, "must be a direction, not zero");
  return *given;
}

// The numbers of a flag after its colon.
std::vector<double> numbers_of(const std::string& flag, std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    const std::string_view word = text.substr(0, comma);
    const std::optional<double> value = parse_number(word);
    if (!value || !std::isfinite(*value))
      throw InputError(fmt::format("--organ-support = \"{}\": {}", flag, kForms));
    numbers.push_back(*value);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

std::string rounded(double value, double unit) {
  return shortest(std::round(1e6 * value / unit) / 1e6 + 0.0);
}

std::string listed(const Vec3& v, double unit, const char* between) {
  return rounded(v.x(), unit) + between + rounded(v.y(), unit) + between + rounded(v.z(), unit);
}

void add_flag(const std::string& flag, LocatedSupport& made) {
  geometry::Support& support = made.support;
  const std::size_t colon = flag.find(':');
  const auto refuse = [&flag](const std::string& want) {
    throw InputError(fmt::format("--organ-support = \"{}\": {}", flag, want));
  };
  if (colon == std::string::npos) refuse(kForms);
  const std::string kind = flag.substr(0, colon);
  if (kind == "painted") {
    if (!made.painted.empty()) refuse("there is a painted mesh already, must be at most one");
    if (colon + 1 == flag.size()) refuse("has no file, must be painted:FILE");
    made.painted = to_path(flag.substr(colon + 1));
    return;
  }
  const std::vector<double> n = numbers_of(flag, std::string_view(flag).substr(colon + 1));
  if (n.size() < 3) refuse(kForms);
  const Vec3 first(n[0], n[1], n[2]);
  if (kind == "bed" && n.size() <= 4) {
    if (support.bed) refuse("there is a bed already, must be at most one");
    support.bed = geometry::Bed{first, n.size() == 4 ? n[3] : geometry::kDefaultBedShare};
  } else if (kind == "faces" && n.size() == 3) {
    if (support.faces) refuse("there are faces already, must be at most once");
    support.faces = geometry::HeldFaces{first};
  } else if (kind == "at" && n.size() == 4) {
    support.attachments.push_back({first * kMillimetre, n[3] * kMillimetre});
  } else {
    refuse(kForms);
  }
}

// Vertices that are painted red.
std::vector<bool> red_vertices(const mesh_io::MeshFile& file) {
  constexpr std::array<std::string_view, 3> kColours{"red", "green", "blue"};
  const mesh_io::PlyVertices vertices = mesh_io::read_ply_vertices(file, kColours);
  std::array<std::vector<double>, 3> shares;  // 0 to 1
  for (std::size_t c = 0; c < 3; ++c) {
    const mesh_io::PlyProperty* const colour = vertices.find(kColours[c]);
    const auto type = colour != nullptr ? colour->type : mesh_io::NumberType::kUint8;
    const bool whole = type == mesh_io::NumberType::kUint8;
    if (colour == nullptr ||
        (!whole && type != mesh_io::NumberType::kFloat && type != mesh_io::NumberType::kDouble))
      throw InputError(fmt::format(
          "{}: element vertex must have the colours red, green and blue, uchar or float from 0 to 1",
          to_text(file.path)));
    for (const double value : colour->values) shares[c].push_back(whole ? value / 255.0 : value);
  }
  std::vector<bool> red;
  for (std::size_t v = 0; v < vertices.points.size(); ++v)
    red.push_back(shares[0][v] >= 0.5 && shares[0][v] >= 2.0 * std::max(shares[1][v], shares[2][v]));
  return red;
}

// @param scale metres per unit of the file
std::vector<geometry::Attachment> painted_places(const std::filesystem::path& path, double scale) {
  constexpr double kNearest = 1e-3;     // m, edge of the cells that keep one place each
  constexpr double kLeastRadius = 1.5;  // of such a cell
  constexpr double kOfEdge = 0.6;       // covers triangles of three red vertices
  if (mesh_io::mesh_format(path) != mesh_io::MeshFormat::kPly)
    throw InputError(to_text(path) + ": must be a PLY file with vertex colours");
  const mesh_io::MeshFile file = mesh_io::open_mesh_file(path);
  const geometry::TriangleMesh mesh = mesh_io::import_mesh(file).mesh;
  const std::vector<bool> red = red_vertices(file);
  if (mesh.triangles.empty() || red.size() != mesh.vertices.size())
    throw InputError(to_text(path) + ": must be a surface with faces and a colour for every vertex");
  std::vector<double> longest(red.size(), 0.0);  // edge at each vertex [m]
  for (const geometry::Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = at(t[k]);
      const std::size_t b = at(t[(k + 1) % 3]);
      const double edge = scale * (mesh.vertices[a] - mesh.vertices[b]).norm();
      longest[a] = std::max(longest[a], edge);
      longest[b] = std::max(longest[b], edge);
    }
  }
  std::vector<geometry::Attachment> places;
  for (double cell = kNearest; places.empty() || places.size() > geometry::kMaxPainted; cell *= 2.0) {
    std::map<std::array<std::int64_t, 3>, geometry::Attachment> kept;
    for (std::size_t v = 0; v < red.size(); ++v) {
      if (!red[v]) continue;
      const Vec3 point = scale * mesh.vertices[v];
      std::array<std::int64_t, 3> key{};
      for (std::size_t k = 0; k < 3; ++k)
        key[k] = static_cast<std::int64_t>(
            std::clamp(std::floor(point[static_cast<Eigen::Index>(k)] / cell), -1e15, 1e15));
      geometry::Attachment& place = kept.try_emplace(key, geometry::Attachment{point, 0.0}).first->second;
      place.radius = std::max({place.radius, kOfEdge * longest[v], kLeastRadius * cell});
    }
    if (kept.empty())
      throw InputError(
          to_text(path) +
          ": has no red vertex: red must be at least half of the full value and twice as much as "
          "green and blue");
    places.clear();
    for (const auto& [key, place] : kept) places.push_back(place);
  }
  return places;
}

}  // namespace

std::optional<LocatedSupport> read_support(const TomlTable& organ, const std::filesystem::path& folder) {
  const std::optional<TomlTable> table = organ.table("support");
  if (!table) return std::nullopt;
  table->allow_only({"bed", "faces", "attachment", "painted"});
  LocatedSupport made;
  made.where = table->location("") + ": organ.support";
  if (const std::optional<TomlTable> bed = table->table("bed")) {
    bed->allow_only(keys_in("organ.support.bed", {"direction"}));
    made.support.bed = geometry::Bed{
        required_direction(*bed, "direction", "a bed needs the direction from the organ towards it"),
        number_in(*bed, "share").value_or(geometry::kDefaultBedShare)};
  }
  if (const std::optional<TomlTable> faces = table->table("faces")) {
    faces->allow_only({"away_from"});
    made.support.faces = geometry::HeldFaces{
        required_direction(*faces, "away_from", "held faces need the direction that they look away from")};
  }
  for (const TomlTable& one : table->tables("attachment")) {
    one.allow_only(keys_in("organ.support.attachment", {"point_mm"}));
    const std::optional<Vec3> point = one.vector("point_mm", kCoordinate);
    if (!point) one.fail_missing("point_mm", "an attachment needs its point");
    const std::optional<double> radius = number_in(one, "radius_mm");
    if (!radius) one.fail_missing("radius_mm", "an attachment needs its radius");
    made.support.attachments.push_back({*point * kMillimetre, *radius * kMillimetre});
  }
  if (const std::optional<std::string> file = table->text("painted")) made.painted = folder / to_path(*file);
  if (made.support.empty() && made.painted.empty())
    throw InputError(made.where +
                     ": is empty, must have a bed, faces, an attachment or a painted mesh (docs/support.md)");
  return made;
}

std::optional<LocatedSupport> support_by_flags(const std::vector<std::string>& flags) {
  LocatedSupport made;
  made.where = "--organ-support";
  for (const std::string& flag : flags)
    if (flag != "none") add_flag(flag, made);
  if (made.support.empty() && made.painted.empty()) return std::nullopt;
  return made;
}

std::vector<std::string> support_flags(const geometry::Support& support) {
  std::vector<std::string> flags;
  if (support.bed)
    flags.push_back("bed:" + listed(support.bed->direction, 1.0, ",") + "," + shortest(support.bed->share));
  if (support.faces) flags.push_back("faces:" + listed(support.faces->away_from, 1.0, ","));
  for (const geometry::Attachment& a : support.attachments)
    flags.push_back("at:" + listed(a.point, kMillimetre, ",") + "," + rounded(a.radius, kMillimetre));
  return flags;
}

std::string support_toml(const geometry::Support& support) {
  std::string text = "[organ.support]\n";
  if (support.bed)
    text += fmt::format("bed = {{ direction = [{}], share = {} }}\n",
                        listed(support.bed->direction, 1.0, ", "), shortest(support.bed->share));
  if (support.faces)
    text += fmt::format("faces = {{ away_from = [{}] }}\n", listed(support.faces->away_from, 1.0, ", "));
  if (!support.painted.empty()) text += "# and painted = \"...\", the file that the scene had\n";
  for (const geometry::Attachment& a : support.attachments)
    text += fmt::format("[[organ.support.attachment]]\npoint_mm = [{}]\nradius_mm = {}\n",
                        listed(a.point, kMillimetre, ", "), rounded(a.radius, kMillimetre));
  return text;
}

std::vector<std::string> support_phrases(const geometry::Support& support) {
  const auto triple = [](const Vec3& v, double unit, double digits) {
    const auto number = [unit, digits](double x) {
      return shortest(std::round(digits * x / unit) / digits + 0.0);
    };
    return fmt::format("({}, {}, {})", number(v.x()), number(v.y()), number(v.z()));
  };
  std::vector<std::string> phrases;
  if (support.bed) {
    phrases.push_back(fmt::format("a bed towards {}, {} % of the extent",
                                  triple(support.bed->direction, 1.0, 1e3),
                                  shortest(std::round(1e3 * support.bed->share) / 10.0)));
  }
  if (support.faces) phrases.push_back("all faces away from " + triple(support.faces->away_from, 1.0, 1e3));
  for (const geometry::Attachment& a : support.attachments) {
    phrases.push_back(fmt::format("the surface within {} mm of {} mm", shortest(a.radius / kMillimetre),
                                  triple(a.point, kMillimetre, 10.0)));
  }
  if (!support.painted.empty())
    phrases.push_back(fmt::format("the surface at {} painted places", support.painted.size()));
  return phrases;
}

void read_painted(LocatedSupport& stated, LengthUnit unit) {
  if (stated.painted.empty()) return;
  try {
    stated.support.painted = painted_places(stated.painted, metres_per(unit));
  } catch (const InputError& error) {
    throw InputError(stated.where + ": painted: " + error.what());
  }
}

void check_support(const LocatedSupport& stated, const geometry::TriangleMesh& organ) {
  try {
    geometry::check_support(stated.support, organ);
  } catch (const InputError& error) {
    throw InputError(stated.where + ": " + error.what());
  }
}

}  // namespace palpate::scene
