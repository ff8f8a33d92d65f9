#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "palpate/base/fetch_list.h"
#include "palpate/base/pose.h"
#include "palpate/contact/preparation.h"
#include "palpate/contact/tissue_laws.h"
#include "palpate/geometry/mesh.h"
#include "palpate/geometry/tool.h"

namespace palpate::contact {

enum class Phase : std::uint8_t { kApproach, kPress, kPull };

/// Bits of ToolResult::status.
inline constexpr std::uint32_t kStartedInside = 1U << 0;  // a part is off until it has been outside
inline constexpr std::uint32_t kContactsFull = 1U << 1;   // more than four contacts wanted on one part
inline constexpr std::uint32_t kGripReleased = 1U << 2;   // past the grip's limit: it has let go
inline constexpr std::uint32_t kJump = 1U << 3;  // moved faster than any hand: treated as placed anew

inline constexpr int kContactsPerPart = 4;
inline constexpr int kMaxParts = 3;
inline constexpr int kMaxViews = kContactsPerPart * kMaxParts + 1;

/// One contact as the picture needs it, in the organ's frame S.
struct ContactView {
  Vec3 point_S = Vec3::Zero();      // on the rest surface
  Vec3 direction_S = Vec3::Zero();  // unit, where the surface goes: inwards (press), towards the tool (pull)
  double depth = 0.0;               // D [m], less while the contact fades
  double tip_radius = 0.0;          // R of the tool there [m]
  double half_width = 0.0;          // of the tool there [m]; 0: no bound
  std::int32_t triangle = -1;       // of the refined rest surface
  bool pull = false;
};

/// What one tool does at one tick.
struct ToolInput {
  Pose pose_W;           // handle
  double gripper = 0.0;  // 0 closed .. 1 open
};

/// What the tissue does to one tool at one tick. World frame, SI.
struct ToolResult {
  Phase phase = Phase::kApproach;
  double distance = 0.0;          // approach: tool to organ [m], negative inside; pressed: -depth; held: 0
  Vec3 nearest_W = Vec3::Zero();  // approach: organ's point nearest to the tool; else contact_W
  Vec3 away_W = Vec3::UnitZ();    // unit: from the tissue to the tool; in contact the contact normal
  Vec3 force_W = Vec3::Zero();    // on the hand, tissue and friction, before the gate [N]
  Vec3 torque_W = Vec3::Zero();   // about the handle's origin [N m]
  double friction = 0.0;          // tangential part of force, norm [N]
  // Of the contact with the largest force (none: 0, and the nearest point):
  double depth = 0.0;    // D, or the stretch when pulled [m]
  int cutoff_layer = 0;  // 0 without contact
  bool saturated = false;
  Vec3 contact_W = Vec3::Zero();
  Vec3 normal_W = Vec3::UnitZ();
  std::uint32_t status = 0;
  int view_count = 0;
  std::array<ContactView, kMaxViews> views{};
};

/// Everything about an organ and its tools that does not change from tick to tick.
class World final {
 public:
  /// [setup] Refines the organ's rest surface, computes its normals and distance tree, resamples the tools.
  /// Works on all processors; no thread of it is left at the end.
  /// @param organ closed, outward-oriented, metres, organ frame S
  /// @param how whether a cache may serve, and whom to tell how far it is
  /// @throws ParameterError for bad tissue values, InputError for a mesh that is not closed or a tool without
  /// points
  ///         or with more than kMaxParts parts.
  World(const geometry::TriangleMesh& organ, const std::vector<geometry::Tool>& tools,
        const model::TissueParameters& tissue, double loop_period, const Preparation& how = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  [[nodiscard]] std::size_t tool_count() const noexcept;
  [[nodiscard]] const model::TissueParameters& tissue() const noexcept;
  [[nodiscard]] const model::SpringLaw& press_law() const noexcept;
  [[nodiscard]] const model::SpringLaw& pull_law() const noexcept;
  /// [any] The refined rest surface that contact points lie on, organ frame.
  [[nodiscard]] const geometry::TriangleMesh& rest_surface() const noexcept;
  /// [any] Radius of curvature [m] of a tool at its tip: given by the user, or estimated from its mesh.
  [[nodiscard]] double tip_radius(std::size_t tool) const noexcept;

  struct Data;
  [[nodiscard]] const Data& data() const noexcept { return *data_; }

 private:
  std::unique_ptr<const Data> data_;
};

/// Everything that changes from tick to tick, for all tools on one organ. Copyable: a copy replays the same.
class State final {
 public:
  /// [setup] All memory that the ticks need; every tool counts as never seen before.
  explicit State(const World& world);
  ~State();
  State(const State&);
  State& operator=(const State&);
  State(State&&) noexcept;
  State& operator=(State&&) noexcept;

  struct Data;
  [[nodiscard]] Data& data() noexcept { return *data_; }
  [[nodiscard]] const Data& data() const noexcept { return *data_; }

 private:
  std::unique_ptr<Data> data_;
};

/// [setup] Adds to `list` where advance() looks at `state` in nearly every tick in contact: while that is not
/// copied to.
void list_memory(const State& state, FetchList& list);

/// [rt] From the next tick on the tissue has these laws. Every contact keeps its place and its depth, so its
/// force is the new law's there, and goes on from what its relaxation remembers; a term that is new has let
/// nothing go yet.
void change_tissue(const World& world, State& state, const TissueLaws& laws) noexcept;

/// [rt] One tick of contact: all tools against the organ's rest surface. A pure function of its arguments.
/// @param organ_W the organ's pose now
/// @param inputs, results one entry a tool, in World's order
void advance(const World& world, const Pose& organ_W, std::span<const ToolInput> inputs, State& state,
             std::span<ToolResult> results) noexcept;

}  // namespace palpate::contact
