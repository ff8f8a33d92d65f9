#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <epoxy/gl.h>

namespace palpate::render {

/// What every drawn vertex carries, as the shaders read it.
struct Vertex {
  Eigen::Vector3f position;  // world [m]
  Eigen::Vector3f normal;    // unit
  Eigen::Vector3f rest;      // where the material's pattern is taken from: rest position or handle frame [m]
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
  void set(const char* name, const Eigen::Vector2f& value) const;
  void set(const char* name, const Eigen::Vector3f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;

 private:
  GLuint id_ = 0;
};

/// Triangles on the graphics side; vertices may be replaced each picture. All members: [setup].
class GpuMesh final {
 public:
  GpuMesh();
  ~GpuMesh();
  GpuMesh(const GpuMesh&) = delete;
  GpuMesh& operator=(const GpuMesh&) = delete;

  void set_triangles(std::span<const std::uint32_t> corners);
  void set_vertices(std::span<const Vertex> vertices);
  void draw() const;
  /// One triangle over the whole target, its corners made by the vertex shader.
  void draw_fullscreen() const;

 private:
  GLuint array_ = 0;
  std::array<GLuint, 2> buffers_{};
  GLsizei count_ = 0;
};

/// A framebuffer with the textures or multisampled buffers it draws to. All members: [setup].
class Target final {
 public:
  enum class Kind { kDepth, kShadow, kGrey, kColour, kColourMultisampled };
  Target(Kind kind, int width, int height);
  ~Target();
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  void bind() const;
  void bind_texture(int unit) const;
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
