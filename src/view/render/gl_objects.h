#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <epoxy/gl.h>

#include "core/deform/live_surface.h"

namespace palpate::render {

/// What a drawn vertex carries that does not move, as the shaders read it. 32 bytes.
struct StillVertex {
  Eigen::Vector3f rest;                // where the material's pattern is taken from [m]
  std::array<std::uint8_t, 4> colour;  // square roots of linear red, green, blue; share of fat
  Eigen::Vector3f vessel;              // where in the pattern of vessels
  std::array<std::uint8_t, 4> light;   // share of the sky in sight, width of the vessels, 0, 0
};

/// A linked vertex and fragment shader. All members: [setup], with the context current.
class Program final {
 public:
  /// @throws std::logic_error with the compiler's words when a shader does not compile.
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

/// Triangles on the graphics side; where their vertices are may be replaced in part. All members: [setup].
class GpuMesh final {
 public:
  GpuMesh();
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  void set_triangles(std::span<const std::uint32_t> corners);
  void set_still(std::span<const StillVertex> vertices);
  void set_moving(std::span<const deform::LiveVertex> vertices);
  /// Replaces vertices from `first` on.
  void change_moving(std::size_t first, std::span<const deform::LiveVertex> vertices);
  void draw() const;
  /// One triangle over the whole target, its corners made by the vertex shader.
  void draw_fullscreen() const;

 private:
  GLuint array_ = 0;
  std::array<GLuint, 3> buffers_{};  // moving, corners, still
  GLsizei count_ = 0;
};

/// A framebuffer with the textures or multisampled buffers it draws to. All members: [setup].
class Target final {
 public:
  enum class Kind { kDepth, kShadow, kGrey, kMoments, kColour, kColourWithDepth, kColourMultisampled };
  Target(Kind kind, int width, int height);
  ~Target();
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  void bind() const;
  void bind_texture(int unit) const;
  /// Copies the colours to a target of the same size, as the mean of the samples.
  void resolve_to(const Target& other) const;
  /// Makes it anew with another size; what it held is gone.
  void resize(int width, int height);
  /// Copies it, stretched, to a rectangle of the window's own framebuffer [pixels, y up].
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

}  // namespace palpate::render
