#pragma once
#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/deform/surface_blocks.h"
#include "view/render/changed_tiles.h"
#include "view/render/gl_objects.h"

namespace palpate::render {

/// Where points of a mesh are drawn in the picture and in the shadow map.
struct Projection {
  Eigen::Matrix4f to_picture;  // from the mesh's frame to clip coordinates
  Eigen::Matrix4f to_light;    // from the mesh's frame to the shadow map's clip coordinates
  float width = 1.0F;          // pixels
  float height = 1.0F;
  float near_plane = 0.0F;  // m before the camera
};

/// The part of the shadow map of the tools that has changed, in square cells, and how close to the light a
/// tool is there. Only surface behind a tool can have another shadow than before.
class ChangedShadow final {
 public:
  static constexpr int kEntries = 256;  // of the shadow map, on each side
  static constexpr int kBlur = 3;       // entries to each side that the map is softened over

  ChangedShadow() { clear(); }
  void clear() noexcept;
  /// Adds the bounding box of a caster: entries of the shadow map, and the depth [0 to 1] nearest to the
  /// light. Casters that rest come after all that moved: their depths are mixed where the map is softened, so
  /// that surface behind either can have another shadow.
  void add(const ScreenBox& entries, float nearest, bool moved) noexcept;
  [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
  /// The entries of the map, before it is softened, that may have changed.
  [[nodiscard]] PixelBox entries() const noexcept { return pixels_of(entries_, kEntries, kEntries); }
  /// Whether the shadow may have changed on something with this bounding box in the map.
  [[nodiscard]] bool falls_on(const ScreenBox& entries, float farthest) const noexcept;

 private:
  static constexpr int kCell = 4;  // entries
  static constexpr int kCells = kEntries / kCell;
  struct Cells {
    std::size_t left, low, right, high;
  };
  [[nodiscard]] static Cells cells_of(const ScreenBox& entries, float margin) noexcept;

  ScreenBox entries_;
  std::array<float, static_cast<std::size_t>(kCells* kCells)> nearest_{};
};

/// The boxes around blocks of a rigid mesh's triangles, and where they are in picture and shadow map.
class RigidBlocks final {
 public:
  RigidBlocks() = default;
  /// [setup] @param corners three per triangle
  explicit RigidBlocks(std::span<const deform::SurfaceVertex> corners);

  /// [any] Adds the tiles that the mesh may cover. @return false where it passes the camera's near plane, so
  /// that no box bounds it
  [[nodiscard]] bool add_pixels(const Projection& projection, ChangedTiles& tiles) const;
  /// [any] Adds the mesh as a caster that moved, or one that rests.
  void add_shadow(const Projection& projection, ChangedShadow& shadow, bool moved) const;
  /// [any] Adds the tiles of the blocks on which the shadow may have changed. @return as add_pixels()
  [[nodiscard]] bool add_shaded(const Projection& projection, const ChangedShadow& shadow,
                                ChangedTiles& tiles) const;
  /// [setup] Draws the blocks of the mesh, whose corners are in this order, in these tiles.
  void draw(const GpuMesh& mesh, const Projection& projection, const ChangedTiles& tiles) const;

 private:
  struct Block {
    Eigen::Vector3f low;
    Eigen::Vector3f high;
    std::size_t count;  // corners
  };
  static bool place(const Projection& projection, const Block& block, ScreenBox& box);

  std::vector<Block> blocks_;
};

/// A deforming mesh on the graphics card in blocks of triangles. It knows where it was drawn last, so that
/// only blocks in the changed part of a picture are drawn. All members: [setup], with the context current.
class DeformingMesh final {
 public:
  [[nodiscard]] GpuMesh& gpu() noexcept { return gpu_; }
  [[nodiscard]] const GpuMesh& gpu() const noexcept { return gpu_; }
  /// Replaces triangles and vertices.
  void set(std::span<const std::uint32_t> corners, std::span<const deform::SurfaceVertex> vertices);
  /// Replaces vertices, starting at index `first`.
  void change(std::size_t first, std::span<const deform::SurfaceVertex> vertices);

  /// Computes where all of the mesh is drawn.
  void place(const Projection& projection);
  /// Adds the tiles of all triangles that changed since the last place() or add_changes(), where they were
  /// and where they are, and computes where they are drawn. The projection must be the one of that call.
  void add_changes(const Projection& projection, ChangedTiles& tiles);
  /// Adds the tiles of the triangles that this shadow may fall on.
  void add_shaded(const ChangedShadow& shadow, ChangedTiles& tiles) const;
  /// Whether the mesh passes the camera's near plane, so that no box bounds it.
  [[nodiscard]] bool is_cut() const noexcept { return cut_; }
  /// Draws the blocks with a triangle in these tiles.
  void draw(const ChangedTiles& tiles) const;

 private:
  static constexpr std::size_t kTriangles = 64;  // per block
  struct Block {
    std::size_t first = 0;              // corner
    std::size_t count = 0;              // corners
    std::vector<std::uint32_t> groups;  // of kGroup vertices with one of this block
    ScreenBox pixels;
    ScreenBox entries;      // in the shadow map
    float farthest = 0.0F;  // from the light
  };
  struct Placed {
    Eigen::Vector2f pixel;
    Eigen::Vector2f entry;
    float depth;
  };
  static constexpr std::size_t kGroup = deform::SurfaceBlocks::kBlock;
  void place_vertex(const Projection& projection, std::size_t vertex);
  void bound(Block& block) const;
  [[nodiscard]] bool is_seen(std::size_t corner) const;
  void add_touched(const Block& block, ChangedTiles& tiles) const;

  GpuMesh gpu_;
  std::vector<std::uint32_t> corners_;
  std::vector<deform::SurfaceVertex> vertices_;
  std::vector<Placed> placed_;
  std::vector<Block> blocks_;
  std::vector<char> touched_;         // one per vertex
  std::vector<char> touched_groups_;  // one per kGroup vertices
  bool cut_ = false;
};

}  // namespace palpate::render
