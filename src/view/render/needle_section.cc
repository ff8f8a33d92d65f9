// The section is the plane through the needle's axis and a fixed direction across it, in the organ's frame.
// Along 25 lines of the plane, parallel to the needle and 1.3 mm apart, the signed distance of the rest
// surface is queried every millimetre. The depth below the surface rises along a line and falls again on the
// far side, so the line meets the lower boundary of each layer twice:
//
//        needle      edges of one line, n layers
//          |         0        surface
//   _______|_______  1        first boundary, inwards
//          |         n - 1    last boundary, inwards
//          V         n        last boundary, outwards
//   _______________  2n - 1   far side
//
// Between the same two edges of neighbouring lines is a band of one layer. The lines are queried when the
// needle enters the tissue or moves by over 0.5 mm outside, not in every picture.
//
// A contact displaces the tissue along the needle by the displacement profile u(r) of docs/model.md around
// the needle. From the surface to the tip all depths move alike: that is the model of docs/needle.md, in
// which the layer at the tip is that of its material point. Below the tip the displacement fades out, for the
// picture only.
#include "view/render/needle_section.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::render {
namespace {

constexpr double kShownShare = 0.75;   // of the needle's length
constexpr double kStep = 1e-3;         // m, between the queries of a column
constexpr double kFarthest = 40e-3;    // m, from the tip to the surface, where a section is shown
constexpr double kSameLine = 0.5e-3;   // m that a needle outside may move across before the plane follows
constexpr double kReachBelow = 10e-3;  // m below the tip, where the displacement is half; at least its size
constexpr double kSameAxis = 0.9998;   // cosine of the angle that it may turn

double place_on(double below, double at_below, double at_above, double wanted) {
  return below + kStep * (wanted - at_below) / (at_above - at_below);
}

}  // namespace

NeedleSection::NeedleSection(geometry::SignedDistance rest, std::vector<model::TissueLayer> layers,
                             const geometry::Needle& needle, const model::FalloffRatios& reach)
    : rest_(std::move(rest)),
      layers_(std::move(layers)),
      needle_(needle),
      reach_(reach),
      depth_(kShownShare * needle.length) {}

/// Where a line meets the surface and the layers: n edges on the way in, n on the way out, in order. An edge
/// that it does not reach lies where the line is deepest; one behind the end of the section lies at the end.
std::vector<double> NeedleSection::edges_on(const Vec3& from, const Vec3& along) const {
  std::vector<double> wanted{0.0};  // depths below the surface
  for (std::size_t i = 0; i + 1 < layers_.size(); ++i) wanted.push_back(wanted.back() + layers_[i].thickness);
  const std::size_t count = wanted.size();
  const double end = depth_ + kAbove;
  std::vector<double> in(count, end);
  std::vector<double> out(count, end);
  std::vector<bool> met(count, false);
  std::vector<bool> left(count, false);
  std::int32_t guess = -1;
  double before = 0.0;
  double deepest = 0.0;
  double deepest_at = -1.0;
  for (double s = -kAbove; s <= end; s += kStep) {
    const geometry::NearestPoint nearest = rest_.nearest(from + s * along, guess);
    guess = nearest.triangle;
    const double depth = -nearest.distance;
    if (s > -kAbove) {
      for (std::size_t k = 0; k < count; ++k) {
        if (!met[k] && depth >= wanted[k] && before < wanted[k]) {
          in[k] = place_on(s - kStep, before, depth, wanted[k]);
          met[k] = true;
        } else if (met[k] && !left[k] && depth < wanted[k] && before >= wanted[k]) {
          out[k] = place_on(s - kStep, before, depth, wanted[k]);
          left[k] = true;
        }
      }
    }
    if (depth > deepest) {
      deepest = depth;
      deepest_at = s;
    }
    if (left[0]) break;
    before = depth;
  }
  for (std::size_t k = 1; k < count; ++k) {
    if (met[k]) continue;
    left[k] = left[k - 1];
    if (left[k]) in[k] = out[k] = std::clamp(deepest_at, in[k - 1], out[k - 1]);
  }
  in.insert(in.end(), out.rbegin(), out.rend());
  return in;
}

/// Whether the plane still is that of the needle: inside, as long as it is the same insertion.
bool NeedleSection::fits(const Vec3& tip, const Vec3& along, const contact::ContactView* view) const {
  if (!plane_) return false;
  if (view != nullptr) return plane_->contact && (view->point_S - *plane_->contact).norm() < kSameLine;
  const Vec3 way = tip - plane_->entry;
  return along.dot(plane_->along) > kSameAxis &&
         (way - way.dot(plane_->along) * plane_->along).norm() < kSameLine;
}

void NeedleSection::place(const Vec3& point, const Vec3& along) {
  const Vec3 preferred = std::abs(along.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  Plane plane;
  plane.entry = point;
  plane.along = along;
  plane.across = (preferred - preferred.dot(along) * along).normalized();
  for (int i = 0; i < kColumns; ++i) {
    const double across = kHalfWidth * (2.0 * i / (kColumns - 1) - 1.0);
    plane.edges.push_back(edges_on(point + across * plane.across, along));
  }
  plane_ = std::move(plane);
}

std::optional<SectionPicture> NeedleSection::picture(const Pose& handle_S,
                                                     std::span<const contact::ContactView> views) {
  const Vec3 tip = handle_S * needle_.tip;
  const Vec3 axis = handle_S.rotation * needle_.axis;
  const contact::ContactView* const view = views.empty() ? nullptr : views.data();
  if (!fits(tip, axis, view)) {
    plane_.reset();
    if (view != nullptr) {
      place(tip + (view->point_S - tip).dot(axis) * axis, axis);
      plane_->contact = view->point_S;
    } else if (const auto entry = rest_.first_entry(tip - kFarthest * axis, tip + kFarthest * axis)) {
      place(entry->point, axis);
    }
  }
  if (!plane_) return std::nullopt;

  SectionPicture made;
  const auto in_plane = [this](const Vec3& point) {
    return SectionPicture::Point{(point - plane_->entry).dot(plane_->across),
                                 (point - plane_->entry).dot(plane_->along)};
  };
  made.tip = in_plane(tip);
  made.hub = in_plane(tip - needle_.length * axis);
  made.diameter = needle_.diameter;
  const double depth = view == nullptr ? 0.0 : view->depth;
  const deform::DisplacementProfile profile(reach_, depth,
                                            view == nullptr ? needle_.diameter : view->tip_radius,
                                            view == nullptr ? 0.0 : view->half_width);
  const double inwards = view != nullptr && view->direction_S.dot(plane_->along) < 0.0 ? -1.0 : 1.0;
  const double reaches = std::max(kReachBelow, depth);
  const std::size_t last = layers_.size() - 1;
  for (std::size_t edge = 0; edge + 1 < 2 * layers_.size(); ++edge) {
    SectionPicture::Band band;
    band.layer = edge <= last ? edge : 2 * last - edge;
    for (int i = 0; i < kColumns; ++i) {
      const std::vector<double>& edges = plane_->edges[static_cast<std::size_t>(i)];
      const double across = kHalfWidth * (2.0 * i / (kColumns - 1) - 1.0);
      const double moved = inwards * profile.at(std::abs(across - made.tip.across));
      const auto displaced = [&](double at_rest) {
        const double below = std::max(0.0, at_rest - (made.tip.along - inwards * depth)) / reaches;
        return SectionPicture::Point{across, at_rest + moved / (1.0 + below * below)};
      };
      band.outer.push_back(displaced(edges[edge]));
      band.inner.push_back(displaced(edges[edge + 1]));
    }
    // The tip is in the band between whose edges it is at its own place across.
    const double place = std::clamp((made.tip.across / kHalfWidth + 1.0) / 2.0, 0.0, 1.0) * (kColumns - 1);
    const auto column = static_cast<std::size_t>(std::lround(place));
    if (made.tip.along > band.outer[column].along && made.tip.along <= band.inner[column].along) {
      made.layer = band.layer;
    }
    made.bands.push_back(std::move(band));
  }
  return made;
}

}  // namespace palpate::render
