#include "bench/measure/bench_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include <malloc.h>

#include "core/base/portable_math.h"
#include "io/scene/make_world.h"
#include "io/scene/minimum_jerk.h"
#include "io/system/clock.h"

namespace palpate::bench {
namespace {

constexpr double kCurvedShare = 0.75;  // shape factor of Phong tessellation, as the paper recommends

// Approach before and after the scene's own path, and the oscillation.
constexpr double kAside = 20e-3;      // m, from the start of the scene's path
constexpr double kAbove = 10e-3;      // m
constexpr double kWay = 2.8;          // s, at 15 mm/s at most
constexpr double kRowSpacing = 5e-3;  // s
constexpr double kSway = 0.5e-3;      // m
constexpr double kTilt = 0.012;       // rad
// Oscillations per path: whole numbers, so that it ends as it begins; about 1 and 0.7 per second.
constexpr double kSwaysAcross = 13.0;
constexpr double kSwaysAlong = 9.0;

std::vector<Vec3> vertex_normals(const geometry::TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const geometry::Triangle& triangle : mesh.triangles) {
    const Vec3 area = geometry::area_vector_doubled(mesh, triangle);
    for (const std::int32_t corner : triangle) normals[static_cast<std::size_t>(corner)] += area;
  }
  for (Vec3& normal : normals) {
    const double length = normal.norm();
    if (length > 0.0) normal /= length;
  }
  return normals;
}

/// Divides the triangles of a mesh; vertices on an edge are shared by its triangles.
class Tessellation final {
 public:
  Tessellation(const geometry::TriangleMesh& coarse, int parts, Shape shape)
      : coarse_(coarse), parts_(parts), shape_(shape), normals_(vertex_normals(coarse)) {
    fine_.vertices = coarse.vertices;
  }

  geometry::TriangleMesh run() {
    for (const geometry::Triangle& triangle : coarse_.triangles) divide(triangle);
    return std::move(fine_);
  }

 private:
  using Steps = std::array<int, 3>;  // barycentric coordinates in steps of 1 / parts

  /// Grid point with weight `steps[k]` / `parts_` of corner k.
  [[nodiscard]] Vec3 point(const geometry::Triangle& corners, const Steps& steps) const {
    Vec3 flat = Vec3::Zero();
    std::array<double, 3> weight{};
    for (std::size_t k = 0; k < 3; ++k) {
      weight[k] = static_cast<double>(steps[k]) / parts_;
      flat += weight[k] * coarse_.vertices[static_cast<std::size_t>(corners[k])];
    }
    if (shape_ == Shape::kFlat) return flat;
    Vec3 curved = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::size_t>(corners[k]);
      const Vec3& normal = normals_[corner];
      curved += weight[k] * (flat - (flat - coarse_.vertices[corner]).dot(normal) * normal);
    }
    return (1.0 - kCurvedShare) * flat + kCurvedShare * curved;
  }

  std::int32_t add(const Vec3& vertex) {
    fine_.vertices.push_back(vertex);
    return static_cast<std::int32_t>(fine_.vertices.size() - 1);
  }

  /// The vertex `step` steps from a to b.
  std::int32_t on_edge(std::int32_t a, std::int32_t b, int step) {
    if (a > b) {
      std::swap(a, b);
      step = parts_ - step;
    }
    const auto [entry, is_new] = edges_.try_emplace({a, b}, static_cast<std::int32_t>(fine_.vertices.size()));
    if (is_new) {
      for (int i = 1; i < parts_; ++i) add(point({a, b, a}, {parts_ - i, i, 0}));
    }
    return entry->second + step - 1;
  }

  std::int32_t vertex_at(const geometry::Triangle& corners, const Steps& steps) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const std::size_t last = (k + 2) % 3;
      if (steps[k] == parts_) return corners[k];
      if (steps[last] == 0 && steps[k] > 0 && steps[next] > 0)
        return on_edge(corners[k], corners[next], steps[next]);
    }
    return add(point(corners, steps));
  }

  void divide(const geometry::Triangle& corners) {
    rows_.assign(static_cast<std::size_t>(parts_) + 1, {});
    for (int i = 0; i <= parts_; ++i) {
      for (int j = 0; j <= i; ++j)
        rows_[static_cast<std::size_t>(i)].push_back(vertex_at(corners, {parts_ - i, i - j, j}));
    }
    for (std::size_t i = 0; i + 1 < rows_.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        fine_.triangles.push_back({rows_[i][j], rows_[i + 1][j], rows_[i + 1][j + 1]});
        if (j < i) fine_.triangles.push_back({rows_[i][j], rows_[i + 1][j + 1], rows_[i][j + 1]});
      }
    }
  }

  const geometry::TriangleMesh& coarse_;
  int parts_;
  Shape shape_;
  std::vector<Vec3> normals_;
  geometry::TriangleMesh fine_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> edges_;  // first vertex of each edge
  std::vector<std::vector<std::int32_t>> rows_;
};

}  // namespace

geometry::TriangleMesh tessellate(const geometry::TriangleMesh& mesh, int parts, Shape shape) {
  if (parts < 1) throw std::invalid_argument("tessellate: " + std::to_string(parts) + " parts, want >= 1");
  if (parts == 1) return mesh;
  return Tessellation(mesh, parts, shape).run();
}

int parts_for(std::size_t triangles, std::size_t wanted) noexcept {
  if (triangles == 0) return 1;
  const double ratio = static_cast<double>(wanted) / static_cast<double>(triangles);
  return std::max(1, static_cast<int>(std::lround(std::sqrt(ratio))));
}

std::size_t triangle_count(const geometry::Tool& tool) noexcept {
  std::size_t count = 0;
  for (const geometry::ToolPart& part : tool.parts) count += part.mesh.triangles.size();
  return count;
}

scene::Scene bench_scene(const std::string& task, std::size_t organ_triangles, std::size_t tool_triangles) {
  scene::Overrides request;
  request.task = task;
  scene::Scene scene = scene::load(request);
  if (organ_triangles > 0) {
    scene.organ =
        tessellate(scene.organ, parts_for(scene.organ.triangles.size(), organ_triangles), Shape::kCurved);
  }
  if (tool_triangles > 0) {
    const int parts = parts_for(triangle_count(scene.tools[0]), tool_triangles);
    for (geometry::ToolPart& part : scene.tools[0].parts)
      part.mesh = tessellate(part.mesh, parts, Shape::kFlat);
  }
  return scene;
}

scene::ToolPath hand_path(const scene::Scene& scene) {
  const scene::ToolPath own = scene::default_path(scene, 0);
  std::vector<scene::PathRow> rows;
  const int steps = static_cast<int>(std::lround(kWay / kRowSpacing));
  const auto add_way = [&](const scene::PathRow& end, double from, double begins) {
    for (int i = 0; i < steps; ++i) {
      const double u = static_cast<double>(i) / steps;
      scene::PathRow row = end;
      row.time = begins + u * kWay;
      row.position +=
          (from > 0.0 ? 1.0 - scene::minimum_jerk(u) : scene::minimum_jerk(u)) * Vec3(kAside, 0.0, kAbove);
      rows.push_back(row);
    }
  };
  add_way(own.rows().front(), 1.0, 0.0);
  for (scene::PathRow row : own.rows()) {
    row.time += kWay;
    rows.push_back(row);
  }
  scene::PathRow leaving = rows.back();
  rows.pop_back();  // add_way adds it
  add_way(leaving, 0.0, leaving.time);
  leaving.time += kWay;
  leaving.position += Vec3(kAside, 0.0, kAbove);
  rows.push_back(leaving);
  for (scene::PathRow& row : rows) {
    const double turns = row.time / leaving.time;
    const auto across = portable::sin_cos(2.0 * portable::kPi * kSwaysAcross * turns);
    const auto along = portable::sin_cos(2.0 * portable::kPi * kSwaysAlong * turns);
    row.position += kSway * Vec3(across.sine, along.sine, 0.0);
    const Quat tilt = rotation_about(Vec3::UnitX(), kTilt * along.sine) *
                      rotation_about(Vec3::UnitY(), kTilt * across.sine);
    row.orientation = (tilt * row.orientation).normalized();
  }
  return scene::ToolPath(std::move(rows));
}

std::size_t bytes_in_use() {
  const struct mallinfo2 held = mallinfo2();
  return held.uordblks + held.hblkhd;
}

Prepared prepare(const scene::Scene& scene) {
  constexpr std::size_t kTimes = 5;
  constexpr double kLongest = 1.0;  // s, for all runs but the first
  std::vector<double> seconds;
  std::optional<haptics::SimulationWorld> world;
  std::size_t bytes = 0;
  double all = 0.0;
  while (seconds.empty() || (seconds.size() < kTimes && all + seconds.back() < kLongest)) {
    world.reset();
    const std::size_t before = bytes_in_use();
    const std::int64_t begun = monotonic_ns();
    world.emplace(scene::make_world(scene));
    seconds.push_back(static_cast<double>(monotonic_ns() - begun) * 1e-9);
    all += seconds.back();
    const std::size_t after = bytes_in_use();
    bytes = after > before ? after - before : 0;
  }
  return {std::move(*world), {scene.organ_name, scene.organ.triangles.size(), median(seconds), bytes}};
}

}  // namespace palpate::bench
