#include "view/render/changed_region.h"

#include <algorithm>

namespace palpate::render {
namespace {

constexpr std::size_t kRigidCorners = 96;  // per block of a rigid mesh
// Entries beyond its own that a pixel's shadow depends on: the blur, the next entry, which the look-up
// interpolates to, the entry's own extent, and rounding.
constexpr float kShadowReach = static_cast<float>(ChangedShadow::kBlur) + 3.0F;
constexpr float kUnchanged = std::numeric_limits<float>::infinity();  // depth in cells where nothing moved
constexpr float kDepthMargin = 1e-4F;                                 // of the map's range of depth
constexpr float kFacingAway = -0.05F;  // pixels^2: twice the area of a triangle that certainly faces away

Eigen::Vector3f corner_of(const Eigen::Vector3f& low, const Eigen::Vector3f& high, unsigned corner) {
  return {(corner & 1U) != 0 ? high.x() : low.x(), (corner & 2U) != 0 ? high.y() : low.y(),
          (corner & 4U) != 0 ? high.z() : low.z()};
}

Eigen::Vector2f pixel_at(const Projection& projection, const Eigen::Vector4f& clip) {
  return {(0.5F * clip.x() / clip.w() + 0.5F) * projection.width,
          (0.5F * clip.y() / clip.w() + 0.5F) * projection.height};
}

// Entry of the shadow map, and depth.
Eigen::Vector3f entry_at(const Projection& projection, const Eigen::Vector3f& point) {
  const Eigen::Vector3f q = (projection.to_light * point.homogeneous()).head<3>();
  constexpr auto kSide = static_cast<float>(ChangedShadow::kEntries);
  return {(0.5F * q.x() + 0.5F) * kSide, (0.5F * q.y() + 0.5F) * kSide, 0.5F * q.z() + 0.5F};
}

int whole_entry(float value, int last) {
  return static_cast<int>(std::clamp(value, 0.0F, static_cast<float>(last)));
}

// Consecutive corners of a mesh that are drawn together.
class Range final {
 public:
  void add(const GpuMesh& mesh, std::size_t first, std::size_t count) {
    if (first_ + count_ != first) {
      draw(mesh);
      first_ = first;
      count_ = 0;
    }
    count_ += count;
  }
  void draw(const GpuMesh& mesh) const { mesh.draw(first_, count_); }

 private:
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace

void ChangedShadow::clear() noexcept {
  entries_ = {};
  nearest_.fill(kUnchanged);
}

ChangedShadow::Cells ChangedShadow::cells_of(const ScreenBox& entries, float margin) noexcept {
  // A look-up outside the map takes the nearest entry, so boxes outside belong to the outermost cells.
  const auto cell = [](float entry) {
    return static_cast<std::size_t>(whole_entry(entry / static_cast<float>(kCell), kCells - 1));
  };
  return {cell(entries.left - margin), cell(entries.low - margin), cell(entries.right + margin),
          cell(entries.high + margin)};
}

void ChangedShadow::add(const ScreenBox& entries, float nearest, bool moved) noexcept {
  if (moved) entries_.add(entries);
  const Cells cells = cells_of(entries, kShadowReach);
  const float depth = std::clamp(nearest, 0.0F, 1.0F) - kDepthMargin;
  for (std::size_t y = cells.low; y <= cells.high; ++y)
    for (std::size_t x = cells.left; x <= cells.right; ++x) {
      float& cell = nearest_[y * kCells + x];
      if (moved || cell != kUnchanged) cell = std::min(cell, depth);
    }
}

bool ChangedShadow::falls_on(const ScreenBox& entries, float farthest) const noexcept {
  const Cells cells = cells_of(entries, 0.0F);
  for (std::size_t y = cells.low; y <= cells.high; ++y)
    for (std::size_t x = cells.left; x <= cells.right; ++x)
      if (farthest > nearest_[y * kCells + x]) return true;
  return false;
}

RigidBlocks::RigidBlocks(std::span<const deform::SurfaceVertex> corners) {
  for (std::size_t first = 0; first < corners.size(); first += kRigidCorners) {
    Block block{corners[first].position, corners[first].position,
                std::min(kRigidCorners, corners.size() - first)};
    for (const deform::SurfaceVertex& v : corners.subspan(first, block.count)) {
      block.low = block.low.cwiseMin(v.position);
      block.high = block.high.cwiseMax(v.position);
    }
    blocks_.push_back(block);
  }
}

// Where a box of the mesh's frame is drawn. @return whether a box bounds it: false where it passes the near
// plane
bool RigidBlocks::place(const Projection& projection, const Block& block, ScreenBox& box) {
  int behind = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const Eigen::Vector4f clip = projection.to_picture * corner_of(block.low, block.high, i).homogeneous();
    if (clip.w() < projection.near_plane) {
      ++behind;
    } else {
      box.add(pixel_at(projection, clip));
    }
  }
  return behind == 0 || behind == 8;
}

bool RigidBlocks::add_pixels(const Projection& projection, ChangedTiles& tiles) const {
  for (const Block& block : blocks_) {
    ScreenBox box;
    if (!place(projection, block, box)) return false;
    tiles.add(box);
  }
  return true;
}

void RigidBlocks::draw(const GpuMesh& mesh, const Projection& projection, const ChangedTiles& tiles) const {
  Range range;
  std::size_t first = 0;
  for (const Block& block : blocks_) {
    ScreenBox box;
    if (!place(projection, block, box) || tiles.touch(box)) range.add(mesh, first, block.count);
    first += block.count;
  }
  range.draw(mesh);
}

void RigidBlocks::add_shadow(const Projection& projection, ChangedShadow& shadow, bool moved) const {
  for (const Block& block : blocks_) {
    ScreenBox entries;
    float nearest = std::numeric_limits<float>::infinity();
    for (unsigned i = 0; i < 8; ++i) {
      const Eigen::Vector3f entry = entry_at(projection, corner_of(block.low, block.high, i));
      entries.add(entry.head<2>());
      nearest = std::min(nearest, entry.z());
    }
    shadow.add(entries, nearest, moved);
  }
}

bool RigidBlocks::add_shaded(const Projection& projection, const ChangedShadow& shadow,
                             ChangedTiles& tiles) const {
  for (const Block& block : blocks_) {
    ScreenBox entries;
    float farthest = -std::numeric_limits<float>::infinity();
    for (unsigned i = 0; i < 8; ++i) {
      const Eigen::Vector3f entry = entry_at(projection, corner_of(block.low, block.high, i));
      entries.add(entry.head<2>());
      farthest = std::max(farthest, entry.z());
    }
    if (!shadow.falls_on(entries, farthest)) continue;
    ScreenBox box;
    if (!place(projection, block, box)) return false;
    tiles.add(box);
  }
  return true;
}

void DeformingMesh::set(std::span<const std::uint32_t> corners,
                        std::span<const deform::SurfaceVertex> vertices) {
  gpu_.set_triangles(corners);
  gpu_.set_moving(vertices);
  corners_.assign(corners.begin(), corners.end());
  vertices_.assign(vertices.begin(), vertices.end());
  placed_.resize(vertices.size());
  touched_.assign(vertices.size(), 0);
  touched_groups_.assign(vertices.size() / kGroup + 1, 0);
  blocks_.clear();
  for (std::size_t first = 0; first < corners.size(); first += 3 * kTriangles) {
    Block& block = blocks_.emplace_back();
    block.first = first;
    block.count = std::min(3 * kTriangles, corners.size() - first);
    for (const std::uint32_t v : corners.subspan(first, block.count))
      block.groups.push_back(v / static_cast<std::uint32_t>(kGroup));
    std::sort(block.groups.begin(), block.groups.end());
    block.groups.erase(std::unique(block.groups.begin(), block.groups.end()), block.groups.end());
  }
}

void DeformingMesh::change(std::size_t first, std::span<const deform::SurfaceVertex> vertices) {
  gpu_.change_moving(first, vertices);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    deform::SurfaceVertex& before = vertices_[first + i];
    if (before.position == vertices[i].position && before.normal == vertices[i].normal &&
        before.moved == vertices[i].moved)
      continue;
    before = vertices[i];
    touched_[first + i] = 1;
    touched_groups_[(first + i) / kGroup] = 1;
  }
}

void DeformingMesh::place_vertex(const Projection& projection, std::size_t vertex) {
  const deform::SurfaceVertex& v = vertices_[vertex];
  const Eigen::Vector4f clip = projection.to_picture * v.position.homogeneous();
  cut_ = cut_ || clip.w() < projection.near_plane;
  const Eigen::Vector3f entry = entry_at(projection, v.position);
  placed_[vertex] = {pixel_at(projection, clip), entry.head<2>(), entry.z()};
}

void DeformingMesh::bound(Block& block) const {
  block.pixels = {};
  block.entries = {};
  block.farthest = -std::numeric_limits<float>::infinity();
  for (std::size_t i = block.first; i < block.first + block.count; ++i) {
    const Placed& placed = placed_[corners_[i]];
    block.pixels.add(placed.pixel);
    block.entries.add(placed.entry);
    block.farthest = std::max(block.farthest, placed.depth);
  }
}

void DeformingMesh::place(const Projection& projection) {
  cut_ = false;
  for (std::size_t v = 0; v < vertices_.size(); ++v) place_vertex(projection, v);
  for (Block& block : blocks_) bound(block);
  std::fill(touched_.begin(), touched_.end(), 0);
  std::fill(touched_groups_.begin(), touched_groups_.end(), 0);
}

// Whether a triangle may face the camera.
bool DeformingMesh::is_seen(std::size_t corner) const {
  const Eigen::Vector2f& a = placed_[corners_[corner]].pixel;
  const Eigen::Vector2f ab = placed_[corners_[corner + 1]].pixel - a;
  const Eigen::Vector2f ac = placed_[corners_[corner + 2]].pixel - a;
  return ab.x() * ac.y() - ab.y() * ac.x() > kFacingAway;
}

void DeformingMesh::add_touched(const Block& block, ChangedTiles& tiles) const {
  for (std::size_t i = block.first; i < block.first + block.count; i += 3) {
    if (touched_[corners_[i]] == 0 && touched_[corners_[i + 1]] == 0 && touched_[corners_[i + 2]] == 0)
      continue;
    if (!is_seen(i)) continue;
    ScreenBox pixels;
    for (std::size_t k = i; k < i + 3; ++k) pixels.add(placed_[corners_[k]].pixel);
    tiles.add(pixels);
  }
}

void DeformingMesh::add_changes(const Projection& projection, ChangedTiles& tiles) {
  std::vector<Block*> changed;
  for (Block& block : blocks_) {
    const bool touched = std::any_of(block.groups.begin(), block.groups.end(),
                                     [this](std::uint32_t group) { return touched_groups_[group] != 0; });
    if (touched) changed.push_back(&block);
  }
  for (const Block* block : changed) add_touched(*block, tiles);
  for (std::size_t v = 0; v < vertices_.size(); ++v)
    if (touched_[v] != 0) place_vertex(projection, v);
  for (Block* block : changed) {
    add_touched(*block, tiles);
    bound(*block);
  }
  std::fill(touched_.begin(), touched_.end(), 0);
  std::fill(touched_groups_.begin(), touched_groups_.end(), 0);
}

void DeformingMesh::add_shaded(const ChangedShadow& shadow, ChangedTiles& tiles) const {
  for (const Block& block : blocks_) {
    if (!shadow.falls_on(block.entries, block.farthest)) continue;
    for (std::size_t i = block.first; i < block.first + block.count; i += 3) {
      if (!is_seen(i)) continue;
      ScreenBox entries;
      ScreenBox pixels;
      float farthest = -std::numeric_limits<float>::infinity();
      for (std::size_t k = i; k < i + 3; ++k) {
        const Placed& placed = placed_[corners_[k]];
        entries.add(placed.entry);
        pixels.add(placed.pixel);
        farthest = std::max(farthest, placed.depth);
      }
      if (shadow.falls_on(entries, farthest)) tiles.add(pixels);
    }
  }
}

void DeformingMesh::draw(const ChangedTiles& tiles) const {
  Range range;
  for (const Block& block : blocks_)
    if (cut_ || tiles.touch(block.pixels)) range.add(gpu_, block.first, block.count);
  range.draw(gpu_);
}

}  // namespace palpate::render
