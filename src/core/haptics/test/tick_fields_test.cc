#include "core/haptics/tick_fields.h"

#include <set>
#include <string>

#include <gtest/gtest.h>

#include "core/base/test/file_contains.h"

namespace palpate::haptics {
namespace {

TEST(TickFields, EveryColumnHasANameOfItsOwn) {
  std::set<std::string> names;
  for (const TickField& field : kTickFields) {
    for (std::size_t i = 0; i < field.size(); ++i) EXPECT_TRUE(names.insert(field.columns[i]).second);
  }
}

/// The column table of docs/file-formats.md.
std::string table_for_documentation() {
  std::string text = "| columns | meaning |\n|---|---|\n";
  for (const TickField& field : kTickFields) {
    for (std::size_t i = 0; i < field.size(); ++i) {
      text += (i == 0 ? "| `" : ", `") + std::string(field.columns[i]) + "`";
    }
    text += " | " + std::string(field.meaning) + " |\n";
  }
  return text;
}

TEST(TickFields, TheDocumentationHasThisTable) {
  EXPECT_TRUE(palpate::test::file_contains(PALPATE_DOCS "/file-formats.md", table_for_documentation()));
}

}  // namespace
}  // namespace palpate::haptics
