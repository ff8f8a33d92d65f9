#include "core/deform/organ_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <gtest/gtest.h>

#include "core/base/index.h"
#include "core/deform/body_compliance.h"
#include "core/deform/cell_pieces.h"
#include "core/deform/response_field.h"
#include "palpate/builtin.h"
#include "palpate/error.h"
#include "palpate/mesh.h"
#include "palpate/surface.h"

namespace palpate::deform {
namespace {

// A bar along x, 120 x 24 x 24 mm, held at its end at -60 mm.
constexpr double kLength = 0.12;
constexpr double kWidth = 0.024;
geometry::TriangleMesh bar() { return geometry::make_box(Vec3(kLength, kWidth, kWidth), 4e-3); }

OrganResponse clamped_bar() {
  geometry::Support support;
  support.faces = geometry::HeldFaces{Vec3::UnitX()};
  return OrganResponse(bar(), support);
}

geometry::Support bed() {
  geometry::Support support;
  support.bed = geometry::Bed{-Vec3::UnitZ(), 0.3};
  return support;
}

// Mean motion of the bar's free end along a unit force that is spread evenly over it.
double motion_of_end(const Vec3& force) {
  const OrganResponse response = clamped_bar();
  const OrganResponse::Load end = response.load_at(Vec3(kLength / 2, 0.0, 0.0), Vec3::UnitX(), 10.0 * kWidth);
  OrganResponse::Displacements field = response.none();
  const std::array<OrganResponse::Displacements, 3> under = response.under(end);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t n = 0; n < field.size(); ++n)
      field[n] += static_cast<float>(force[static_cast<Eigen::Index>(axis)]) * under[axis][n];
  }
  return response.work(end, force.cast<float>(), field);
}

TEST(ResponseCells, SayHowMuchOfTheSurfaceIsOnPartsThinnerThanACell) {
  const ResponseCells plate = response_cells(geometry::make_box(Vec3(0.1, 0.1, 4e-3), 4e-3));
  EXPECT_GT(plate.edge, 4e-3);
  EXPECT_NEAR(plate.thin_share, 2.0 * 100.0 * 100.0 / (2.0 * 100.0 * 100.0 + 4.0 * 100.0 * 4.0), 1e-9);
  EXPECT_EQ(response_cells(bar()).thin_share, 0.0);
}

TEST(ResponseCells, AreDescribedInMillimetresAndPercent) {
  EXPECT_EQ(describe({8.5715e-3, 0.0551}),
            "8.57 mm, half as large where the organ is thin; 5.5 % of the surface is on parts thinner than "
            "their cells, where the deformation shown is not reliable");
}

TEST(CellGrid, SplinesReproduceConstantsAndLines) {
  const CellGrid grid({Vec3(-1.0, -2.0, 0.0), Vec3(3.0, 1.0, 2.0)}, 0.7);
  for (const Vec3& point : {Vec3(0.1, 0.2, 0.3), Vec3(2.9, -1.9, 1.7), Vec3(-0.9, 0.9, 0.05)}) {
    const CellGrid::Place place = grid.place_of(point);
    const auto weights = CellGrid::weights(place.within);
    double sum = 0.0;
    Vec3 middle = Vec3::Zero();
    for (std::size_t n = 0; n < weights.size(); ++n) {
      const std::array<std::size_t, 3> offset = {n / 9, n / 3 % 3, n % 3};
      Vec3 node;  // the middle of its splines, in cells
      for (std::size_t axis = 0; axis < 3; ++axis)
        node[static_cast<Eigen::Index>(axis)] = place.cell[axis] + static_cast<double>(offset[axis]) - 0.5;
      sum += weights[n];
      middle += weights[n] * (grid.low() + grid.edge() * node);
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
    EXPECT_LT((middle - point).norm(), 1e-12);
  }
}

TEST(CellPieces, HaveTheVolumeOfABall) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.03, 5000);
  const CellPieces pieces(CellGrid(geometry::bounds(ball), 9e-3), ball);
  double volume = 0.0;
  for (std::size_t piece = 0; piece < pieces.pieces().size(); ++piece)
    volume += pieces.share(piece) * std::pow(pieces.edge_of(piece), 3);
  EXPECT_NEAR(volume / geometry::signed_volume(ball), 1.0, 0.01);
}

TEST(OrganResponse, AClampedBarStretchesByForceTimesLengthOverStiffness) {
  EXPECT_NEAR(motion_of_end(Vec3::UnitX()) / (kLength / (kWidth * kWidth)), 1.0, 0.05);
}

TEST(OrganResponse, AClampedBarBendsLikeABeam) {
  const double inertia = std::pow(kWidth, 4) / 12.0;
  const double area = kWidth * kWidth;
  const double shear = 1.0 / (2.0 * (1.0 + 0.45));
  // Timoshenko's beam, shear coefficient 5/6.
  const double beam = std::pow(kLength, 3) / (3.0 * inertia) + kLength / (5.0 / 6.0 * shear * area);
  EXPECT_NEAR(motion_of_end(Vec3::UnitZ()) / beam, 1.0, 0.08);
}

TEST(OrganResponse, ForceAtOnePlaceMovesAnotherAsMuchAsTheReverse) {
  const geometry::TriangleMesh ball = geometry::make_ball(0.03, 5000);
  const OrganResponse response(ball, bed());
  const Vec3 a = 0.03 * Vec3::UnitZ();
  const Vec3 b = 0.03 * Vec3::UnitX();
  const OrganResponse::Load at_a = response.load_at(a, Vec3::UnitZ(), 8e-3);
  const OrganResponse::Load at_b = response.load_at(b, Vec3::UnitX(), 8e-3);
  const OrganResponse::Displacements by_a = response.under(at_a)[2];
  const OrganResponse::Displacements by_b = response.under(at_b)[0];
  const double there = response.work(at_b, Eigen::Vector3f::UnitX(), by_a);
  EXPECT_NEAR(there, response.work(at_a, Eigen::Vector3f::UnitZ(), by_b), 1e-4 * std::abs(there));
}

TEST(OrganResponse, HoldingTooLittleIsRefused) {
  geometry::Support support;
  support.attachments.push_back({Vec3(0.0, 0.0, 0.012), 0.5e-3});
  EXPECT_THROW(OrganResponse(bar(), support), InputError);
}

// A bar of 16 mm width and 10 mm thickness, bent to a hairpin: two prongs of 60 mm with a gap of 6 mm
// between.
constexpr double kProng = 0.06;
constexpr double kBend = 8e-3;  // radius of its middle line
geometry::TriangleMesh hairpin() {
  const double length = 2.0 * kProng + std::numbers::pi * kBend;
  geometry::TriangleMesh mesh = geometry::make_box(Vec3(length, 16e-3, 10e-3), 2.5e-3);
  for (Vec3& v : mesh.vertices) {
    const double along = v.x() + 0.5 * length;
    const double angle = std::clamp((along - kProng) / kBend, 0.0, std::numbers::pi);
    const double beyond = along - kProng - kBend * angle;  // below 0 on the first prong
    const Vec3 outward(std::sin(angle), 0.0, -std::cos(angle));
    const Vec3 middle = kBend * outward + Vec3(kProng + (angle > 0.0 ? -beyond : beyond), v.y(), 0.0);
    v = middle - v.z() * outward;
  }
  return mesh;
}

TEST(OrganResponse, ProngsOfAHairpinMoveApartLikeBeams) {
  const geometry::TriangleMesh mesh = hairpin();
  ASSERT_GT(geometry::signed_volume(mesh), 0.0);
  geometry::Support support;
  support.attachments.push_back({Vec3(0.0, 0.0, -kBend), 8e-3});
  const OrganResponse response(mesh, support);
  const OrganResponse::Load tip = response.load_at(Vec3(0.0, 0.0, kBend), -Vec3::UnitX(), 10e-3);
  const OrganResponse::Displacements field = response.under(tip)[2];
  const double motion = response.work(tip, Eigen::Vector3f::UnitZ(), field);
  // Strain energy of the bending moment F x, with x from the ends: both prongs and the bend.
  const double inertia = 16e-3 * std::pow(10e-3, 3) / 12.0;
  const double bend = kBend * (std::numbers::pi * kProng * kProng + 4.0 * kProng * kBend +
                               std::numbers::pi * kBend * kBend / 2.0);
  const double beams = (2.0 * std::pow(kProng, 3) / 3.0 + bend) / inertia;
  EXPECT_NEAR(motion / beams, 1.0, 0.15);
}

// Wherever an edge of the surface leads from one piece to another, both have the same displacement.
void expect_continuous(const geometry::TriangleMesh& mesh, const geometry::Support& support, const Vec3& at) {
  const OrganResponse response(mesh, support);
  const CellPieces& pieces = response.pieces();
  const OrganResponse::Displacements field = response.under(response.load_at(at, Vec3::UnitZ(), 8e-3))[2];
  float largest = 0.0F;
  for (const Eigen::Vector4f& u : field) largest = std::max(largest, u.norm());
  std::size_t borders = 0;
  double jump = 0.0;
  for (const geometry::Triangle& t : mesh.triangles) {
    const std::array<Vec3, 3> p = {mesh.vertices[palpate::at(t[0])], mesh.vertices[palpate::at(t[1])],
                                   mesh.vertices[palpate::at(t[2])]};
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 from = p[k];
      Vec3 to = p[(k + 1) % 3];
      if (pieces.place_of(from, normal).piece == pieces.place_of(to, normal).piece) continue;
      while ((to - from).norm() > 1e-9) {
        const Vec3 middle = 0.5 * (from + to);
        const bool same = pieces.place_of(middle, normal).piece == pieces.place_of(from, normal).piece;
        (same ? from : to) = middle;
      }
      ++borders;
      jump = std::max(jump, (response.at(field, pieces.place_of(from, normal)) -
                             response.at(field, pieces.place_of(to, normal)))
                                .norm());
    }
  }
  EXPECT_GT(borders, 100U);
  EXPECT_LT(jump, 1e-5 * static_cast<double>(largest));
}

TEST(OrganResponse, ItsFieldIsContinuousBetweenPiecesAndBetweenCellsOfBothSizes) {
  geometry::Support support;
  support.attachments.push_back({Vec3(0.0, 0.0, -kBend), 8e-3});
  expect_continuous(hairpin(), support, Vec3(0.5 * kProng, 0.0, kBend + 5e-3));
  const geometry::TriangleMesh gallbladder = geometry::make_organ("gallbladder");
  const auto eighths = [&] {
    const CellPieces pieces = finest_pieces(gallbladder);
    return std::count_if(pieces.pieces().begin(), pieces.pieces().end(),
                         [&](const auto& piece) { return pieces.cells().is_eighth(piece.cell); });
  }();
  EXPECT_GT(eighths, 20);
  expect_continuous(gallbladder, bed(), Vec3(0.0, 0.0, 0.017));
}

// --- several contacts

ResponseField::Contact contact_at(const Vec3& outwards, double depth) {
  return {0.03 * outwards, outwards, -depth * outwards, 5e-3};
}

std::shared_ptr<const OrganResponse> resting_ball() {
  return prepare_response(geometry::make_ball(0.03, 5000), bed());
}

TEST(ResponseField, EveryContactReachesItsDepth) {
  ResponseField field(resting_ball());
  const std::array<ResponseField::Contact, 3> contacts = {
      contact_at(Vec3::UnitZ(), 3e-3), contact_at(Vec3::UnitX(), 1e-3),
      ResponseField::Contact{0.03 * Vec3::UnitY(), Vec3::UnitY(), 2e-3 * Vec3(0.3, 0.9, 0.1).normalized(),
                             3e-3}};
  field.set(contacts);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3& point = contacts[i].point;
    const Vec3 u =
        field.at(point.cast<float>(), field.place_of(point, point.normalized())).displacement.cast<double>();
    EXPECT_NEAR(u.dot(contacts[i].normal), contacts[i].displacement.dot(contacts[i].normal), 2e-6) << i;
    EXPECT_EQ(field.missing(i), 0.0) << i;
  }
  // A pull holds its contact in all directions.
  const Vec3 pulled =
      field.at(contacts[2].point.cast<float>(), field.place_of(contacts[2].point, contacts[2].normal))
          .displacement.cast<double>();
  EXPECT_LT((pulled - contacts[2].displacement).norm(), 4e-6);
}

TEST(ResponseField, ADentInAConvexPlaceIsNarrowerUnlessItIsDeep) {
  ResponseField field(resting_ball());
  // inwards at 2 mm beside the contact, of the motion at the contact
  const auto beside = [&](double depth, double curvature) {
    ResponseField::Contact contact = contact_at(Vec3::UnitZ(), depth);
    contact.curvature = curvature;
    field.set({&contact, 1});
    const Vec3 point = 0.03 * Vec3(2.0, 0.0, 30.0).normalized();
    const auto u = field.at(point.cast<float>(), field.place_of(point, point.normalized())).displacement;
    return -static_cast<double>(u.z()) / depth;
  };
  EXPECT_LT(beside(1.5e-3, 300.0), beside(1.5e-3, 0.0) - 0.05);
  EXPECT_LT(beside(6e-3, 0.0) - beside(6e-3, 300.0), 0.02);
}

TEST(ResponseField, APressThatAnotherPushesAwayDoesNotPull) {
  ResponseField field(resting_ball());
  const Vec3 aside = Vec3(0.12, 0.0, 1.0).normalized();
  const std::array<ResponseField::Contact, 2> contacts = {contact_at(Vec3::UnitZ(), 6e-3),
                                                          contact_at(aside, 0.1e-3)};
  field.set(contacts);
  const Vec3& point = contacts[1].point;
  const Vec3 u =
      field.at(point.cast<float>(), field.place_of(point, point.normalized())).displacement.cast<double>();
  EXPECT_LT(u.dot(aside), -2e-3);  // the deeper press takes it along
}

TEST(ResponseField, AWideToolOnAHeldPlaceLacksDepth) {
  ResponseField field(resting_ball());
  ResponseField::Contact contact = contact_at(-Vec3::UnitZ(), 5e-3);
  field.set({&contact, 1});
  EXPECT_EQ(field.missing(0), 0.0);  // a narrow one dents the tissue beside it
  contact.tip_radius = 60e-3;
  field.set({&contact, 1});
  EXPECT_GT(field.missing(0), 0.2);
  EXPECT_LE(field.missing(0), 1.0);
}

TEST(ResponseField, TheSurfaceBulgesBesideAPress) {
  ResponseField field(resting_ball());
  const ResponseField::Contact contact = contact_at(Vec3::UnitZ(), 5e-3);
  field.set({&contact, 1});
  const Vec3 side = 0.03 * Vec3::UnitX();
  const Vec3 u =
      field.at(side.cast<float>(), field.place_of(side, Vec3::UnitX())).displacement.cast<double>();
  EXPECT_GT(u.x(), 0.1e-3);  // nearly incompressible: the equator moves outwards
}

TEST(ResponseField, TheGradientIsTheDerivativeOfTheDisplacement) {
  ResponseField field(resting_ball());
  const ResponseField::Contact contact = contact_at(Vec3::UnitZ(), 5e-3);
  field.set({&contact, 1});
  constexpr float kStep = 1e-4F;
  for (const Vec3& direction : {Vec3(0.3, 0.2, 1.0), Vec3(1.0, 0.3, 0.2), Vec3(-0.7, 0.7, 0.3)}) {
    const Vec3 point = 0.03 * direction.normalized();
    const PlaceMotion here = field.at(point.cast<float>(), field.place_of(point, point.normalized()));
    // Along the surface, where the half-space's part is meant; its part along the normal is not drawn.
    const Vec3 along = point.cross(Vec3::UnitZ()).cross(point).normalized();
    const Vec3 before = point - kStep * along;
    const Vec3 after = point + kStep * along;
    const Eigen::Vector3f slope =
        (field.at(after.cast<float>(), field.place_of(after, after.normalized())).displacement -
         field.at(before.cast<float>(), field.place_of(before, before.normalized())).displacement) /
        (2.0F * kStep);
    EXPECT_LT((here.gradient * along.cast<float>() - slope).norm(), 0.06F) << direction.transpose();
  }
}

}  // namespace
}  // namespace palpate::deform
