#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/haptics/simulation.h"
#include "palpate/organ_motion.h"
#include "palpate/recording.h"
#include "run/palpation/felt_map.h"

namespace palpate::palpation {

/// A point of the surface that a hand marked while it touched the tissue.
struct Mark {
  std::uint64_t tick = 0;
  std::uint32_t hand = 0;
  Vec3 place_S = Vec3::Zero();        // on the rest surface
  std::optional<std::size_t> lump{};  // within the tolerance of this one, index in Score::lumps
  bool first = false;                 // the first mark of that lump
  double distance = 0.0;              // m, to the nearest lump's place; 0 without lumps
};

/// An inclusion that was to be found.
struct Lump {
  std::string name;
  Vec3 place_S = Vec3::Zero();  // on the rest surface, above its centre
  bool found = false;
  bool covered = false;  // touched within the tolerance
};

/// How a search for inclusions went. docs/lumps.md gives the sources of the measures.
struct Score {
  std::vector<Lump> lumps;
  std::vector<Mark> marks;
  std::size_t found = 0;
  std::size_t missed = 0;
  std::size_t wrong = 0;          // marks outside every lump's tolerance
  std::size_t repeated = 0;       // further marks of a lump that is found
  std::size_t untouched = 0;      // presses of the button without contact, which mark nothing
  std::optional<double> error{};  // m, mean distance of found lumps to their first marks
  double coverage = 0.0;          // share of the search area's surface that was touched, 0 to 1
  double time = 0.0;              // s, from the first contact to the last mark (no mark: the last contact)
  double contact_time = 0.0;      // s, of all hands together
  double path = 0.0;              // m, of the tools' handles in that time
  double mean_force = 0.0;        // N, tissue force over the ticks in contact
  double largest_force = 0.0;     // N
  double force_variation = 0.0;   // standard deviation of the tissue force in contact divided by its mean
  double force_rate = 0.0;  // N/s, root mean square of dF/dt in contact, F averaged over 50 ms: smooth is low
};

/// [setup] @param name of the recording @param remedy how a search is made @throws InputError "NAME: no
/// search in it: WHY; REMEDY" if the scene's task is not palpate and it has no inclusion
void require_search(const scene::Scene& scene, const std::string& name, const std::string& remedy);

/// [setup] The inclusions that a scene hides; in a scene that hides none, all. Their places on the surface.
[[nodiscard]] std::vector<Lump> lumps_of(const scene::Scene& scene);

/// Scores a search row by row, during a run or from a recording. All members: one thread.
class Scorer final {
 public:
  /// [setup] @param scene, world of the run; `world` must outlive this
  Scorer(const scene::Scene& scene, const contact::World& world);

  /// [any] Adds one tick of one hand, in the order of a recording.
  void add(const haptics::TickRow& row);
  /// [any] The score of the rows so far.
  [[nodiscard]] Score score() const;
  /// [any] The marks so far. Whether one found a lump is in score() alone.
  [[nodiscard]] const std::vector<Mark>& marks() const noexcept { return score_.marks; }
  /// [any] How often the button was pressed without contact, so that it marked nothing.
  [[nodiscard]] std::size_t untouched_marks() const noexcept { return score_.untouched; }
  [[nodiscard]] const FeltMap& map() const noexcept { return map_; }

 private:
  /// A hand's forces since its contact began, and its last place.
  struct Hand {
    std::vector<double> forces;  // N
    std::optional<Vec3> tool;
    double path = 0.0;  // m, since the first contact
    bool marking = false;
  };
  void add_force(double force, Hand& hand);
  void add_mark(Mark mark);
  /// The search lasts at least until this row.
  void extend_to(const haptics::TickRow& row);
  [[nodiscard]] double coverage() const;

  double rate_Hz_;
  double tolerance_;  // m
  std::uint32_t mark_bit_;
  std::size_t window_;  // ticks, over which the force is averaged for its rate
  Pose organ_pose_;
  model::OrganMotion motion_;
  FeltMap map_;
  std::vector<double> areas_;  // m^2, of the search area, per vertex of the map's surface
  Score score_;                // its sums are completed by score()
  std::vector<Hand> hands_;
  std::optional<double> began_;  // s, first contact
  std::uint64_t ticks_ = 0;      // in contact, of all hands
  std::uint64_t rate_count_ = 0;
  double sum_ = 0.0;      // N
  double squares_ = 0.0;  // N^2
  double rates_ = 0.0;    // (N/s)^2
};

/// [setup] Calls `use` with every row of a recording. @param progress 0..1
template <typename Use>
void for_each_row(const record::Recording& recording, const record::Progress& progress, const Use& use) {
  constexpr std::size_t kBlock = 10'000;  // rows
  for (std::size_t i = 0; i < recording.rows.size(); ++i) {
    use(recording.rows[i]);
    if (progress && i % kBlock == 0) {
      progress(static_cast<double>(i) / static_cast<double>(recording.rows.size()));
    }
  }
}

/// A scored recording of any task, with the world that its map refers to.
class ScoredRecording final {
 public:
  /// [setup] @param how preparation of the organ @param progress 0..1 @throws InputError as
  /// scene::make_world()
  ScoredRecording(const record::Recording& recording, const contact::Preparation& how = {},
                  const record::Progress& progress = {});

  [[nodiscard]] const Scorer& scorer() const noexcept { return scorer_; }

 private:
  std::unique_ptr<const haptics::SimulationWorld> world_;
  Scorer scorer_;
};

/// One measure of a score, as text.
struct Measure {
  const char* name;
  std::string value;  // with its unit
  std::string definition;
};
/// [setup] All measures, in the order in which text, report and window show them.
[[nodiscard]] std::vector<Measure> measures(const Score& score);

/// [setup] The score as a JSON document. Keys as in docs/file-formats.md.
[[nodiscard]] std::string to_json(const Score& score);

/// [setup] Writes x_mm, y_mm, z_mm, felt_factor, true_factor, depth_mm and force_N of every vertex; a vertex
/// that was never touched has an empty felt_factor. @throws InputError that names the file
void write_map(const FeltMap& map, const std::filesystem::path& file);

}  // namespace palpate::palpation
