#pragma once
// Private data of World and State. Only the .cc files of this module include it.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/contact/contact.h"
#include "core/contact/distance_cache.h"
#include "core/contact/grasp.h"
#include "core/contact/inclusions.h"
#include "core/contact/needle.h"
#include "core/contact/organ_surface.h"
#include "core/contact/proxy.h"
#include "core/contact/tissue_laws.h"
#include "core/contact/tool_points.h"
#include "core/contact/tool_tissue.h"

namespace palpate::contact {

constexpr std::size_t kMaxContacts = kMaxHands * kContactsPerPart * kMaxParts;

/// The sampled points of one instrument.
struct ToolPoints {
  std::vector<PartPoints> parts;
  bool has_jaws = false;
  double tip_radius = 0.0;  // at the tip [m]
  std::optional<geometry::Needle> needle{};
};

struct World::Data {
  model::TissueParameters tissue;
  OrganSurface surface;
  std::vector<ToolPoints> tools;
  TissueLaws laws;  // of `tissue`
  double period;    // T [s]
  StiffnessMap map{};
  InclusionState inclusions{};  // before tick 0
};

/// State of one rigid part.
struct PartState {
  PartState(const OrganSurface& surface, const PartPoints& points) : distances(surface, points) {}

  DistanceCache distances;
  double gripper = -1.0;     // gripper value of `joint_T`
  Pose joint_T;              // the part's frame in the handle's
  double press_level = 1.0;  // 0 while the jaws hold tissue
  int contact_count = 0;
  std::uint32_t cursor = 0;         // the next inside point to try for a new contact
  bool may_start_contacts = false;  // has been outside since its last jump
  std::array<Proxy, kContactsPerPart> contacts{};

  [[nodiscard]] std::span<Proxy> active() noexcept {
    return std::span(contacts).first(static_cast<std::size_t>(contact_count));
  }
};

/// State of one tool.
struct ToolState {
  double size_factor = 1.0;  // of the forces of the laws, for this tool's tip radius
  Pose pose_S;               // the handle in the organ's frame, in this tick
  std::vector<PartState> parts;
  std::size_t nearest_part = 0;  // part nearest to the organ at the last search
  Grasp grip;
  NeedleInsertion insertion;
};

struct State::Data {
  std::vector<ToolState> tools;
  std::optional<TissueLaws> updated_laws;  // updated during the run; empty: the world's laws apply
  InclusionState inclusions{};             // in this tick

  [[nodiscard]] const TissueLaws& laws(const World::Data& world) const noexcept {
    return updated_laws ? *updated_laws : world.laws;
  }
};

}  // namespace palpate::contact
