#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/signed_distance.h"
#include "palpate/pose.h"
#include "palpate/surface.h"
#include "palpate/tissue.h"
#include "palpate/tool.h"
#include "palpate/tool_contact.h"

namespace palpate::render {

/// A section through an organ along a needle: its layers, as the needle displaces them. Coordinates [m]:
/// `across` the needle, `along` it inwards from where it meets the surface at rest.
struct SectionPicture {
  struct Point {
    double across = 0.0;
    double along = 0.0;
  };
  struct Band {
    std::size_t layer = 0;     // from 0
    std::vector<Point> outer;  // its two edges, as many points each, from left to right
    std::vector<Point> inner;
  };
  std::vector<Band> bands;
  Point tip;
  Point hub;
  double diameter = 0.0;             // of the needle [m]
  std::optional<std::size_t> layer;  // of the tip; none outside the organ
};

/// Colours of the layers from the surface inwards, 0xRRGGBB; also in bindings/web/page/marks.js.
inline constexpr std::array<std::uint32_t, model::kMaxTissueLayers> kLayerColours{
    0xd6a187, 0xe8cc78, 0xba695c, 0xcc9682, 0xdbd6c2, 0x9e5c5e, 0xc2ccd6, 0x6b85a8};

/// Makes the sections of one needle.
class NeedleSection final {
 public:
  static constexpr double kHalfWidth = 16e-3;  // m
  static constexpr double kAbove = 10e-3;      // m outside the surface

  /// [setup] @param rest of the organ's rest surface @param reach falloff of the displacement
  NeedleSection(geometry::SignedDistance rest, std::vector<model::TissueLayer> layers,
                const geometry::Needle& needle, const model::FalloffRatios& reach);

  /// [setup] @param handle_S pose of the needle's handle, organ frame @param views the hand's contacts
  /// @return nothing where the needle points past the organ or is far from it
  [[nodiscard]] std::optional<SectionPicture> picture(const Pose& handle_S,
                                                      std::span<const contact::ContactView> views);

  /// [any] How far below the surface the section goes [m].
  [[nodiscard]] double depth() const noexcept { return depth_; }

 private:
  static constexpr int kColumns = 25;
  /// The plane of the section, and where it meets the layers at rest.
  struct Plane {
    Vec3 entry = Vec3::Zero();    // on the needle's axis, organ frame
    std::optional<Vec3> contact;  // that it was placed for
    Vec3 along = Vec3::Zero();
    Vec3 across = Vec3::Zero();
    // Per column: `along` of each edge, from the surface inwards through all layers and out again.
    std::vector<std::vector<double>> edges;
  };

  [[nodiscard]] std::vector<double> edges_on(const Vec3& from, const Vec3& along) const;
  [[nodiscard]] bool fits(const Vec3& tip, const Vec3& along, const contact::ContactView* view) const;
  void place(const Vec3& point, const Vec3& along);

  geometry::SignedDistance rest_;
  std::vector<model::TissueLayer> layers_;
  geometry::Needle needle_;
  model::FalloffRatios reach_;
  double depth_;
  std::optional<Plane> plane_;
};

}  // namespace palpate::render
