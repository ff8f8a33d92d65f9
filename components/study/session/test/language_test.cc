#include "study/session/language.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "study/session/study.h"
#include "study/session/study_languages.h"
#include "study/session/test/study_text.h"

namespace palpate::study {
namespace {

using testing::HasSubstr;

// zh.toml with a part replaced.
std::string chinese_with(const std::string& part, const std::string& by) {
  std::string text = kChinese;
  const std::size_t at = text.find(part);
  return at == std::string::npos ? text : text.replace(at, part.size(), by);
}

TEST(Language, EnglishIsWhatTheProgramSaysAndHasEverySentenceOfTheTasks) {
  const Language english = builtin_language("en");
  for (const auto& [sentence, own] : english.sentences) EXPECT_EQ(sentence, own);
  for (std::size_t kind = 0; kind < kTaskKinds; ++kind) {
    const TaskDescription& task = describe(static_cast<TaskKind>(kind));
    for (const char* text : {task.sentence, task.instructions, task.action}) {
      EXPECT_TRUE(english.sentences.contains(text)) << text;
    }
  }
}

TEST(Language, ChineseHasEverySentence) {
  const Language chinese = builtin_language("zh");
  EXPECT_EQ(chinese("Which one?"), "哪一段？");
  EXPECT_EQ(chinese("a consent text"), "a consent text");
  EXPECT_EQ(chinese.sentences.size(), builtin_language("en").sentences.size());
}

TEST(Language, AFileThatLacksASentenceOrAPlaceOfANumberIsRefused) {
  EXPECT_THAT(
      error_of([] { (void)read_language(chinese_with("\"Which one?\" = \"哪一段？\"\n", ""), "l.toml"); }),
      HasSubstr("l.toml: sentences.\"Which one?\": is missing"));
  EXPECT_THAT(
      error_of([] { (void)read_language(chinese_with("\"Which one?\"", "\"Which onne?\""), "l.toml"); }),
      HasSubstr("sentences.\"Which one?\": is missing"));
  EXPECT_THAT(error_of([] { (void)read_language(chinese_with("第 {} 段\"", "第段\""), "l.toml"); }),
              HasSubstr("must have 1 times {}"));
  EXPECT_THAT(error_of([] { (void)read_language(chinese_with("第 {} 段\"", "第 {} 段}\""), "l.toml"); }),
              HasSubstr("must have 1 times {}"));
  EXPECT_THAT(
      error_of([] { (void)read_language(std::string(kChinese) + "\"Press on\" = \"x\"\n", "l.toml"); }),
      HasSubstr("\"Press on\": is no sentence of the screens"));
  EXPECT_THAT(error_of([] { (void)builtin_language("fr"); }), HasSubstr("must be en, zh or a file.toml"));
}

}  // namespace
}  // namespace palpate::study
