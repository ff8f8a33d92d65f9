#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/scene/test/temporary_folder.h"
#include "palpate/scene.h"
#include "palpate/units.h"

namespace palpate::scene {
namespace {

using test::error_of;
using test::TemporaryFolder;
using testing::EndsWith;
using testing::HasSubstr;

const std::string kRequired = R"([tissue]
k1_N_per_m = 18.0
beta = 1.6
q = 0.7
rest_length_mm = 14.0
max_length_mm = 22.0
min_length_mm = 6
t1_us = 1.0
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string tissue_error_in(const std::string& content) {
  const TemporaryFolder folder;
  const auto file = folder.write("soft.toml", content);
  const std::string message = error_of([&] { (void)read_tissue_file(file); });
  EXPECT_TRUE(message.starts_with(file.string() + ":")) << message;
  return message.starts_with(folder.path().string()) ? message.substr(folder.path().string().size() + 1)
                                                     : message;
}

TEST(TissueFile, ReadsEveryFieldIntoSi) {
  const TemporaryFolder folder;
  const auto file =
      folder.write("soft.toml", replaced(kRequired, "[tissue]", "[tissue]\nname = \"example\"") + R"(
[tissue.reach]
contact_ratio = 1.2
first_bar_ratio = 0.5
bar_ratio = 1.9
weight_ratio = 0.6
depth_exponent = 0.4
[tissue.contact]
friction = 0
tangential_N_per_m = 200.0
tangential_damping_N_s_per_m = 0.75
damping_N_s_per_m = 0.25
reference_radius_mm = 8.0
grip_limit_N = 6.0
[tissue.source]
indenter = "ball"
radius_mm = 3.0
max_depth_mm = 9.0
)");
  const model::TissueParameters tissue = read_tissue_file(file);
  EXPECT_EQ(tissue.name, "example");
  EXPECT_EQ(tissue.k1, 18.0);
  EXPECT_EQ(tissue.beta, 1.6);
  EXPECT_EQ(tissue.q, 0.7);
  EXPECT_DOUBLE_EQ(tissue.rest_length, 0.014);
  EXPECT_DOUBLE_EQ(tissue.max_length, 0.022);
  EXPECT_DOUBLE_EQ(tissue.min_length, 0.006);
  EXPECT_DOUBLE_EQ(tissue.t1, 1e-6);
  EXPECT_EQ(tissue.reach.contact_ratio, 1.2);
  EXPECT_EQ(tissue.reach.first_bar_ratio, 0.5);
  EXPECT_EQ(tissue.reach.bar_ratio, 1.9);
  EXPECT_EQ(tissue.reach.weight_ratio, 0.6);
  EXPECT_EQ(tissue.reach.depth_exponent, 0.4);
  EXPECT_EQ(tissue.contact.friction, 0.0);
  EXPECT_EQ(tissue.contact.tangential_stiffness, 200.0);
  EXPECT_EQ(tissue.contact.tangential_damping, 0.75);
  EXPECT_EQ(tissue.contact.damping, 0.25);
  EXPECT_DOUBLE_EQ(tissue.contact.reference_radius, 0.008);
  EXPECT_EQ(tissue.contact.grip_limit, 6.0);
  ASSERT_TRUE(tissue.source.has_value());
  EXPECT_EQ(tissue.source->indenter, "ball");
  EXPECT_DOUBLE_EQ(tissue.source->radius, 0.003);
  EXPECT_DOUBLE_EQ(tissue.max_depth.value(), 0.009);
}

TEST(TissueFile, DefaultsAllThatIsNotRequired) {
  const TemporaryFolder folder;
  const model::TissueParameters tissue = read_tissue_file(folder.write("soft.toml", kRequired));
  EXPECT_EQ(tissue.name, "soft");
  EXPECT_EQ(tissue.reach.contact_ratio, 1.1);
  EXPECT_EQ(tissue.reach.first_bar_ratio, 0.43);
  EXPECT_EQ(tissue.reach.bar_ratio, 1.8);
  EXPECT_EQ(tissue.reach.weight_ratio, 0.58);
  EXPECT_EQ(tissue.reach.depth_exponent, 0.5);
  EXPECT_EQ(tissue.contact.friction, 0.2);
  EXPECT_EQ(tissue.tangential_stiffness(), 180.0);
  EXPECT_EQ(tissue.contact.tangential_damping, 0.0);
  EXPECT_EQ(tissue.contact.damping, 0.5);
  EXPECT_EQ(tissue.contact.reference_radius, 0.010);
  EXPECT_EQ(tissue.contact.grip_limit, 8.0);
  EXPECT_FALSE(tissue.source.has_value());
  EXPECT_EQ(tissue.max_depth, std::nullopt);
}

TEST(TissueFile, ReadsASizeExponentAndRefusesItWithoutASourceRadius) {
  const TemporaryFolder folder;
  const std::string text = kRequired + "size_exponent = 0.5\n";
  EXPECT_EQ(
      read_tissue_file(folder.write("soft.toml", text + "[tissue.source]\nradius_mm = 3\n")).size_exponent,
      0.5);
  EXPECT_THAT(tissue_error_in(text), HasSubstr("soft.toml:9: tissue.size_exponent = 0.5: must be 0 where "
                                               "[tissue.source] has no radius_mm"));
}

TEST(TissueFile, AMaxDepthNeedsNoIndenter) {
  const TemporaryFolder folder;
  const model::TissueParameters tissue =
      read_tissue_file(folder.write("soft.toml", kRequired + "[tissue.source]\nmax_depth_mm = 12\n"));
  EXPECT_EQ(tissue.max_depth, 0.012);
  EXPECT_FALSE(tissue.source.has_value());
}

TEST(TissueFile, RefusesEachMissingRequiredKeyByName) {
  for (const std::string key :
       {"k1_N_per_m", "beta", "q", "rest_length_mm", "max_length_mm", "min_length_mm", "t1_us"}) {
    const std::string message = tissue_error_in(replaced(kRequired, "\n" + key + " =", "\n# " + key + " ="));
    EXPECT_THAT(message, HasSubstr("soft.toml:1: tissue." + key + ": missing, must be a finite number"));
  }
}

TEST(TissueFile, NamesTheNearestKnownKeyOfAnUnknownOne) {
  EXPECT_EQ(tissue_error_in(replaced(kRequired, "beta", "betta")),
            "soft.toml:3: tissue.betta = 1.6: unknown key, did you mean beta?");
  EXPECT_EQ(tissue_error_in(kRequired + "bta = 1.7\n"),
            "soft.toml:9: tissue.bta = 1.7: unknown key, did you mean beta?");
  EXPECT_EQ(tissue_error_in(kRequired + "[tissue.contact]\nfriktion = 0.3\n"),
            "soft.toml:10: tissue.contact.friktion = 0.3: unknown key, did you mean friction?");
  EXPECT_EQ(tissue_error_in(replaced(kRequired, "k1_N_per_m", "k1_N_per_mm")),
            "soft.toml:2: tissue.k1_N_per_mm = 18: unknown key, did you mean k1_N_per_m, with values in "
            "N_per_m, not N_per_mm?");
  EXPECT_THAT(tissue_error_in(kRequired + "[tisue]\n"), HasSubstr("soft.toml:9: tisue = "));
}

TEST(TissueFile, RefusesWrongTypesWithLineFieldAndValue) {
  EXPECT_EQ(tissue_error_in(replaced(kRequired, "q = 0.7", "q = \"0.7\"")),
            "soft.toml:4: tissue.q = \"0.7\": must be a finite number");
  EXPECT_EQ(tissue_error_in(replaced(kRequired, "q = 0.7", "q = true")),
            "soft.toml:4: tissue.q = true: must be a finite number");
  EXPECT_THAT(tissue_error_in(kRequired + "name = 3\n"),
              HasSubstr("soft.toml:9: tissue.name = 3: must be a text"));
  EXPECT_THAT(tissue_error_in(kRequired + "name = \"a\\nb\"\n"),
              HasSubstr("soft.toml:9: tissue.name = \"a b\": must be"));
  EXPECT_THAT(tissue_error_in(kRequired + "reach = 3\n"),
              HasSubstr("soft.toml:9: tissue.reach = 3: must be a table"));
  EXPECT_THAT(tissue_error_in("tissue = 3\n"), HasSubstr("soft.toml:1: tissue = 3: must be a table"));
  EXPECT_THAT(tissue_error_in("\n"), HasSubstr("tissue: missing"));
}

TEST(TissueFile, RefusesNumbersThatAreNotFinite) {
  for (const std::string value : {"nan", "inf", "-inf"}) {
    EXPECT_EQ(tissue_error_in(replaced(kRequired, "beta = 1.6", "beta = " + value)),
              "soft.toml:3: tissue.beta = " + value + ": must be a finite number");
  }
}

TEST(TissueFile, RefusesValuesOutOfRangeAtTheirOwnLine) {
  EXPECT_THAT(tissue_error_in(replaced(kRequired, "k1_N_per_m = 18.0", "k1_N_per_m = -18.0")),
              HasSubstr("soft.toml:2: tissue.k1_N_per_m = -18: must be"));
  EXPECT_THAT(tissue_error_in(replaced(kRequired, "t1_us = 1.0", "t1_us = 0")),
              HasSubstr("soft.toml:8: tissue.t1_us = 0: must be"));
  EXPECT_THAT(tissue_error_in(replaced(kRequired, "max_length_mm = 22.0", "max_length_mm = 14.0")),
              HasSubstr("soft.toml:6: tissue.max_length_mm = 14: must be"));
  EXPECT_THAT(tissue_error_in(kRequired + "[tissue.contact]\nfriction = -0.1\n"),
              HasSubstr("soft.toml:10: tissue.contact.friction = -0.1: must be"));
  EXPECT_THAT(tissue_error_in(kRequired + "[tissue.reach]\nweight_ratio = 1.0\n"),
              HasSubstr("soft.toml:10: tissue.reach.weight_ratio = 1: must be"));
  EXPECT_THAT(tissue_error_in(kRequired + "[tissue.reach]\ndepth_exponent = 1.5\n"),
              HasSubstr("soft.toml:10: tissue.reach.depth_exponent = 1.5: must be > 0 and <= 1"));
  EXPECT_THAT(tissue_error_in(kRequired + "[tissue.source]\nradius_mm = 0\n"),
              HasSubstr("soft.toml:10: tissue.source.radius_mm = 0: must be"));
  EXPECT_THAT(tissue_error_in(kRequired + "[tissue.source]\nindenter = \"ball\"\n"),
              HasSubstr("soft.toml:9: tissue.source.radius_mm: missing"));
  EXPECT_THAT(tissue_error_in(kRequired + "[tissue.source]\nindenter = \"ball\"\nmax_depth_mm = 9\n"),
              HasSubstr("soft.toml:9: tissue.source.radius_mm: missing"));
  EXPECT_THAT(tissue_error_in(kRequired + "[tissue.source]\nmax_depth_mm = 0\n"),
              HasSubstr("soft.toml:10: tissue.source.max_depth_mm = 0: must be finite and > 0"));
}

TEST(TissueFile, ReadsLawAndRelaxation) {
  const TemporaryFolder folder;
  const model::TissueParameters tissue = read_tissue_file(folder.write(
      "soft.toml", kRequired + "law = \"smooth\"\n[[tissue.relaxation]]\nshare = 0.3\ntime_s = 1.5\n"
                               "[[tissue.relaxation]]\nshare = 0.2\ntime_s = 20\n"));
  EXPECT_EQ(tissue.law, model::LawKind::kSmooth);
  ASSERT_EQ(tissue.relaxation.size(), 2U);
  EXPECT_EQ(tissue.relaxation[0].g, 0.3);
  EXPECT_EQ(tissue.relaxation[0].tau, 1.5);
  EXPECT_EQ(tissue.relaxation[1].g, 0.2);
  EXPECT_EQ(tissue.relaxation[1].tau, 20.0);
}

TEST(TissueFile, IsLayeredAndDoesNotRelaxUnlessItSaysSo) {
  const TemporaryFolder folder;
  const model::TissueParameters tissue = read_tissue_file(folder.write("soft.toml", kRequired));
  EXPECT_EQ(tissue.law, model::LawKind::kLayered);
  EXPECT_TRUE(tissue.relaxation.empty());
}

TEST(TissueFile, RefusesOtherLawsAndRelaxationThatCannotBe) {
  const std::string term = "[[tissue.relaxation]]\n";
  EXPECT_THAT(tissue_error_in(kRequired + "law = \"hertz\"\n"),
              EndsWith("tissue.law = \"hertz\": must be \"layered\" or \"smooth\""));
  EXPECT_THAT(tissue_error_in(kRequired + term + "share = 0\ntime_s = 1.5\n"),
              HasSubstr("share = 0: must be"));
  EXPECT_THAT(tissue_error_in(kRequired + term + "share = 0.3\ntime_s = -1\n"),
              HasSubstr("time_s = -1: must be"));
  EXPECT_THAT(tissue_error_in(kRequired + term + "share = 0.3\n"), HasSubstr("time_s: missing"));
  EXPECT_THAT(
      tissue_error_in(kRequired + term + "share = 0.3\ntime_s = 1\n" + term + "share = 0.7\ntime_s = 2\n"),
      HasSubstr("soft.toml:13: tissue.relaxation.share = 0.7: the shares of all terms must sum to less "
                "than 1, these to 1"));
  std::string four = kRequired;
  for (int i = 0; i < 4; ++i) four += term + "share = 0.1\ntime_s = 1\n";
  EXPECT_THAT(tissue_error_in(four), HasSubstr("must be at most 3 [[tissue.relaxation]]"));
}

TEST(TissueFile, WrittenLawAndRelaxationReadBackTheSame) {
  const TemporaryFolder folder;
  model::TissueParameters tissue = load_tissue("heart");
  tissue.law = model::LawKind::kSmooth;
  tissue.relaxation = {{0.1, 0.3}, {0.2, 7.0}};
  const model::TissueParameters back = read_tissue_file(folder.write("back.toml", to_toml(tissue)));
  EXPECT_EQ(back.law, model::LawKind::kSmooth);
  ASSERT_EQ(back.relaxation.size(), 2U);
  EXPECT_EQ(back.relaxation[1].g, 0.2);
  EXPECT_EQ(back.relaxation[1].tau, 7.0);
}

TEST(TissueFile, RefusesTextThatIsNotTomlWithItsLine) {
  EXPECT_THAT(tissue_error_in(kRequired + "q = = 3\n"), HasSubstr("soft.toml:9: not valid TOML: "));
  EXPECT_THAT(tissue_error_in(kRequired + "q = 0.8\n"), HasSubstr("soft.toml:9: not valid TOML: "));
}

TEST(TissueFile, RefusesMissingFilesAndFolders) {
  const TemporaryFolder folder;
  EXPECT_EQ(error_of([&] { (void)load_tissue(folder.path().string() + "/none.toml"); }),
            folder.path().string() + "/none.toml: there is no such file");
  EXPECT_EQ(error_of([&] { (void)load_tissue(folder.path().string()); }),
            folder.path().string() + ": is a folder, must be a TOML file");
}

TEST(TissueFile, WrittenTextReadsBackTheSame) {
  const TemporaryFolder folder;
  for (const std::string name : {"gallbladder", "heart", "liver", "kidney"}) {
    model::TissueParameters tissue = load_tissue(name);
    tissue.contact.tangential_stiffness = 123.0;
    tissue.source = model::SourceParameters{"a \"ball\"", 0.003};
    const model::TissueParameters back = read_tissue_file(folder.write("back.toml", to_toml(tissue)));
    EXPECT_EQ(back.name, name);
    EXPECT_EQ(back.k1, tissue.k1);
    EXPECT_EQ(back.beta, tissue.beta);
    EXPECT_DOUBLE_EQ(back.rest_length, tissue.rest_length);
    EXPECT_DOUBLE_EQ(back.max_length, tissue.max_length);
    EXPECT_DOUBLE_EQ(back.min_length, tissue.min_length);
    EXPECT_DOUBLE_EQ(back.t1, tissue.t1);
    EXPECT_EQ(back.contact.tangential_stiffness, 123.0);
    EXPECT_EQ(back.source->indenter, "a \"ball\"");
    EXPECT_DOUBLE_EQ(back.source->radius, 0.003);
    EXPECT_EQ(back.max_depth, tissue.max_depth);
    EXPECT_EQ(back.law, tissue.law);
    tissue.source.reset();
    const model::TissueParameters bare = read_tissue_file(folder.write("bare.toml", to_toml(tissue)));
    EXPECT_FALSE(bare.source.has_value());
    EXPECT_EQ(bare.max_depth, tissue.max_depth);
  }
}

TEST(LoadTissue, TakesANameWithoutSlashOrEndingAsBuiltIn) {
  EXPECT_EQ(load_tissue("heart").name, "heart");
  EXPECT_THAT(error_of([] { (void)load_tissue("hart"); }), HasSubstr("gallbladder"));
}

TEST(TissueFile, LayersAreReadWrittenAndReadAgain) {
  const TemporaryFolder folder;
  const std::string layers =
      "[[tissue.layer]]\nname = \"skin\"\nthickness_mm = 2\npuncture_force_N = 4.5\ncutting_force_N = 1\n"
      "friction_N = 0.1\nfriction_N_per_mm = 0.05\nlateral_N_per_mm2 = 0.02\nrate_exponent = 0.3\n"
      "[[tissue.layer]]\npuncture_force_N = 0\ncutting_force_N = 0.4\n";
  const model::TissueParameters tissue = read_tissue_file(folder.write("a.toml", kRequired + layers));
  ASSERT_EQ(tissue.layers.size(), 2U);
  const model::TissueLayer& skin = tissue.layers[0];
  EXPECT_EQ(skin.name, "skin");
  EXPECT_EQ(skin.thickness, 2e-3);
  EXPECT_EQ(skin.puncture_force, 4.5);
  EXPECT_EQ(skin.friction_per_length, 50.0);
  EXPECT_EQ(skin.lateral_stiffness, 0.02 * 1e6);
  EXPECT_EQ(skin.rate_exponent, 0.3);
  EXPECT_EQ(tissue.layers[1].name, "layer 2");
  EXPECT_EQ(tissue.layers[1].thickness, std::numeric_limits<double>::infinity());
  EXPECT_EQ(read_tissue_file(folder.write("b.toml", to_toml(tissue))).layers, tissue.layers);
}

TEST(TissueFile, ALayerThatCannotBeIsRefusedByItsLine) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& layers) {
    return error_of([&] { (void)read_tissue_file(folder.write("a.toml", kRequired + layers)); });
  };
  const std::string one = "[[tissue.layer]]\npuncture_force_N = 1\ncutting_force_N = 1\n";
  EXPECT_THAT(refusal(one + one), HasSubstr("tissue.layer.thickness_mm"));
  EXPECT_THAT(refusal(one + "thickness_mm = 3\n"), HasSubstr("the last layer has no end"));
  const std::string fat = "[[tissue.layer]]\nname = \"fat\"\npuncture_force_N = 1\ncutting_force_N = 1\n";
  EXPECT_THAT(refusal(fat + "thickness_mm = 3\n" + one + "thickness_mm = 3\n" + fat),
              HasSubstr(":19: tissue.layer.name = \"fat\": layer 1 has this name too"));
  EXPECT_THAT(refusal("[[tissue.layer]]\npuncture_force_N = -1\ncutting_force_N = 1\n"),
              HasSubstr(":10: tissue.layer.puncture_force_N = -1: must be >= 0 and <= 1000"));
  EXPECT_THAT(refusal("[[tissue.layer]]\ncutting_force_N = 1\n"), HasSubstr("puncture_force_N"));
  EXPECT_THAT(refusal(one + "colour = 3\n"), HasSubstr("colour"));
  std::string many;
  for (int i = 0; i < 9; ++i) {
    many += "[[tissue.layer]]\npuncture_force_N = 1\ncutting_force_N = 1\n" +
            std::string(i < 8 ? "thickness_mm = 1\n" : "");
  }
  EXPECT_THAT(refusal(many), HasSubstr("at most 8"));
}

}  // namespace
}  // namespace palpate::scene
