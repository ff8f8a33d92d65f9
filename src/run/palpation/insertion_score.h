#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/haptics/simulation.h"
#include "palpate/organ_motion.h"
#include "palpate/recording.h"
#include "run/palpation/score.h"

namespace palpate::palpation {

/// How the insertions of a needle went. docs/needle.md defines every measure.
struct InsertionScore {
  std::size_t targets = 0;  // the layer, or the inclusions; 0: the scene has no target
  std::size_t reached = 0;
  std::optional<double> closest{};     // m, from a tip to a target; 0: in it
  std::optional<double> at_end{};      // m, in the last tick
  std::optional<double> overshoot{};   // m, of the tip beyond its first entry into a target until it stopped
  std::vector<std::string> crossed;    // layers that a tip entered, in this order
  std::vector<std::string> forbidden;  // those that it should not have entered
  std::optional<double> angle{};       // rad, between needle and surface normal at the entry
  std::size_t attempts = 0;
  double time = 0.0;           // s
  double largest_force = 0.0;  // N, tissue force
};

/// [setup] Whether the recordings of this scene have an InsertionScore: task insert.
[[nodiscard]] bool is_insertion(const scene::Scene& scene);

/// Scores the insertions of a run row by row, during it or from a recording. All members: one thread.
class InsertionScorer final {
 public:
  /// [setup] @param scene, world of the run; both must outlive this @throws InputError when the scene's
  /// target is a layer that its tissue does not have
  InsertionScorer(const scene::Scene& scene, const contact::World& world);

  /// [any] Adds one tick of one hand, in the order of a recording.
  void add(const haptics::TickRow& row);
  /// [any] The score of the rows so far.
  [[nodiscard]] InsertionScore score() const;

 private:
  /// A target: a range of depths below the surface, or an inclusion.
  struct Target {
    double low = 0.0;         // m
    double high = 0.0;        // m
    std::uint64_t layer = 0;  // from 1; 0: an inclusion
    const model::Inclusion* inclusion = nullptr;
    bool reached = false;
  };
  struct Hand {
    bool inside = false;
    Vec3 shift_S = Vec3::Zero();   // from the way's origin to the entry on the rest surface
    std::uint64_t layer = 0;       // of the tip in the last row
    std::optional<double> at_end;  // m, to the nearest target in the last row
    double angle = 0.0;            // rad, of the last entry
    std::int32_t nearest = -1;     // triangle
  };
  /// The way of the tip beyond its first entry into a target.
  struct Arrival {
    std::uint32_t hand = 0;
    double farthest = 0.0;  // m, length of the shaft past its entry
    double way = 0.0;       // m, through the tissue
    double grown_at = 0.0;  // s, when it had grown by kRest last
    double grown_to = 0.0;  // m
    bool stopped = false;
  };

  void enter(const haptics::TickRow& row, const Pose& organ_W, const Vec3& tip_S, Hand& hand);
  void cross(const haptics::TickRow& row, Hand& hand);
  bool approach_targets(const haptics::TickRow& row, const Vec3& tip_S, Hand& hand);
  void follow(const haptics::TickRow& row);

  const scene::Scene& scene_;
  const geometry::SignedDistance& surface_;
  model::OrganMotion motion_;
  std::vector<Target> targets_;
  std::vector<Hand> hands_;
  std::optional<Arrival> arrival_;
  std::optional<double> began_;  // s, first contact
  InsertionScore score_;         // without what score() completes
};

/// The score of a search or of insertions.
using AnyScore = std::variant<Score, InsertionScore>;

/// [setup] @param how, progress as ScoredRecording @throws InputError as scene::make_world()
[[nodiscard]] InsertionScore score_insertions(const record::Recording& recording,
                                              const contact::Preparation& how = {},
                                              const record::Progress& progress = {});

/// [setup] As measures(Score) and to_json(Score).
[[nodiscard]] std::vector<Measure> measures(const AnyScore& score);
[[nodiscard]] std::string to_json(const AnyScore& score);

}  // namespace palpate::palpation
