#pragma once
#include <span>

#include "core/contact/contact_patch.h"
#include "core/contact/distance_cache.h"
#include "core/contact/organ_surface.h"
#include "core/contact/tissue_laws.h"
#include "core/contact/tool_points.h"
#include "core/model/relaxation.h"

namespace palpate::contact {

/// Friction at one contact: a spring k_t [N/m] and a damper c_t [N s/m] in parallel, in series with a Coulomb
/// slider,
///   f = k_t s + c_t (s - s_before)/T, |f| <= mu F_n.
/// Spring and cone: [Hayward, Armstrong 2000]; the damper on ds/dt is sigma_1 of [Canudas de Wit et al.
/// 1995]. Where the contact slides, f lies on the cone and s is solved from it, so that c_t damps the spring
/// and not the slider. f is that of the tick's end, so it takes from the hand at least what the spring gains
/// in energy.
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

/// What load sharing needs of a contact, and what it gives it (sharing.h). Organ frame.
struct Load {
  SurfacePoint at;                  // c
  Vec3 normal = Vec3::UnitZ();      // there, unit
  double elastic_force = 0.0;       // F(D) [N]
  double fade_weight = 1.0;         // 1 .. 0 while the contact fades, 0 .. 1 while it comes back
  double share = 1.0;               // of the tissue, fade weight counted in
  model::RelaxationState memory{};  // of the force

  [[nodiscard]] bool fading() const noexcept { return fade_weight < 1.0; }
};

/// The proxy (god-object) of one press contact [Zilles and Salisbury 1995; Ruspini 1997]: a point c on the
/// rest surface that walks towards the deepest place of the tool behind it, with a normal that turns at a
/// limited rate, and the force there (model.md, section 4). Organ frame S.
///
/// Invariants. After walk() the patch is that of c and the normal, and the walk and the turn of a tick are
/// within their limits. Depth that is kept back is never negative and is let in within 50 ms. The fade weight
/// is within 0..1; a proxy that has merged never comes back.
class Proxy final {
 public:
  Proxy() = default;
  /// [rt] Starts at a place. @param own_motion of the tool there in this tick [m]: depth beyond it is let in
  /// gradually
  Proxy(const SurfacePoint& at, const Vec3& normal, const ContactPatch& patch) noexcept;
  void begin(double own_motion, double odometer, double period) noexcept;

  /// [rt] Up to three steps along the surface towards the centroid of the patch; the normal turns along, so
  /// that a step too far shows in the next one.
  void walk(const OrganSurface& surface, const PartPoints& points, const DistanceCache& distances,
            double reference_radius, double period) noexcept;
  /// [rt] Fades out when it is stale (merged or lost), else in, within 100 ms. What fades out gets no deeper.
  void fade(bool is_stale, double period) noexcept;
  /// [rt] Force and friction of this tick. @param level 0..1, of the part's press
  void press(const TissueLaws& laws, const DistanceCache& distances, double level, double period) noexcept;

  /// [rt] Whether it has lost its own deepest place and is on its way to a deeper one of the others: there it
  /// would press what that one presses already.
  [[nodiscard]] bool is_lost(double reference_radius, std::span<const Proxy> others) const noexcept;
  /// [rt] Where the two are closer than R_ref/10 the weaker one becomes stale for good.
  static void merge(Proxy& a, Proxy& b, double reference_radius) noexcept;

  [[nodiscard]] Load& load() noexcept { return load_; }
  [[nodiscard]] const Load& load() const noexcept { return load_; }
  [[nodiscard]] const ContactPatch& patch() const noexcept { return patch_; }
  [[nodiscard]] bool has_merged() const noexcept { return merged_; }
  /// D that counts [m].
  [[nodiscard]] double depth() const noexcept { return depth_; }
  /// Where the force applies.
  [[nodiscard]] const Vec3& touch() const noexcept { return touch_; }
  /// Along the normal, with damping [N].
  [[nodiscard]] double normal_force() const noexcept { return normal_force_; }
  /// Across it [N].
  [[nodiscard]] const Vec3& friction() const noexcept { return friction_; }

 private:
  [[nodiscard]] Vec3 aside() const noexcept;
  void hold_back(double excess, double period) noexcept;
  void follow_patch(const DistanceCache& distances, double period) noexcept;

  Load load_;
  Vec3 surface_normal_ = Vec3::UnitZ();  // at c; load_.normal turns towards it at a limited rate
  double step_ = 0.0;                    // length of the next step of the walk [m]
  Vec3 last_direction_ = Vec3::Zero();   // of the walk
  double walked_ = 0.0;                  // odometer of the part when c last went on
  double offset_ = 0.0;                  // depth not let in yet [m]
  double offset_step_ = 0.0;             // let in a tick [m]
  double depth_ = 0.0;
  FrictionSpring spring_;
  Vec3 touch_ = Vec3::Zero();
  bool merged_ = false;
  ContactPatch patch_;  // in S
  double normal_force_ = 0.0;
  Vec3 friction_ = Vec3::Zero();
};

/// [rt] The patch at a point with a unit normal, all in S. @param guess as of contact_patch_of
[[nodiscard]] ContactPatch patch_in_S(const PartPoints& points, const RigidTransform& placed_S,
                                      const Vec3& point_S, const Vec3& normal_S, double reference_radius,
                                      std::uint32_t guess) noexcept;

}  // namespace palpate::contact
