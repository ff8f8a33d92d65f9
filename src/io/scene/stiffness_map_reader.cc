#include "io/scene/stiffness_map_reader.h"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/core.h>

#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/mesh_io/formats/ply_vertices.h"
#include "io/system/csv_table.h"
#include "io/system/path_text.h"
#include "palpate/error.h"

namespace palpate::scene {
namespace {

using mesh_io::PlyProperty;
using mesh_io::PlyVertices;

StiffnessMapFile read_csv(const std::filesystem::path& file) {
  enum Column : std::size_t { kX, kY, kZ, kFactor };
  CsvTable table(file, {{"x_mm"}, {"y_mm"}, {"z_mm"}, {"factor"}});
  StiffnessMapFile map;
  while (table.next_row()) {
    map.points.push_back(
        {Vec3(table.number(kX), table.number(kY), table.number(kZ)) * kMillimetre, table.number(kFactor)});
    try {
      model::validate(map.points.back());
    } catch (const ParameterError& error) {
      table.fail(error.what());
    }
    if (map.points.size() > model::kMaxStiffnessPoints) {
      table.fail(fmt::format("a stiffness map has at most {} points", model::kMaxStiffnessPoints));
    }
  }
  map.count = map.points.size();
  return map;
}

void require_no_factors(const std::filesystem::path& file, const StiffnessMapOptions& options) {
  if (!options.factor_at_black && !options.factor_at_white) return;
  throw InputError(fmt::format("{}: has factors, not colours: leave out {}", to_text(file),
                               options.factor_at_black ? "factor_at_black" : "factor_at_white"));
}

/// The factor of a vertex, from its property `factor` or `quality`, or from its colours.
class VertexFactor final {
 public:
  VertexFactor(const std::filesystem::path& file, const PlyVertices& vertices,
               const StiffnessMapOptions& options) {
    for (const char* name : {"factor", "quality"}) {
      if (scalar_ == nullptr) scalar_ = vertices.find(name);
    }
    if (scalar_ != nullptr) {
      require_no_factors(file, options);
      return;
    }
    const std::array<const char*, 3> names{"red", "green", "blue"};
    for (std::size_t c = 0; c < 3; ++c) {
      colours_[c] = vertices.find(names[c]);
      if (colours_[c] == nullptr) {
        throw InputError(to_text(file) +
                         ": element vertex must have the property factor or quality, or the colours red, "
                         "green and blue");
      }
      using enum mesh_io::NumberType;
      const mesh_io::NumberType type = colours_[c]->type;
      if (type != kUint8 && type != kFloat && type != kDouble) {
        throw InputError(
            fmt::format("{}: property {} must be uchar, or float from 0 to 1", to_text(file), names[c]));
      }
    }
    if (!options.factor_at_black || !options.factor_at_white) {
      throw InputError(
          fmt::format("{}: has colours: needs factor_at_black and factor_at_white", to_text(file)));
    }
    black_ = *options.factor_at_black;
    white_ = *options.factor_at_white;
  }

  /// @throws ParameterError
  [[nodiscard]] double operator()(std::size_t vertex) const {
    if (scalar_ != nullptr) return scalar_->values[vertex];
    double brightness = 0.0;
    for (const PlyProperty* colour : colours_) {
      const double most = colour->type == mesh_io::NumberType::kUint8 ? 255.0 : 1.0;
      const double value = colour->values[vertex];
      if (!(value >= 0.0 && value <= most)) {
        throw ParameterError(colour->name, value, "a number >= 0 and <= " + shortest(most));
      }
      brightness += value / most / 3.0;
    }
    const double black = portable::log(black_);
    const double factor = portable::exp(black + brightness * (portable::log(white_) - black));
    return std::clamp(factor, std::min(black_, white_), std::max(black_, white_));  // against rounding
  }
  [[nodiscard]] std::string field() const { return scalar_ != nullptr ? scalar_->name : "factor"; }

 private:
  const PlyProperty* scalar_ = nullptr;
  std::array<const PlyProperty*, 3> colours_{};
  double black_ = 1.0;
  double white_ = 1.0;
};

StiffnessMapFile read_ply(const std::filesystem::path& file, const StiffnessMapOptions& options) {
  constexpr std::array<std::string_view, 5> kWanted{"factor", "quality", "red", "green", "blue"};
  const PlyVertices vertices = mesh_io::read_ply_vertices(mesh_io::open_mesh_file(file), kWanted);
  const VertexFactor factor_of(file, vertices, options);
  StiffnessMapFile map;
  map.item = "vertex";
  map.count = vertices.points.size();
  if (map.count == 0) throw InputError(to_text(file) + ": has no vertices");
  for (std::size_t v = 0; v < map.count; ++v) {
    try {
      map.points.push_back({vertices.points[v] * metres_per(options.unit), factor_of(v)});
      model::validate(map.points.back(), factor_of.field());
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: vertex {}: {}", to_text(file), v + 1, error.what()));
    }
  }
  if (map.count <= model::kMaxStiffnessPoints) return map;
  for (std::size_t i = 0; i < model::kMaxStiffnessPoints; ++i) {
    map.points[i] = map.points[i * map.count / model::kMaxStiffnessPoints];
  }
  map.points.resize(model::kMaxStiffnessPoints);
  map.remarks.push_back(fmt::format("{}: of its {} vertices, {} at even steps are used for the stiffness map",
                                    to_text(file), map.count, map.points.size()));
  return map;
}

}  // namespace

std::string StiffnessMapFile::name_of(std::size_t point) const {
  return item + ' ' + std::to_string(point * count / points.size() + 1);
}

StiffnessMapFile read_stiffness_map(const std::filesystem::path& file, const StiffnessMapOptions& options) {
  if (mesh_io::mesh_format(file) == mesh_io::MeshFormat::kPly) return read_ply(file, options);
  StiffnessMapFile map = read_csv(file);
  require_no_factors(file, options);
  return map;
}

}  // namespace palpate::scene
