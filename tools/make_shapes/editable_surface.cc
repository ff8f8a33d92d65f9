#include "tools/make_shapes/editable_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/index.h"

namespace palpate::geometry {

namespace {

// A triangle counts as folded when its normal is more than 60 degrees from the surface's normal at its
// corners.
constexpr double kLeanCosine = 0.5;
// Collapses make no triangle with an angle below about 12 degrees.
constexpr double kSliverCosine = 0.978;

}  // namespace

EditableSurface::EditableSurface(const TriangleMesh& mesh)
    : points(mesh.vertices),
      normals(mesh.vertices.size(), Vec3::Zero()),
      sizes(mesh.vertices.size(), 1.0),
      triangles_(mesh.triangles),
      around_(mesh.vertices.size()),
      living_(static_cast<int>(mesh.vertices.size())) {
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const std::int32_t v : triangles_[t]) around_[at(v)].push_back(static_cast<std::int32_t>(t));
  }
}

std::vector<EditableSurface::Edge> EditableSurface::edges() const {
  std::vector<Edge> result;
  result.reserve(triangles_.size() * 3 / 2);
  for (const Triangle& t : triangles_) {
    if (t[0] < 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = t[k];
      const std::int32_t b = t[(k + 1) % 3];
      if (a < b) result.push_back({a, b});
    }
  }
  return result;
}

EditableSurface::Wing EditableSurface::wing(std::int32_t a, std::int32_t b) const {
  for (const std::int32_t t : around_[at(a)]) {
    const Triangle& corners = triangles_[at(t)];
    for (std::size_t k = 0; k < 3; ++k) {
      if (corners[k] == a && corners[(k + 1) % 3] == b) return {t, corners[(k + 2) % 3]};
    }
  }
  return {};
}

bool EditableSurface::has_edge(const Edge& edge) const { return wing(edge.a, edge.b).triangle >= 0; }

double EditableSurface::relative_length(const Edge& edge) const {
  return length(edge) / (0.5 * (sizes[at(edge.a)] + sizes[at(edge.b)]));
}

double EditableSurface::sharpest(const Vec3& a, const Vec3& b, const Vec3& c) const {
  // Scalars, because this runs millions of times and Eigen expressions are slow in unoptimised builds.
  const double abx = b.x() - a.x();
  const double aby = b.y() - a.y();
  const double abz = b.z() - a.z();
  const double bcx = c.x() - b.x();
  const double bcy = c.y() - b.y();
  const double bcz = c.z() - b.z();
  const double cax = a.x() - c.x();
  const double cay = a.y() - c.y();
  const double caz = a.z() - c.z();
  const double ab = std::sqrt(abx * abx + aby * aby + abz * abz);
  const double bc = std::sqrt(bcx * bcx + bcy * bcy + bcz * bcz);
  const double ca = std::sqrt(cax * cax + cay * cay + caz * caz);
  if (ab * bc * ca <= 0.0) return 1.0;
  const double at_a = -(abx * cax + aby * cay + abz * caz) / (ab * ca);
  const double at_b = -(abx * bcx + aby * bcy + abz * bcz) / (ab * bc);
  const double at_c = -(bcx * cax + bcy * cay + bcz * caz) / (bc * ca);
  return std::max(at_a, std::max(at_b, at_c));
}

bool EditableSurface::faces_outward(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) const {
  const Vec3 area = (b - a).cross(c - a);
  const double size = area.norm() * normal.norm();
  return size > 0.0 && area.dot(normal) > kLeanCosine * size;
}

void EditableSurface::replace_corner(std::int32_t triangle, std::int32_t from, std::int32_t to) {
  for (std::int32_t& v : triangles_[at(triangle)]) {
    if (v == from) v = to;
  }
}

void EditableSurface::detach(std::int32_t triangle, std::int32_t vertex) {
  std::vector<std::int32_t>& list = around_[at(vertex)];
  list.erase(std::find(list.begin(), list.end(), triangle));
}

void EditableSurface::set_triangle(std::int32_t triangle, const Triangle& corners) {
  for (const std::int32_t v : triangles_[at(triangle)]) detach(triangle, v);
  triangles_[at(triangle)] = corners;
  for (const std::int32_t v : corners) around_[at(v)].push_back(triangle);
}

std::int32_t EditableSurface::add_triangle(const Triangle& corners) {
  const auto index = static_cast<std::int32_t>(triangles_.size());
  triangles_.push_back(corners);
  for (const std::int32_t v : corners) around_[at(v)].push_back(index);
  return index;
}

void EditableSurface::split(const Edge& edge) {
  const Wing left = wing(edge.a, edge.b);
  const Wing right = wing(edge.b, edge.a);
  const auto middle = static_cast<std::int32_t>(points.size());
  points.emplace_back(0.5 * (point(edge.a) + point(edge.b)));
  const Vec3 normal = normals[at(edge.a)] + normals[at(edge.b)];
  const double norm = normal.norm();
  normals.push_back(norm > 0.0 ? Vec3(normal / norm) : normals[at(edge.a)]);
  sizes.push_back(0.5 * (sizes[at(edge.a)] + sizes[at(edge.b)]));
  around_.emplace_back();
  ++living_;
  set_triangle(left.triangle, {edge.a, middle, left.opposite});
  add_triangle({middle, edge.b, left.opposite});
  set_triangle(right.triangle, {edge.b, middle, right.opposite});
  add_triangle({middle, edge.a, right.opposite});
}

bool EditableSurface::collapse_allowed(const Edge& edge, const Wing& left, const Wing& right) const {
  if (left.opposite == right.opposite) return false;
  if (around(left.opposite).size() <= 3 || around(right.opposite).size() <= 3) return false;
  if (around(edge.a).size() + around(edge.b).size() < 8) return false;
  int common = 0;  // neighbours of both ends; only the two opposite corners are allowed
  for (const std::int32_t t : around(edge.a)) {
    for (const std::int32_t v : triangles_[at(t)]) {
      if (v == edge.a || v == edge.b) continue;
      for (const std::int32_t s : around(edge.b)) {
        const Triangle& other = triangles_[at(s)];
        if (other[0] == v || other[1] == v || other[2] == v) ++common;
      }
    }
  }
  // Each common neighbour is counted in two triangles at a and two at b, minus the edge's own ones: 2 x (2 +
  // 1 + 1) = 8.
  return common == 8;
}

bool EditableSurface::collapse_shapes_well(const Edge& edge, const Vec3& middle, double longest) const {
  const Vec3 normal = normals[at(edge.a)] + normals[at(edge.b)];
  const double size = 0.5 * (sizes[at(edge.a)] + sizes[at(edge.b)]);
  for (const std::int32_t end : {edge.a, edge.b}) {
    const std::int32_t other = end == edge.a ? edge.b : edge.a;
    for (const std::int32_t t : around(end)) {
      const Triangle& corners = triangles_[at(t)];
      if (corners[0] == other || corners[1] == other || corners[2] == other) continue;
      std::array<Vec3, 3> p;
      Vec3 mean = normal;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = corners[k] == end ? middle : point(corners[k]);
        if (corners[k] == end) continue;
        mean += normals[at(corners[k])];
        const double wanted = 0.5 * (size + sizes[at(corners[k])]);
        if ((middle - point(corners[k])).norm() > longest * wanted) return false;
      }
      if (!faces_outward(p[0], p[1], p[2], mean) || sharpest(p[0], p[1], p[2]) > kSliverCosine) return false;
    }
  }
  return true;
}

bool EditableSurface::collapse(const Edge& edge, double longest) {
  const Wing left = wing(edge.a, edge.b);
  const Wing right = wing(edge.b, edge.a);
  if (!collapse_allowed(edge, left, right)) return false;
  const Vec3 middle = 0.5 * (point(edge.a) + point(edge.b));
  if (!collapse_shapes_well(edge, middle, longest)) return false;
  for (const std::int32_t t : {left.triangle, right.triangle}) {
    for (const std::int32_t v : triangles_[at(t)]) detach(t, v);
    triangles_[at(t)] = {-1, -1, -1};
  }
  for (const std::int32_t t : around_[at(edge.b)]) {
    replace_corner(t, edge.b, edge.a);
    around_[at(edge.a)].push_back(t);
  }
  around_[at(edge.b)].clear();
  points[at(edge.a)] = middle;
  sizes[at(edge.a)] = 0.5 * (sizes[at(edge.a)] + sizes[at(edge.b)]);
  const Vec3 normal = normals[at(edge.a)] + normals[at(edge.b)];
  if (normal.norm() > 0.0) normals[at(edge.a)] = normal / normal.norm();
  --living_;
  return true;
}

bool EditableSurface::flip_if_better(const Edge& edge) {
  const Wing left = wing(edge.a, edge.b);
  const Wing right = wing(edge.b, edge.a);
  const std::int32_t c = left.opposite;
  const std::int32_t d = right.opposite;
  if (around(edge.a).size() <= 3 || around(edge.b).size() <= 3 || c == d) return false;
  const Vec3& pa = point(edge.a);
  const Vec3& pb = point(edge.b);
  const Vec3& pc = point(c);
  const Vec3& pd = point(d);
  const double before = std::max(sharpest(pa, pb, pc), sharpest(pb, pa, pd));
  const double after = std::max(sharpest(pd, pc, pa), sharpest(pc, pd, pb));
  if (after >= before - 1e-9 || has_edge({c, d}) || has_edge({d, c})) return false;
  const Vec3 normal = normals[at(edge.a)] + normals[at(edge.b)] + normals[at(c)] + normals[at(d)];
  if (!faces_outward(pa, pd, pc, normal) || !faces_outward(pb, pc, pd, normal)) return false;
  set_triangle(left.triangle, {edge.a, d, c});
  set_triangle(right.triangle, {edge.b, c, d});
  return true;
}

void EditableSurface::compact() {
  std::vector<std::int32_t> renamed(points.size(), -1);
  std::size_t kept = 0;
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (around_[v].empty()) continue;
    points[kept] = points[v];
    normals[kept] = normals[v];
    sizes[kept] = sizes[v];
    renamed[v] = static_cast<std::int32_t>(kept++);
  }
  points.resize(kept);
  normals.resize(kept);
  sizes.resize(kept);
  std::size_t left = 0;
  for (const Triangle& t : triangles_) {
    if (t[0] < 0) continue;
    triangles_[left++] = {renamed[at(t[0])], renamed[at(t[1])], renamed[at(t[2])]};
  }
  triangles_.resize(left);
  around_.assign(kept, {});
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const std::int32_t v : triangles_[t]) around_[at(v)].push_back(static_cast<std::int32_t>(t));
  }
}

TriangleMesh EditableSurface::mesh() const { return {points, triangles_}; }

}  // namespace palpate::geometry
