#include "view/render/organ_picture.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include "palpate/error.h"
#include "view/render/display_mesh.h"

namespace palpate::render {
namespace {

constexpr double kCreaseDeg = 50.0;
constexpr double kNoCreaseDeg = 180.0;    // for organs whose sharp edges are a zigzag
constexpr double kEdgeBand = 0.08e-3;     // m beside a sharp edge, where normals turn; a pixel or less
constexpr double kEdgesAcross = 120.0;    // edges per organ diagonal, before contact
constexpr double kShortestEdge = 0.8e-3;  // m, before contact
constexpr double kLongestEdge = 2.5e-3;   // m
constexpr double kEvenShare = 0.05;       // of the mesh's mean edge length: limit of the smoothing
constexpr double kFineEdge = 0.6e-3;      // m, at contacts
constexpr double kFineRadius = 12e-3;     // m around a contact with the finest edges
constexpr double kCoarsening = 0.08;      // m of edge length per metre of distance beyond that radius
constexpr double kSameCentre = 4e-3;      // m: a contact closer than this to a refined position uses that
                                          // refinement

constexpr double kLoweredWithin = 24e-3;  // m along the surface: covers ToolImprint::kReach beside the axis
constexpr double kLiveTriangles = 24'000.0;
constexpr int kLiveSteps = 1200;  // geodesic steps per picture: about 0.5 ms on a slow processor

constexpr double kRounding = 0.2;  // rounding of the profile's corners; moves no vertex by more than 4 % of
                                   // the depth

double area_of(const geometry::TriangleMesh& mesh) {
  double doubled = 0.0;
  for (const geometry::Triangle& t : mesh.triangles) doubled += geometry::area_vector_doubled(mesh, t).norm();
  return 0.5 * doubled;
}

// Splits a set of vertices at the middle of its longest side until each part is one range, so that changed
// ranges are compact.
void sort_in_halves(const geometry::TriangleMesh& mesh, std::span<std::int32_t> vertices) {
  constexpr std::size_t kRun = deform::SurfaceBlocks::kBlock;
  if (vertices.size() <= kRun) return;
  const auto place = [&mesh](std::int32_t v) -> const Vec3& {
    return mesh.vertices[static_cast<std::size_t>(v)];
  };
  Vec3 low = place(vertices.front());
  Vec3 high = low;
  for (const std::int32_t v : vertices) {
    low = low.cwiseMin(place(v));
    high = high.cwiseMax(place(v));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t half = (vertices.size() / kRun + 1) / 2 * kRun;
  std::nth_element(vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(half), vertices.end(),
                   [&](std::int32_t a, std::int32_t b) {
                     return std::pair(place(a)[axis], a) < std::pair(place(b)[axis], b);
                   });
  sort_in_halves(mesh, vertices.first(half));
  sort_in_halves(mesh, vertices.subspan(half));
}

// Sorts vertices so that neighbours in space are close in memory: a change then affects few ranges.
void sort_by_position(geometry::TriangleMesh& mesh) {
  std::vector<std::int32_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  sort_in_halves(mesh, order);
  std::vector<Vec3> vertices;
  std::vector<std::int32_t> now_at(order.size());
  for (const std::int32_t v : order) {
    now_at[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(vertices.size());
    vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  }
  mesh.vertices = std::move(vertices);
  for (geometry::Triangle& t : mesh.triangles)
    for (std::int32_t& v : t) v = now_at[static_cast<std::size_t>(v)];
  std::sort(mesh.triangles.begin(), mesh.triangles.end(), [](const auto& a, const auto& b) {
    return std::min({a[0], a[1], a[2]}) < std::min({b[0], b[1], b[2]});
  });
}

// A page without threads prepares the response at its first picture.
#ifdef __EMSCRIPTEN__
constexpr std::launch kPrepares = std::launch::deferred;
#else
constexpr std::launch kPrepares = std::launch::async;
#endif
constexpr double kToolCreaseDeg = 36.0;
constexpr double kLargestBend = 8.0 * std::numbers::pi / 180.0;  // largest angle between the normals at the
                                                                 // ends of a displayed edge
constexpr double kShortestToolEdge = 0.3e-3;                     // m: shorter edges are not split

// The indentation nearest to a point.
std::size_t nearest_of(std::span<const deform::Indentation> indentations, const Vec3& point, bool deformed) {
  std::size_t own = 0;
  const auto away = [&](std::size_t i) {
    const deform::Indentation& at = indentations[i];
    return (at.point + (deformed ? at.depth : 0.0) * at.direction - point).norm();
  };
  for (std::size_t i = 0; i < indentations.size(); ++i)
    if (away(i) < away(own)) own = i;
  return own;
}

}  // namespace

OrganPicture::OrganPicture(const geometry::TriangleMesh& rest, const model::FalloffRatios& reach,
                           Detail detail, const std::optional<geometry::Support>& support,
                           const std::shared_ptr<const contact::OrganStore>& store)
    : reach_(reach),
      detail_(detail),
      crease_deg_(has_clean_creases(rest, kCreaseDeg) ? kCreaseDeg : kNoCreaseDeg),
      organ_(std::make_shared<const geometry::TriangleMesh>(rest)) {
  if (support && detail == Detail::kLive) {
    prepare(*support, store);
  } else {
    response_ = deform::prepare_response(rest, support, store.get());
  }
  double edge = std::clamp(geometry::bounds(rest).size().norm() / kEdgesAcross, kShortestEdge, kLongestEdge);
  if (detail == Detail::kLive) edge = std::max(edge, 1.75 * std::sqrt(area_of(rest) / kLiveTriangles));
  const RefineRule rule{crease_deg_, [edge](const Vec3&, double length, double) { return length > edge; }};
  base_ = refine_smoothly(rest, rule);
  smooth_bumps(base_, kEvenShare * mean_edge(rest), crease_deg_);
  take_surface(base_);
  if (detail == Detail::kLive) base_ = {};
}

void OrganPicture::take_surface(geometry::TriangleMesh rest) {
  narrow_creases(rest, crease_deg_, kEdgeBand);
  sort_by_position(rest);
  surface_ = std::make_unique<deform::DeformedSurface>(std::move(rest), reach_, kRounding);
  surface_->set_response(response_);
}

void OrganPicture::prepare(const geometry::Support& support,
                           std::shared_ptr<const contact::OrganStore> store) {
  awaited_ = std::async(kPrepares, [organ = organ_, support, store = std::move(store)] {
    return deform::prepare_response(*organ, support, store.get());
  });
}

void OrganPicture::set_support(std::optional<geometry::Support> support) {
  response_.reset();
  surface_->set_response(nullptr);
  failed_ = false;
  next_ = std::move(support);
  outdated_ = awaited_.valid();
  if (!outdated_ && next_) prepare(*std::exchange(next_, std::nullopt));
}

ResponseState OrganPicture::response() const noexcept {
  if (response_ != nullptr) return ResponseState::kShown;
  if (failed_) return ResponseState::kFailed;
  return next_ || (awaited_.valid() && !outdated_) ? ResponseState::kPreparing : ResponseState::kNone;
}

void OrganPicture::take_response() {
  if (!awaited_.valid() || awaited_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout) return;
  const bool outdated = std::exchange(outdated_, false);
  try {
    std::shared_ptr<const deform::OrganResponse> response = awaited_.get();
    if (!outdated) response_ = std::move(response);
  } catch (const InputError&) {  // the organ would turn away
    failed_ = !outdated;
  }
  if (next_) prepare(*std::exchange(next_, std::nullopt));
  if (response_ != nullptr) surface_->set_response(response_);
}

bool OrganPicture::divide_around(std::span<const deform::Indentation> indentations) {
  if (detail_ == Detail::kLive) return false;
  const auto divided = [this](const deform::Indentation& i) {
    return std::any_of(centres_.begin(), centres_.end(),
                       [&i](const Vec3& c) { return (c - i.point).norm() < kSameCentre; });
  };
  if (std::all_of(indentations.begin(), indentations.end(), divided)) return false;
  centres_.clear();
  for (const deform::Indentation& i : indentations) {
    if (!divided(i)) centres_.push_back(i.point);
  }
  const RefineRule rule{crease_deg_, [this](const Vec3& middle, double length, double) {
                          double nearest = std::numeric_limits<double>::infinity();
                          for (const Vec3& c : centres_) nearest = std::min(nearest, (middle - c).norm());
                          return length > kFineEdge + kCoarsening * std::max(0.0, nearest - kFineRadius);
                        }};
  take_surface(refine_smoothly(base_, rule));
  return true;
}

// Moves a displaced vertex on by a field along `direction` whose gradient by the position is `slope`.
void OrganPicture::shift(std::int32_t v, const Eigen::Vector3f& direction, float by,
                         const Eigen::Vector3f& slope) {
  deform::SurfaceVertex& vertex = surface_->move(v);
  vertex.position += by * direction;
  // Transposed adjugate of I + direction slope^T.
  const Eigen::Vector3f normal =
      (1.0F + direction.dot(slope)) * vertex.normal - direction.dot(vertex.normal) * slope;
  if (normal.squaredNorm() > 0.0F) vertex.normal = normal.normalized();
}

void OrganPicture::lower_onto(const ToolImprint& imprint, std::span<const deform::Indentation> indentations) {
  const std::size_t own = nearest_of(indentations, imprint.point(), false);
  const Eigen::Vector3f direction = imprint.direction().cast<float>();
  Eigen::Vector3f slope;
  for (const deform::DeformedSurface::Range& run : surface_->near(own, kLoweredWithin)) {
    for (std::size_t i = run.first; i < run.first + run.count; ++i) {
      const Eigen::Vector3f& at_rest = surface_->rest_vertices()[i];
      const Eigen::Vector3f& rest_normal = surface_->rest_normals()[i];
      const float lowering = imprint.lowering(surface_->vertices()[i].position, at_rest, rest_normal, &slope);
      const auto v = static_cast<std::int32_t>(i);
      if (!(lowering > 0.0F) || !surface_->is_near(own, v, kLoweredWithin)) continue;
      shift(v, direction, lowering, slope);
      const float inwards = direction.dot(rest_normal) < 0.0F ? -1.0F : 1.0F;
      surface_->move(v).moved = inwards * (surface_->vertices()[i].position - at_rest).norm();
    }
  }
}

// The fold is no displacement: a map of the displacement does not show it.
void OrganPicture::raise_fold(const GraspedFold& fold, std::span<const deform::Indentation> indentations) {
  constexpr float kLeast = 1e-6F;  // m
  const std::size_t own = nearest_of(indentations, fold.peak(), true);
  for (const deform::DeformedSurface::Range& run : surface_->near(own, GraspedFold::kReach)) {
    for (std::size_t i = run.first; i < run.first + run.count; ++i) {
      const GraspedFold::Raise raise = fold.raise(surface_->vertices()[i].position);
      const auto v = static_cast<std::int32_t>(i);
      if (raise.by > kLeast && surface_->is_near(own, v, GraspedFold::kReach))
        shift(v, fold.up(), raise.by, raise.slope);
    }
  }
}

bool OrganPicture::update(std::span<const deform::Indentation> indentations,
                          std::span<const ToolImprint> imprints, std::span<const GraspedFold> folds) {
  const bool changed = divide_around(indentations);
  take_response();
  surface_->update(indentations, detail_ == Detail::kStill ? deform::DeformedSurface::kSettle : kLiveSteps);
  for (const ToolImprint& imprint : imprints) lower_onto(imprint, indentations);
  for (const GraspedFold& fold : folds) raise_fold(fold, indentations);
  return changed;
}

IndexedCorners indexed_corners(std::span<const deform::SurfaceVertex> corners) {
  using Key = std::array<float, 6>;
  std::map<Key, std::uint32_t> index_of;
  IndexedCorners indexed;
  for (const deform::SurfaceVertex& v : corners) {
    const Key key{v.position.x(), v.position.y(), v.position.z(), v.normal.x(), v.normal.y(), v.normal.z()};
    const auto [entry, is_new] =
        index_of.try_emplace(key, static_cast<std::uint32_t>(indexed.vertices.size()));
    if (is_new) indexed.vertices.push_back(v);
    indexed.corners.push_back(entry->second);
  }
  return indexed;
}

ToolPicture::ToolPicture(const geometry::Tool& tool) {
  const RefineRule rule{kToolCreaseDeg, [](const Vec3&, double length, double bend) {
                          return bend > kLargestBend && length > kShortestToolEdge;
                        }};
  for (const geometry::ToolPart& part : tool.parts) {
    Part drawn{part, {}};
    drawn.part.mesh = refine_smoothly(part.mesh, rule);
    drawn.normals = corner_normals(drawn.part.mesh, kToolCreaseDeg);
    parts_.push_back(std::move(drawn));
  }
}

std::vector<deform::SurfaceVertex> ToolPicture::corners(std::size_t part) const {
  const Part& drawn = parts_.at(part);
  std::vector<deform::SurfaceVertex> corners;
  for (const geometry::Triangle& t : drawn.part.mesh.triangles) {
    for (const std::int32_t v : t) {
      const Vec3& p = drawn.part.mesh.vertices[static_cast<std::size_t>(v)];
      corners.push_back(
          deform::SurfaceVertex{p.cast<float>(), drawn.normals[corners.size()].cast<float>(), 0.0F});
    }
  }
  return corners;
}

Pose ToolPicture::part_pose(std::size_t part, const Pose& handle_W, double gripper) const {
  return handle_W * geometry::part_pose(parts_.at(part).part, gripper);
}

}  // namespace palpate::render
