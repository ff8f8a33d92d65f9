#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Core>

#include "core/deform/deformed_surface.h"
#include "palpate/offscreen.h"
#include "view/render/opengl.h"

namespace palpate::render {

/// Static attributes of a vertex, as the shaders read them. 32 bytes.
struct StaticVertex {
  Eigen::Vector3f rest;                // rest position [m], where the material's pattern is evaluated
  std::array<std::uint8_t, 4> colour;  // square roots of linear red, green, blue; fraction of fat
  Eigen::Vector3f vessel;              // position in the pattern of vessels
  std::array<std::uint8_t, 4> light;   // visible fraction of the sky, width of the vessels;
                                       // beside a vessel's line (organ_vessels.h), share of it
};

/// Attributes of a vertex in a map of values.
struct MapVertex {
  float share = 0.0F;  // of the legend's range, 0 to 1
  float known = 0.0F;  // above 0.5: coloured by the map; below: natural colour
};

/// A linked vertex and fragment shader. All members: [setup], with the context current.
class Program final {
 public:
  /// @throws std::logic_error with the compiler's message when a shader does not compile.
  Program(const std::string& vertex_source, const std::string& fragment_source);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const { glUseProgram(id_); }
  void set(const char* name, float value) const;
  void set(const char* name, int value) const;
  void set(const char* name, int x, int y) const;
  void set(const char* name, const Eigen::Vector2f& value) const;
  void set(const char* name, const Eigen::Vector3f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;

 private:
  GLuint id_ = 0;
};

/// Triangles in GPU memory; ranges of their vertices can be replaced. All members: [setup].
class GpuMesh final {
 public:
  GpuMesh();
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  void set_triangles(std::span<const std::uint32_t> corners);
  void set_static(std::span<const StaticVertex> vertices);
  void set_moving(std::span<const deform::SurfaceVertex> vertices);
  /// Replaces vertices, starting at index `first`.
  void change_moving(std::size_t first, std::span<const deform::SurfaceVertex> vertices);
  /// Sets the attributes for a map of values. Without them no vertex is known.
  void set_map(std::span<const MapVertex> vertices);
  void draw() const;
  /// Draws a range of its corners.
  void draw(std::size_t first, std::size_t count) const;
  /// Draws one triangle over the whole target; the vertex shader generates its corners.
  void draw_fullscreen() const;

 private:
  GLuint array_ = 0;
  std::array<GLuint, 4> buffers_{};  // moving attributes, corner indices, static attributes, map of values
  GLsizei count_ = 0;
};

/// A framebuffer with the textures or multisampled buffers that it draws to. All members: [setup].
class Target final {
 public:
  enum class Kind { kDepth, kShadow, kGrey, kCover, kColour, kColourWithDepth, kColourMultisampled };
  Target(Kind kind, int width, int height);
  ~Target();
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  void bind() const;
  void bind_texture(int unit) const;
  /// Copies the colours to a target of the same size, averaged over the samples.
  void resolve_to(const Target& other) const;
  /// Allocates it again with another size; its contents are lost.
  void resize(int width, int height);
  /// Copies it, scaled, to a rectangle of the window's framebuffer [pixels, y up].
  void show_at(int x, int y, int width, int height) const;
  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }

 private:
  Kind kind_;
  int width_;
  int height_;
  GLuint framebuffer_ = 0;
  GLuint texture_ = 0;
  std::array<GLuint, 2> renderbuffers_{};
};

/// [setup] Reads the bound framebuffer from its upper left corner.
[[nodiscard]] Image read_pixels(int width, int height);

}  // namespace palpate::render
