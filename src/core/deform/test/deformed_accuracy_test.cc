// DeformedSurface with skipped blocks against the same surface computed in full in every frame.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/deform/deformed_surface.h"
#include "core/deform/test/reordered.h"
#include "palpate/builtin.h"
#include "palpate/mesh.h"

namespace palpate::deform {
namespace {

constexpr double kAccuracyRounding = 0.2;
constexpr float kStated = 0.05e-3F;  // m; stated error of a vertex
constexpr float kMaxTurned = 0.03F;  // rad; largest error of a normal
constexpr int kSteps = 1200;         // of fronts per frame, as in pictures

// Halves vertices across their longest side until each part is a block, as pictures do. Where two sides of
// the surface are near each other, a block holds both.
void halve(const geometry::TriangleMesh& mesh, std::span<std::size_t> vertices) {
  if (vertices.size() <= SurfaceBlocks::kBlock) return;
  Vec3 low = mesh.vertices[vertices.front()];
  Vec3 high = low;
  for (const std::size_t v : vertices) {
    low = low.cwiseMin(mesh.vertices[v]);
    high = high.cwiseMax(mesh.vertices[v]);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  std::stable_sort(vertices.begin(), vertices.end(), [&mesh, axis](std::size_t a, std::size_t b) {
    return mesh.vertices[a][axis] < mesh.vertices[b][axis];
  });
  const std::size_t half = (vertices.size() / SurfaceBlocks::kBlock + 1) / 2 * SurfaceBlocks::kBlock;
  halve(mesh, vertices.first(half));
  halve(mesh, vertices.subspan(half));
}

geometry::TriangleMesh in_runs(const geometry::TriangleMesh& mesh) {
  std::vector<std::size_t> order(mesh.vertices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  halve(mesh, order);
  return reordered(mesh, order);
}

// A sheet of 90 x 60 mm with a cleft 2 mm wide and 16 mm deep along y; edges 1 mm.
geometry::TriangleMesh sheet_with_cleft() {
  std::vector<Vec3> line;  // across the cleft
  for (int x = -45; x <= -1; ++x) line.emplace_back(x, 0, 0);
  for (int z = -1; z >= -16; --z) line.emplace_back(-1, 0, z);
  line.emplace_back(0, 0, -16);
  for (int z = -16; z <= -1; ++z) line.emplace_back(1, 0, z);
  for (int x = 1; x <= 45; ++x) line.emplace_back(x, 0, 0);
  const auto across = static_cast<std::int32_t>(line.size());
  geometry::TriangleMesh sheet;
  for (std::int32_t y = 0; y <= 60; ++y) {
    for (const Vec3& p : line) sheet.vertices.emplace_back(1e-3 * (p + Vec3(0, y - 30, 0)));
    for (std::int32_t i = 0; y < 60 && i + 1 < across; ++i) {
      const std::int32_t a = y * across + i;
      sheet.triangles.push_back({a, a + 1, a + across + 1});
      sheet.triangles.push_back({a, a + across + 1, a + across});
    }
  }
  return sheet;
}

// A hollow ball with a wall of 3 mm.
geometry::TriangleMesh hollow_ball() {
  geometry::TriangleMesh ball = geometry::make_ball(0.03, 20480);
  const geometry::TriangleMesh inner = geometry::make_ball(0.027, 20480);
  const auto first = static_cast<std::int32_t>(ball.vertices.size());
  ball.vertices.insert(ball.vertices.end(), inner.vertices.begin(), inner.vertices.end());
  for (const geometry::Triangle& t : inner.triangles)
    ball.triangles.push_back({first + t[0], first + t[2], first + t[1]});
  return ball;
}

// The same contacts on two surfaces: one with skipped blocks as in pictures, one computed in full.
class Pair {
 public:
  explicit Pair(const geometry::TriangleMesh& mesh, const std::shared_ptr<const OrganResponse>& response = {})
      : live_(mesh, {}, kAccuracyRounding), full_(mesh, {}, kAccuracyRounding) {
    live_.set_response(response);
    full_.set_response(response);
  }

  void update(std::span<const Indentation> contacts) {
    for (std::size_t v = 0; v < full_.vertices().size(); v += SurfaceBlocks::kBlock)
      full_.move(static_cast<std::int32_t>(v));
    full_.update(contacts, kSteps);
    live_.update(contacts, kSteps);
    for (std::size_t v = 0; v < full_.vertices().size(); ++v) {
      const SurfaceVertex& a = live_.vertices()[v];
      const SurfaceVertex& b = full_.vertices()[v];
      worst_ = std::max(worst_, (a.position - b.position).norm());
      most_turned_ = std::max(most_turned_, (a.normal - b.normal).norm());
    }
  }
  // Largest error of a vertex [m] and of a normal [rad] over all frames.
  [[nodiscard]] float worst() const { return worst_; }
  [[nodiscard]] float most_turned() const { return most_turned_; }

 private:
  DeformedSurface live_;
  DeformedSurface full_;
  float worst_ = 0.0F;
  float most_turned_ = 0.0F;
};

struct Place {
  Vec3 point, inwards;
};

// Every n-th vertex of a mesh with its inward direction.
std::vector<Place> places_on(const geometry::TriangleMesh& mesh, std::size_t count) {
  std::vector<Place> places;
  for (std::size_t i = 0; i < count; ++i) {
    const geometry::Triangle& t = mesh.triangles[(2 * i + 1) * mesh.triangles.size() / (2 * count)];
    places.push_back({mesh.vertices[static_cast<std::size_t>(t[0])],
                      -geometry::area_vector_doubled(mesh, t).normalized()});
  }
  return places;
}

// Indents by 0.15 mm per frame to 6 mm, holds for some frames and withdraws.
std::vector<double> in_and_out() {
  std::vector<double> depths;
  for (int i = 1; i <= 40; ++i) depths.push_back(0.15e-3 * i);
  depths.insert(depths.end(), 5, depths.back());
  for (int i = 39; i >= 0; --i) depths.push_back(0.15e-3 * i);
  return depths;
}

void expect_stated_accuracy(const Pair& pair, const std::string& what) {
  EXPECT_LT(pair.worst(), kStated) << what;
  EXPECT_LT(pair.most_turned(), kMaxTurned) << what;
}

void expect_stated_accuracy_of_presses(const geometry::TriangleMesh& ordered, std::span<const Place> places,
                                       const std::string& name) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    Pair pair(ordered);
    for (const double depth : in_and_out())
      pair.update(std::vector{Indentation{places[i].point, places[i].inwards, depth, 0.003, 0.0}});
    expect_stated_accuracy(pair, name + ", place " + std::to_string(i));
  }
}

TEST(LiveAccuracy, HoldsWhereRunsHaveBothFacesOfAPlate) {
  const geometry::TriangleMesh plate = in_runs(geometry::make_box(Vec3(0.1, 0.1, 0.006), 0.001));
  const std::vector<Place> places = {{Vec3(0, 0, 0.003), -Vec3::UnitZ()},
                                     {Vec3(0.0123, -0.0071, 0.003), -Vec3::UnitZ()},
                                     {Vec3(-0.02, 0.013, -0.003), Vec3::UnitZ()},
                                     {Vec3(0.047, 0.01, 0.003), -Vec3::UnitZ()}};
  expect_stated_accuracy_of_presses(plate, places, "plate");
}

TEST(LiveAccuracy, HoldsAtBothWallsOfACleft) {
  const geometry::TriangleMesh sheet = in_runs(sheet_with_cleft());
  const std::vector<Place> places = {{Vec3(0.003, 0, 0), -Vec3::UnitZ()},
                                     {Vec3(-0.007, 0.004, 0), -Vec3::UnitZ()},
                                     {Vec3(0.001, -0.003, -0.008), Vec3::UnitX()},
                                     {Vec3(0.012, 0.02, 0), -Vec3::UnitZ()}};
  expect_stated_accuracy_of_presses(sheet, places, "sheet");
}

TEST(LiveAccuracy, HoldsOnAHollowBall) {
  const geometry::TriangleMesh ball = in_runs(hollow_ball());
  expect_stated_accuracy_of_presses(ball, places_on(ball, 6), "hollow ball");
}

TEST(LiveAccuracy, HoldsOnTheBuiltInOrgans) {
  for (const char* const name : {"gallbladder-30k", "heart-30k", "liver-30k", "kidney-30k"}) {
    const geometry::TriangleMesh organ = in_runs(geometry::make_organ(name));
    expect_stated_accuracy_of_presses(organ, places_on(organ, 8), name);
  }
}

// Contacts near a point that slide, separate, turn, begin and end.
std::vector<std::vector<Indentation>> ways_about(const Place& place) {
  const Vec3 aside = place.inwards.unitOrthogonal();
  const Vec3 across = place.inwards.cross(aside);
  std::vector<std::vector<Indentation>> pictures;
  for (int i = 1; i <= 40;
       ++i) {  // two jaws slide 4 mm apart, one deeper; a third contact comes from the other side
    const double depth = 0.12e-3 * i;
    const Vec3 way = 0.1e-3 * i * aside;
    pictures.push_back({{place.point + way, place.inwards, depth, 0.003, 0.0},
                        {place.point + way + 4e-3 * across, place.inwards, 0.7 * depth, 0.002, 0.0}});
    if (i > 15)
      pictures.back().push_back(
          {place.point + 6e-3 * place.inwards, -place.inwards, 0.1e-3 * (i - 15), 0.003, 0.0});
  }
  for (int i = 1; i <= 40; ++i) {  // a pull turns to the side, deep enough to be widened
    const double angle = 0.03 * i;
    const Vec3 direction = std::sin(angle) * aside - std::cos(angle) * place.inwards;
    pictures.push_back({{place.point, direction, 0.15e-3 * i, 0.001, 0.0}});
    if (i > 20) pictures.back().push_back({place.point + 9e-3 * across, direction, 4e-3, 0.001, 0.0});
  }
  for (int i = 1; i <= 15; ++i)  // held by a trembling hand
    pictures.push_back({{place.point, place.inwards, 5e-3 + 0.01e-3 * std::sin(2.0 * i), 0.003, 0.0}});
  pictures.emplace_back();
  return pictures;
}

TEST(LiveAccuracy, HoldsWhereContactsSlidePartAndTurn) {
  const geometry::TriangleMesh plate = in_runs(geometry::make_box(Vec3(0.1, 0.1, 0.006), 0.001));
  const geometry::TriangleMesh sheet = in_runs(sheet_with_cleft());
  const geometry::TriangleMesh liver = in_runs(geometry::make_organ("liver-30k"));
  const auto expect_on = [](const geometry::TriangleMesh& mesh, const Place& place, const std::string& what) {
    Pair pair(mesh);
    for (const std::vector<Indentation>& contacts : ways_about(place)) pair.update(contacts);
    expect_stated_accuracy(pair, what);
  };
  expect_on(plate, {Vec3(0.005, -0.003, 0.003), -Vec3::UnitZ()}, "plate");
  expect_on(sheet, {Vec3(-0.004, 0.0, 0.0), -Vec3::UnitZ()}, "sheet");
  for (const Place& place : places_on(liver, 4)) expect_on(liver, place, "liver");
}

TEST(LiveAccuracy, HoldsWhereAWholeOrganGivesWay) {
  const geometry::TriangleMesh liver = in_runs(geometry::make_organ("liver-30k"));
  geometry::Support support;
  support.bed = geometry::Bed{Vec3::UnitY(), 0.3};
  const auto response = prepare_response(liver, support);
  for (const Place& place : places_on(liver, 4)) {
    Pair pair(liver, response);
    for (const double depth : in_and_out())
      pair.update(std::vector{Indentation{place.point, place.inwards, depth, 0.003, 0.0}});
    for (const std::vector<Indentation>& contacts : ways_about(place)) pair.update(contacts);
    expect_stated_accuracy(pair, "liver on its bed");
  }
}

}  // namespace
}  // namespace palpate::deform
