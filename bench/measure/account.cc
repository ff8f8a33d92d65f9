#include "bench/measure/account.h"

#include <nlohmann/json.hpp>

namespace palpate::bench {
namespace {

using Json = nlohmann::ordered_json;

/// Adds p50_us and so on, with `prefix` before each name.
void add_times(Json& row, const TimeStatistics& times, const std::string& prefix = "") {
  row[prefix + "p50_us"] = times.p50_us;
  row[prefix + "p99_us"] = times.p99_us;
  row[prefix + "p999_us"] = times.p999_us;
  row[prefix + "max_us"] = times.max_us;
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

}  // namespace

// nlohmann::json finds these by argument-dependent lookup.

void to_json(Json& row, const TickAccount& tick) {
  row = {{"scene", tick.scene},
         {"phase", tick.phase},
         {"organ_triangles", tick.organ_triangles},
         {"tool_triangles", tick.tool_triangles},
         {"ticks", tick.contact.samples}};
  add_times(row, tick.contact);
  row["approach_ticks"] = tick.approach.samples;
  add_times(row, tick.approach, "approach_");
  row["repeats"] = tick.repeats;
  add_times(row, tick.contact_least, "least_");
  add_times(row, tick.approach_least, "approach_least_");
  add_times(row, tick.first, "first_");
}

void to_json(Json& row, const NearestAccount& nearest) {
  row = {{"organ_triangles", nearest.organ_triangles}};
  add_times(row, nearest.times);
}

void to_json(Json& row, const PreparationAccount& one) {
  row = {{"organ", one.organ},
         {"organ_triangles", one.organ_triangles},
         {"seconds", one.seconds},
         {"bytes", one.bytes}};
}

void to_json(Json& row, const HandsRun& run) {
  row = {{"hands", run.hands},
         {"threads", run.threads},
         {"periods", run.periods},
         {"missed", run.missed},
         {"lost", run.lost}};
  add_times(row, run.round, "round_");
  add_times(row, run.wall, "wall_");
  row["worst_core_p999_us"] = run.worst_p999_us;
}

void to_json(Json& row, const HandsAccount& hands) {
  row = {{"bytes_per_hand", hands.bytes_per_hand}};
  if (hands.most.hands > 0) row["most"] = hands.most;
  if (hands.asked.hands > 0) row.update(Json(hands.asked));
}

void to_json(Json& row, const LoopAccount& loop) {
  row = {{"scene", loop.scene},
         {"rate_Hz", loop.rate_Hz},
         {"ticks", loop.ticks},
         {"missed", loop.missed},
         {"missed_empty", loop.missed_empty}};
  add_times(row, loop.late, "late_");
  add_times(row, loop.late_empty, "late_empty_");
}

void to_json(Json& row, const PictureAccount& picture) {
  row = {{"scene", picture.scene},
         {"organ_triangles", picture.organ_triangles},
         {"driver", picture.driver},
         {"pictures", picture.frame.samples},
         {"quality", picture.quality}};
  add_times(row, picture.deformation, "deformation_");
  add_times(row, picture.frame, "frame_");
  add_times(row, picture.frame_computed, "frame_computed_");
  add_times(row, picture.redraw_computed, "redraw_computed_");
  add_times(row, picture.turned_computed, "turned_computed_");
  add_times(row, picture.drape_computed, "drape_computed_");
}

void to_json(Json& row, const PeerAccount& peer) {
  row = {{"name", peer.name},
         {"does", peer.does},
         {"scene", peer.scene},
         {"organ_triangles", peer.organ_triangles},
         {"tool_triangles", peer.tool_triangles},
         {"ticks", peer.contact.samples},
         {"ratio", peer.ratio},
         {"approach_ticks", peer.approach.samples},
         {"approach_ratio", peer.approach_ratio}};
  add_times(row, peer.contact);
  add_times(row, peer.approach, "approach_");
}

std::string to_json(const Account& account) {
  const Json json = {{"machine", account.machine},
                     {"build", account.build},
                     {"command", account.command},
                     {"clock_ns", account.clock_ns},
                     {"tick", account.ticks},
                     {"nearest", account.nearest},
                     {"law_ns", or_null(account.law_ns)},
                     {"inverse_ns", or_null(account.inverse_ns)},
                     {"noise_ns", or_null(account.noise_ns)},
                     {"preparation", account.preparation},
                     {"hands_per_core", account.hands ? Json(account.hands->hands_per_core) : Json(nullptr)},
                     {"hands", account.hands ? Json(*account.hands) : Json(nullptr)},
                     {"loop", account.loops},
                     {"polled", account.polled},
                     {"pictures", account.pictures},
                     {"peers", account.peers},
                     {"remarks", account.remarks}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace palpate::bench
