#include "palpate/render/offscreen.h"

#include <epoxy/gl.h>

#include "palpate/base/error.h"
#include "palpate/render/gl_context.h"
#include "palpate/render/indentations.h"
#include "palpate/render/organ_picture.h"
#include "palpate/render/painter.h"
#include "palpate/render/tool_picture.h"

namespace palpate::render {
namespace {

constexpr double kLitShare = 0.75;  // of the organ's diagonal: radius of what the light must reach
constexpr int kLargestSide = 8192;  // pixels

void check_size(int width, int height) {
  if (width >= 1 && height >= 1 && width <= kLargestSide && height <= kLargestSide) return;
  throw InputError("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels cannot be drawn; want 1 to " + std::to_string(kLargestSide) + " a side");
}

}  // namespace

struct OffscreenRenderer::Impl {
  Impl(const Subject& subject, int width, int height)
      : painter(tissue_look(subject.tissue_name), width, height),
        organ(subject.organ, subject.reach),
        instruments(subject.tools) {
    for (const geometry::Tool& tool : subject.tools) tools.emplace_back(tool);
    const geometry::Bounds box = geometry::bounds(subject.organ);
    region = {box.middle(), kLitShare * box.size().norm()};
    driver = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
    upload_organ_triangles();
  }

  void upload_organ_triangles() {
    std::vector<std::uint32_t> corners;
    corners.reserve(organ.rest().triangles.size() * 3);
    for (const geometry::Triangle& t : organ.rest().triangles)
      for (const std::int32_t v : t) corners.push_back(static_cast<std::uint32_t>(v));
    painter.organ().set_triangles(corners);
  }

  void upload_organ(const haptics::Snapshot& snapshot) {
    if (organ.update(indentations_of(snapshot), imprints_of(snapshot, instruments))) upload_organ_triangles();
    vertices.clear();
    for (std::size_t i = 0; i < organ.vertices().size(); ++i) {
      vertices.push_back({(snapshot.organ_W * organ.vertices()[i]).cast<float>(),
                          (snapshot.organ_W.rotation * organ.normals()[i]).cast<float>(),
                          organ.rest().vertices[i].cast<float>()});
    }
    painter.organ().set_vertices(vertices);
  }

  void upload_tools(const haptics::Snapshot& snapshot) {
    vertices.clear();
    for (std::size_t i = 0; i < tools.size() && i < snapshot.hands; ++i)
      tools[i].append(snapshot.tools[i].pose_W, snapshot.tools[i].gripper, vertices);
    std::vector<std::uint32_t> corners(vertices.size());
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
    painter.tools().set_triangles(corners);
    painter.tools().set_vertices(vertices);
  }

  Painter painter;
  OrganPicture organ;
  std::vector<geometry::Tool> instruments;
  std::vector<ToolPicture> tools;
  LitRegion region;  // organ frame
  std::string driver;
  std::vector<Vertex> vertices;
};

// Holds the renderer's own context, if it has one, while it draws.
class OffscreenRenderer::Current final {
 public:
  explicit Current(GlContext* context) : context_(context) {
    if (context_ != nullptr) context_->make_current();
  }
  ~Current() {
    if (context_ != nullptr) context_->release();
  }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  GlContext* context_;
};

OffscreenRenderer::OffscreenRenderer(const Subject& subject, int width, int height) {
  check_size(width, height);
  context_ = std::make_unique<GlContext>();
  impl_ = std::make_unique<Impl>(subject, width, height);
  context_->release();
}

OffscreenRenderer::OffscreenRenderer(const Subject& subject, int width, int height,
                                     InCurrentContext /*here*/) {
  check_size(width, height);
  impl_ = std::make_unique<Impl>(subject, width, height);
}

OffscreenRenderer::~OffscreenRenderer() {
  if (context_) context_->make_current();
}

Image OffscreenRenderer::draw(const haptics::Snapshot& snapshot, const Camera& camera) {
  draw_and_keep(snapshot, camera);
  return kept();
}

void OffscreenRenderer::draw_and_keep(const haptics::Snapshot& snapshot, const Camera& camera) {
  const Current current(context_.get());
  impl_->upload_organ(snapshot);
  impl_->upload_tools(snapshot);
  impl_->painter.draw(camera, {snapshot.organ_W * impl_->region.middle, impl_->region.radius});
}

Image OffscreenRenderer::kept() {
  const Current current(context_.get());
  return impl_->painter.read();
}

void OffscreenRenderer::show_at(int x, int y, int width, int height) {
  const Current current(context_.get());
  impl_->painter.show_at(x, y, width, height);
}

void OffscreenRenderer::resize(int width, int height) {
  check_size(width, height);
  const Current current(context_.get());
  impl_->painter.resize(width, height);
}

std::string OffscreenRenderer::driver() const { return impl_->driver; }

}  // namespace palpate::render
