// Functions of palpate_web.h for pictures on a canvas.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "palpate/offscreen.h"

#include "app/window/mark_shapes.h"
#include "app/window/orbit_camera.h"
#include "app/window/resolution_choice.h"
#include "bindings/c/errors.h"
#include "bindings/c/simulation.h"
#include "bindings/web/palpate_web.h"

using palpate::InputError;
using palpate::Pose;
using palpate::Vec3;
using palpate::app::ray_through;
using palpate::c_interface::guarded;
using palpate::c_interface::UseError;
using palpate::geometry::Ray;
using palpate::haptics::Snapshot;
using palpate::render::Quality;

namespace {

palpate::render::Subject subject_of(const palpate::scene::Scene& scene) {
  return {scene.organ,
          scene.tools,
          scene.tissue.reach,
          scene.tissue.name,
          palpate::scene::visible_inclusions(scene.inclusions),
          scene.support,
          scene.organ_name};
}

/// Copies a snapshot that came from another instance. @throws UseError for other bytes
void copy_snapshot(const void* bytes, std::size_t size, Snapshot& snapshot) {
  if (size != sizeof snapshot) {
    throw UseError("snapshot: has " + std::to_string(size) + " bytes, must have " +
                   std::to_string(sizeof snapshot) + "; take it from snapshot() of the same version");
  }
  std::memcpy(static_cast<void*>(&snapshot), bytes, size);
  bool valid = snapshot.hands <= palpate::kMaxHands;
  for (const palpate::contact::ToolResult& result : snapshot.results) {
    valid = valid && result.view_count >= 0 && result.view_count <= palpate::contact::kMaxViews;
  }
  if (!valid) throw UseError("snapshot: its bytes are damaged");
}

/// Reads the numbers of palpate_web_view_draw_state().
class StateReader final {
 public:
  explicit StateReader(std::span<const double> numbers) : left_(numbers) {}

  [[nodiscard]] bool at_end() const noexcept { return left_.empty(); }
  double number() {
    if (left_.empty()) throw UseError("state: too few numbers");
    const double value = left_.front();
    if (!std::isfinite(value)) throw UseError("state: every number must be finite");
    left_ = left_.subspan(1);
    return value;
  }
  Vec3 vector() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }
  Pose pose() {
    const Vec3 position = vector();
    const double w = number();
    const Vec3 axis = vector();
    const palpate::Quat rotation(w, axis.x(), axis.y(), axis.z());
    if (!(rotation.norm() > 0.5)) throw UseError("state: every orientation must be a unit quaternion");
    return {rotation.normalized(), position};
  }

 private:
  std::span<const double> left_;
};

/// The vertex of the organ nearest to a point.
Vec3 nearest_vertex(const palpate::geometry::TriangleMesh& organ, const Vec3& point_S) {
  return *std::min_element(organ.vertices.begin(), organ.vertices.end(), [&](const Vec3& a, const Vec3& b) {
    return (a - point_S).squaredNorm() < (b - point_S).squaredNorm();
  });
}

void read_hand(StateReader& numbers, const Pose& organ_W, const palpate::geometry::TriangleMesh& organ,
               palpate::contact::ToolInput& tool, palpate::contact::ToolResult& result) {
  tool.pose_W = numbers.pose();
  tool.gripper = numbers.number();
  const double contacts = numbers.number();
  if (!(contacts >= 0.0 && contacts <= palpate::contact::kMaxViews)) {
    throw UseError("state: a hand must have at most " + std::to_string(palpate::contact::kMaxViews) +
                   " contacts");
  }
  result.view_count = static_cast<int>(contacts);
  for (palpate::contact::ContactView& view :
       std::span(result.views).first(static_cast<std::size_t>(result.view_count))) {
    view = {};
    view.point_S = numbers.vector();
    view.direction_S = numbers.vector();
    view.depth = numbers.number();
    view.tip_radius = numbers.number();
    view.half_width = numbers.number();
    view.pull = numbers.number() != 0.0;
    result.contact_W = organ_W * view.point_S;
    result.normal_W = (view.pull ? 1.0 : -1.0) * (organ_W.rotation * view.direction_S);
  }
  if (result.view_count > 0) return;
  const Vec3& tool_W = tool.pose_W.position;
  result.nearest_W = organ_W * nearest_vertex(organ, organ_W.inverse() * tool_W);
  result.away_W = (tool_W - result.nearest_W).normalized();
}

// The renderer's first pictures, which prepare its shaders, are small.
constexpr int kFirstWidth = 60;
constexpr int kFirstHeight = 44;

/// A text as a JSON string; the few characters that need escapes become ones that do not.
std::string in_json(std::string text) {
  for (char& letter : text) {
    if (letter == '"') letter = '\'';
    if (letter == '\\') letter = '/';
    if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
  }
  return '"' + text + '"';
}

/// Shapes as palpate_web_view_marks() gives them.
std::string marks_text(const palpate::app::MarkShapes& shapes) {
  std::string text = "{\"lines\":[";
  const char* comma = "";
  for (const auto& [from, to, colour, width] : shapes.lines) {
    text += fmt::format("{}[{},{},{},{},{},{}]", comma, from.x, from.y, to.x, to.y, width,
                        static_cast<int>(colour));
    comma = ",";
  }
  text += "],\"triangles\":[";
  comma = "";
  for (const auto& [tip, left, right, colour] : shapes.triangles) {
    text += fmt::format("{}[{},{},{},{},{},{},{}]", comma, tip.x, tip.y, left.x, left.y, right.x, right.y,
                        static_cast<int>(colour));
    comma = ",";
  }
  text += "],\"words\":[";
  comma = "";
  for (const auto& [at, colour, words] : shapes.words) {
    text += fmt::format("{}[{},{},{},{}]", comma, at.x, at.y, static_cast<int>(colour), in_json(words));
    comma = ",";
  }
  return text + "]}";
}

}  // namespace

/// The renderer, its camera, and the choice of quality and resolution as in the program's window.
struct palpate_web_view {
 public:
  palpate_web_view(palpate_simulation& shown_simulation, int wide, int high)
      : simulation(shown_simulation),
        width(wide),
        height(high),
        renderer(subject_of(simulation.scene()), kFirstWidth, kFirstHeight,
                 palpate::render::OffscreenRenderer::InCurrentContext{}),
        driver(renderer.driver()),
        shown(simulation.newest_snapshot()),
        needle(palpate::app::NeedleMarks::of(simulation.scene(), simulation.world().contact)) {
    frame(false);
  }

  [[nodiscard]] double aspect() const { return static_cast<double>(width) / height; }

  void frame(bool close_up) {
    const palpate::render::Subject subject = subject_of(simulation.scene());
    const palpate::contact::ToolResult& result = shown.results[0];
    if (!close_up) {
      palpate::app::look_as_at_start(camera, subject, shown,
                                     simulation.scene().task == palpate::scene::Task::kPalpate, aspect());
      return;
    }
    const bool contact = result.view_count > 0;
    camera.look_as(
        palpate::render::frame_contact(subject, shown, contact ? result.contact_W : result.nearest_W,
                                       contact ? result.normal_W : result.away_W, true),
        aspect());
  }

  void draw() {
    const auto start = std::chrono::steady_clock::now();
    const double share = resolution.now();
    const int wide = std::max(1, static_cast<int>(std::lround(share * width)));
    const int high = std::max(1, static_cast<int>(std::lround(share * height)));
    if (wide != drawn_width || high != drawn_height) renderer.resize(wide, high);
    drawn_width = wide;
    drawn_height = high;
    renderer.draw_and_keep(shown, camera.camera());
    renderer.show_at(0, 0, width, height);
    if (!adapts) return;
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    (void)resolution.add(took, renderer.quality() != Quality::kFast);
    renderer.limit_quality(resolution.all() ? Quality::kBalanced : Quality::kFast);
  }

  void set_quality(int quality) {
    adapts = quality < 0;
    if (adapts) {
      renderer.adapt_to_time();
    } else {
      resolution.raise_to_all();
      renderer.hold_quality(static_cast<Quality>(quality));
    }
  }

  palpate_simulation& simulation;
  int width;  // of the canvas, pixels
  int height;
  palpate::render::OffscreenRenderer renderer;
  std::string driver;
  Snapshot shown;
  std::optional<palpate::app::NeedleMarks> needle;
  palpate::app::OrbitCamera camera;
  palpate::app::ResolutionChoice resolution;
  int drawn_width = kFirstWidth;
  int drawn_height = kFirstHeight;
  bool adapts = true;
};

extern "C" {

palpate_status palpate_web_view_open(palpate_simulation* simulation, int32_t width, int32_t height,
                                     palpate_web_view** view) {
  return guarded([&] { *view = std::make_unique<palpate_web_view>(*simulation, width, height).release(); });
}

void palpate_web_view_close(palpate_web_view* view) { std::unique_ptr<palpate_web_view>{view}.reset(); }

palpate_status palpate_web_view_draw(palpate_web_view* view, const void* bytes, size_t size, int32_t width,
                                     int32_t height) {
  return guarded([&] {
    if (bytes == nullptr) {
      view->shown = view->simulation.newest_snapshot();
    } else {
      copy_snapshot(bytes, size, view->shown);
    }
    view->width = width;
    view->height = height;
    view->draw();
  });
}

palpate_status palpate_web_view_draw_state(palpate_web_view* view, const double* numbers, size_t count,
                                           int32_t width, int32_t height) {
  return guarded([&] {
    Snapshot snapshot = view->shown;
    StateReader reader({numbers, count});
    snapshot.organ_W = reader.pose();
    for (std::uint32_t hand = 0; hand < snapshot.hands; ++hand) {
      read_hand(reader, snapshot.organ_W, view->simulation.scene().organ, snapshot.tools[hand],
                snapshot.results[hand]);
    }
    if (!reader.at_end()) throw UseError("state: must have one hand per instrument of the scene");
    view->shown = snapshot;
    view->width = width;
    view->height = height;
    view->draw();
  });
}

void palpate_web_view_camera(const palpate_web_view* view, double camera[10]) {
  const palpate::render::Camera now = view->camera.camera();
  for (int i = 0; i < 3; ++i) {
    camera[i] = now.eye[i];
    camera[3 + i] = now.target[i];
    camera[6 + i] = now.up[i];
  }
  camera[9] = now.vertical_view_deg;
}

palpate_status palpate_web_view_set_camera(palpate_web_view* view, const double camera[10]) {
  return guarded([&] {
    const palpate::render::Camera wanted{Vec3(camera), Vec3(camera + 3), Vec3(camera + 6), camera[9]};
    const Vec3 back = wanted.eye - wanted.target;
    if (!(back.norm() > 0.0) || !back.allFinite() || !(wanted.up.cross(back).norm() > 0.0) ||
        !wanted.up.allFinite()) {
      throw InputError("camera: eye, target and up must be finite, and up not along the line of sight");
    }
    if (!(wanted.vertical_view_deg >= 1.0 && wanted.vertical_view_deg <= 120.0)) {
      throw palpate::ParameterError("camera.verticalViewDeg", wanted.vertical_view_deg, "1 to 120");
    }
    view->camera.look_exactly_as(
        {wanted.eye, wanted.target, wanted.up.normalized(), wanted.vertical_view_deg});
  });
}

void palpate_web_view_orbit(palpate_web_view* view, double right, double up) {
  view->camera.orbit(right, up);
}
void palpate_web_view_pan(palpate_web_view* view, double right, double up) { view->camera.pan(right, up); }
void palpate_web_view_zoom(palpate_web_view* view, double factor) { view->camera.zoom(factor); }

palpate_status palpate_web_view_frame(palpate_web_view* view, int32_t close_up) {
  return guarded([&] { view->frame(close_up != 0); });
}

int32_t palpate_web_view_keep_in_frame(palpate_web_view* view) {
  constexpr double kFarther = 1.02;  // a frame
  if (palpate::app::contacts_in_frame(view->shown, view->camera.camera(), view->aspect())) return 0;
  view->camera.zoom(kFarther);
  return 1;
}

const char* palpate_web_view_marks(palpate_web_view* view, double width, double height, double letters,
                                   uint32_t which) {
  static std::string text;
  const palpate::app::PictureMarks marks{(which & 1U) != 0, (which & 2U) != 0, (which & 4U) != 0,
                                         (which & 8U) != 0, (which & 16U) != 0};
  const palpate::app::PictureSize size{static_cast<float>(width), static_cast<float>(height),
                                       static_cast<float>(letters)};
  text = marks_text(palpate::app::shapes_of(marks, size, view->camera, view->shown,
                                            view->needle ? &*view->needle : nullptr));
  return text.c_str();
}

palpate_status palpate_web_view_steer(const palpate_web_view* view, uint32_t hand, double right, double up,
                                      double way[3]) {
  return guarded([&] {
    if (hand >= view->simulation.hands()) throw UseError("hand: must be less than info.hands");
    const Vec3 axis_W = view->shown.tools[hand].pose_W.rotation * Vec3::UnitZ();
    const palpate::app::ToolPlane plane = palpate::app::plane_across(axis_W, view->camera);
    const Vec3 moved = view->camera.height_at_target() * (right * plane.right + up * plane.away);
    for (int i = 0; i < 3; ++i) way[i] = moved[i];
  });
}

void palpate_web_view_ray(const palpate_web_view* view, double x, double y, double ray[6]) {
  const Ray found = ray_through(view->camera.camera(), view->aspect(), x, y);
  for (int i = 0; i < 3; ++i) {
    ray[i] = found.origin[i];
    ray[3 + i] = found.direction[i];
  }
}

int32_t palpate_web_view_pick(const palpate_web_view* view, double x, double y, double point[6]) {
  const Ray ray_W = ray_through(view->camera.camera(), view->aspect(), x, y);
  const Pose to_organ = view->shown.organ_W.inverse();
  const Ray ray_S{to_organ * ray_W.origin, to_organ.rotation * ray_W.direction};
  const std::optional<Vec3> point_S = palpate::geometry::seen_point(view->simulation.scene().organ, ray_S);
  if (!point_S) return 0;
  const Vec3 point_W = view->shown.organ_W * *point_S;
  for (int i = 0; i < 3; ++i) {
    point[i] = point_W[i];
    point[3 + i] = (*point_S)[i];
  }
  return 1;
}

palpate_status palpate_web_view_show_displacement(palpate_web_view* view, double range) {
  return guarded([&] {
    if (!(range >= 0.0) || !std::isfinite(range)) throw palpate::ParameterError("range", range, ">= 0 (m)");
    view->renderer.set_map_range(range);
  });
}

palpate_status palpate_web_view_show_drape(palpate_web_view* view, int32_t shown) {
  return guarded([&] { view->renderer.show_drape(shown != 0); });
}

palpate_status palpate_web_view_show_inclusions(palpate_web_view* view, const double* inclusions,
                                                size_t count) {
  return guarded([&] {
    if (count > palpate::model::kMaxInclusions) {
      throw UseError("inclusions: must be at most " + std::to_string(palpate::model::kMaxInclusions));
    }
    std::vector<palpate::model::Inclusion> all(count);
    for (palpate::model::Inclusion& inclusion : all) {
      inclusion.centre_S = Vec3(inclusions);
      inclusion.radius = inclusions[3];
      inclusion.ratio = inclusions[4];
      inclusions += 5;
    }
    view->renderer.show_inclusions(std::move(all));
  });
}

palpate_status palpate_web_view_show_marks(palpate_web_view* view, const double* marks, size_t count) {
  return guarded([&] {
    std::vector<palpate::render::SurfaceMark> all(count);
    for (palpate::render::SurfaceMark& mark : all) {
      mark = {Vec3(marks), static_cast<palpate::render::SurfaceMark::Kind>(static_cast<int>(marks[3]))};
      marks += 4;
    }
    view->renderer.show_marks(all);
  });
}

palpate_status palpate_web_view_set_quality(palpate_web_view* view, int32_t quality) {
  return guarded([&] { view->set_quality(quality); });
}

int32_t palpate_web_view_quality(const palpate_web_view* view) {
  return static_cast<int32_t>(view->renderer.quality());
}

const char* palpate_web_view_driver(const palpate_web_view* view) { return view->driver.c_str(); }
}
