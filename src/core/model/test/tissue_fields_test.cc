#include "core/model/tissue_fields.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/test/file_contains.h"
#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate::model {
namespace {

/// Bytes of the members that a section's fields cover.
std::size_t bytes_of(std::string_view section) {
  std::size_t bytes = 0;
  for (const TissueField& field : kTissueFields) {
    if (field.section == section) bytes += field.optional() ? sizeof(std::optional<double>) : sizeof(double);
  }
  return bytes;
}

TEST(TissueFields, EveryNumberOfATissueHasALine) {
  EXPECT_EQ(bytes_of("reach"), sizeof(FalloffRatios));
  EXPECT_EQ(bytes_of("contact"), sizeof(ContactParameters));
  EXPECT_EQ(bytes_of(""), offsetof(TissueNumbers, law));
}

TEST(TissueFields, EveryLineIsAboutAnotherNumber) {
  TissueNumbers tissue;
  double value = 1.0;
  for (const TissueField& field : kTissueFields) field.at.set(tissue, value++);
  value = 1.0;
  for (const TissueField& field : kTissueFields) {
    EXPECT_EQ(field.at.get(tissue), value) << field.key;
    EXPECT_EQ(field.in_force(tissue), value++) << field.key;
  }
}

TEST(TissueFields, NamesAreUnambiguousWhereverTheyStandAlone) {
  std::set<std::string> names;
  std::set<std::string> columns;
  for (const TissueField& field : kTissueFields) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    EXPECT_TRUE(columns.insert(field.column()).second) << field.column();
  }
}

TEST(TissueFields, WithoutAValueANumberThatMustBeGivenStaysAndAnotherIsDerived) {
  TissueParameters tissue = tissue_preset("heart");
  tissue.contact.tangential_stiffness = 7.0;
  for (const TissueField& field : kTissueFields) field.at.set(tissue, std::nullopt);
  TissueParameters heart = tissue_preset("heart");
  heart.max_depth.reset();
  EXPECT_EQ(tissue.numbers(), heart.numbers());
  EXPECT_EQ(tissue.contact.tangential_stiffness, std::nullopt);
}

TEST(TissueFields, SlidersReachNoValueThatIsRefused) {
  for (const TissueField& field : kTissueFields) {
    if (field.key == std::string_view("reference_radius_mm")) continue;  // no slider
    EXPECT_TRUE(field.range.contains(field.slider.low)) << field.key;
    EXPECT_TRUE(field.range.contains(field.slider.high)) << field.key;
    EXPECT_LT(field.slider.low, field.slider.high) << field.key;
  }
}

std::string default_in_words(const TissueField& field) {
  if (field.required()) return "required";
  const std::optional<double> value = field.at.get(TissueNumbers{});
  return value ? shortest(*value / field.unit.si) : field.derived_text;
}

/// The tissue table of docs/file-formats.md.
std::string table_for_documentation() {
  std::string text = "| key | default | must be | meaning |\n|---|---|---|---|\n";
  for (const TissueField& field : kTissueFields) {
    text += "| `" + field.path() + "` | " + default_in_words(field) + " | " + field.range.to_string() +
            " | " + field.meaning + " |\n";
  }
  return text;
}

TEST(TissueFields, TheDocumentationHasThisTable) {
  EXPECT_TRUE(palpate::test::file_contains(PALPATE_DOCS "/file-formats.md", table_for_documentation()));
}

}  // namespace
}  // namespace palpate::model
