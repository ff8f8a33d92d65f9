#pragma once
// What World and State hold inside; only the .cc files of this module include it.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/contact.h"
#include "core/contact/contact_patch.h"
#include "core/contact/distance_cache.h"
#include "core/contact/grip.h"
#include "core/contact/organ_surface.h"
#include "core/contact/tissue_laws.h"
#include "core/contact/tool_points.h"

namespace palpate::contact {

constexpr std::size_t kMaxTools = 8;
constexpr std::size_t kMostContacts = kMaxTools * kContactsPerPart * kMaxParts;

/// An instrument as contact sees it.
struct ToolPoints {
  std::vector<PartPoints> parts;
  bool has_jaws = false;
  double tip_radius = 0.0;  // at the tip [m]
};

struct World::Data {
  model::TissueParameters tissue;
  OrganSurface surface;
  std::vector<ToolPoints> tools;
  TissueLaws laws;  // of `tissue`
  double period;    // T [s]
};

/// One press contact; organ frame S.
struct Contact {
  SurfacePoint at;                      // c
  Vec3 surface_normal = Vec3::UnitZ();  // at c
  Vec3 normal = Vec3::UnitZ();          // state: turns towards the surface's normal at a limited rate
  double step = 0.0;                    // length of the next step of the walk [m]
  Vec3 last_direction = Vec3::Zero();   // of the walk
  double walked = 0.0;                  // odometer of the part when c last went on
  double offset = 0.0;                  // depth not let in yet [m]
  double offset_step = 0.0;             // let in a tick [m]
  double depth = 0.0;                   // D that counts, last tick [m]
  Vec3 slip = Vec3::Zero();             // of the tangential spring [m]
  Vec3 touch = Vec3::Zero();            // where the force applies
  bool merged = false;                  // another contact has come to the same place
  double presence = 1.0;                // 1 .. 0 while it leaves, 0 .. 1 while it comes back

  [[nodiscard]] bool leaving() const noexcept { return presence < 1.0; }

  model::RelaxationState memory;  // of the force
  // Of this tick:
  ContactPatch patch;            // in S
  double elastic_force = 0.0;    // F(D) [N]
  double normal_force = 0.0;     // with damping [N]
  Vec3 friction = Vec3::Zero();  // [N]
  double share = 1.0;            // of several contacts on one tissue, presence counted in
};

/// One rigid part from tick to tick.
struct PartState {
  PartState(const OrganSurface& surface, const PartPoints& points) : distances(surface, points) {}

  DistanceCache distances;
  double gripper = -1.0;     // that `joint_T` belongs to
  Pose joint_T;              // of the part's frame in the handle's
  double press_level = 1.0;  // 0 while the jaws hold tissue
  int contact_count = 0;
  std::uint32_t cursor = 0;  // next point to try for a start
  bool armed = false;        // has been outside since it was placed
  std::array<Contact, kContactsPerPart> contacts{};

  [[nodiscard]] std::span<Contact> active() noexcept {
    return std::span(contacts).first(static_cast<std::size_t>(contact_count));
  }
};

/// One tool from tick to tick.
struct ToolState {
  Pose pose_S;  // of the handle in the organ's frame, this tick
  std::vector<PartState> parts;
  std::size_t nearest_part = 0;  // to the organ, when that was last looked for
  Grip grip;
};

struct State::Data {
  std::vector<ToolState> tools;
  std::optional<TissueLaws> changed;  // while the run went on; none: the world's are in force

  [[nodiscard]] const TissueLaws& laws(const World::Data& world) const noexcept {
    return changed ? *changed : world.laws;
  }
};

}  // namespace palpate::contact
