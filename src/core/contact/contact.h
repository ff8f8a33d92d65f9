#pragma once
#include <memory>
#include <span>
#include <vector>

#include "core/contact/inclusions.h"
#include "core/contact/tissue_laws.h"
#include "palpate/inclusion.h"
#include "palpate/mesh.h"
#include "palpate/pose.h"
#include "palpate/preparation.h"
#include "palpate/tool.h"
#include "palpate/tool_contact.h"

namespace palpate::geometry {
class SignedDistance;
}

namespace palpate::contact {

/// [setup] Radius of curvature [m] of a tool at its tip, as World::tip_radius(). @throws InputError for a
/// tool without parts or triangles
[[nodiscard]] double tip_radius_of(const geometry::Tool& tool);

/// The constant part of a simulation: an organ, its tissue and the tools.
class World final {
 public:
  /// [setup] Refines the organ's rest surface, computes its normals and its bounding-volume hierarchy, and
  /// resamples the tools. Uses all processors; its threads end before it returns.
  /// @param organ closed, outward-oriented, metres, organ frame S
  /// @param how cache and progress callback @param variation where the tissue is not uniform
  /// @param distance_of signed distance of the refined organ
  /// @throws ParameterError for bad tissue values; InputError for a mesh that is not closed, or a tool
  /// without points or with more than kMaxParts parts. InputError also for an inclusion that is not inside
  /// the organ, or a point of the stiffness map that is not on its surface.
  World(const geometry::TriangleMesh& organ, const std::vector<geometry::Tool>& tools,
        const model::TissueParameters& tissue, double loop_period, const Preparation& how = {},
        const model::TissueVariation& variation = {}, const DistanceOf& distance_of = build_distance);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  [[nodiscard]] std::size_t tool_count() const noexcept;
  [[nodiscard]] const model::TissueParameters& tissue() const noexcept;
  [[nodiscard]] const model::SpringLaw& press_law() const noexcept;
  [[nodiscard]] const model::SpringLaw& pull_law() const noexcept;
  /// [any] The refined rest surface, organ frame.
  [[nodiscard]] const geometry::TriangleMesh& rest_surface() const noexcept;
  /// [any] The signed distance of rest_surface().
  [[nodiscard]] const geometry::SignedDistance& rest_distance() const noexcept;
  /// [any] Radius of curvature [m] of a tool at its tip: given by the user, or estimated from its mesh.
  [[nodiscard]] double tip_radius(std::size_t tool) const noexcept;
  /// [any] Whether a tool is a needle, which enters a tissue with layers.
  [[nodiscard]] bool has_needle() const noexcept;
  /// [any] The inclusions before tick 0.
  [[nodiscard]] std::vector<model::Inclusion> inclusions() const;

  struct Data;
  [[nodiscard]] const Data& data() const noexcept { return *data_; }

 private:
  std::unique_ptr<const Data> data_;
};

/// The changing part of a simulation: all tools' contacts with one organ. A copy continues with the same
/// results.
class State final {
 public:
  /// [setup] Allocates all memory that ticks need. No tool has a pose yet.
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

/// [rt] Changes the tissue from the next tick on. Proxies and depths stay, so each contact force becomes that
/// of the new law at the same depth. Relaxation keeps its history; a new Prony term begins unrelaxed.
void change_tissue(const World& world, State& state, const TissueLaws& laws) noexcept;

/// [setup] An inclusion in the world's organ. @param index for messages, from 0
/// @throws InputError when it is not valid or not inside the organ
[[nodiscard]] PlacedInclusion placed_inclusion(const World& world, std::size_t index,
                                               const model::Inclusion& inclusion);

/// [rt] Replaces an inclusion from the next tick on. @param index below the number of inclusions
void change_inclusion(State& state, std::size_t index, const PlacedInclusion& placed) noexcept;

/// [rt] Moves the inclusions that pulse to their places in the tick at `time` [s] after tick 0.
void move_inclusions(State& state, double time) noexcept;

/// [rt] One tick of contact: all tools against the organ's rest surface. A pure function of its arguments.
/// @param organ_W the organ's pose in this tick
/// @param inputs, results one entry per tool, in World's order
void advance(const World& world, const Pose& organ_W, std::span<const ToolInput> inputs, State& state,
             std::span<ToolResult> results) noexcept;

}  // namespace palpate::contact
