#include "palpate/support.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/index.h"
#include "core/base/infinity.h"
#include "core/base/text.h"
#include "core/geometry/signed_distance.h"
#include "palpate/error.h"

namespace palpate::geometry {
namespace {

void check_direction(const std::string& field, const Vec3& direction) {
  if (!direction.allFinite() || !(direction.norm() > 1e-9))
    throw InputError(field + ": must be a direction, three finite numbers that are not all 0");
}

Vec3 nearest_point(const TriangleMesh& organ, const Vec3& p) {
  Vec3 best = p;
  double least = kInfinity;
  for (const Triangle& t : organ.triangles) {
    const Vec3 q =
        nearest_on_triangle(p, organ.vertices[at(t[0])], organ.vertices[at(t[1])], organ.vertices[at(t[2])]);
    if ((q - p).squaredNorm() >= least) continue;
    least = (q - p).squaredNorm();
    best = q;
  }
  return best;
}

}  // namespace

void validate(const Support& support) {
  if (support.empty())
    throw InputError(
        "organ.support: must have a bed, faces, an attachment or a painted mesh (docs/support.md)");
  if (support.bed) {
    check_direction("bed.direction", support.bed->direction);
    const double share = support.bed->share;
    if (!(share > 0.0 && share <= kLargestBedShare))
      throw ParameterError("bed.share", share, "a number > 0 and <= " + shortest(kLargestBedShare));
  }
  if (support.faces) check_direction("faces.away_from", support.faces->away_from);
  if (support.attachments.size() > kMaxAttachments)
    throw InputError("attachment: there are " + std::to_string(support.attachments.size()) +
                     ", must be at most " + std::to_string(kMaxAttachments));
  if (support.painted.size() > kMaxPainted)
    throw InputError("painted: there are " + std::to_string(support.painted.size()) +
                     " places, must be at most " + std::to_string(kMaxPainted));
  for (const Attachment& place : support.painted)
    if (!place.point.allFinite() || !(place.radius > 0.0 && place.radius <= kLargestAttachment))
      throw InputError("painted: each place must be finite, with a radius > 0 and <= " +
                       shortest(1e3 * kLargestAttachment) + " mm");
  for (const Attachment& attachment : support.attachments) {
    if (!attachment.point.allFinite()) throw InputError("attachment.point_mm: must be three finite numbers");
    if (!(attachment.radius >= kSmallestAttachment && attachment.radius <= kLargestAttachment))
      throw ParameterError("attachment.radius_mm", 1e3 * attachment.radius,
                           "a number >= " + shortest(1e3 * kSmallestAttachment) +
                               " and <= " + shortest(1e3 * kLargestAttachment));
  }
}

HeldSurface::Cell HeldSurface::cell_of(const Vec3& point) const noexcept {
  Cell cell{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = std::floor(point[static_cast<Eigen::Index>(k)] / painted_edge_);
    cell[k] = static_cast<int>(std::clamp(x, -1e9, 1e9));
  }
  return cell;
}

HeldSurface::HeldSurface(const Support& support, const TriangleMesh& organ) : support_(support) {
  validate(support);
  if (support_.bed) {
    Vec3& direction = support_.bed->direction;
    direction.normalize();
    double low = kInfinity;
    double high = -kInfinity;
    for (const Vec3& v : organ.vertices) {
      low = std::min(low, v.dot(direction));
      high = std::max(high, v.dot(direction));
    }
    bed_from_ = high - support_.bed->share * (high - low);
  }
  for (Attachment& attachment : support_.attachments)
    attachment.point = nearest_point(organ, attachment.point);
  for (const Attachment& place : support_.painted) painted_edge_ = std::max(painted_edge_, place.radius);
  for (std::size_t i = 0; i < support_.painted.size(); ++i)
    painted_.emplace_back(cell_of(support_.painted[i].point), static_cast<std::uint32_t>(i));
  std::sort(painted_.begin(), painted_.end());
}

bool HeldSurface::holds_inside(const Vec3& point) const noexcept {
  return support_.bed && point.dot(support_.bed->direction) > bed_from_;
}

bool HeldSurface::holds(const Vec3& point, const Vec3& normal) const noexcept {
  if (holds_inside(point)) return true;
  if (support_.faces && normal.dot(support_.faces->away_from) < 0.0) return true;
  const auto reaches = [&point](const Attachment& a) {
    return (point - a.point).squaredNorm() < a.radius * a.radius;
  };
  if (std::any_of(support_.attachments.begin(), support_.attachments.end(), reaches)) return true;
  if (painted_.empty()) return false;
  const Cell middle = cell_of(point);
  for (int n = 0; n < 9; ++n) {  // rows of three cells along the last axis
    const Cell first = {middle[0] + n / 3 - 1, middle[1] + n % 3 - 1, middle[2] - 1};
    auto place = std::lower_bound(painted_.begin(), painted_.end(), std::pair(first, std::uint32_t{0}));
    for (; place != painted_.end() && place->first[0] == first[0] && place->first[1] == first[1] &&
           place->first[2] <= middle[2] + 1;
         ++place)
      if (reaches(support_.painted[place->second])) return true;
  }
  return false;
}

double held_share(const Support& support, const TriangleMesh& organ) {
  const HeldSurface held(support, organ);
  double all = 0.0;
  double taken = 0.0;
  for (const Triangle& t : organ.triangles) {
    const Vec3 area = area_vector_doubled(organ, t);
    const Vec3 middle =
        (organ.vertices[at(t[0])] + organ.vertices[at(t[1])] + organ.vertices[at(t[2])]) / 3.0;
    all += area.norm();
    if (held.holds(middle, area)) taken += area.norm();
  }
  return all > 0.0 ? taken / all : 0.0;
}

void check_support(const Support& support, const TriangleMesh& organ) {
  validate(support);
  for (const Attachment& attachment : support.attachments) {
    const double away = (nearest_point(organ, attachment.point) - attachment.point).norm();
    if (away <= attachment.radius) continue;
    const auto tenths = [](double metres) { return shortest(std::round(1e4 * metres) / 10.0); };
    const Vec3& p = attachment.point;
    const auto written = [](double metres) { return shortest(std::round(1e9 * metres) / 1e6); };
    throw InputError("attachment.point_mm = [" + written(p.x()) + ", " + written(p.y()) + ", " +
                     written(p.z()) + "]: is " + tenths(away) +
                     " mm from the organ's surface, must be within its radius of " +
                     tenths(attachment.radius) + " mm (millimetres in the organ's frame?)");
  }
  const double share = held_share(support, organ);
  const auto percent = [](double part) { return shortest(std::round(1e4 * part) / 100.0) + " %"; };
  const std::string stated = "holds " + percent(share) + " of the organ's surface";
  if (share < kLeastHeld)
    throw InputError(stated + ", must hold at least " + percent(kLeastHeld) +
                     ", otherwise the organ would drift or turn away");
  if (share > kMostHeld)
    throw InputError(stated + ", must hold at most " + percent(kMostHeld) + ", otherwise nothing gives way");
}

}  // namespace palpate::geometry
