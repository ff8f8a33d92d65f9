#include "view/render/gl_objects.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include <fmt/core.h>

#include "core/base/charconv.h"

namespace palpate::render {
namespace {

constexpr int kSamples = 4;  // per pixel, for antialiasing

GLuint compile(GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint done = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
  if (done == 0) {
    std::string log(4096, '\0');
    GLsizei length = 0;
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    glDeleteShader(shader);
    throw std::logic_error("a shader does not compile: " + log);
  }
  return shader;
}

// OpenGL expects buffer offsets as pointers.
const void* offset(std::uintptr_t bytes) { return bit_cast<const void*>(bytes); }

struct Layout {
  GLint format;
  GLenum order;
  GLenum type;
};

Layout layout_of(Target::Kind kind) {
  switch (kind) {
    case Target::Kind::kDepth:
    case Target::Kind::kShadow:
      return {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT};
    case Target::Kind::kGrey:
    case Target::Kind::kCover:
      return {GL_RG16F, GL_RG, GL_FLOAT};
    default:
      return {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
  }
}

}  // namespace

Program::Program(const std::string& vertex_source, const std::string& fragment_source) {
  const GLuint vertex = compile(GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
  id_ = glCreateProgram();
  glAttachShader(id_, vertex);
  glAttachShader(id_, fragment);
  glLinkProgram(id_);
  glDeleteShader(vertex);
  glDeleteShader(fragment);
  GLint done = 0;
  glGetProgramiv(id_, GL_LINK_STATUS, &done);
  if (done == 0) throw std::logic_error("shaders do not link");
}

Program::~Program() { glDeleteProgram(id_); }

void Program::set(const char* name, float value) const {
  glUniform1f(glGetUniformLocation(id_, name), value);
}
void Program::set(const char* name, int value) const { glUniform1i(glGetUniformLocation(id_, name), value); }
void Program::set(const char* name, int x, int y) const {
  glUniform2i(glGetUniformLocation(id_, name), x, y);
}
void Program::set(const char* name, const Eigen::Vector2f& value) const {
  glUniform2f(glGetUniformLocation(id_, name), value.x(), value.y());
}
void Program::set(const char* name, const Eigen::Vector3f& value) const {
  glUniform3f(glGetUniformLocation(id_, name), value.x(), value.y(), value.z());
}
void Program::set(const char* name, const Eigen::Matrix4f& value) const {
  glUniformMatrix4fv(glGetUniformLocation(id_, name), 1, GL_FALSE, value.data());
}

GpuMesh::GpuMesh() {
  glGenVertexArrays(1, &array_);
  glGenBuffers(4, buffers_.data());
  glBindVertexArray(array_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers_[1]);
  struct Attribute {
    GLint count;
    GLenum type;
    std::size_t offset;
  };
  const auto describe = [](GLuint first, std::span<const Attribute> attributes, GLsizei stride) {
    for (const Attribute& a : attributes) {
      glEnableVertexAttribArray(first);
      glVertexAttribPointer(first, a.count, a.type, a.type == GL_UNSIGNED_BYTE ? GL_TRUE : GL_FALSE, stride,
                            offset(a.offset));
      ++first;
    }
  };
  const std::array<Attribute, 3> moving = {{{3, GL_FLOAT, offsetof(deform::SurfaceVertex, position)},
                                            {3, GL_FLOAT, offsetof(deform::SurfaceVertex, normal)},
                                            {1, GL_FLOAT, offsetof(deform::SurfaceVertex, moved)}}};
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
  describe(0, moving, sizeof(deform::SurfaceVertex));
  const std::array<Attribute, 4> still = {{{3, GL_FLOAT, offsetof(StaticVertex, rest)},
                                           {4, GL_UNSIGNED_BYTE, offsetof(StaticVertex, colour)},
                                           {3, GL_FLOAT, offsetof(StaticVertex, vessel)},
                                           {4, GL_UNSIGNED_BYTE, offsetof(StaticVertex, light)}}};
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[2]);
  describe(3, still, sizeof(StaticVertex));
}

GpuMesh::~GpuMesh() {
  glDeleteBuffers(4, buffers_.data());
  glDeleteVertexArrays(1, &array_);
}

void GpuMesh::set_triangles(std::span<const std::uint32_t> corners) {
  glBindVertexArray(array_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size_bytes()), corners.data(),
               GL_STATIC_DRAW);
  count_ = static_cast<GLsizei>(corners.size());
}

void GpuMesh::set_static(std::span<const StaticVertex> vertices) {
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[2]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
               GL_STATIC_DRAW);
}

void GpuMesh::set_moving(std::span<const deform::SurfaceVertex> vertices) {
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
               GL_DYNAMIC_DRAW);
}

void GpuMesh::change_moving(std::size_t first, std::span<const deform::SurfaceVertex> vertices) {
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[0]);
  glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(first * sizeof(deform::SurfaceVertex)),
                  static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data());
}

void GpuMesh::set_map(std::span<const MapVertex> vertices) {
  constexpr GLuint kMapAttribute = 7;
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffers_[3]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
               GL_DYNAMIC_DRAW);
  glVertexAttribPointer(kMapAttribute, 2, GL_FLOAT, GL_FALSE, sizeof(MapVertex), nullptr);
  glEnableVertexAttribArray(kMapAttribute);
}

void GpuMesh::draw() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

void GpuMesh::draw(std::size_t first, std::size_t count) const {
  if (count == 0) return;
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT,
                 offset(first * sizeof(std::uint32_t)));
}

void GpuMesh::draw_fullscreen() const {
  glBindVertexArray(array_);
  glDisableVertexAttribArray(0);
  glDisableVertexAttribArray(1);
  glDisableVertexAttribArray(2);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

Target::Target(Kind kind, int width, int height) : kind_(kind), width_(width), height_(height) {
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (kind == Kind::kColourMultisampled) {
    glGenRenderbuffers(2, renderbuffers_.data());
    const std::array<GLenum, 2> formats = {GL_RGBA8, GL_DEPTH_COMPONENT24};
    const std::array<GLenum, 2> places = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
    for (std::size_t i = 0; i < 2; ++i) {
      glBindRenderbuffer(GL_RENDERBUFFER, renderbuffers_[i]);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, kSamples, formats[i], width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, renderbuffers_[i]);
    }
  } else {
    const bool depth = kind == Kind::kDepth || kind == Kind::kShadow;
    glGenTextures(1, &texture_);
    glBindTexture(GL_TEXTURE_2D, texture_);
    const Layout layout = layout_of(kind);
    glTexImage2D(GL_TEXTURE_2D, 0, layout.format, width, height, 0, layout.order, layout.type, nullptr);
    const GLint filter = kind == Kind::kShadow || kind == Kind::kCover ? GL_LINEAR : GL_NEAREST;
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (kind == Kind::kShadow) {
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    }
    glFramebufferTexture2D(GL_FRAMEBUFFER, depth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                           texture_, 0);
    if (kind == Kind::kColourWithDepth || kind == Kind::kCover) {
      glGenRenderbuffers(1, renderbuffers_.data());
      glBindRenderbuffer(GL_RENDERBUFFER, renderbuffers_[0]);
      glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, renderbuffers_[0]);
    }
    if (depth) {
      constexpr GLenum kNoColour = GL_NONE;
      glDrawBuffers(1, &kNoColour);
      glReadBuffer(GL_NONE);
    }
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error(fmt::format("OpenGL cannot draw to a picture of {} x {} pixels", width, height));
}

Target::~Target() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
  glDeleteRenderbuffers(2, renderbuffers_.data());
}

void Target::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
}

void Target::bind_texture(int unit) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture_);
}

void Target::resolve_to(const Target& other) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, other.framebuffer_);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, other.framebuffer_);
}

void Target::resize(int width, int height) {
  Target fresh(kind_, width, height);
  std::swap(width_, fresh.width_);
  std::swap(height_, fresh.height_);
  std::swap(framebuffer_, fresh.framebuffer_);
  std::swap(texture_, fresh.texture_);
  std::swap(renderbuffers_, fresh.renderbuffers_);
}

void Target::show_at(int x, int y, int width, int height) const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  const bool same_size = width == width_ && height == height_;
  glBlitFramebuffer(0, 0, width_, height_, x, y, x + width, y + height, GL_COLOR_BUFFER_BIT,
                    same_size ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

Image read_pixels(int width, int height) {
  Image image{width, height, {}};
  const std::size_t row = static_cast<std::size_t>(image.width) * 4;
  std::vector<std::uint8_t> bottom_up(row * static_cast<std::size_t>(image.height));
  glReadPixels(0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE, bottom_up.data());
  image.rgb.resize(bottom_up.size() / 4 * 3);
  auto to = image.rgb.begin();
  for (std::size_t y = static_cast<std::size_t>(image.height); y-- > 0;) {
    for (std::size_t at = y * row; at < (y + 1) * row; at += 4) to = std::copy_n(&bottom_up[at], 3, to);
  }
  return image;
}

}  // namespace palpate::render
