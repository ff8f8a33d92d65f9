// Fits of a needle's records. The records are those of the simulated needle itself, with noise of known seed;
// what it does is tested in core/contact/test/needle_test.cc.
#include "fit/identify/needle_fit.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"

namespace palpate::identify {
namespace {

using testing::HasSubstr;

constexpr double kNeedleSpeed = 2e-3;  // m/s
constexpr double kSampling = 5e-3;     // s

model::TissueParameters needle_truth(std::size_t layers) {
  model::TissueParameters tissue;
  tissue.name = "truth";
  tissue.law = model::LawKind::kSmooth;
  tissue.k1 = 100.0;
  tissue.beta = 2.0;
  tissue.q = 0.7;
  tissue.rest_length = 12e-3;
  tissue.max_length = 18e-3;
  tissue.min_length = 6e-3;
  tissue.t1 = 1e-6;
  tissue.relaxation = {{0.2, 0.3}, {0.15, 4.0}};
  const double punctures[] = {3.0, 2.2, 2.4};
  for (std::size_t k = 0; k < layers; ++k) {
    model::TissueLayer layer;
    layer.name = "layer " + std::to_string(k + 1);
    if (k + 1 < layers) layer.thickness = 6e-3;
    layer.puncture_force = punctures[k];
    layer.cutting_force = k == 0 ? 0.9 : 0.6;
    layer.friction = 0.15;
    layer.friction_per_length = k == 0 ? 60.0 : 40.0;
    tissue.layers.push_back(layer);
  }
  return tissue;
}

/// Depths from 1 mm above the surface to 30 mm below it, 5 s there, and out again.
NeedleRecord needle_path() {
  NeedleRecord record;
  record.name = "path";
  const auto add = [&record](double depth) {
    record.time.push_back(kSampling * static_cast<double>(record.size()));
    record.depth.push_back(depth);
  };
  const int way = static_cast<int>(31e-3 / kNeedleSpeed / kSampling);
  for (int i = 0; i <= way; ++i) add(-1e-3 + 31e-3 * i / way);
  for (int i = 0; i < static_cast<int>(5.0 / kSampling); ++i) add(30e-3);
  for (int i = way; i >= 0; --i) add(-1e-3 + 31e-3 * i / way);
  return record;
}

Specimen needle_record(const model::TissueParameters& truth, double noise, std::uint64_t seed = 1) {
  const NeedleRecord path = needle_path();
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  Specimen record;
  record.name = "record " + std::to_string(seed);
  record.time = path.time;
  record.displacement = path.depth;
  for (const double force : run_needle(path, truth, 0.0, {}, 1e-3).force)
    record.force.push_back(force + 0.02 + normal(random));
  return record;
}

NeedleFit needle_fit_of(const std::vector<Specimen>& records) {
  std::vector<Insertion> insertions;
  for (const Specimen& one : records) insertions.push_back(insertion_of(one, one.name));
  Settings settings;
  settings.law = model::LawKind::kSmooth;
  return fit_needle(insertions, settings, [](double, const std::string&) {});
}

const NeedleFit& fit_of_one_layer() {
  static const NeedleFit fit = needle_fit_of({needle_record(needle_truth(1), 0.05)});
  return fit;
}

const NeedleValue& needle_value(const NeedleFit& fit, int layer, const std::string& name) {
  return *std::find_if(fit.values.begin(), fit.values.end(),
                       [&](const NeedleValue& value) { return value.layer == layer && value.name == name; });
}

std::string needle_refusal(const Specimen& record) {
  try {
    (void)insertion_of(record, "file.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(NeedleFit, OneLayerIsFoundWithItsForcesWithinFivePercent) {
  const NeedleFit& fit = fit_of_one_layer();
  ASSERT_EQ(fit.layers, 1U);
  EXPECT_EQ(fit.poor, "");
  EXPECT_NEAR(needle_value(fit, 1, "puncture_force_N").estimate.value, 3.0, 0.15);
  EXPECT_NEAR(needle_value(fit, 1, "cutting_force_N").estimate.value, 0.9, 0.045);
  EXPECT_NEAR(needle_value(fit, 1, "friction_N").estimate.value, 0.15, 0.02);
  EXPECT_NEAR(needle_value(fit, 1, "friction_N_per_mm").estimate.value, 60.0, 3.0);
  EXPECT_LT(fit.nrmse, 0.02);  // noise is 1.1 % of the range
  EXPECT_NEAR(fit.repeats.front().zero, 0.02, 0.01);
}

TEST(NeedleFit, TwoLayersAreFoundByEvidenceWithTheirBoundaryAndPunctures) {
  const NeedleFit fit = needle_fit_of({needle_record(needle_truth(2), 0.05)});
  ASSERT_EQ(fit.layers, 2U);
  EXPECT_NEAR(needle_value(fit, 1, "thickness_mm").estimate.value, 6e-3, 0.2e-3);
  EXPECT_NEAR(needle_value(fit, 2, "puncture_force_N").estimate.value, 2.2, 0.11);
  const NeedleRun truth = run_needle(needle_path(), needle_truth(2), 0.0, {}, 1e-3);
  ASSERT_EQ(fit.repeats.front().punctures.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k)
    EXPECT_NEAR(fit.repeats.front().punctures[k].depth, truth.punctures[k].depth, 0.3e-3) << k;
  EXPECT_GT(fit.evidence[0].nrmse, 1.2 * fit.evidence[1].nrmse);
}

/// Times at which a run along rows punctures the first membrane, reaches the second, and punctures it, as the
/// truth does by its forces and its thickness.
std::vector<double> times_of_truth(const NeedleRecord& rows, const model::TissueParameters& truth) {
  const NeedleRun free = run_needle(needle_path(), truth, 0.0, {}, 1e-3);
  double low = free.punctures.at(0).time;
  double high = free.punctures.at(1).time;
  std::vector<double> times{low, 0.0, high};
  for (int i = 0; i < 40; ++i) {
    times[1] = 0.5 * (low + high);
    const NeedleRun run = run_needle(rows, truth, 0.0, times, 0.1);
    (run.punctures.at(1).length > truth.layers[0].thickness ? high : low) = times[1];
  }
  return times;
}

// A fall of d newtons that ends with a time constant of 20 ms changes by d/20 in 1 ms.
TEST(NeedleModel, TheForceFollowsTheTimesOfThePuncturesWithoutSteps) {
  const model::TissueParameters truth = needle_truth(2);
  const NeedleRecord rows = needle_path();
  std::vector<double> times = times_of_truth(rows, truth);
  const auto after = static_cast<std::size_t>(times[2] / kSampling) + 4;
  double before = 0.0;
  for (int i = 0; i <= 100; ++i) {
    const double force = run_needle(rows, truth, 0.0, times, 0.1).force[after];
    if (i > 0) {
      EXPECT_NEAR(force, before, 0.012) << i;  // 0.1 ms of 1.6 N, and half as much
    }
    before = force;
    times[2] += 1e-4;
  }
}

// The friction on a needle that slips is that of its length one tick before, so long ticks shift it.
TEST(NeedleModel, LongTicksGiveTheForceOfShortOnes) {
  NeedleRecord coarse;
  const NeedleRecord path = needle_path();
  for (std::size_t i = 0; i < path.size(); i += 14) {  // every 70 ms
    coarse.time.push_back(path.time[i]);
    coarse.depth.push_back(path.depth[i]);
  }
  const NeedleRun fine = run_needle(path, needle_truth(2), 0.0, {}, 1e-3);
  const std::vector<double> times = times_of_truth(coarse, needle_truth(2));
  const NeedleRun run = run_needle(coarse, needle_truth(2), 0.0, times, 0.1);
  EXPECT_NEAR(run.punctures.at(1).length, 6e-3, 1e-9);
  EXPECT_NEAR(run.punctures.at(1).tip, fine.punctures[1].tip, 0.02);
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    const bool falls = std::abs(coarse.time[i] - times[0]) < 0.2 || std::abs(coarse.time[i] - times[2]) < 0.2;
    // 1 ms of a fall; 25 ms at 2 mm/s of 60 N/m and, in a layer's first 1 mm, 150 N/m are 0.0105 N
    const double limit = falls ? 0.2 : 0.011;
    EXPECT_NEAR(run.force[i], fine.force[14 * i], limit) << coarse.time[i];
  }
}

// A press that ended at the bump would not determine the contact, and the needle would puncture elsewhere.
TEST(NeedleFit, ABumpInThePressIsNoPunctureForItsTissue) {
  Specimen bumped = needle_record(needle_truth(1), 0.05);
  const auto bump = static_cast<std::size_t>(1.5e-3 / kNeedleSpeed / kSampling);  // 0.5 mm deep
  for (std::size_t i = bump; i < bump + 5; ++i) bumped.force[i] += 0.4;
  ASSERT_GT(insertion_of(bumped, "file.csv").falls.size(), 1U);
  const NeedleFit fit = needle_fit_of({bumped});
  EXPECT_EQ(fit.layers, 1U);
  EXPECT_LT(fit.nrmse, 0.02);
}

TEST(NeedleFit, ThreeLayersAreFoundWithTheirBoundaries) {
  const NeedleFit fit = needle_fit_of({needle_record(needle_truth(3), 0.05)});
  ASSERT_EQ(fit.layers, 3U);
  for (const int layer : {1, 2})
    EXPECT_NEAR(needle_value(fit, layer, "thickness_mm").estimate.value, 6e-3, 0.2e-3) << layer;
}

TEST(NeedleFit, TheFittedTissuePuncturesWhereTheRecordDoes) {
  const NeedleFit& fit = fit_of_one_layer();
  const NeedleRun free = run_needle(needle_path(), fit.tissue, fit.repeats.front().contact, {}, 1e-3);
  ASSERT_EQ(free.punctures.size(), 1U);
  EXPECT_NEAR(free.punctures[0].depth + fit.repeats.front().contact, fit.repeats.front().punctures[0].depth,
              0.05e-3);
}

TEST(NeedleFit, RepeatsPredictEachOtherToTheirNoise) {
  const model::TissueParameters truth = needle_truth(1);
  const NeedleFit fit = needle_fit_of({needle_record(truth, 0.05, 1), needle_record(truth, 0.05, 2)});
  ASSERT_EQ(fit.repeats.size(), 2U);
  for (const NeedleRepeat& repeat : fit.repeats) EXPECT_LT(*repeat.predicted_nrmse, 0.04);
}

TEST(NeedleFit, WithoutAWithdrawalNoTissueComesFromIt) {
  Specimen record = needle_record(needle_truth(1), 0.05);
  const auto deepest = std::max_element(record.displacement.begin(), record.displacement.end());
  const auto rows = static_cast<std::size_t>(deepest - record.displacement.begin()) + 900;
  record.time.resize(rows);
  record.displacement.resize(rows);
  record.force.resize(rows);
  EXPECT_THAT(needle_fit_of({record}).poor, HasSubstr("cutting force and friction are not determined apart"));
}

TEST(NeedleRecords, WhatASensorReadsInTheAirIsSubtractedAndSaid) {
  Specimen good = needle_record(needle_truth(1), 0.02);
  for (int i = 1; i <= 500; ++i) {  // on into the air
    good.time.push_back(good.time.back() + kSampling);
    good.displacement.push_back(good.displacement.back() - kSampling * kNeedleSpeed);
    good.force.push_back(0.02 * (i % 2 == 0 ? 1 : -1));
  }
  const Insertion tared = insertion_of(good, "file.csv");
  EXPECT_TRUE(tared.notes.empty());
  EXPECT_NEAR(tared.air, 0.02, 0.01);  // over 0.5 mm at 2 mm/s, a row every 5 ms
  EXPECT_EQ(tared.air_rows, 50.0);
  Specimen drifting = good;
  for (std::size_t i = 0; i < drifting.size(); ++i) drifting.force[i] += 3.0 + 0.05 * drifting.time[i];
  const Insertion corrected = insertion_of(drifting, "file.csv");
  for (std::size_t i = 0; i < good.size(); i += 50)
    EXPECT_NEAR(corrected.all.force[i], good.force[i], 0.03) << i;
  EXPECT_NEAR(corrected.drift, 0.05 * good.time.back(), 0.1);
  ASSERT_EQ(corrected.notes.size(), 1U);
  EXPECT_THAT(corrected.notes[0], HasSubstr("N before the contact, "));
  EXPECT_THAT(corrected.notes[0], HasSubstr("subtracted; tare it"));
}

// It ends 1 mm above the tissue, which hangs on it by 0.4 N: a press of 100 N/m has 0.1 N there.
TEST(NeedleRecords, TissueThatSticksToTheNeedleIsNoDriftOfTheSensor) {
  model::TissueParameters truth = needle_truth(1);
  truth.layers[0].friction = 0.4;
  truth.layers[0].friction_per_length = 10.0;
  const Insertion sticks = insertion_of(needle_record(truth, 0.05), "file.csv");
  EXPECT_LT(sticks.all.force.back(), -0.2);
  EXPECT_EQ(sticks.drift, 0.0);
  EXPECT_TRUE(sticks.notes.empty());
}

TEST(NeedleRecords, AnInsertionTooFastForItsPuncturesIsQuestioned) {
  const auto notes_at = [](double times) {  // the speed
    Specimen record = needle_record(needle_truth(1), 0.0);
    for (double& time : record.time) time /= times;
    return insertion_of(record, "file.csv").notes;
  };
  const auto is_question = testing::HasSubstr("insert at");
  EXPECT_THAT(notes_at(1.0), testing::Not(testing::Contains(is_question)));
  EXPECT_THAT(notes_at(10.0), testing::Contains(is_question));
}

TEST(NeedleRecords, NoLongMeanReachesIntoAFall) {
  Specimen fast = needle_record(needle_truth(1), 0.02);
  for (double& time : fast.time) time *= 0.2;  // a row each 1 ms; a mean of the others takes 7 ms
  for (int i = 0; i < 29000; ++i) {            // 36 s in all: 40 ms
    fast.time.push_back(fast.time.back() + 1e-3);
    fast.displacement.push_back(fast.displacement.back());
    fast.force.push_back(0.02);
  }
  const Insertion made = insertion_of(fast, "file.csv");
  ASSERT_EQ(made.falls.size(), 1U);
  const NeedleRecord& means = made.thinned;
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double end = means.time[i] + 0.5e-3 * (means.rows[i] - 1.0);
    if (end > made.falls[0].time - 28e-3 && end < made.falls[0].time + 100e-3) {
      EXPECT_LE(means.rows[i], 2.0) << end;
    }
  }
}

TEST(NeedleRecords, ALimitOfTheSensorIsSeenWhereDepthsRepeatAndTheForceFlickers) {
  Specimen saturated = needle_record(needle_truth(1), 0.02);
  for (std::size_t i = 0; i < saturated.size(); ++i) {
    saturated.displacement[i] = 1e-5 * std::round(saturated.displacement[i] / 1e-5);
    saturated.force[i] = std::min(saturated.force[i], i % 2 == 0 ? 2.0 : 1.999);
  }
  EXPECT_THAT(needle_refusal(saturated), HasSubstr("sensor's limit"));
}

TEST(NeedleRecords, AGapOnTheWayInAndASecondInsertionAreRefused) {
  const Specimen good = needle_record(needle_truth(1), 0.02);
  Specimen gap = good;
  const auto begin = static_cast<std::ptrdiff_t>(good.size() / 5);
  for (std::vector<double>* values : {&gap.time, &gap.displacement, &gap.force})
    values->erase(values->begin() + begin,
                  values->begin() + begin + static_cast<std::ptrdiff_t>(0.35 / kSampling));
  EXPECT_THAT(needle_refusal(gap), HasSubstr("no rows for 0.35"));
  Specimen twice = good;
  for (std::size_t i = 0; i < good.size(); ++i) {
    twice.time.push_back(good.time.back() + good.time[i] + kSampling);
    twice.displacement.push_back(good.displacement[i]);
    twice.force.push_back(good.force[i]);
  }
  EXPECT_THAT(needle_refusal(twice), HasSubstr("goes in more than once"));
}

TEST(NeedleRecords, ARecordThatBeginsUnderForceWithoutRowsInTheAirIsQuestioned) {
  Specimen inside = needle_record(needle_truth(1), 0.02);
  const auto first =
      std::find_if(inside.displacement.begin(), inside.displacement.end(), [](double z) { return z > 4e-3; });
  const auto rows = first - inside.displacement.begin();
  for (std::vector<double>* values : {&inside.time, &inside.displacement, &inside.force})
    values->erase(values->begin(), values->begin() + rows);
  const Insertion made = insertion_of(inside, "file.csv");
  ASSERT_EQ(made.notes.size(), 1U);
  EXPECT_THAT(made.notes[0], HasSubstr("shows no rows before the contact"));
}

TEST(NeedleRecords, WhatIsNoRecordOfANeedleIsRefusedInWords) {
  const Specimen good = needle_record(needle_truth(1), 0.05);
  EXPECT_EQ(needle_refusal(good), "");
  Specimen untimed = good;
  untimed.time.clear();
  EXPECT_THAT(needle_refusal(untimed), HasSubstr("file.csv: time_s: missing"));
  Specimen few = good;
  few.time.resize(60);
  few.displacement.resize(60);
  few.force.resize(60);
  EXPECT_THAT(needle_refusal(few), HasSubstr("has 60 rows, must have at least 100"));
  Specimen saturated = good;
  for (double& force : saturated.force) force = std::min(force, 2.0);
  EXPECT_THAT(needle_refusal(saturated), HasSubstr("sensor's limit"));
  Specimen negative = good;
  for (double& force : negative.force) force = -force;
  EXPECT_THAT(needle_refusal(negative), HasSubstr("must be positive where the needle goes in"));
  Specimen pressed = good;
  for (std::size_t i = 0; i < pressed.size(); ++i)
    pressed.force[i] = 50.0 * std::max(0.0, pressed.displacement[i]);
  EXPECT_THAT(needle_refusal(pressed), HasSubstr("it has punctured nothing"));
  Specimen slow = good;
  for (double& time : slow.time) time *= 30.0;
  EXPECT_THAT(needle_refusal(slow), HasSubstr("s apart, must be at most 0.1 s"));
}

TEST(NeedleRecords, ColumnsAndRepeatsAreReadAsOtherFitsReadThem) {
  const palpate::test::TemporaryFolder folder;
  std::ostringstream out;
  out << "time_s,displacement_mm,force_N,specimen\n";
  for (const std::uint64_t seed : {1U, 2U}) {
    const Specimen record = needle_record(needle_truth(1), 0.05, seed);
    for (std::size_t i = 0; i < record.size(); ++i) {
      out << record.time[i] << ',' << 1e3 * record.displacement[i] << ',' << record.force[i] << ",run "
          << seed << '\n';
    }
  }
  const std::vector<Insertion> all = read_insertions(folder.write("needles.csv", out.str()));
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].all.name, "run 2");
  EXPECT_NEAR(all[0].hold, 5.2, 0.3);
  EXPECT_TRUE(all[0].withdrawn);
  EXPECT_NEAR(all[0].falls.front().force, 1.6, 0.4);
}

}  // namespace
}  // namespace palpate::identify
