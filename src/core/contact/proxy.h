#pragma once
// The proxy of a press contact and its phases. Proxy::update_phases() changes the phase of every contact of a
// part in each tick, after all of them have walked:
//
//     start ---> entering ---------------------------------------> pressing
//                |      ^    nothing held back, fade weight 1            |
//           lost |      | no longer lost                                 | lost
//                v      |                                                |
//      end <---- lost <--------------------------------------------------+
//            fade weight 0
//      end <---- merged <---- from every phase, near a deeper proxy
//            fade weight 0
//
// entering  A point of the tool went in (press.cc), or a lost contact has a deepest point of its own again.
//           Depth beyond the tool's motion of the first tick is held back, and admitted evenly within 50 ms
//           (kLetIn). After a normal touch there is none, and the phase lasts one tick. After a loss the fade
//           weight rises to 1 within 100 ms (kFade). A hand feels a force that grows without a step.
// pressing  The force is that of the whole depth.
// lost      The patch centroid is more than R_ref/10 aside, towards a deeper contact of the part: the proxy
//           slides into the other's patch, and would press it twice. The contact is stale: its fade weight
//           falls to 0 within 100 ms, and depth that it would gain is held back. A hand feels no step, as
//           load sharing gives its part of the force to the other contact.
// merged    Two proxies closer than R_ref/10 are one contact. The less deep one is stale for good. Both go on
//           with the mean of their relaxation, so the sum of their forces has no step.
//
// From every phase a contact also ends in the tick in which its patch has no depth, and so no force. When the
// part jumps (contact.cc), its contacts end at once.
#include <cstdint>
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

/// Phase of a press contact: see the head of this file.
enum class ContactPhase : std::uint8_t { kEntering, kPressing, kLost, kMerged };

/// Force of one contact on the tool before load sharing. Organ frame.
struct PressForce {
  double normal = 0.0;           // along the normal, damping included [N]
  Vec3 friction = Vec3::Zero();  // tangential [N]
  Vec3 lateral = Vec3::Zero();   // tangential, of tissue that is not uniform: -dU/ds [N]. It pushes the tool
                                 // off a hard inclusion.
};

/// The proxy (god-object) of one press contact [Zilles and Salisbury 1995; Ruspini 1997]. It is a point c on
/// the rest surface that walks towards the patch centroid, with a normal that turns at a limited rate, and
/// the contact force (docs/model.md, section 4). Organ frame S.
///
/// Invariants. After walk() the patch is that of c and the normal; walk and turn of a tick are within their
/// limits. Held-back depth is never negative. In kPressing it is 0 and the fade weight is 1; a stale proxy
/// (kLost, kMerged) has a fade weight below 1 and gets no deeper. kMerged is final.
class Proxy final {
 public:
  Proxy() = default;
  /// [rt] Starts a contact with a patch at a point of the surface.
  Proxy(const SurfacePoint& at, const Vec3& normal, const ContactPatch& patch, const DistanceCache& distances,
        double period) noexcept;

  /// [rt] Up to three steps along the surface towards the patch centroid. The normal turns along, so that the
  /// next step corrects one that is too long.
  void walk(const OrganSurface& surface, const PartPoints& points, const DistanceCache& distances,
            double reference_radius, double period) noexcept;
  /// [rt] Sets phase and fade weight of a part's contacts in this tick. @param all that have not ended
  static void update_phases(double reference_radius, double period, std::span<Proxy> all) noexcept;
  /// [rt] Computes depth and force of this tick. @param level press level of the part, 0..1
  void press(const ToolTissue& tissue, const DistanceCache& distances, double level, double period) noexcept;

  /// [rt] Whether the proxy has left its own local maximum of depth and moves towards a deeper contact of the
  /// part, whose patch it would press twice.
  [[nodiscard]] bool is_lost(double reference_radius, std::span<const Proxy> others) const noexcept;
  [[nodiscard]] bool has_ended() const noexcept { return !(patch_.depth > 0.0 && load_.fade_weight > 0.0); }

  [[nodiscard]] Load& load() noexcept { return load_; }
  [[nodiscard]] const Load& load() const noexcept { return load_; }
  [[nodiscard]] const ContactPatch& patch() const noexcept { return patch_; }
  /// D minus the held-back depth [m].
  [[nodiscard]] double depth() const noexcept { return depth_; }
  [[nodiscard]] const PressForce& force() const noexcept { return force_; }
  /// Of the law at depth(), without stiffness map, inclusions and size of the tool.
  [[nodiscard]] const model::ContactResponse& response() const noexcept { return response_; }
  /// Point of application of the force.
  [[nodiscard]] const Vec3& application_point() const noexcept { return application_point_; }

 private:
  /// State of walk().
  struct Walk {
    Vec3 surface_normal = Vec3::UnitZ();  // at c; the normal of load_ turns towards it
    double step = 0.0;                    // length of the next step [m]
    Vec3 direction = Vec3::Zero();        // of the last step
    double odometer = 0.0;                // at the last step [m]
  };
  /// Depth that the contact does not press with yet.
  struct HeldBack {
    double depth = 0.0;     // [m]
    double admitted = 0.0;  // in each tick [m]
  };

  [[nodiscard]] Vec3 tangential_offset() const noexcept;
  void merge(Proxy& other, double reference_radius) noexcept;
  void hold_back(double excess, double period) noexcept;
  void fade(double period) noexcept;
  void follow_patch(const DistanceCache& distances, double period) noexcept;
  [[nodiscard]] double press_at_place(const ToolTissue& tissue) noexcept;

  ContactPhase phase_ = ContactPhase::kEntering;
  HeldBack held_back_;
  Load load_;  // its fade weight is below 1 only while the contact is stale, or enters after a loss
  Walk walk_;
  ContactPatch patch_;  // in S
  double depth_ = 0.0;
  model::ContactResponse response_;
  Vec3 application_point_ = Vec3::Zero();
  FrictionSpring spring_;
  std::array<double, model::kMaxRelaxationTerms> relaxed_depth_{};  // of the tissue that is not uniform [m]
  PressForce force_;
};

/// [rt] The contact patch at a point with a unit normal, all in S. @param guess as in contact_patch_of
[[nodiscard]] ContactPatch patch_in_S(const PartPoints& points, const RigidTransform& placed_S,
                                      const Vec3& point_S, const Vec3& normal_S, double reference_radius,
                                      std::uint32_t guess) noexcept;

}  // namespace palpate::contact
