#include "view/render/grasped_fold.h"

#include <algorithm>
#include <cmath>

namespace palpate::render {
namespace {

constexpr double kHeight = 4e-3;     // m, of the fold
constexpr double kThickness = 3e-3;  // m
constexpr double kFullAt = 3e-3;     // m of pull from which the fold is whole
constexpr double kTips = 4e-3;       // m: length of the tips whose width counts
constexpr double kLeastWidth = 2e-3;

// The pull of a hand, and null without one.
const contact::ContactView* pull_of(const contact::ToolResult& result) {
  for (int i = 0; i < std::min(result.view_count, contact::kMaxViews); ++i) {
    const contact::ContactView& view = result.views[static_cast<std::size_t>(i)];
    if (view.pull && view.depth > 0.0) return &view;
  }
  return nullptr;
}

double grown(double depth) {
  const double t = std::clamp(depth / kFullAt, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

GraspedFold::GraspedFold(const Vec3& peak, const Vec3& up, const Vec3& opening, double height,
                         double thickness, double width)
    : peak_(peak),
      middle_(peak.cast<float>()),
      up_(up.cast<float>()),
      across_((opening * (2.0 / thickness)).cast<float>()),
      along_((up.cross(opening) * (2.0 / width)).cast<float>()),
      height_(static_cast<float>(height)) {}

GraspedFold::Raise GraspedFold::raise(const Eigen::Vector3f& now) const noexcept {
  const Eigen::Vector3f offset = now - middle_;
  const float x = offset.dot(across_);
  const float y = offset.dot(along_);
  const float y2 = y * y;
  const float h = height_ * std::exp(-x * x - y2 * y2);
  return {h, -h * (2.0F * x * across_ + 4.0F * y * y2 * along_)};
}

std::optional<Jaws> Jaws::of(const geometry::Tool& tool) {
  Jaws jaws;
  double length = 0.0;
  Vec3 tip = Vec3::Zero();
  const geometry::ToolPart* longest = nullptr;
  for (const geometry::ToolPart& part : tool.parts) {
    if (!part.is_jaw || part.open_angle == 0.0) continue;
    for (const Vec3& v : part.mesh.vertices) {
      if ((v - part.pivot).norm() <= length) continue;
      length = (v - part.pivot).norm();
      tip = v;
      longest = &part;
    }
  }
  if (longest == nullptr) return {};
  const Vec3 axis = longest->axis.normalized();
  const Vec3 arm = (longest->pivot - tip) - (longest->pivot - tip).dot(axis) * axis;
  if (!(arm.norm() > 0.0)) return {};
  jaws.up_ = arm.normalized();
  jaws.opening_ = axis.cross(jaws.up_);
  double low = 0.0;
  double high = 0.0;
  for (const geometry::ToolPart& part : tool.parts) {
    if (!part.is_jaw) continue;
    jaws.opening_m_ += std::abs(part.open_angle) * arm.norm();
    for (const Vec3& v : part.mesh.vertices) {
      if ((v - tip).dot(jaws.up_) > kTips) continue;
      low = std::min(low, (v - tip).dot(axis));
      high = std::max(high, (v - tip).dot(axis));
    }
  }
  jaws.width_ = std::max(kLeastWidth, high - low);
  return jaws;
}

double Jaws::thickness(double depth) noexcept { return kThickness * grown(depth); }

double Jaws::gripper_at(double gap) const noexcept { return std::clamp(gap / opening_m_, 0.0, 1.0); }

GraspedFold Jaws::fold(const Vec3& peak, const Pose& handle, double depth) const {
  return {peak,  handle.rotation * up_, handle.rotation * opening_, kHeight * grown(depth), kThickness,
          width_};
}

double drawn_gripper(const haptics::Snapshot& snapshot, std::size_t hand, const Jaws* jaws) {
  const double gripper = snapshot.tools[hand].gripper;
  const contact::ContactView* pull = jaws == nullptr ? nullptr : pull_of(snapshot.results[hand]);
  if (pull == nullptr) return gripper;
  return std::max(gripper, jaws->gripper_at(Jaws::thickness(pull->depth)));
}

std::vector<GraspedFold> folds_of(const haptics::Snapshot& snapshot,
                                  std::span<const std::optional<Jaws>> jaws) {
  std::vector<GraspedFold> folds;
  const Pose organ_from_world = snapshot.organ_W.inverse();
  const std::size_t hands = std::min({jaws.size(), static_cast<std::size_t>(snapshot.hands), kMaxHands});
  for (std::size_t hand = 0; hand < hands; ++hand) {
    const contact::ContactView* pull = jaws[hand] ? pull_of(snapshot.results[hand]) : nullptr;
    if (pull == nullptr) continue;
    const Vec3 peak = pull->point_S + pull->depth * pull->direction_S;
    folds.push_back(jaws[hand]->fold(peak, organ_from_world * snapshot.tools[hand].pose_W, pull->depth));
  }
  return folds;
}

}  // namespace palpate::render
