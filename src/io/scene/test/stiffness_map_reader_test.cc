#include "io/scene/stiffness_map_reader.h"

#include <array>
#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;

const std::string kMappedScene = "[[tool]]\nmesh = \"sphere:5\"\n[organ]\nmesh = \"box\"\n";  // four lines

TEST(StiffnessMapFile, IsReadInMillimetresAndRefusedWithItsLine) {
  const TemporaryFolder folder;
  const auto map = folder.write("map.csv", "x_mm,y_mm,z_mm,factor\n1,2,3,0.5\n4,5,6,2\n");
  const std::vector<model::StiffnessPoint> points = read_stiffness_map(map).points;
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NEAR((points[1].point_S - Vec3(4e-3, 5e-3, 6e-3)).norm(), 0.0, 1e-15);
  EXPECT_EQ(points[0].factor, 0.5);
  const auto zero = folder.write("zero.csv", "x_mm,y_mm,z_mm,factor\n1,2,3,0\n");
  EXPECT_THAT(error_of([&] { (void)read_stiffness_map(zero); }),
              HasSubstr("zero.csv:2: factor = 0: must be a number >= 0.01 and <= 100"));
}

TEST(StiffnessMapFile, ASceneThatNamesItReadsItAndListsItAmongItsFiles) {
  const TemporaryFolder folder;
  const auto map = folder.write("map.csv", "x_mm,y_mm,z_mm,factor\n0,0,20,2\n");
  Overrides request;
  request.scene = folder.write("s.toml", kMappedScene + "[organ.stiffness]\nmap = \"map.csv\"\n");
  const Scene scene = load(request);
  ASSERT_EQ(scene.stiffness.size(), 1U);
  EXPECT_EQ(scene.files.back().path, map);
}

TEST(StiffnessMapFile, APointThatIsNotNearTheSurfaceIsRefusedWithFileAndRow) {
  const TemporaryFolder folder;
  const auto map = folder.write("far.csv", "x_mm,y_mm,z_mm,factor\n0,0,20,2\n0,0,50,2\n");
  Overrides request;
  request.scene = folder.write("s.toml", kMappedScene + "[organ.stiffness]\nmap = \"far.csv\"\n");
  EXPECT_THAT(error_of([&] { (void)load(request); }),
              AllOf(HasSubstr("far.csv: row 2"), HasSubstr("30 mm"), HasSubstr("at most 5 mm")));
}

/// PLY text of vertices with x, y, z and the given properties. @param rows one a vertex
std::string ply(const std::vector<std::string>& properties, const std::vector<std::string>& rows) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(rows.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) text += std::string("property double ") + axis + "\n";
  for (const std::string& property : properties) text += "property " + property + "\n";
  text += "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  for (const std::string& row : rows) text += row + "\n";
  return text + "3 0 0 0\n";
}

const std::vector<std::string> kBytes = {"uchar red", "uchar green", "uchar blue"};
const std::vector<std::string> kFloats = {"float red", "float green", "float blue"};

class StiffnessMapPly : public testing::Test {
 protected:
  StiffnessMapFile read(const std::string& text, const StiffnessMapOptions& options = {}) {
    return read_stiffness_map(folder_.write("scan.ply", text), options);
  }
  std::vector<double> factors(const std::string& text, double black, double white) {
    StiffnessMapOptions options;
    options.factor_at_black = black;
    options.factor_at_white = white;
    std::vector<double> values;
    for (const model::StiffnessPoint& one : read(text, options).points) values.push_back(one.factor);
    return values;
  }
  std::string error(const std::string& text, const StiffnessMapOptions& options = {}) {
    return error_of([&] { (void)read(text, options); });
  }
  std::string colour_error(const std::string& text) {
    return error_of([&] { (void)factors(text, 0.5, 8.0); });
  }

  TemporaryFolder folder_;
};

TEST_F(StiffnessMapPly, GivesTheSameMapAsACsvFileWithTheSameNumbers) {
  const std::vector<model::StiffnessPoint> csv =
      read_stiffness_map(folder_.write("map.csv", "x_mm,y_mm,z_mm,factor\n1.1,2,3,0.7\n-4e1,5,6.3,2\n"))
          .points;
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty double quality\nend_header\n";
  for (const double value : {1.1, 2.0, 3.0, 0.7, -4e1, 5.0, 6.3, 2.0}) {
    std::array<char, sizeof value> bytes{};
    std::memcpy(bytes.data(), &value, sizeof value);
    binary.append(bytes.data(), bytes.size());
  }
  for (const std::string& text : {ply({"double factor"}, {"1.1 2 3 0.7", "-4e1 5 6.3 2"}), binary}) {
    const std::vector<model::StiffnessPoint> points = read(text).points;
    ASSERT_EQ(points.size(), csv.size());
    for (std::size_t i = 0; i < csv.size(); ++i) {
      EXPECT_EQ(points[i].point_S, csv[i].point_S);
      EXPECT_EQ(points[i].factor, csv[i].factor);
    }
  }
}

TEST_F(StiffnessMapPly, IsInTheUnitOfTheOrgan) {
  const std::string text = ply({"float factor"}, {"0 0 0.02 2"});
  EXPECT_NEAR(read(text).points[0].point_S.z(), 2e-5, 1e-18);
  (void)folder_.write("map.ply", text);
  Overrides request;
  request.scene =
      folder_.write("s.toml", kMappedScene + "unit = \"m\"\n[organ.stiffness]\nmap = \"map.ply\"\n");
  EXPECT_NEAR(load(request).stiffness.at(0).point_S.z(), 0.02, 1e-15);
}

TEST_F(StiffnessMapPly, TheLogarithmOfTheFactorIsLinearInTheMeanOfTheColours) {
  const std::string bytes =
      ply(kBytes, {"0 0 0 0 0 0", "0 0 0 255 255 255", "0 0 0 255 0 0", "0 0 0 0 51 0"});
  // 16^(1/3) = 2.5198..., 16^(1/15) = 1.2030...
  EXPECT_THAT(factors(bytes, 0.5, 8.0), testing::ElementsAre(0.5, testing::DoubleNear(8.0, 1e-14),
                                                             testing::DoubleNear(1.2599210498948732, 1e-14),
                                                             testing::DoubleNear(0.6015125180410583, 1e-14)));
  const std::string floats = ply(kFloats, {"0 0 0 1 1 1", "0 0 0 0.25 0.5 0.75"});
  EXPECT_THAT(factors(floats, 4.0, 1.0),
              testing::ElementsAre(testing::DoubleNear(1.0, 1e-15), testing::DoubleNear(2.0, 1e-14)));
}

TEST_F(StiffnessMapPly, TheLargestFactorsAreNotExceededByRounding) {
  const std::string text = ply(kBytes, {"0 0 0 0 0 0", "0 0 0 255 255 255"});
  for (const double factor : factors(text, 0.01, 100.0)) {
    EXPECT_GE(factor, 0.01);
    EXPECT_LE(factor, 100.0);
  }
}

TEST_F(StiffnessMapPly, MoreVerticesThanAMapMayHaveAreThinnedOutAtEvenStepsWithARemark) {
  std::vector<std::string> rows;
  for (int v = 0; v < 50000; ++v) rows.push_back("0 0 " + std::to_string(v) + " 2");
  const StiffnessMapFile map = read(ply({"float factor"}, rows));
  ASSERT_EQ(map.points.size(), 20000U);
  EXPECT_NEAR(map.points[1].point_S.z(), 2e-3, 1e-15);
  EXPECT_NEAR(map.points[2].point_S.z(), 5e-3, 1e-15);
  EXPECT_NEAR(map.points.back().point_S.z(), 49.997, 1e-12);
  EXPECT_EQ(map.name_of(2), "vertex 6");
  EXPECT_THAT(map.remarks, testing::ElementsAre(AllOf(HasSubstr("scan.ply: of its 50000 vertices, 20000"))));
  (void)folder_.write("map.ply", ply({"float factor"}, std::vector<std::string>(20001, "0 0 20 2")));
  Overrides request;
  request.scene = folder_.write("s.toml", kMappedScene + "[organ.stiffness]\nmap = \"map.ply\"\n");
  EXPECT_THAT(load(request).remarks, testing::Contains(HasSubstr("of its 20001 vertices")));
}

TEST_F(StiffnessMapPly, EveryMistakeIsNamedWithFileVertexAndValue) {
  EXPECT_THAT(error(ply({"float factor"}, {"0 0 0 1", "0 0 0 0"})),
              HasSubstr("scan.ply: vertex 2: factor = 0: must be a number >= 0.01 and <= 100"));
  EXPECT_THAT(error(ply({"double quality"}, {"0 0 0 nan"})), HasSubstr("scan.ply: vertex 1: quality = nan"));
  EXPECT_THAT(error(ply({"float factor"}, {"0 nan 0 1"})), HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(colour_error(ply(kBytes, {"0 0 0 1 2 3", "0 0 0 1 256 3"})),
              HasSubstr("scan.ply: vertex 2: green = 256: must be a number >= 0 and <= 255"));
  EXPECT_THAT(colour_error(ply(kFloats, {"0 0 0 1 0.5 -0.5"})),
              HasSubstr("vertex 1: blue = -0.5: must be a number >= 0 and <= 1"));
  EXPECT_THAT(colour_error(ply({"int red", "int green", "int blue"}, {"0 0 0 1 2 3"})),
              HasSubstr("scan.ply: property red must be uchar, or float from 0 to 1"));
  EXPECT_THAT(colour_error(ply({"uchar red", "uchar green"}, {"0 0 0 1 2"})),
              HasSubstr("scan.ply: element vertex must have the property factor or quality, or the colours"));
  EXPECT_THAT(error(ply({"list uchar float factor"}, {"0 0 0 1 2"})),
              HasSubstr("property factor or quality"));
  EXPECT_THAT(error(ply({"float factor"}, {})), HasSubstr("has no vertices"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("no element vertex"));
  EXPECT_THAT(error("ply\nformat ascii 1.0\nelement vertex 2\nproperty float factor\nend_header\n1\n"),
              HasSubstr("truncated"));
  const std::string large(4000002, ' ');
  EXPECT_THAT(error("ply\nformat binary_little_endian 1.0\nelement vertex 4000001\nproperty uchar factor\n"
                    "end_header\n" +
                    large),
              HasSubstr("4000001 vertices: at most 4000000"));
}

TEST_F(StiffnessMapPly, TheFactorsOfBlackAndWhiteAreRequiredWithColoursAndRefusedElsewhere) {
  StiffnessMapOptions white;
  white.factor_at_white = 8.0;
  EXPECT_THAT(error(ply(kBytes, {"0 0 0 1 2 3"}), white),
              HasSubstr("scan.ply: has colours: needs factor_at_black and factor_at_white"));
  EXPECT_THAT(error(ply({"float factor"}, {"0 0 0 1"}), white),
              HasSubstr("scan.ply: has factors, not colours: leave out factor_at_white"));
  (void)folder_.write("map.csv", "x_mm,y_mm,z_mm,factor\n0,0,20,2\n");
  Overrides request;
  const auto error_with = [&](const std::string& value) {
    request.scene = folder_.write(
        "s.toml", kMappedScene + "[organ.stiffness]\nmap = \"map.csv\"\nfactor_at_black = " + value + "\n");
    return error_of([&] { (void)load(request); });
  };
  EXPECT_THAT(error_with("0.5"),
              AllOf(HasSubstr("s.toml:6: organ.stiffness.map"), HasSubstr("map.csv: has factors"),
                    HasSubstr("leave out factor_at_black")));
  EXPECT_THAT(error_with("0"),
              HasSubstr("s.toml:7: organ.stiffness.factor_at_black = 0: must be a number >= 0.01"));
}

}  // namespace
}  // namespace palpate::scene
