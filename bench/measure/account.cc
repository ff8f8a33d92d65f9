#include "bench/measure/account.h"

#include <nlohmann/json.hpp>

namespace palpate::bench {
namespace {

using Json = nlohmann::ordered_json;

/// p50_us and so on, each name after `prefix`.
void add_figures(Json& row, const TimeFigures& figures, const std::string& prefix = "") {
  row[prefix + "p50_us"] = figures.p50_us;
  row[prefix + "p99_us"] = figures.p99_us;
  row[prefix + "p999_us"] = figures.p999_us;
  row[prefix + "max_us"] = figures.max_us;
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json ticks_json(const Account& account) {
  Json rows = Json::array();
  for (const TickAccount& tick : account.ticks) {
    Json row;
    row["scene"] = tick.scene;
    row["phase"] = tick.phase;
    row["organ_triangles"] = tick.organ_triangles;
    row["tool_triangles"] = tick.tool_triangles;
    row["ticks"] = tick.contact.samples;
    add_figures(row, tick.contact);
    row["approach_ticks"] = tick.approach.samples;
    add_figures(row, tick.approach, "approach_");
    row["repeats"] = tick.repeats;
    add_figures(row, tick.contact_least, "least_");
    add_figures(row, tick.approach_least, "approach_least_");
    row["plain_samples"] = tick.plain.samples;
    add_figures(row, tick.plain, "plain_");
    add_figures(row, tick.plain_least, "plain_least_");
    rows.push_back(row);
  }
  return rows;
}

Json nearest_json(const Account& account) {
  Json rows = Json::array();
  for (const NearestAccount& nearest : account.nearest) {
    Json row;
    row["organ_triangles"] = nearest.organ_triangles;
    add_figures(row, nearest.times);
    rows.push_back(row);
  }
  return rows;
}

Json preparation_json(const Account& account) {
  Json rows = Json::array();
  for (const PreparationAccount& one : account.preparation) {
    rows.push_back({{"organ", one.organ},
                    {"organ_triangles", one.organ_triangles},
                    {"seconds", one.seconds},
                    {"bytes", one.bytes}});
  }
  return rows;
}

void add_run(Json& row, const HandsRun& run) {
  row["hands"] = run.hands;
  row["threads"] = run.threads;
  row["periods"] = run.periods;
  row["missed"] = run.missed;
  row["lost"] = run.lost;
  add_figures(row, run.round, "round_");
  add_figures(row, run.wall, "wall_");
  row["worst_core_p999_us"] = run.worst_p999_us;
}

Json hands_json(const HandsAccount& hands) {
  Json row;
  row["bytes_per_hand"] = hands.bytes_per_hand;
  if (hands.most.hands > 0) add_run(row["most"], hands.most);
  if (hands.asked.hands > 0) add_run(row, hands.asked);
  return row;
}

Json loops_json(const Account& account) {
  Json rows = Json::array();
  for (const LoopAccount& loop : account.loops) {
    Json row;
    row["scene"] = loop.scene;
    row["rate_Hz"] = loop.rate_Hz;
    row["ticks"] = loop.ticks;
    row["missed"] = loop.missed;
    row["missed_empty"] = loop.missed_empty;
    add_figures(row, loop.late, "late_");
    add_figures(row, loop.late_empty, "late_empty_");
    rows.push_back(row);
  }
  return rows;
}

Json pictures_json(const Account& account) {
  Json rows = Json::array();
  for (const PictureAccount& picture : account.pictures) {
    Json row;
    row["scene"] = picture.scene;
    row["organ_triangles"] = picture.organ_triangles;
    row["driver"] = picture.driver;
    row["pictures"] = picture.frame.samples;
    row["fast_share"] = picture.fast_share;
    add_figures(row, picture.deformation, "deformation_");
    add_figures(row, picture.frame, "frame_");
    add_figures(row, picture.frame_computed, "frame_computed_");
    rows.push_back(row);
  }
  return rows;
}

Json peers_json(const Account& account) {
  Json rows = Json::array();
  for (const PeerAccount& peer : account.peers) {
    Json row;
    row["name"] = peer.name;
    row["does"] = peer.does;
    row["scene"] = peer.scene;
    row["organ_triangles"] = peer.organ_triangles;
    row["tool_triangles"] = peer.tool_triangles;
    row["ticks"] = peer.contact.samples;
    add_figures(row, peer.contact);
    row["ratio"] = peer.ratio;
    row["approach_ticks"] = peer.approach.samples;
    add_figures(row, peer.approach, "approach_");
    row["approach_ratio"] = peer.approach_ratio;
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

std::string to_json(const Account& account) {
  Json json;
  json["machine"] = account.machine;
  json["build"] = account.build;
  json["command"] = account.command;
  json["clock_ns"] = account.clock_ns;
  json["tick"] = ticks_json(account);
  json["nearest"] = nearest_json(account);
  json["law_ns"] = or_null(account.law_ns);
  json["inverse_ns"] = or_null(account.inverse_ns);
  json["noise_ns"] = or_null(account.noise_ns);
  json["preparation"] = preparation_json(account);
  json["hands_per_core"] = account.hands ? Json(account.hands->hands_per_core) : Json(nullptr);
  json["hands"] = account.hands ? hands_json(*account.hands) : Json(nullptr);
  json["loop"] = loops_json(account);
  json["polled"] = account.polled;
  json["pictures"] = pictures_json(account);
  json["peers"] = peers_json(account);
  json["remarks"] = account.remarks;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace palpate::bench
