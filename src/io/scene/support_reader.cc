#include "io/scene/support_reader.h"

#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/scene_keys.h"
#include "palpate/error.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

constexpr Range kCoordinate{-1e6, 1e6};  // mm, or of a direction
constexpr const char* kForms =
    "must be bed:X,Y,Z or bed:X,Y,Z,SHARE (a direction), faces:X,Y,Z (a direction), at:X,Y,Z,RADIUS (mm) or "
    "none";

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

void add_flag(const std::string& flag, geometry::Support& support) {
  const std::size_t colon = flag.find(':');
  const auto refuse = [&flag](const std::string& want) {
    throw InputError(fmt::format("--organ-support = \"{}\": {}", flag, want));
  };
  if (colon == std::string::npos) refuse(kForms);
  const std::string kind = flag.substr(0, colon);
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

}  // namespace

std::optional<LocatedSupport> read_support(const TomlTable& organ) {
  const std::optional<TomlTable> table = organ.table("support");
  if (!table) return std::nullopt;
  table->allow_only({"bed", "faces", "attachment"});
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
  if (made.support.empty())
    throw InputError(made.where + ": is empty, must have a bed, faces or an attachment (docs/support.md)");
  return made;
}

std::optional<LocatedSupport> support_by_flags(const std::vector<std::string>& flags) {
  LocatedSupport made;
  made.where = "--organ-support";
  for (const std::string& flag : flags)
    if (flag != "none") add_flag(flag, made.support);
  if (made.support.empty()) return std::nullopt;
  return made;
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
  return phrases;
}

void check_support(const LocatedSupport& stated, const geometry::TriangleMesh& organ) {
  try {
    geometry::check_support(stated.support, organ);
  } catch (const InputError& error) {
    throw InputError(stated.where + ": " + error.what());
  }
}

}  // namespace palpate::scene
