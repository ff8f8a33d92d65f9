#pragma once
#include <span>

#include "core/contact/contact_patch.h"
#include "core/contact/distance_cache.h"
#include "core/contact/organ_surface.h"
#include "core/contact/tissue_laws.h"
#include "core/contact/tool_points.h"
#include "core/contact/tool_tissue.h"
#include "core/model/relaxation.h"

namespace palpate::contact {

/// Friction at one contact: a spring k_t [N/m] and a damper c_t [N s/m] in parallel, in series with a Coulomb
/// slider,
/// f = k_t s + c_t (s - s_before)/T, |f| <= mu F_n.
/// Spring and cone: [Hayward, Armstrong 2000]; the damper on ds/dt is sigma_1 of [Canudas de Wit et al.
/// 1995]. When the contact slides, f lies on the cone and s is solved from it, so c_t damps the spring and
/// not the slider. f is evaluated at the end of the tick, so it takes at least the energy from the hand that
/// the spring stores.
class FrictionSpring final {
 public:
  explicit FrictionSpring(const Vec3& slip = Vec3::Zero()) noexcept : slip_(slip) {}
  /// [rt] @param motion of the tool at the contact in this tick [m] @return the force on the tool [N]
  [[nodiscard]] Vec3 stretch(double period, const TissueLaws& laws, const Vec3& motion, const Vec3& normal,
                             double normal_force) noexcept;
  /// s [m], in the tangent plane.
  [[nodiscard]] const Vec3& slip() const noexcept { return slip_; }

 private:
  Vec3 slip_;
};

/// Input and result of load sharing for one contact (load_sharing.h). Organ frame.
struct Load {
  SurfacePoint at;                  // the proxy's position
  Vec3 normal = Vec3::UnitZ();      // unit normal at the proxy
  double elastic_force = 0.0;       // F(D) before relaxation [N]
  double fade_weight = 1.0;         // 1 in contact, falls to 0 while the proxy is stale
  double share = 1.0;               // of the tissue, including the fade weight
  model::RelaxationState memory{};  // history variables of the force

  [[nodiscard]] bool fading() const noexcept { return fade_weight < 1.0; }
};

/// The proxy (god-object) of one press contact [Zilles and Salisbury 1995; Ruspini 1997]. It is a point c on
/// the rest surface that walks towards the patch centroid, with a normal that turns at a limited rate, and
/// the contact force (docs/model.md, section 4). Organ frame S.
///
/// Invariants. After walk() the patch is that of c and the normal; walk and turn of a tick are within their
/// limits. Held-back depth is never negative and is admitted within 50 ms. The fade weight is in 0..1. A
/// merged proxy never comes back.
class Proxy final {
 public:
  Proxy() = default;
  Proxy(const SurfacePoint& at, const Vec3& normal, const ContactPatch& patch) noexcept;
  /// [rt] Starts the contact. @param own_motion of the tool there in this tick [m]; depth beyond it is
  /// admitted gradually
  void begin(double own_motion, double odometer, double period) noexcept;

  /// [rt] Up to three steps along the surface towards the patch centroid. The normal turns along, so that the
  /// next step corrects one that is too long.
  void walk(const OrganSurface& surface, const PartPoints& points, const DistanceCache& distances,
            double reference_radius, double period) noexcept;
  /// [rt] Lowers the fade weight of a stale proxy (merged or lost) to 0, or raises it to 1, within 100 ms.
  /// The depth of a stale proxy does not grow.
  void fade(bool is_stale, double period) noexcept;
  /// [rt] Computes force and friction of this tick. @param level press level of the part, 0..1
  void press(const ToolTissue& tissue, const DistanceCache& distances, double level, double period) noexcept;

  /// [rt] Whether the proxy has left its own local maximum of depth and moves towards a deeper contact of the
  /// part, whose patch it would press twice.
  [[nodiscard]] bool is_lost(double reference_radius, std::span<const Proxy> others) const noexcept;
  /// [rt] If two proxies are closer than R_ref/10, marks the weaker one as merged: it stays stale.
  static void merge(Proxy& a, Proxy& b, double reference_radius) noexcept;

  [[nodiscard]] Load& load() noexcept { return load_; }
  [[nodiscard]] const Load& load() const noexcept { return load_; }
  [[nodiscard]] const ContactPatch& patch() const noexcept { return patch_; }
  [[nodiscard]] bool has_merged() const noexcept { return merged_; }
  /// D minus the held-back depth [m].
  [[nodiscard]] double depth() const noexcept { return depth_; }
  /// Point of application of the force.
  [[nodiscard]] const Vec3& application_point() const noexcept { return application_point_; }
  /// Along the normal, damping included [N].
  [[nodiscard]] double normal_force() const noexcept { return normal_force_; }
  /// Tangential [N].
  [[nodiscard]] const Vec3& friction() const noexcept { return friction_; }
  /// Tangential, of tissue that is not uniform: -dU/ds [N]. It pushes the tool off a hard inclusion.
  [[nodiscard]] const Vec3& lateral_force() const noexcept { return lateral_force_; }

 private:
  [[nodiscard]] Vec3 tangential_offset() const noexcept;
  void hold_back_depth(double excess, double period) noexcept;
  [[nodiscard]] double press_at_place(const ToolTissue& tissue) noexcept;
  void follow_patch(const DistanceCache& distances, double period) noexcept;

  Load load_;
  Vec3 surface_normal_ = Vec3::UnitZ();  // at c; load_.normal turns towards it at a limited rate
  double step_ = 0.0;                    // length of the next step of the walk [m]
  Vec3 last_direction_ = Vec3::Zero();   // of the last step
  double walked_ = 0.0;                  // odometer at the last step of the walk
  double offset_ = 0.0;                  // held-back depth [m]
  double offset_step_ = 0.0;             // admitted per tick [m]
  double depth_ = 0.0;
  FrictionSpring spring_;
  Vec3 application_point_ = Vec3::Zero();
  bool merged_ = false;
  ContactPatch patch_;  // in S
  double normal_force_ = 0.0;
  Vec3 friction_ = Vec3::Zero();
  Vec3 lateral_force_ = Vec3::Zero();
  std::array<double, model::kMaxRelaxationTerms> relaxed_depth_{};  // of the tissue that is not uniform [m]
};

/// [rt] The contact patch at a point with a unit normal, all in S. @param guess as in contact_patch_of
[[nodiscard]] ContactPatch patch_in_S(const PartPoints& points, const RigidTransform& placed_S,
                                      const Vec3& point_S, const Vec3& normal_S, double reference_radius,
                                      std::uint32_t guess) noexcept;

}  // namespace palpate::contact
