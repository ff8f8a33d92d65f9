#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/contact/tissue_laws.h"
#include "palpate/mesh.h"
#include "palpate/pose.h"
#include "palpate/preparation.h"
#include "palpate/tool.h"
#include "palpate/tool_contact.h"

namespace palpate::contact {

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
