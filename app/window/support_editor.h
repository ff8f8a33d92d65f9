#pragma once
#include <optional>
#include <string>

#include "core/geometry/ray.h"
#include "palpate/pose.h"
#include "palpate/scene.h"
#include "palpate/support.h"
#include "view/report/subject.h"

#include "app/window/live_picture.h"

namespace palpate::app {

struct PanelModel;
struct Commands;

/// What the panel shows of the support.
struct SupportStatus {
  geometry::Support support;
  bool choosing = false;  // a click on the organ attaches it there
  double radius = 8e-3;   // of the next attachment [m]
  double held = 0.0;      // share of the surface
  std::string cells{};    // deform::describe(ResponseCells), from the first support on
  std::string refusal{};  // why the support does not count; empty: it does
  render::ResponseState response = render::ResponseState::kNone;
};

/// A change of the support by the panel.
struct SupportChange {
  std::optional<bool> choosing{};
  std::optional<double> radius{};
  std::optional<geometry::Support> support{};
  bool settled = true;  // false: a value is being dragged; the response waits
};

/// Chooses by hand what holds the organ, for the picture alone: the run and its recording keep the scene's
/// support. All members: [setup], the thread of the picture.
class SupportEditor final {
 public:
  explicit SupportEditor(const scene::Scene& scene);

  [[nodiscard]] bool choosing() const noexcept { return status_.choosing; }
  /// Support that the picture moves by; empty: the profile.
  [[nodiscard]] std::optional<geometry::Support> in_force() const;
  /// Whether the user has changed the scene's support.
  [[nodiscard]] bool changed() const noexcept { return changed_; }

  void apply(const SupportChange& change, LivePicture& picture);
  /// Attaches the organ where a line of sight meets its rest surface. @return whether it does
  bool pick(const geometry::Ray& ray_W, const Pose& organ_W, LivePicture& picture);
  /// Colours what is held, while choosing.
  void draw_on(LivePicture& picture) const;
  [[nodiscard]] SupportStatus status(const LivePicture& picture) const;

 private:
  void set(const geometry::Support& support, bool settled, LivePicture& picture);
  void measure(const geometry::Support& support);

  const geometry::TriangleMesh& organ_;
  SupportStatus status_;
  std::optional<report::SurfacePlaces> places_;  // made when first needed
  bool changed_ = false;
};

/// [setup] The panel's part. @throws nothing
void support_panel(const PanelModel& shown, Commands& commands);

}  // namespace palpate::app
