#include "bench/measure/account.h"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace palpate::bench {
namespace {

Account sample() {
  Account account;
  account.machine = "a \"machine\", of two cores";
  account.build = "palpate 1";
  account.command = "palpate bench\n--json";
  account.clock_ns = 200.0;
  account.ticks.push_back({"press, slow",
                           "press",
                           2110,
                           968,
                           {10, 3.0, 4.0, 5.0, 6.0},
                           {20, 1.0, 2.0, 2.5, 2.75},
                           5,
                           {2, 2.9, 3.9, 4.5, 4.75},
                           {4, 0.9, 1.9, 2.25, 2.5},
                           {5, 20.0, 21.0, 21.5, 22.0}});
  account.nearest.push_back({2110, {5, 0.5, 0.6, 0.7, 0.8}});
  account.law_ns = 10.0;
  account.inverse_ns = 11.0;
  account.noise_ns = 12.5;
  account.preparation.push_back({"gallbladder", 2110, 0.25, 1000});
  account.hands =
      HandsAccount{150,
                   90'000.0,
                   {302, 2, 20'000, 3, 4, {20'000, 5, 6, 7, 8}, {20'000, 9, 10, 11, 12}, 7.25},
                   {300, 2, 6000, 1, 0, {6000, 400, 500, 600, 700}, {6000, 410, 510, 610, 710}, 640}};
  account.loops.push_back({"press", 10'000.0, 100, 1, 2, {100, 1, 2, 3, 4}, {100, 5, 6, 7, 8}});
  account.peers.push_back({"FCL", "distance", "press", 2110, 968, {7, 30, 40, 50, 60}, {}, 10.0, 0.0});
  account.remarks = {"Embree is not compared with"};
  return account;
}

TEST(Account, JsonHasTheDocumentedKeysAndFigures) {
  const auto json = nlohmann::json::parse(to_json(sample()));
  EXPECT_EQ(json["machine"], "a \"machine\", of two cores");
  const auto& tick = json["tick"][0];
  EXPECT_EQ(tick["organ_triangles"], 2110);
  EXPECT_EQ(tick["tool_triangles"], 968);
  EXPECT_EQ(tick["phase"], "press");
  EXPECT_EQ(tick["p50_us"], 3.0);
  EXPECT_EQ(tick["p99_us"], 4.0);
  EXPECT_EQ(tick["p999_us"], 5.0);
  EXPECT_EQ(tick["max_us"], 6.0);
  EXPECT_EQ(tick["approach_p50_us"], 1.0);
  EXPECT_EQ(tick["approach_max_us"], 2.75);
  EXPECT_EQ(tick["repeats"], 5);
  EXPECT_EQ(tick["least_p999_us"], 4.5);
  EXPECT_EQ(tick["approach_least_p999_us"], 2.25);
  EXPECT_EQ(tick["first_p50_us"], 20.0);
  EXPECT_EQ(tick["first_max_us"], 22.0);
  EXPECT_EQ(json["law_ns"], 10.0);
  EXPECT_EQ(json["inverse_ns"], 11.0);
  EXPECT_EQ(json["noise_ns"], 12.5);
  EXPECT_EQ(json["preparation"][0]["organ_triangles"], 2110);
  EXPECT_EQ(json["preparation"][0]["seconds"], 0.25);
  EXPECT_EQ(json["preparation"][0]["bytes"], 1000);
  EXPECT_EQ(json["hands_per_core"], 150);
  EXPECT_EQ(json["hands"]["missed"], 1);
  EXPECT_EQ(json["hands"]["round_p999_us"], 600.0);
  EXPECT_EQ(json["hands"]["wall_p50_us"], 410.0);
  EXPECT_EQ(json["hands"]["worst_core_p999_us"], 640.0);
  EXPECT_EQ(json["hands"]["most"]["hands"], 302);
  EXPECT_EQ(json["hands"]["most"]["periods"], 20'000);
  EXPECT_EQ(json["hands"]["most"]["lost"], 4);
  EXPECT_EQ(json["hands"]["most"]["round_p999_us"], 7.0);
  EXPECT_EQ(json["loop"][0]["missed_empty"], 2);
  EXPECT_EQ(json["peers"][0]["name"], "FCL");
  EXPECT_EQ(json["peers"][0]["organ_triangles"], 2110);
  EXPECT_EQ(json["peers"][0]["p50_us"], 30.0);
  EXPECT_EQ(json["peers"][0]["p999_us"], 50.0);
  EXPECT_EQ(json["peers"][0]["ratio"], 10.0);
}

TEST(Account, JsonOfNothingMeasuredHasEveryKey) {
  const auto json = nlohmann::json::parse(to_json(Account{}));
  for (const char* key : {"tick", "preparation", "peers", "loop", "nearest"}) {
    EXPECT_TRUE(json.at(key).is_array()) << key;
    EXPECT_TRUE(json.at(key).empty()) << key;
  }
  for (const char* key : {"law_ns", "inverse_ns", "noise_ns", "hands_per_core"})
    EXPECT_TRUE(json.at(key).is_null()) << key;
}

/// Number of cells of a line without quoted commas.
std::size_t cells(const std::string& line) {
  std::size_t count = 1;
  bool quoted = false;
  for (const char letter : line) {
    if (letter == '"') quoted = !quoted;
    if (letter == ',' && !quoted) ++count;
  }
  return count;
}

TEST(Account, CsvHasEighteenCellsALineAndCommentsOfOneLine) {
  std::istringstream csv(to_csv(sample()));
  std::string line;
  std::size_t comments = 0;
  std::size_t rows = 0;
  while (std::getline(csv, line)) {
    if (line[0] == '#') {
      ++comments;
      continue;
    }
    EXPECT_EQ(cells(line), 18U) << line;
    ++rows;
  }
  EXPECT_EQ(comments, 5U);    // machine, build, command, clock, one remark
  EXPECT_EQ(rows, 1U + 26U);  // header; 3 tick, 1 nearest, 3 parts, 2 preparation, 12 hands, 4 loop, 1 peer
}

TEST(Account, CsvQuotesACommaAndRoundTrips) {
  Account account;
  account.ticks = sample().ticks;
  account.ticks[0].contact.p50_us = 0.1;
  const std::string csv = to_csv(account);
  EXPECT_NE(csv.find("tick,palpate,\"press, slow\",contact,2110,968,10,0.1,4,5,6,,us,5,2.9,3.9,4.5,4.75\n"),
            std::string::npos)
      << csv;
}

TEST(Account, TextNamesEveryFigureAndWhatIsMissing) {
  const std::string text = to_text(sample());
  for (const char* word :
       {"press, slow", "3.00", "2.75", "4.75 of 5", "2.25", "FCL, press, contact", "10 times palpate's p50",
        "12.5 ns", "0.25 s", "1.00 kB", "150", "300 hands on 2 threads, missed periods", "640 us",
        "302 hands on 2 threads, lost rows", "p99.9 of the worst core", "7.25 us", "missed, empty",
        "Embree is not compared with"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
  }
}

TEST(Account, TextOfNothingMeasuredIsTwoLines) {
  const std::string text = to_text(Account{});
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
}

}  // namespace
}  // namespace palpate::bench
