#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

#include "core/base/text.h"
#include "core/haptics/prepared_update.h"
#include "core/haptics/simulation.h"
#include "io/record/recording_frames.h"
#include "io/record/tick_columns.h"
#include "io/scene/make_world.h"
#include "palpate/error.h"
#include "palpate/parameter_updates.h"
#include "palpate/recording.h"

namespace palpate::record {
namespace {

using haptics::TickRow;

const char* value_of(const TickRow& row, const Column& column) noexcept {
  return reinterpret_cast<const char*>(&row) + column.offset;
}

bool all_zero(const char* bytes, std::size_t count) noexcept {
  return std::all_of(bytes, bytes + count, [](char byte) { return byte == 0; });
}

std::string text_of(const TickRow& row, const Column& column) {
  return haptics::with_number(row, column.type, column.offset, [](auto number) {
    if constexpr (std::is_floating_point_v<decltype(number)>)
      return shortest(number);
    else
      return std::to_string(number);
  });
}

/// Replays a recording, tick by tick.
class Replay final {
 public:
  /// [setup] @throws InputError when ticks or hands are missing, or the scene is invalid.
  explicit Replay(const Recording& recording, const contact::Preparation& how)
      : recording_(recording),
        world_(scene::make_world(recording.scene, how)),
        state_(world_),
        samples_(world_.hands()),
        commands_(world_.hands()),
        rows_(world_.hands()) {
    for (const haptics::ParameterUpdate& change : recording.changes) {
      changes_.push_back(haptics::prepare_update(world_, change));
    }
    for (std::size_t i = 0; i < recording.rows.size(); ++i) {
      const TickRow& row = recording.rows[i];
      if (row.tick != i / hands() || row.hand != i % hands()) {
        throw InputError(fmt::format("the recording lacks tick {} of hand {}; it cannot be replayed",
                                     i / hands(), i % hands()));
      }
    }
  }

  [[nodiscard]] std::size_t hands() const noexcept { return world_.hands(); }
  [[nodiscard]] std::uint64_t ticks() const noexcept { return recording_.rows.size() / hands(); }

  /// Replays the next tick, from 0 on. @throws InputError when the recording lacks a parameter update of this
  /// tick.
  void run_tick(std::uint64_t number) {
    const std::span<const TickRow> recorded = recorded_rows(number);
    change_at(number, (recorded.front().events & haptics::kParameterUpdated) != 0);
    for (std::size_t hand = 0; hand < hands(); ++hand) samples_[hand] = haptics::sample_of(recorded[hand]);
    haptics::tick(world_, state_, number, samples_, commands_, rows_);
  }

  [[nodiscard]] std::span<const TickRow> recorded_rows(std::uint64_t tick) const noexcept {
    return std::span(recording_.rows).subspan(tick * hands(), hands());
  }
  [[nodiscard]] std::span<const TickRow> rows() const noexcept { return rows_; }

  /// All that the next tick depends on.
  struct Checkpoint {
    haptics::SimulationState state;
    std::vector<haptics::ForceCommand> commands;
    std::size_t next_change = 0;
  };
  [[nodiscard]] Checkpoint checkpoint() const { return {state_, commands_, next_change_}; }
  void restore(const Checkpoint& checkpoint) {
    state_ = checkpoint.state;
    commands_ = checkpoint.commands;
    next_change_ = checkpoint.next_change;
  }

  /// The snapshot that the loop publishes, but with the recording's own time.
  [[nodiscard]] haptics::Snapshot snapshot(std::uint64_t number) const {
    haptics::Snapshot snapshot;
    const auto taken_ns = std::llround(static_cast<double>(number) / world_.rate_Hz * 1e9);
    haptics::make_snapshot({state_, commands_, number, taken_ns}, snapshot);
    return snapshot;
  }

 private:
  /// Applies the parameter update of this tick, if there is one.
  void change_at(std::uint64_t number, bool expected) {
    const bool there = next_change_ < changes_.size() && changes_[next_change_].values.tick == number;
    if (there != expected) {
      throw InputError(fmt::format(
          "the recording {} change of tissue or noise at tick {}{}; it cannot be replayed",
          expected ? "lacks the" : "has a", number, expected ? "" : " that its rows do not know"));
    }
    if (there) haptics::apply_update(world_, state_, changes_[next_change_++]);
  }

  const Recording& recording_;
  haptics::SimulationWorld world_;
  haptics::SimulationState state_;
  std::vector<haptics::DeviceState> samples_;
  std::vector<haptics::ForceCommand> commands_;
  std::vector<TickRow> rows_;
  std::vector<haptics::PreparedUpdate> changes_;
  std::size_t next_change_ = 0;
};

}  // namespace

std::string row_difference(const TickRow& recorded, const TickRow& replayed, bool values) {
  for (const Column& column : tick_columns()) {
    if (is_measured_time(column)) continue;
    const char* a = value_of(recorded, column);
    const char* b = value_of(replayed, column);
    if (std::memcmp(a, b, column_size(column.type)) == 0) continue;
    std::string text = fmt::format("tick {}, hand {}, {}", recorded.tick, recorded.hand, column.name);
    if (!values) return text;
    return text +
           fmt::format(": recorded {}, replayed {}", text_of(recorded, column), text_of(replayed, column));
  }
  return {};
}

std::uint64_t hash_rows(std::span<const TickRow> rows, std::uint64_t hash) noexcept {
  constexpr std::uint64_t kPrime = 1099511628211ULL;
  for (const TickRow& row : rows) {
    for (const Column& column : tick_columns()) {
      if (is_measured_time(column)) continue;
      const char* at = value_of(row, column);
      if (column.added_later && all_zero(at, column_size(column.type))) continue;
      for (std::size_t i = 0; i < column_size(column.type); ++i) {
        hash = (hash ^ static_cast<unsigned char>(at[i])) * kPrime;
      }
    }
  }
  return hash;
}

ReplayResult replay(const Recording& recording, const Progress& progress, const contact::Preparation& how) {
  constexpr std::uint64_t kProgressEvery = 1024;  // ticks
  Replay again(recording, how);
  ReplayResult result;
  result.hash = kHashStart;
  const std::uint64_t ticks = again.ticks();
  for (std::uint64_t number = 0; number < ticks; ++number) {
    again.run_tick(number);
    const std::span<const TickRow> recorded = again.recorded_rows(number);
    for (std::size_t hand = 0; hand < again.hands(); ++hand) {
      std::string difference = row_difference(recorded[hand], again.rows()[hand], !recording.facts.blind);
      ++result.rows_compared;
      if (!difference.empty() && ++result.rows_different == 1)
        result.first_difference = std::move(difference);
    }
    result.hash = hash_rows(again.rows(), result.hash);
    if (progress && number % kProgressEvery == 0) {
      progress(static_cast<double>(number) / static_cast<double>(ticks));
    }
  }
  return result;
}

std::vector<haptics::Snapshot> snapshots_at(const Recording& recording,
                                            const std::vector<std::uint64_t>& ticks,
                                            const contact::Preparation& how) {
  Replay again(recording, how);
  std::vector<haptics::Snapshot> snapshots;
  std::uint64_t next = 0;
  for (const std::uint64_t wanted : ticks) {
    if (wanted >= again.ticks()) {
      throw InputError(fmt::format("the recording has no tick {}; it has {} ticks", wanted, again.ticks()));
    }
    if (wanted + 1 < next) throw InputError("snapshots_at: ticks must be in ascending order");
    for (; next <= wanted; ++next) again.run_tick(next);
    snapshots.push_back(again.snapshot(wanted));
  }
  return snapshots;
}

struct RecordingFrames::Impl {
  Impl(const Recording& recorded, const contact::Preparation& how)
      : recording(recorded), again(recorded, how), apart(std::max(kLeastApart, again.ticks() / kMaxKept)) {
    kept.push_back(again.checkpoint());
  }

  /// Continues from the nearest stored state before `tick`, unless the current state is nearer.
  void jump_towards(std::uint64_t tick) {
    const std::uint64_t from = std::min<std::uint64_t>(tick / apart, kept.size() - 1) * apart;
    if (next <= tick + 1 && next >= from) return;
    again.restore(kept[from / apart]);
    next = from;
  }

  void run_one() {
    const std::uint64_t tick = std::exchange(next, kNoTick);  // a failed tick leaves an invalid state
    again.run_tick(tick);
    next = tick + 1;
    if (next == kept.size() * apart) kept.push_back(again.checkpoint());
  }

  static constexpr std::uint64_t kLeastApart = 512;  // ticks
  static constexpr std::uint64_t kMaxKept = 512;
  static constexpr std::uint64_t kNoTick = std::numeric_limits<std::uint64_t>::max();

  const Recording& recording;
  Replay again;
  std::uint64_t apart;                   // ticks between two stored states
  std::vector<Replay::Checkpoint> kept;  // the states before the ticks 0, apart, 2 apart ...
  std::uint64_t next = 0;                // the next tick; kNoTick: a stored state must be restored first
};

RecordingFrames::RecordingFrames(const Recording& recording, const contact::Preparation& how)
    : impl_(std::make_unique<Impl>(recording, how)) {}

RecordingFrames::~RecordingFrames() = default;

std::uint64_t RecordingFrames::ticks() const noexcept { return impl_->again.ticks(); }

bool RecordingFrames::approach(std::uint64_t tick, std::uint64_t most) {
  if (tick >= ticks()) {
    throw InputError(fmt::format("the recording has no tick {}; it has {} ticks", tick, ticks()));
  }
  impl_->jump_towards(tick);
  for (std::uint64_t done = 0; impl_->next <= tick && done < most; ++done) impl_->run_one();
  return impl_->next == tick + 1;
}

haptics::Snapshot RecordingFrames::at(std::uint64_t tick) {
  while (!approach(tick, std::numeric_limits<std::uint64_t>::max())) {
  }
  return impl_->again.snapshot(tick);
}

std::uint64_t RecordingFrames::deepest(std::uint32_t hand) const noexcept {
  const TickRow* best = nullptr;
  for (const TickRow& row : impl_->recording.rows) {
    if (row.hand != hand) continue;
    if (best == nullptr || row.depth > best->depth ||
        (row.depth == best->depth && best->depth == 0.0 && row.distance < best->distance))
      best = &row;
  }
  return best != nullptr ? best->tick : 0;
}

}  // namespace palpate::record
