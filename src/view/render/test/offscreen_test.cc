#include "palpate/offscreen.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <set>

#include <gtest/gtest.h>
#include <png.h>

#include "palpate/error.h"
#include "palpate/mesh.h"

namespace palpate::render {
namespace {

constexpr int kPictureWidth = 320;
constexpr int kPictureHeight = 240;
constexpr double kBall = 0.03;  // m: radius of the organ

Subject ball_subject(const std::string& tissue = "liver") {
  Subject subject;
  subject.organ = geometry::make_ball(kBall, 1280);
  subject.tissue_name = tissue;
  geometry::Tool tool;
  tool.parts.push_back({});
  tool.parts[0].mesh = geometry::make_ball(0.003, 320);
  subject.tools.push_back(tool);
  return subject;
}

haptics::Snapshot far_tool() {
  haptics::Snapshot snapshot;
  snapshot.hands = 1;
  snapshot.tools[0].pose_W.position = Vec3(0, 0, 5.0);
  return snapshot;
}

haptics::Snapshot pressed(double depth) {
  haptics::Snapshot snapshot = far_tool();
  snapshot.results[0].view_count = 1;
  contact::ContactView& view = snapshot.results[0].views[0];
  view.point_S = Vec3(0, 0, kBall);
  view.direction_S = -Vec3::UnitZ();
  view.depth = depth;
  view.tip_radius = 0.003;
  return snapshot;
}

Camera front_camera() {
  Camera camera;
  camera.eye = Vec3(0, -0.2, 0.12);
  camera.target = Vec3::Zero();
  return camera;
}

struct Colour {
  int red, green, blue;
};

Colour at(const Image& image, int x, int y) {
  const std::size_t i =
      3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
  return {image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]};
}

double brightness(const Image& image, int x, int y) {
  const Colour c = at(image, x, y);
  return (c.red + c.green + c.blue) / 3.0;
}

// Projection of a point, in pixels from the top left corner.
std::array<int, 2> pixel_of(const Camera& camera, const Vec3& p) {
  const Vec3 back = (camera.eye - camera.target).normalized();
  const Vec3 right = camera.up.cross(back).normalized();
  const Vec3 up = back.cross(right);
  const double scale = 0.5 * kPictureHeight / std::tan(0.5 * camera.vertical_view_deg * 3.14159265 / 180.0) /
                       (camera.eye - p).dot(back);
  return {static_cast<int>(0.5 * kPictureWidth + scale * (p - camera.eye).dot(right)),
          static_cast<int>(0.5 * kPictureHeight - scale * (p - camera.eye).dot(up))};
}

// One renderer for all tests: starting OpenGL takes longer than rendering a small picture.
class Offscreen : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    liver_ = std::make_unique<OffscreenRenderer>(ball_subject(), kPictureWidth, kPictureHeight);
  }
  static void TearDownTestSuite() { liver_.reset(); }
  static std::unique_ptr<OffscreenRenderer> liver_;
};
std::unique_ptr<OffscreenRenderer> Offscreen::liver_;

TEST_F(Offscreen, DrawsWithoutADisplayAndNamesItsDriver) {
  EXPECT_FALSE(liver_->driver().empty());
  const Image image = liver_->draw(far_tool(), front_camera());
  EXPECT_EQ(image.width, kPictureWidth);
  EXPECT_EQ(image.height, kPictureHeight);
  EXPECT_EQ(image.rgb.size(), static_cast<std::size_t>(kPictureWidth * kPictureHeight * 3));
  std::set<std::array<int, 3>> colours;
  for (int y = 0; y < kPictureHeight; ++y) {
    for (int x = 0; x < kPictureWidth; ++x) {
      const Colour c = at(image, x, y);
      colours.insert({c.red, c.green, c.blue});
    }
  }
  EXPECT_GT(colours.size(), 1000U);
}

TEST_F(Offscreen, ShowsTheOrganInItsColourBeforeAGreyBackground) {
  const Image image = liver_->draw(far_tool(), front_camera());
  const Colour organ = at(image, kPictureWidth / 2, kPictureHeight / 2);
  EXPECT_GT(organ.red, organ.green + 30);
  EXPECT_GT(organ.red, organ.blue + 30);
  const Colour corner = at(image, 4, 4);
  EXPECT_NEAR(corner.red, corner.green, 16);
  EXPECT_NEAR(corner.green, corner.blue, 16);
}

TEST_F(Offscreen, ADrapeHidesNothingAndIsDarkUnderTheOrgan) {
  Camera camera = front_camera();
  const Image without = liver_->draw(pressed(0.004), camera);
  liver_->show_drape(true);
  const Image with = liver_->draw(pressed(0.004), camera);
  int behind = 0;
  for (int y = 0; y < kPictureHeight; ++y) {
    for (int x = 0; x < kPictureWidth; ++x) {
      const Colour before = at(without, x, y);
      const Colour after = at(with, x, y);
      if (before.red > before.green + 40) {
        EXPECT_EQ(before.red, after.red) << "the organ at " << x << ' ' << y;
      } else if (before.red != after.red) {
        ++behind;
      }
    }
  }
  EXPECT_GT(behind, kPictureWidth * kPictureHeight / 4);
  const auto [x, y] = pixel_of(camera, Vec3(0.0, -0.45 * kBall, -kBall));
  const auto [x_far, y_far] = pixel_of(camera, Vec3(0.0, -1.5 * kBall, -kBall));
  EXPECT_LT(brightness(with, x, y), 0.6 * brightness(with, x_far, y_far)) << "the shadow";

  camera.eye.z() = -0.12;
  const Image from_below = liver_->draw(pressed(0.004), camera);
  liver_->show_drape(false);
  EXPECT_EQ(from_below.rgb, liver_->draw(pressed(0.004), camera).rgb) << "from below";
  EXPECT_EQ(without.rgb, liver_->draw(pressed(0.004), front_camera()).rgb) << "hidden again";
}

TEST_F(Offscreen, IsTheOrgansSizeOnThePicture) {
  const Camera camera = front_camera();
  const Image image = liver_->draw(far_tool(), camera);
  // From distance d, a ball of radius R covers a cone of half angle asin(R/d).
  const double distance = camera.eye.norm();
  const double radius_px = 0.5 * kPictureHeight /
                           std::tan(0.5 * camera.vertical_view_deg * 3.14159265 / 180.0) *
                           std::tan(std::asin(kBall / distance));
  int left = kPictureWidth;
  int right = 0;
  for (int x = 0; x < kPictureWidth; ++x) {
    const Colour c = at(image, x, kPictureHeight / 2);
    if (c.red < c.green + 15) continue;
    left = std::min(left, x);
    right = std::max(right, x);
  }
  EXPECT_NEAR(right - left + 1, 2.0 * radius_px, 3.0);
}

TEST_F(Offscreen, ASameSnapshotGivesTheSamePicture) {
  const Image first = liver_->draw(far_tool(), front_camera());
  EXPECT_EQ(liver_->draw(far_tool(), front_camera()).rgb, first.rgb);
}

TEST_F(Offscreen, APressChangesThePictureAroundTheContactAndNotFarAway) {
  const Camera camera = front_camera();
  const Image rest = liver_->draw(far_tool(), camera);
  const Image dent = liver_->draw(pressed(0.008), camera);
  const auto [x, y] = pixel_of(camera, Vec3(0, 0, kBall));
  double near = 0.0;
  for (int i = -8; i <= 8; ++i)
    near = std::max(near, std::abs(brightness(rest, x + i, y + 4) - brightness(dent, x + i, y + 4)));
  EXPECT_GT(near, 25.0);
  const auto [fx, fy] = pixel_of(camera, Vec3(0, -0.02, -0.02));
  for (int i = -8; i <= 8; ++i) EXPECT_NEAR(brightness(rest, fx + i, fy), brightness(dent, fx + i, fy), 6.0);
  for (const int corner : {2, kPictureWidth - 3})
    EXPECT_EQ(brightness(rest, corner, 2), brightness(dent, corner, 2));
}

TEST_F(Offscreen, ThePressedTopIsLowerByTheDepth) {
  // With the camera level with the contact, the top row of the outline over the contact falls by D.
  Camera camera;
  camera.eye = Vec3(0, -0.25, kBall);
  camera.target = Vec3(0, 0, kBall);
  const auto top_row = [&](const Image& image) {
    for (int y = 0; y < kPictureHeight; ++y) {
      const Colour c = at(image, kPictureWidth / 2, y);
      if (c.red > c.green + 15) return y;
    }
    return kPictureHeight;
  };
  haptics::Snapshot pull = pressed(0.008);
  pull.results[0].views[0].direction_S = Vec3::UnitZ();
  const int rest = top_row(liver_->draw(far_tool(), camera));
  const int tent = top_row(liver_->draw(pull, camera));
  const double rows_a_metre =
      0.5 * kPictureHeight / std::tan(0.5 * camera.vertical_view_deg * 3.14159265 / 180.0) / 0.25;
  EXPECT_NEAR(rest - tent, 0.008 * rows_a_metre, 2.0);
}

TEST_F(Offscreen, AnOrganTurnedInsideOutIsSeenHollow) {
  Subject hollow = ball_subject();
  for (geometry::Triangle& t : hollow.organ.triangles) std::swap(t[1], t[2]);
  const auto upper_minus_lower = [](OffscreenRenderer& renderer) {
    const Image image = renderer.draw(far_tool(), front_camera());
    return brightness(image, kPictureWidth / 2 - 10, kPictureHeight / 2 - 35) -
           brightness(image, kPictureWidth / 2 + 10, kPictureHeight / 2 + 35);
  };
  // The key light is above: a ball is bright on top, a bowl at its bottom.
  OffscreenRenderer inside_out(hollow, kPictureWidth, kPictureHeight);
  EXPECT_GT(upper_minus_lower(*liver_), 30.0);
  EXPECT_LT(upper_minus_lower(inside_out), 0.0);
}

TEST_F(Offscreen, TheToolIsDrawnGreyAtItsPose) {
  const Camera camera = front_camera();
  haptics::Snapshot snapshot = far_tool();
  snapshot.tools[0].pose_W.position = Vec3(0.0, -0.04, 0.02);
  const Image image = liver_->draw(snapshot, camera);
  const Image without = liver_->draw(far_tool(), camera);
  const auto [x, y] = pixel_of(camera, snapshot.tools[0].pose_W.position);
  const Colour steel = at(image, x, y);
  EXPECT_NEAR(steel.red, steel.blue, 25);
  EXPECT_GT(at(without, x, y).red, at(without, x, y).blue + 30);
}

TEST_F(Offscreen, AJawTurnsWithTheGripper) {
  Subject subject = ball_subject();
  geometry::ToolPart& jaw = subject.tools[0].parts[0];
  jaw.mesh = geometry::make_box(Vec3(0.004, 0.004, 0.03), 0.01);
  for (Vec3& v : jaw.mesh.vertices) v.z() += 0.015;
  jaw.is_jaw = true;
  jaw.axis = Vec3::UnitY();
  jaw.open_angle = 3.14159265 / 2.0;  // rotates from +z to +x
  OffscreenRenderer renderer(subject, kPictureWidth, kPictureHeight);
  haptics::Snapshot snapshot = far_tool();
  snapshot.tools[0].pose_W.position = Vec3(0.0, -0.035, 0.01);
  const Camera camera = front_camera();
  const auto [x, y] = pixel_of(camera, snapshot.tools[0].pose_W.position + Vec3(0.02, 0, 0));
  const Colour shut = at(renderer.draw(snapshot, camera), x, y);
  EXPECT_GT(shut.red, shut.blue + 15);
  snapshot.tools[0].gripper = 1.0;
  const Colour open = at(renderer.draw(snapshot, camera), x, y);
  EXPECT_NEAR(open.red, open.blue, 25);
}

TEST_F(Offscreen, TheOrganMovesWithItsPose) {
  haptics::Snapshot snapshot = far_tool();
  snapshot.organ_W.position = Vec3(0.1, 0, 0);
  const Image image = liver_->draw(snapshot, front_camera());
  const Colour middle = at(image, kPictureWidth / 2, kPictureHeight / 2);
  EXPECT_NEAR(middle.red, middle.blue, 25);
}

TEST_F(Offscreen, NothingIsBlackOrGlares) {
  for (const char* tissue : {"gallbladder", "heart", "liver", "kidney", "sponge"}) {
    OffscreenRenderer renderer(ball_subject(tissue), kPictureWidth, kPictureHeight);
    const Image image = renderer.draw(pressed(0.008), front_camera());
    int black = 0;
    int white = 0;
    for (int y = 0; y < kPictureHeight; ++y) {
      for (int x = 0; x < kPictureWidth; ++x) {
        const double b = brightness(image, x, y);
        if (b < 6.0) ++black;
        if (b > 249.0) ++white;
      }
    }
    EXPECT_LT(black, kPictureWidth * kPictureHeight / 500) << tissue;
    EXPECT_LT(white, kPictureWidth * kPictureHeight / 500) << tissue;
  }
}

TEST_F(Offscreen, TwoRenderersDrawInTurn) {
  OffscreenRenderer other(ball_subject("gallbladder"), 64, 48);
  const Image green = other.draw(far_tool(), front_camera());
  EXPECT_EQ(liver_->draw(far_tool(), front_camera()).width, kPictureWidth);
  EXPECT_EQ(other.draw(far_tool(), front_camera()).rgb, green.rgb);
  const Colour c = at(green, 32, 24);
  EXPECT_GT(c.green, c.red - 25);
}

TEST_F(Offscreen, APictureWithoutASizeIsRefused) {
  EXPECT_THROW(OffscreenRenderer(ball_subject(), 0, 100), InputError);
  EXPECT_THROW(OffscreenRenderer(ball_subject(), 100, -1), InputError);
  EXPECT_THROW(OffscreenRenderer(ball_subject(), 100, 100000), InputError);
}

TEST_F(Offscreen, ShowsInclusionsWhereTheyAreStifferPaleAndSofterBlue) {
  const Camera camera = front_camera();
  const Image plain = liver_->draw(far_tool(), camera);
  const Vec3 towards_eye = camera.eye.normalized();
  model::Inclusion inclusion;
  inclusion.radius = 5e-3;
  inclusion.centre_S = 0.8 * kBall * towards_eye;
  liver_->show_inclusions({inclusion});
  const Image stiff = liver_->draw(far_tool(), camera);
  inclusion.ratio = 0.2;
  liver_->show_inclusions({inclusion});
  const Image soft = liver_->draw(far_tool(), camera);
  liver_->show_inclusions({});
  const auto [x, y] = pixel_of(camera, inclusion.centre_S);
  EXPECT_GT(at(stiff, x, y).green, at(plain, x, y).green + 20);
  EXPECT_GT(at(soft, x, y).blue, at(plain, x, y).blue + 20);
  EXPECT_LT(at(soft, x, y).red, at(plain, x, y).red);
  // Beyond the sphere's outline, which no ray that meets the sphere crosses.
  const auto [rim, row] = pixel_of(camera, inclusion.centre_S + 1.2 * inclusion.radius * Vec3::UnitX());
  for (int i = 0; i < kPictureWidth; ++i) {
    if (std::abs(i - x) < rim - x) continue;
    EXPECT_EQ(at(stiff, i, row).green, at(plain, i, row).green) << i;
  }
  EXPECT_EQ(liver_->draw(far_tool(), camera).rgb, plain.rgb) << "taken away again";
}

TEST(Png, IsReadBackAsItWasWritten) {
  Image image{3, 2, {255, 0, 0, 0, 255, 0, 0, 0, 255, 10, 20, 30, 40, 50, 60, 70, 80, 90}};
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "palpate_png_test.png";
  write_png(image, file);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_file(&header, file.c_str()), 0);
  header.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(header));
  ASSERT_NE(png_image_finish_read(&header, nullptr, rgb.data(), 0, nullptr), 0);
  EXPECT_EQ(header.width, 3U);
  EXPECT_EQ(header.height, 2U);
  EXPECT_EQ(rgb, image.rgb);
  std::filesystem::remove(file);
}

TEST(Png, AFileThatCannotBeWrittenIsNamed) {
  const Image image{1, 1, {1, 2, 3}};
  try {
    write_png(image, "/no_such_folder/picture.png");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("/no_such_folder/picture.png"), std::string::npos);
  }
}

TEST(Png, APictureWhoseBytesDoNotFitItsSizeIsRefused) {
  EXPECT_THROW(write_png(Image{2, 2, {1, 2, 3}}, "never.png"), InputError);
  EXPECT_THROW(write_png(Image{}, "never.png"), InputError);
  EXPECT_FALSE(std::filesystem::exists("never.png"));
}

TEST_F(Offscreen, WhatACloseUpShowsOfALargeOrganBeyondTheShadowMapIsLit) {
  Subject subject = ball_subject();
  subject.organ = geometry::make_box(Vec3(0.6, 0.6, 0.02), 0.02);
  Camera camera;
  camera.target = Vec3(0, 0, 0.01);
  camera.eye = camera.target + Vec3(0, -0.11, 0.04);
  OffscreenRenderer renderer(subject, kPictureWidth, kPictureHeight);
  const Image image = renderer.draw(far_tool(), camera);
  const double middle = brightness(image, kPictureWidth / 2, kPictureHeight / 2);
  // On the right and far away, beyond the edge of the shadow map.
  EXPECT_GT(brightness(image, kPictureWidth - 20, 20), 0.7 * middle);
  EXPECT_GT(brightness(image, kPictureWidth - 5, 30), 0.7 * middle);
}

}  // namespace
}  // namespace palpate::render
