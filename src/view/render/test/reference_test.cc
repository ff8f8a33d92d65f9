// Compares whole pictures with committed references. The measure must reject every deliberate defect tested
// here.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <png.h>

#include "core/contact/contact.h"
#include "core/geometry/signed_distance.h"
#include "palpate/builtin.h"
#include "palpate/offscreen.h"
#include "palpate/surface.h"
#include "view/render/organ_picture.h"

namespace palpate::render {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 320;
constexpr int kHeight = 200;
constexpr int kBlock = 4;  // pixels: insensitive to outlines that another Mesa version draws one pixel aside

struct Scene {
  std::string name;
  Subject subject;
  haptics::Snapshot snapshot;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
};

// The point of an organ that a tool from above touches first, over its middle.
geometry::NearestPoint top_of(const geometry::TriangleMesh& organ) {
  const geometry::Bounds box = geometry::bounds(organ);
  return geometry::SignedDistance(organ).nearest(
      Vec3(box.middle().x(), box.middle().y(), box.high.z() + 0.02));
}

// A ball pressed 8 mm into the gallbladder by the contact computation, in small steps.
Scene pressed_gallbladder() {
  Scene scene{"gallbladder-pressed", {}, {}};
  scene.subject.organ = geometry::make_organ("gallbladder");
  scene.subject.tools = {geometry::make_tool("sphere:3")};
  scene.subject.tissue_name = "gallbladder";
  const model::TissueParameters tissue = model::tissue_preset("gallbladder");
  const geometry::NearestPoint top = top_of(scene.subject.organ);
  const contact::World world(scene.subject.organ, scene.subject.tools, tissue, 1e-3);
  contact::State state(world);
  contact::ToolInput input;
  for (int step = 0; step <= 600; ++step) {
    const double height = 0.004 - 2e-5 * step;  // of the ball's lowest point; ends at -8 mm
    input.pose_W.position = top.point + (height + 0.003) * top.normal;
    contact::advance(world, Pose{}, std::span(&input, 1), state, std::span(scene.snapshot.results.data(), 1));
  }
  scene.snapshot.hands = 1;
  scene.snapshot.tools[0] = input;
  scene.point = top.point;
  scene.normal = top.normal;
  return scene;
}

// The heart's wall pulled out by 10 mm.
Scene pulled_heart() {
  Scene scene{"heart-pulled", {}, {}};
  scene.subject.organ = geometry::make_organ("heart");
  scene.subject.tools = {geometry::make_tool("sphere:3")};
  scene.subject.tissue_name = "heart";
  const geometry::NearestPoint top = top_of(scene.subject.organ);
  scene.snapshot.hands = 1;
  scene.snapshot.tools[0].pose_W.position = top.point + 0.013 * top.normal;
  scene.snapshot.results[0].view_count = 1;
  scene.snapshot.results[0].views[0] = {top.point, top.normal, 0.010, 0.002, 0.0, -1, true};
  scene.point = top.point;
  scene.normal = top.normal;
  return scene;
}

Camera camera_of(const Scene& scene) {
  return frame_contact(scene.subject, scene.snapshot, scene.point, scene.normal, true);
}

Image draw(const Scene& scene, Quality quality = Quality::kFull) {
  OffscreenRenderer renderer(scene.subject, kWidth, kHeight, quality);
  Image image = renderer.draw(scene.snapshot, camera_of(scene));
  for (int i = 0; i < 40 && quality != Quality::kFull; ++i)
    image = renderer.draw(scene.snapshot, camera_of(scene));
  return image;
}

fs::path reference_file(const std::string& name) {
  return fs::path(PALPATE_REFERENCE_PICTURES) / (name + ".png");
}

Image read_reference(const std::string& name) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  Image image;
  if (png_image_begin_read_from_file(&header, reference_file(name).c_str()) == 0) return image;
  header.format = PNG_FORMAT_RGB;
  image = {static_cast<int>(header.width), static_cast<int>(header.height), {}};
  image.rgb.resize(PNG_IMAGE_SIZE(header));
  png_image_finish_read(&header, nullptr, image.rgb.data(), 0, nullptr);
  return image;
}

// Differences between means over blocks of 4 x 4 pixels: the mean in any channel, the fraction of clearly
// different blocks, and whether these fill a square of kPatch x kPatch blocks. An outline shifted by one
// pixel gives a line of such blocks; a missing object, however small, gives a square.
struct Difference {
  double mean = 0.0;
  double clear_share = 0.0;
  bool patch = false;
  [[nodiscard]] bool tolerable() const { return mean < 1.5 && clear_share < 0.01 && !patch; }
};

// Largest difference in any channel between the block means of two pictures.
double block_difference(const Image& a, const Image& b, int x, int y) {
  double largest = 0.0;
  for (int c = 0; c < 3; ++c) {
    double sum = 0.0;
    for (int j = 0; j < kBlock; ++j)
      for (int i = 0; i < kBlock; ++i) {
        const auto at = static_cast<std::size_t>(((y + j) * kWidth + x + i) * 3 + c);
        sum += static_cast<double>(a.rgb[at]) - static_cast<double>(b.rgb[at]);
      }
    largest = std::max(largest, std::abs(sum) / (kBlock * kBlock));
  }
  return largest;
}

Difference difference(const Image& a, const Image& b) {
  constexpr double kClear = 14.0;  // of 255
  constexpr int kPatch = 3;
  constexpr int kColumns = kWidth / kBlock;
  Difference result;
  std::vector<int> clear;  // per block: side of the largest square of clearly different blocks that ends
                           // there
  for (int y = 0; y + kBlock <= kHeight; y += kBlock) {
    for (int x = 0; x + kBlock <= kWidth; x += kBlock) {
      const double own = block_difference(a, b, x, y);
      result.mean += own;
      const auto i = clear.size();
      int side = own > kClear ? 1 : 0;
      if (side > 0) result.clear_share += 1.0;
      if (side > 0 && x > 0 && y > 0)
        side += std::min({clear[i - 1], clear[i - kColumns], clear[i - kColumns - 1]});
      clear.push_back(side);
      result.patch = result.patch || side >= kPatch;
    }
  }
  result.mean /= static_cast<double>(clear.size());
  result.clear_share /= static_cast<double>(clear.size());
  return result;
}

/// A scene, its renderer, and the first picture.
struct Drawn {
  explicit Drawn(Scene drawn)
      : scene(std::move(drawn)),
        renderer(scene.subject, kWidth, kHeight),
        image(renderer.draw(scene.snapshot, camera_of(scene))) {}

  Scene scene;
  OffscreenRenderer renderer;
  Image image;
};

class Reference : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    const Drawn& drawn = this->drawn();
    if (std::getenv("PALPATE_UPDATE_REFERENCES") != nullptr)
      write_png(drawn.image, reference_file(drawn.scene.name));
    reference_ = read_reference(drawn.scene.name);
    ASSERT_EQ(reference_.rgb.size(), drawn.image.rgb.size()) << reference_file(drawn.scene.name);
  }
  static void TearDownTestSuite() { drawn_.clear(); }

  /// Prepared once per program.
  static Drawn& drawn() {
    const std::string name = GetParam();
    const auto found = drawn_.find(name);
    if (found != drawn_.end()) return found->second;
    return drawn_.try_emplace(name, name == "heart" ? pulled_heart() : pressed_gallbladder()).first->second;
  }
  /// The scene's organ and tools at another moment.
  static Image at(const haptics::Snapshot& snapshot) {
    return drawn().renderer.draw(snapshot, camera_of(drawn().scene));
  }

  Image reference_;

 private:
  static inline std::map<std::string, Drawn> drawn_;
};

TEST_P(Reference, ThePictureIsTheCommittedOne) {
  const Difference d = difference(drawn().image, reference_);
  EXPECT_TRUE(d.tolerable()) << "mean " << d.mean << ", share of blocks " << d.clear_share << ", patch "
                             << d.patch;
}

TEST_P(Reference, AMissingOrganIsNoticed) {
  haptics::Snapshot spoilt = drawn().scene.snapshot;
  spoilt.organ_W.position = Vec3(0, 0, -50.0);
  EXPECT_FALSE(difference(at(spoilt), reference_).tolerable());
}

TEST_P(Reference, AMissingToolIsNoticed) {
  haptics::Snapshot spoilt = drawn().scene.snapshot;
  spoilt.tools[0].pose_W.position = Vec3(0, 0, -50.0);
  EXPECT_FALSE(difference(at(spoilt), reference_).tolerable());
}

TEST_P(Reference, LampsThatAreOffAreNoticed) {
  drawn().renderer.switch_lamps(false);
  EXPECT_FALSE(difference(at(drawn().scene.snapshot), reference_).tolerable());
  drawn().renderer.switch_lamps(true);
}

TEST_P(Reference, AnOrganTurnedInsideOutIsNoticed) {
  Scene spoilt = drawn().scene;
  for (geometry::Triangle& t : spoilt.subject.organ.triangles) std::swap(t[1], t[2]);
  EXPECT_FALSE(difference(draw(spoilt), reference_).tolerable());
}

TEST_P(Reference, AnOrganThatDoesNotGiveWayIsNoticed) {
  haptics::Snapshot spoilt = drawn().scene.snapshot;
  spoilt.results[0].view_count = 0;
  EXPECT_FALSE(difference(at(spoilt), reference_).tolerable());
}

TEST_P(Reference, TheQuickPicturesShowTheSame) {
  for (const Quality quality : {Quality::kBalanced, Quality::kFast}) {
    const Difference d = difference(draw(drawn().scene, quality), reference_);
    EXPECT_LT(d.mean, 6.0);
    EXPECT_LT(d.clear_share, 0.15);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, Reference, testing::Values("gallbladder", "heart"),
                         [](const auto& info) { return std::string(info.param); });

// Distance from the tool's contact point to the displayed surface, along the contact's direction.
double drawn_depth(const OrganPicture& organ, const contact::ContactView& view) {
  const Vec3 start = view.point_S - 0.02 * view.direction_S;
  double nearest = 1.0;
  for (const geometry::Triangle& t : organ.rest().triangles) {
    const auto at = [&](std::size_t k) {
      return Vec3(organ.vertices()[static_cast<std::size_t>(t[k])].position.cast<double>());
    };
    const Vec3 ab = at(1) - at(0);
    const Vec3 ac = at(2) - at(0);
    const Vec3 q = view.direction_S.cross(ac);
    const double determinant = ab.dot(q);
    if (determinant == 0.0) continue;
    const Vec3 s = start - at(0);
    const double u = s.dot(q) / determinant;
    const Vec3 r = s.cross(ab);
    const double v = view.direction_S.dot(r) / determinant;
    if (u < -1e-9 || v < -1e-9 || u + v > 1.0 + 1e-9) continue;
    const double way = ac.dot(r) / determinant;
    if (way > 0.0) nearest = std::min(nearest, way);
  }
  return nearest - 0.02;
}

TEST(DrawnSurface, UnderTheToolAgreesWithTheHapticDepthToAFifthOfAMillimetre) {
  for (const Scene& scene : {pressed_gallbladder(), pulled_heart()}) {
    const contact::ContactView& view = scene.snapshot.results[0].views[0];
    ASSERT_GT(view.depth, 0.006) << scene.name;
    const std::vector<ToolShape> shapes(1, ToolShape(scene.subject.tools[0]));
    for (const Detail detail : {Detail::kStill, Detail::kLive}) {
      OrganPicture organ(scene.subject.organ, scene.subject.reach, detail);
      for (int i = 0; i < 40; ++i)
        organ.update(deform::indentations_of(scene.snapshot.hand_results()),
                     imprints_of(scene.snapshot, shapes));
      // For a pull, the ray from outside meets the surface first: measure from the other end.
      contact::ContactView along = view;
      if (view.pull) along.direction_S = -view.direction_S;
      const double drawn = drawn_depth(organ, along) * (view.pull ? -1.0 : 1.0);
      EXPECT_NEAR(drawn, view.depth, 0.0002) << scene.name << (detail == Detail::kLive ? " live" : " still");
    }
  }
}

}  // namespace
}  // namespace palpate::render
