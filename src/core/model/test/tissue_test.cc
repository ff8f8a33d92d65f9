#include "palpate/tissue.h"

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "palpate/error.h"
#include "palpate/spring_law.h"

namespace palpate::model {
namespace {

constexpr double kTissueInfinity = std::numeric_limits<double>::infinity();
constexpr double kTissueNaN = std::numeric_limits<double>::quiet_NaN();

const std::vector<std::string> kPresetNames{
    "gallbladder",  "heart",           "liver",         "kidney", "liver-ex-vivo",
    "heart-muscle", "skin-fat-muscle", "liver-capsule", "vein",   "epidural"};

// One bad value of one field, and its form in the message.
struct BadValue {
  std::string field;
  std::string shown;
  std::function<void(TissueParameters&)> spoil;
};

void expect_refused(const BadValue& bad) {
  TissueParameters tissue = tissue_preset("gallbladder");
  tissue.source = SourceParameters{"ball", 3e-3};
  ASSERT_NO_THROW(validate(tissue));
  bad.spoil(tissue);
  try {
    validate(tissue);
    ADD_FAILURE() << "accepted " << bad.field << " = " << bad.shown;
  } catch (const ParameterError& error) {
    EXPECT_EQ(error.field(), bad.field);
    EXPECT_THAT(error.what(), testing::StartsWith(bad.field + " = " + bad.shown + ": must be "));
  }
}

// Every number that must be finite and above 0, by its key in a tissue file, with the key's unit in SI.
struct PositiveField {
  std::string name;
  double unit;
  double& (*of)(TissueParameters&);
};

const std::vector<PositiveField> kPositiveFields{
    {"k1_N_per_m", 1.0, [](TissueParameters& t) -> double& { return t.k1; }},
    {"beta", 1.0, [](TissueParameters& t) -> double& { return t.beta; }},
    {"q", 1.0, [](TissueParameters& t) -> double& { return t.q; }},
    {"t1_us", 1e-6, [](TissueParameters& t) -> double& { return t.t1; }},
    {"rest_length_mm", 1e-3, [](TissueParameters& t) -> double& { return t.rest_length; }},
    {"reach.contact_ratio", 1.0, [](TissueParameters& t) -> double& { return t.reach.contact_ratio; }},
    {"reach.first_bar_ratio", 1.0, [](TissueParameters& t) -> double& { return t.reach.first_bar_ratio; }},
    {"reach.bar_ratio", 1.0, [](TissueParameters& t) -> double& { return t.reach.bar_ratio; }},
    {"reach.weight_ratio", 1.0, [](TissueParameters& t) -> double& { return t.reach.weight_ratio; }},
    {"reach.depth_exponent", 1.0, [](TissueParameters& t) -> double& { return t.reach.depth_exponent; }},
    {"contact.tangential_N_per_m", 1.0,
     [](TissueParameters& t) -> double& { return t.contact.tangential_stiffness.emplace(1.0); }},
    {"contact.grip_limit_N", 1.0, [](TissueParameters& t) -> double& { return t.contact.grip_limit; }},
    {"source.radius_mm", 1e-3, [](TissueParameters& t) -> double& { return t.source->radius; }},
    {"source.max_depth_mm", 1e-3, [](TissueParameters& t) -> double& { return t.max_depth.emplace(1.0); }},
};

TEST(ValidateTissue, RefusesWhatIsNotFiniteAndAboveZeroInTheUnitOfTheFile) {
  for (const PositiveField& field : kPositiveFields) {
    const auto set = [&field](double value) {
      return [&field, value](TissueParameters& tissue) { field.of(tissue) = value * field.unit; };
    };
    expect_refused({field.name, "0", set(0.0)});
    expect_refused({field.name, "-2", set(-2.0)});
    expect_refused({field.name, "inf", set(kTissueInfinity)});
    expect_refused({field.name, "-inf", set(-kTissueInfinity)});
    expect_refused({field.name, "nan", set(kTissueNaN)});
  }
}

TEST(ValidateTissue, RefusesNegativeFrictionAndDampingButNotZero) {
  for (const double bad : {-0.5, kTissueInfinity, kTissueNaN}) {
    const std::string shown = bad == -0.5 ? "-0.5" : bad == kTissueInfinity ? "inf" : "nan";
    expect_refused({"contact.friction", shown, [bad](TissueParameters& t) { t.contact.friction = bad; }});
    expect_refused({"contact.tangential_damping_N_s_per_m", shown,
                    [bad](TissueParameters& t) { t.contact.tangential_damping = bad; }});
    expect_refused(
        {"contact.damping_N_s_per_m", shown, [bad](TissueParameters& t) { t.contact.damping = bad; }});
  }
  TissueParameters tissue = tissue_preset("heart");
  tissue.contact.friction = 0.0;
  tissue.contact.damping = 0.0;
  EXPECT_NO_THROW(validate(tissue));
}

TEST(ValidateTissue, RefusesASizeExponentOutOfRangeOrWithoutASourceRadius) {
  for (const auto& [bad, shown] :
       {std::pair{-0.1, "-0.1"}, std::pair{2.01, "2.01"}, std::pair{kTissueNaN, "nan"}}) {
    expect_refused({"size_exponent", shown, [bad = bad](TissueParameters& t) { t.size_exponent = bad; }});
  }
  expect_refused({"size_exponent", "0.5", [](TissueParameters& t) {
                    t.size_exponent = 0.5;
                    t.source.reset();
                  }});
  TissueParameters tissue = tissue_preset("heart");
  tissue.source = SourceParameters{"ball", 3e-3};
  tissue.size_exponent = 2.0;
  EXPECT_NO_THROW(validate(tissue));
}

TEST(SizeFactor, IsAPowerOfTheRatioOfTheRadii) {  // 4^0.5 = 2, 0.25^1 = 0.25
  EXPECT_NEAR(size_factor(0.5, 3e-3, 12e-3), 2.0, 1e-15);
  EXPECT_NEAR(size_factor(1.0, 12e-3, 3e-3), 0.25, 1e-15);
  EXPECT_EQ(size_factor(0.0, 0.0, 3e-3), 1.0);
  TissueParameters tissue = tissue_preset("gallbladder");
  EXPECT_EQ(for_tool(tissue, 12e-3).numbers(), tissue.numbers());
  tissue.source = SourceParameters{"ball", 3e-3};
  tissue.size_exponent = 0.5;
  EXPECT_NEAR(for_tool(tissue, 12e-3).k1, 36.0, 1e-12);
  EXPECT_EQ(for_tool(tissue, 12e-3).size_exponent, 0.0);
}

TEST(ValidateTissue, RefusesAReferenceRadiusBelowAMillimetre) {
  for (const double bad : {0.99, 0.0, -2.0}) {
    TissueParameters tissue = tissue_preset("heart");
    tissue.contact.reference_radius = bad * 1e-3;
    EXPECT_THROW(validate(tissue), ParameterError) << bad;
  }
  TissueParameters tissue = tissue_preset("heart");
  tissue.contact.reference_radius = 1e-3;
  EXPECT_NO_THROW(validate(tissue));
}

TEST(ValidateTissue, RefusesLengthsOutOfOrder) {
  const auto set_max = [](double value) { return [value](TissueParameters& t) { t.max_length = value; }; };
  const auto set_min = [](double value) { return [value](TissueParameters& t) { t.min_length = value; }; };
  expect_refused({"max_length_mm", "14", set_max(14e-3)});  // equal to the rest length
  expect_refused({"max_length_mm", "2", set_max(2e-3)});
  expect_refused({"max_length_mm", "inf", set_max(kTissueInfinity)});
  expect_refused({"max_length_mm", "nan", set_max(kTissueNaN)});
  expect_refused({"min_length_mm", "14", set_min(14e-3)});
  expect_refused({"min_length_mm", "30", set_min(30e-3)});
  expect_refused({"min_length_mm", "-1", set_min(-1e-3)});
  expect_refused({"min_length_mm", "nan", set_min(kTissueNaN)});
  TissueParameters tissue = tissue_preset("heart");
  tissue.min_length = 0.0;  // a spring may be compressed to length 0
  EXPECT_NO_THROW(validate(tissue));
}

TEST(ValidateTissue, RefusesRatiosOfTheReachOutsideTheirRange) {
  expect_refused({"reach.bar_ratio", "1", [](TissueParameters& t) { t.reach.bar_ratio = 1.0; }});
  expect_refused({"reach.weight_ratio", "1", [](TissueParameters& t) { t.reach.weight_ratio = 1.0; }});
  expect_refused({"reach.weight_ratio", "1.5", [](TissueParameters& t) { t.reach.weight_ratio = 1.5; }});
  expect_refused(
      {"reach.depth_exponent", "1.001", [](TissueParameters& t) { t.reach.depth_exponent = 1.001; }});
  TissueParameters tissue = tissue_preset("liver");
  tissue.reach.depth_exponent = 1.0;
  EXPECT_NO_THROW(validate(tissue));
}

TEST(ValidateTissue, RefusesTwoLayersOfOneNameButNotTwoWithout) {
  TissueParameters tissue = tissue_preset("vein");
  for (TissueLayer& layer : tissue.layers) layer.name.clear();
  validate(tissue);
  tissue.layers[0].name = tissue.layers[2].name = "wall";
  try {
    validate(tissue);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "layer 3: name = \"wall\": layer 1 has this name too");
  }
}

TEST(TissueParameters, FirstLimitIsByDirection) {
  TissueParameters tissue;
  tissue.rest_length = 14e-3;
  tissue.max_length = 24e-3;
  tissue.min_length = 6e-3;
  EXPECT_DOUBLE_EQ(tissue.first_limit(Direction::kPull), 10e-3);
  EXPECT_DOUBLE_EQ(tissue.first_limit(Direction::kPress), 8e-3);
}

TEST(TissueParameters, TangentialStiffnessIsTenTimesTheFirstSpringUnlessGiven) {
  TissueParameters tissue = tissue_preset("gallbladder");
  EXPECT_DOUBLE_EQ(tissue.tangential_stiffness(), 180.0);
  tissue.contact.tangential_stiffness = 50.0;
  EXPECT_EQ(tissue.tangential_stiffness(), 50.0);
}

TEST(TissuePreset, EveryOneIsValidAndCarriesItsName) {
  for (const std::string& name : kPresetNames) {
    const TissueParameters tissue = tissue_preset(name);
    EXPECT_EQ(tissue.name, name);
    EXPECT_NO_THROW(validate(tissue)) << name;
  }
}

TEST(TissuePreset, GallbladderAndHeartHaveThePapersFigures) {
  EXPECT_EQ(tissue_preset("gallbladder").beta, 1.6);
  EXPECT_EQ(tissue_preset("gallbladder").k1, 18.0);  // 0.18 N/cm
  EXPECT_EQ(tissue_preset("heart").beta, 2.0);
  EXPECT_EQ(tissue_preset("heart").k1, 15.0);  // 0.15 N/cm
}

TEST(TissuePreset, OnlyAMeasuredOneHasASource) {
  EXPECT_THAT(tissue_preset_names(), testing::ElementsAreArray(kPresetNames));
  for (const std::string& name : kPresetNames) {
    const bool measured = name == "liver-ex-vivo" || name == "heart-muscle";
    EXPECT_EQ(tissue_preset(name).source.has_value(), measured) << name;
    EXPECT_TRUE(tissue_preset(name).max_depth.has_value()) << name;
  }
}

TEST(TissuePreset, LiverExVivoIsWithinFivePercentOfTheRangeOfTheMeasuredMedians) {
  const SpringLaw law(tissue_preset("liver-ex-vivo"), Direction::kPress, 1e-3);
  const std::vector<std::pair<double, double>> medians{// of the three places' medians, docs/tissues.md
                                                       {0.5e-3, 0.044},
                                                       {1e-3, 0.110},
                                                       {1.5e-3, 0.224},
                                                       {2e-3, 0.417},
                                                       {2.5e-3, 0.698}};
  for (const auto& [depth, force] : medians)
    EXPECT_NEAR(law.force_at(depth).force, force, 0.05 * 0.698) << depth;
}

// Of 14 of 15 curves (one ends at 0.5 mm), docs/tissues.md.
TEST(TissuePreset, HeartMuscleIsWithinTenPercentOfTheRangeOfTheMeasuredMedians) {
  const std::vector<std::pair<double, double>> pressed{
      {0.2e-3, 0.0177}, {0.4e-3, 0.0457}, {0.6e-3, 0.0857}, {0.8e-3, 0.1678}, {1e-3, 0.3618}};
  const std::vector<std::pair<double, double>> pulled{
      {0.2e-3, 0.0135}, {0.4e-3, 0.0308}, {0.6e-3, 0.0545}, {0.8e-3, 0.0916}, {1e-3, 0.1767}};
  const SpringLaw press(tissue_preset("heart-muscle"), Direction::kPress, 1e-3);
  const SpringLaw pull(tissue_preset("heart-muscle"), Direction::kPull, 1e-3);
  for (const auto& [depth, force] : pressed)
    EXPECT_NEAR(press.force_at(depth).force, force, 0.02 * 0.3618) << depth;
  for (const auto& [depth, force] : pulled)
    EXPECT_NEAR(pull.force_at(depth).force, force, 0.1 * 0.1767) << depth;
}

// Of the layered law a hand feels the steps, so only the paper's tissues have it.
TEST(TissuePreset, OnlyThePapersTissuesHaveItsLayeredLaw) {
  for (const std::string& name : kPresetNames) {
    const bool papers = name == "gallbladder" || name == "heart";
    EXPECT_EQ(tissue_preset(name).law, papers ? LawKind::kLayered : LawKind::kSmooth) << name;
  }
}

TEST(TissuePreset, RefusesUnknownNamesAndListsTheKnownOnes) {
  try {
    static_cast<void>(tissue_preset("spleen"));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("spleen"));
    for (const std::string& name : kPresetNames) EXPECT_THAT(error.what(), testing::HasSubstr(name));
  }
}

TEST(TissuePreset, ANameThatIsNearlyOneIsAnsweredWithIt) {
  try {
    (void)tissue_preset("livr");
    ADD_FAILURE() << "accepted livr";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::EndsWith("; did you mean liver?"));
  }
}

}  // namespace
}  // namespace palpate::model
