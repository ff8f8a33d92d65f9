// Measurements in pictures with a known answer, and rejected pictures.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include "core/base/statistics.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

#include "fit/imaging/image_compare.h"
#include "fit/imaging/image_edge.h"
#include "fit/imaging/image_file.h"
#include "fit/imaging/image_measure.h"
#include "fit/imaging/robust.h"
#include "fit/imaging/test/image_scene.h"

namespace palpate::imaging {
namespace {

using test::SideView;
using testing::HasSubstr;

SideView rest() {
  SideView view;
  view.depth_mm = 0.0;
  view.instrument = false;
  return view;
}

SideView pressed() {
  SideView view;
  view.depth_mm = 5.0;
  return view;
}

ImageSettings settings() {
  ImageSettings settings;
  settings.pixel = 1e-4;
  return settings;
}

ImageMeasurement measure(const SideView& before, const SideView& after,
                         const ImageSettings& with = settings()) {
  return measure_pictures(test::photograph(before), test::photograph(after), with, "before.png", "after.png");
}

/// The error message of a rejected pair; empty when it was accepted.
std::string refusal(const Picture& before, const Picture& after, const ImageSettings& with = settings()) {
  try {
    (void)measure_pictures(before, after, with, "before.png", "after.png");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Picture flat(int width, int height, unsigned char light) {
  return test::picture_of(
      std::vector<unsigned char>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), light),
      width, height);
}

Picture pure_noise(std::uint32_t seed) {
  Random random(seed, 0, 0);
  std::vector<unsigned char> gray(std::size_t{600} * 400);
  for (unsigned char& g : gray) g = static_cast<unsigned char>(256.0 * random.uniform());
  return test::picture_of(gray, 600, 400);
}

double worst_error(const ImageMeasurement& found, const SideView& view) {
  double worst = 0.0;
  for (const ImagePoint& point : found.points) {
    worst = std::max(worst, std::abs(point.u / 1e-4 - test::true_u(view, point.r / 1e-4)));
  }
  return worst;
}

TEST(Image, MeasuresAPress) {
  const ImageMeasurement found = measure(rest(), pressed());
  EXPECT_GT(found.points.size(), 250U);
  EXPECT_LT(worst_error(found, pressed()), 1.0);
  EXPECT_NEAR(found.centre_x, 450.0, 1.0);
  EXPECT_TRUE(found.tip_hidden);  // the ball covers it
  EXPECT_TRUE(found.before.dark_below);
  EXPECT_GT(found.confidence, 50);
}

TEST(Image, MeasuresAPull) {
  SideView after = pressed();
  after.depth_mm = -5.0;
  ImageSettings pull = settings();
  pull.direction = model::Direction::kPull;
  const ImageMeasurement found = measure(rest(), after, pull);
  SideView upwards = after;
  upwards.depth_mm = 5.0;
  EXPECT_LT(worst_error(found, upwards), 1.0);
  EXPECT_GT(found.depth, 1e-3);
}

// Organs of 120 and 60 mm radius: over 900 columns their outline falls by 84 and 169 rows to both sides.
TEST(Image, MeasuresAPressOnACurvedOrgan) {
  for (const double dome : {337.5, 675.0}) {
    SideView before = rest();
    SideView after = pressed();
    before.dome = dome;
    after.dome = dome;
    const ImageMeasurement found = measure(before, after);
    std::vector<double> errors;
    for (const ImagePoint& point : found.points) {
      const double r_px = std::abs(point.x - after.centre_x);
      errors.push_back(std::abs(point.u / 1e-4 - test::true_u(after, r_px)));
    }
    EXPECT_LT(median(errors), 0.5) << dome;
  }
}

TEST(Image, TakesOutTurnAndShiftBetweenThePictures) {
  SideView after = pressed();
  after.turn = 3.0 * M_PI / 180.0;
  after.shift_y = 7.0;
  const ImageMeasurement found = measure(rest(), after);
  EXPECT_NEAR(found.turn * 180.0 / M_PI, 3.0, 0.1);
  for (const ImagePoint& point : found.points) {
    EXPECT_NEAR(point.u / 1e-4, test::true_u(after, point.r / 1e-4), point.uncertainty / 1e-4 + 0.5);
  }
}

TEST(Image, AFixedCameraLeavesNoUncertaintyOfTheFlanks) {
  ImageSettings fixed = settings();
  fixed.fixed_camera = true;
  const ImageMeasurement found = measure(rest(), pressed(), fixed);
  EXPECT_EQ(found.far_uncertainty, 0.0);
  EXPECT_LT(worst_error(found, pressed()), 1.0);
}

TEST(Image, HiddenColumnsGiveNoPoints) {
  SideView after = pressed();
  after.bars = {650.0};
  const ImageMeasurement found = measure(rest(), after);
  for (const ImagePoint& point : found.points) {
    EXPECT_FALSE(point.x > 632.0 && point.x < 668.0) << point.x;
  }
}

TEST(Image, FindsAnEdgeToAHundredthOfAPixel) {
  cv::Mat gray(60, 60, CV_32F);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) {
      gray.at<float>(y, x) =
          static_cast<float>(0.8 - 0.5 * 0.5 * std::erfc(-(y - 30.37) / (1.4 * std::sqrt(2.0))));
    }
  }
  const Edge edge = fit_edge(gray, 30.0, 32.0, 0.0);
  EXPECT_TRUE(edge.found);
  EXPECT_NEAR(32.0 + edge.offset, 30.37, 0.01);
  EXPECT_NEAR(edge.width, 1.4, 0.05);
  EXPECT_NEAR(edge.above, 0.8, 0.01);
  EXPECT_NEAR(edge.below, 0.3, 0.01);
}

TEST(Image, RefusesBlankPictures) {
  EXPECT_THAT(refusal(flat(600, 400, 128), flat(600, 400, 128)), HasSubstr("before.png: no surface line"));
}

TEST(Image, RefusesPureNoise) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    EXPECT_NE(refusal(pure_noise(seed), pure_noise(seed + 50)), "") << seed;
  }
}

TEST(Image, RefusesDifferentSizes) {
  EXPECT_THAT(refusal(flat(600, 400, 128), flat(600, 401, 128)),
              HasSubstr("after.png: is 600 x 401 pixels, must be 600 x 400 as before.png is"));
}

TEST(Image, RefusesTwoEquallyPlausibleLines) {
  Picture striped = test::photograph(rest());
  for (int y = 330; y < striped.height; ++y) {  // a table under the tissue, as bright as the background
    for (int x = 0; x < striped.width; ++x) {
      striped.gray[static_cast<std::size_t>(y) * static_cast<std::size_t>(striped.width) +
                   static_cast<std::size_t>(x)] = 0.75F;
    }
  }
  EXPECT_THAT(refusal(striped, striped), HasSubstr("two lines across the picture are about as plausible"));
}

TEST(Image, RefusesAnEdgeOnASmallPartOnly) {
  SideView view = rest();
  for (int x = 230; x < 900; x += 60) view.bars.push_back(x);  // hidden from there on
  view.bar_width = 70.0;
  EXPECT_NE(refusal(test::photograph(view), test::photograph(view)), "");
}

TEST(Image, RefusesWhatDidNotMove) {
  SideView again = rest();
  again.seed = 9;
  EXPECT_THAT(refusal(test::photograph(rest()), test::photograph(again)), HasSubstr("moved by no more than"));
}

TEST(Image, RefusesTheWrongDirection) {
  SideView bare = pressed();
  bare.instrument = false;
  EXPECT_THAT(refusal(test::photograph(bare), test::photograph(rest())), HasSubstr("moved the other way"));
}

TEST(Image, RefusesADentAtThePicturesEdge) {
  SideView after = pressed();
  after.centre_x = 90.0;
  EXPECT_NE(refusal(test::photograph(rest()), test::photograph(after)), "");
}

TEST(Image, RefusesAScaleThatIsNone) {
  ImageSettings none;
  EXPECT_THAT(refusal(flat(600, 400, 1), flat(600, 400, 1), none), HasSubstr("scale_mm_per_px"));
}

TEST(ImageFile, ReadsPngAndJpeg) {
  const palpate::test::TemporaryFolder folder;
  const Picture drawn = test::photograph(rest());
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(drawn.width);
  header.height = static_cast<png_uint_32>(drawn.height);
  header.format = PNG_FORMAT_RGB;
  ASSERT_NE(png_image_write_to_file(&header, (folder / "a.png").c_str(), 0, drawn.rgb.data(), 0, nullptr), 0);
  const Picture png = read_picture(folder / "a.png");
  EXPECT_EQ(png.width, 900);
  EXPECT_EQ(png.rgb, drawn.rgb);
  std::vector<unsigned char> gray;
  for (std::size_t i = 0; i < drawn.rgb.size(); i += 3) gray.push_back(drawn.rgb[i]);
  const std::vector<unsigned char> bytes = test::as_jpeg(gray, drawn.width, drawn.height, 95);
  std::ofstream(folder / "a.jpg", std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const Picture jpeg = read_picture(folder / "a.jpg");
  EXPECT_EQ(jpeg.height, 460);
  EXPECT_NEAR(jpeg.gray[100], drawn.gray[100], 0.03F);
  std::filesystem::resize_file(folder / "a.jpg", bytes.size() / 2);
  EXPECT_THROW((void)read_picture(folder / "a.jpg"), InputError);
  std::filesystem::resize_file(folder / "a.png", std::filesystem::file_size(folder / "a.png") / 2);
  EXPECT_THROW((void)read_picture(folder / "a.png"), InputError);
}

TEST(ImageFile, RefusesWhatItCannotRead) {
  const palpate::test::TemporaryFolder folder;
  EXPECT_THROW((void)read_picture(folder / "none.png"), InputError);
  std::ofstream(folder / "text.png") << "not a picture";
  EXPECT_THROW((void)read_picture(folder / "text.png"), InputError);
  std::ofstream(folder / "recording.png") << "\x89HDF\r\n\x1a\n";
  EXPECT_THAT([&] { (void)read_picture(folder / "recording.png"); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr(
                  "recording.png: is a recording (HDF5), must be a PNG or JPEG picture; palpate view")));
  // a PNG of 33 bytes that declares 60000 x 60000 pixels
  const unsigned char huge[] = {0x89, 'P',  'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a, 0,    0,    0,
                                13,   'I',  'H', 'D', 'R',  0,    0,    0xea, 0x60, 0,    0,
                                0xea, 0x60, 8,   2,   0,    0,    0,    0x3e, 0x2c, 0x9d, 0x0f};
  std::ofstream(folder / "huge.png", std::ios::binary)
      .write(reinterpret_cast<const char*>(huge), sizeof huge);
  EXPECT_THROW((void)read_picture(folder / "huge.png"), InputError);
}

TEST(Robust, TheMostPointsWin) {
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 30; ++i) {
    x.push_back(i);
    y.push_back(i % 3 == 0 ? 100.0 + i : 2.0 + 0.5 * i);  // every third value is an outlier
  }
  const std::vector<double> line = robust_polynomial(x, y, 1, 0.1);
  EXPECT_NEAR(line[0], 2.0, 1e-2);
  EXPECT_NEAR(line[1], 0.5, 1e-3);
}

// At r = 3 mm a ball of 5 mm radius is 1 mm above its lowest point, at 4 mm 2 mm above. A line that rises by
// 45 degrees from 5.5 mm to the ball's side is 0.5 mm higher there, 5 mm above the lowest point.
TEST(ComparePhotographs, TheVisibleBallBoundsTheDepth) {
  ImageMeasurement measured;
  ImagePoint point;
  point.r = 3e-3;
  point.u = 2e-3;
  point.uncertainty = 0.1e-3;
  measured.points = {point};
  EXPECT_NEAR(deepest_visible(measured, 0.0, 5e-3), 3.1e-3, 1e-12);
  EXPECT_NEAR(deepest_visible(measured, 1e-3 / kPixelError, 5e-3), 4.1e-3, 1e-12);
  measured.points[0].r = 5.5e-3;
  EXPECT_NEAR(deepest_visible(measured, 0.5e-3 / kPixelRange, 5e-3), 7.65e-3, 1e-12);
  EXPECT_EQ(deepest_visible(measured, 0.4e-3 / kPixelRange, 5e-3), std::numeric_limits<double>::infinity());
}

// A tissue of half the picture's width fits best with a much deeper ball. The ball is 5 mm deep.
TEST(ComparePhotographs, AFittedDepthIsNoDeeperThanTheVisibleBall) {
  const test::SideView after = pressed();
  const ImageMeasurement found = measure(rest(), after);
  ASSERT_TRUE(found.tip_hidden);
  model::FalloffRatios narrow;
  narrow.contact_ratio = 0.6;
  const double tip_radius = after.tip_mm * 1e-3;
  const validate::Deformation line = deformation_of(found, "after.png");
  const double deepest = deepest_visible(found, 1e-4, tip_radius);
  EXPECT_GT(deepest, 5e-3);
  EXPECT_LT(deepest, 8e-3);
  EXPECT_GT(nearest_depth(line, narrow, tip_radius, 1.0), 1.2 * deepest);
  EXPECT_LE(nearest_depth(line, narrow, tip_radius, deepest), deepest);
}

TEST(ComparePhotographs, NamesAPictureThatIsNotThere) {
  EXPECT_THROW((void)compare_photographs("none.png", "none.png", {}, {}, 0.0, 3e-3), InputError);
}

}  // namespace
}  // namespace palpate::imaging
