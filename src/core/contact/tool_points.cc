#include "core/contact/tool_points.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <span>

#include "core/geometry/cell.h"
#include "palpate/error.h"

namespace palpate::contact {
namespace {

constexpr double kSpacing = 2e-3;        // m (docs/model.md, section 4)
constexpr double kSmallestArea = 1e-12;  // m^2; a point on a degenerate triangle keeps a weight
constexpr std::uint32_t kClusterSize = PartPoints::kClusterSize;
constexpr std::size_t kMaxPoints = PartPoints::kMaxPoints;
constexpr double kNormalWeight = 2e-3;      // m; normals that differ by 1 count as this distance
constexpr double kCurvatureReach = 2.5e-3;  // m, radius of the neighbourhood that the curvature is fitted to
constexpr double kWidthReach = 8e-3;        // m, radius of the neighbourhood of the half-width
constexpr double kWidthDepth = 5e-3;        // m, depth within which the half-width is measured
constexpr double kSmallestRadius = 0.5e-3;  // m; to soft tissue an edge is not sharper
constexpr double kLargestRadius = 50e-3;    // m; flat

struct Sample {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  double area = 0.0;
};

std::vector<Sample> samples_of(const geometry::TriangleMesh& mesh) {
  const geometry::TriangleMesh fine = geometry::refine(mesh, kSpacing);
  std::vector<Sample> samples(fine.vertices.size());
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].point = fine.vertices[i];
  for (const geometry::Triangle& triangle : fine.triangles) {
    const Vec3 doubled = geometry::area_vector_doubled(fine, triangle);
    for (const std::int32_t corner : triangle) {
      Sample& sample = samples[static_cast<std::size_t>(corner)];
      sample.normal += doubled;
      sample.area += doubled.norm() / 6.0;
    }
  }
  for (Sample& sample : samples) {
    const double length = sample.normal.norm();
    if (length > 0.0) sample.normal /= length;
    sample.area = std::max(sample.area, kSmallestArea);
  }
  return samples;
}

/// Orders points so that neighbours are adjacent: halves along the longest side of the bounding box, down to
/// one cluster. Its outermost points come first, so that a search for the deepest point soon leaves out most
/// (by index, a tick in contact took 16 % more instructions); equal ones by index
/// (docs/decisions/0026-one-order-everywhere.md).
void order(const std::vector<Sample>& samples, std::span<std::uint32_t> indices) {
  if (indices.size() <= kClusterSize) {
    std::sort(indices.begin(), indices.end());
    Vec3 normal = Vec3::Zero();
    for (const std::uint32_t i : indices) normal += samples[i].normal;
    std::stable_sort(indices.begin(), indices.end(), [&](std::uint32_t a, std::uint32_t b) {
      return samples[a].point.dot(normal) > samples[b].point.dot(normal);
    });
    return;
  }
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  for (const std::uint32_t i : indices) {
    low = low.cwiseMin(samples[i].point);
    high = high.cwiseMax(samples[i].point);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  // Put whole clusters on the left, so that all clusters but the last are full.
  const std::size_t clusters = (indices.size() + kClusterSize - 1) / kClusterSize;
  const std::size_t half = (clusters / 2) * kClusterSize;
  const auto middle = indices.begin() + static_cast<std::ptrdiff_t>(half);
  std::nth_element(indices.begin(), middle, indices.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double pa = samples[a].point[axis];
    const double pb = samples[b].point[axis];
    return pa < pb || (pa == pb && a < b);
  });
  order(samples, indices.first(half));
  order(samples, indices.subspan(half));
}

/// Replaces a group of samples by its outermost one, with the area of all. Sorts the group by index.
Sample outermost(const std::vector<Sample>& samples, std::span<std::uint32_t> group) {
  std::sort(group.begin(), group.end());
  Vec3 normal = Vec3::Zero();
  double area = 0.0;
  for (const std::uint32_t i : group) {
    normal += samples[i].area * samples[i].normal;
    area += samples[i].area;
  }
  const auto out = std::max_element(group.begin(), group.end(), [&](std::uint32_t a, std::uint32_t b) {
    return samples[a].point.dot(normal) < samples[b].point.dot(normal);
  });
  Sample kept = samples[*out];
  kept.area = area;
  return kept;
}

/// Halves a run by position and normal until there are `groups` groups; each becomes one sample.
void thin_out(const std::vector<Sample>& samples, std::span<std::uint32_t> run, std::size_t groups,
              std::vector<Sample>& thinned) {
  if (groups <= 1 || run.size() <= 1) {
    thinned.push_back(outermost(samples, run));
    return;
  }
  using Key = Eigen::Matrix<double, 6, 1>;
  const auto key = [&samples](std::uint32_t i) {
    Key k;
    k << samples[i].point, kNormalWeight * samples[i].normal;
    return k;
  };
  Key low = key(run.front());
  Key high = low;
  for (const std::uint32_t i : run) {
    low = low.cwiseMin(key(i));
    high = high.cwiseMax(key(i));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t left_groups = groups / 2;
  const std::size_t left = std::clamp<std::size_t>(run.size() * left_groups / groups, 1, run.size() - 1);
  std::nth_element(run.begin(), run.begin() + static_cast<std::ptrdiff_t>(left), run.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double ka = key(a)[axis];
                     const double kb = key(b)[axis];
                     return ka < kb || (ka == kb && a < b);
                   });
  thin_out(samples, run.first(left), left_groups, thinned);
  thin_out(samples, run.subspan(left), groups - left_groups, thinned);
}

/// Points of a part in cubes of kWidthReach, for neighbourhood queries in set-up.
class Cells final {
 public:
  explicit Cells(const std::vector<Sample>& samples) : samples_(samples) {
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
      cells_.emplace_back(geometry::cell_at(samples[i].point, kWidthReach), i);
    }
    std::sort(cells_.begin(), cells_.end());
  }

  template <typename Visit>
  void each_near(const Vec3& p, Visit visit) const {
    const geometry::Cell middle = geometry::cell_at(p, kWidthReach);
    for (std::int64_t dx = -1; dx <= 1; ++dx) {
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        for (std::int64_t dz = -1; dz <= 1; ++dz) {
          const geometry::Cell wanted{middle[0] + dx, middle[1] + dy, middle[2] + dz};
          auto it = std::lower_bound(cells_.begin(), cells_.end(), std::pair{wanted, std::uint32_t{0}});
          for (; it != cells_.end() && it->first == wanted; ++it) visit(samples_[it->second]);
        }
      }
    }
  }

 private:
  const std::vector<Sample>& samples_;
  std::vector<std::pair<geometry::Cell, std::uint32_t>> cells_;
};

/// Radius of curvature R: least squares of h = rho^2 / (2 R) over the neighbourhood, h the depth below the
/// tangent plane. Half-width: half the shorter extent, across the normal, of the points within kWidthDepth.
void shape_at(const Sample& sample, const Cells& cells, double& radius, double& half_width) {
  double rho4 = 0.0;
  double rho2_h = 0.0;
  const Vec3 across = sample.normal.unitOrthogonal();
  const Vec3 along = sample.normal.cross(across);
  constexpr int kDirections = 8;  // over half a turn
  std::array<double, kDirections> low{};
  std::array<double, kDirections> high{};
  static const std::array<std::array<double, 2>, kDirections> kFan{
      {{1.0, 0.0},
       {0.9238795325112867, 0.3826834323650898},
       {0.7071067811865476, 0.7071067811865476},
       {0.3826834323650898, 0.9238795325112867},
       {0.0, 1.0},
       {-0.3826834323650898, 0.9238795325112867},
       {-0.7071067811865476, 0.7071067811865476},
       {-0.9238795325112867, 0.3826834323650898}}};
  cells.each_near(sample.point, [&](const Sample& other) {
    const Vec3 offset = other.point - sample.point;
    const double h = -offset.dot(sample.normal);
    const double rho2 = std::max(0.0, offset.squaredNorm() - h * h);
    if (rho2 <= kCurvatureReach * kCurvatureReach && other.normal.dot(sample.normal) > 0.5) {
      rho4 += other.area * rho2 * rho2;
      rho2_h += other.area * rho2 * h;
    }
    if (h > kWidthDepth || rho2 > kWidthReach * kWidthReach) return;
    const double u = offset.dot(across);
    const double v = offset.dot(along);
    for (std::size_t d = 0; d < kDirections; ++d) {
      const double extent = kFan[d][0] * u + kFan[d][1] * v;
      low[d] = std::min(low[d], extent);
      high[d] = std::max(high[d], extent);
    }
  });
  radius = rho2_h > 0.0 ? std::clamp(rho4 / (2.0 * rho2_h), kSmallestRadius, kLargestRadius) : kLargestRadius;
  half_width = kWidthReach;
  for (std::size_t d = 0; d < kDirections; ++d) half_width = std::min(half_width, 0.5 * (high[d] - low[d]));
  half_width = std::max(half_width, kSmallestRadius);
}

void make_clusters(PartPoints& points) {
  const auto count = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t begin = 0; begin < count; begin += kClusterSize) {
    PartPoints::Cluster cluster;
    cluster.begin = begin;
    cluster.end = std::min(count, begin + kClusterSize);
    Vec3 low = points.point(begin);
    Vec3 high = low;
    for (std::uint32_t i = begin; i < cluster.end; ++i) {
      low = low.cwiseMin(points.point(i));
      high = high.cwiseMax(points.point(i));
    }
    cluster.centre = 0.5 * (low + high);
    cluster.half_size = 0.5 * (high - low);
    for (std::uint32_t i = begin; i < cluster.end; ++i) {
      points.offset.push_back((points.point(i) - cluster.centre).norm());
      cluster.radius = std::max(cluster.radius, points.offset.back());
    }
    points.clusters.push_back(cluster);
  }
}

}  // namespace

PartPoints sample_part(const geometry::ToolPart& part, double given_radius) {
  if (part.mesh.triangles.empty()) throw InputError("tool part \"" + part.name + "\" has no triangles");
  std::vector<Sample> samples = samples_of(part.mesh);
  std::vector<std::uint32_t> indices(samples.size());
  std::iota(indices.begin(), indices.end(), 0U);
  if (samples.size() > kMaxPoints) {
    std::vector<Sample> thinned;
    thin_out(samples, indices, kMaxPoints, thinned);
    samples = std::move(thinned);
    indices.resize(samples.size());
    std::iota(indices.begin(), indices.end(), 0U);
  }
  order(samples, indices);
  const Cells cells(samples);
  const geometry::Bounds box = geometry::bounds(part.mesh);

  PartPoints points;
  points.joint = part;
  points.joint.mesh = {};
  points.box_middle = box.middle();
  points.box_reach = 0.5 * box.size();
  for (const std::uint32_t i : indices) {
    const Sample& sample = samples[i];
    double radius = 0.0;
    double half_width = 0.0;
    shape_at(sample, cells, radius, half_width);
    points.x.push_back(sample.point.x());
    points.y.push_back(sample.point.y());
    points.z.push_back(sample.point.z());
    points.area.push_back(sample.area);
    points.tip_radius.push_back(given_radius > 0.0 ? given_radius : radius);
    points.half_width.push_back(half_width);
  }
  make_clusters(points);
  return points;
}

}  // namespace palpate::contact
