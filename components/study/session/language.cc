#include "study/session/language.h"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/text.h"
#include "io/scene/toml_reader.h"
#include "palpate/error.h"

#include "study/session/study_languages.h"

namespace palpate::study {
namespace {

// Places for numbers and keys: "{}".
std::size_t places_in(const std::string& sentence) {
  std::size_t places = 0;
  for (std::size_t at = sentence.find("{}"); at != std::string::npos; at = sentence.find("{}", at + 2))
    ++places;
  return places;
}

std::map<std::string, std::string> sentences_of(const scene::TomlFile& parsed) {
  std::map<std::string, std::string> sentences;
  const toml::table* table = parsed.root["sentences"].as_table();
  if (table == nullptr)
    throw InputError(parsed.name + ": sentences: is missing, must be a table [sentences]");
  for (const auto& [english, node] : *table) {
    const auto value = node.value<std::string>();
    if (!value || trimmed(*value).empty()) {
      throw InputError(fmt::format("{}:{}: sentences.\"{}\": must be a text", parsed.name,
                                   node.source().begin.line, excerpt(std::string(english.str()))));
    }
    sentences.emplace(std::string(english.str()), *value);
  }
  return sentences;
}

const std::map<std::string, std::string>& english_sentences() {
  static const std::map<std::string, std::string> all = sentences_of(scene::parse_toml(kEnglish, "en.toml"));
  return all;
}

void check_sentences(const std::map<std::string, std::string>& sentences, const std::string& file) {
  std::vector<std::string> known;
  for (const auto& [english, own] : english_sentences()) {
    known.push_back(english);
    const auto found = sentences.find(english);
    if (found == sentences.end()) {
      throw InputError(
          fmt::format("{}: sentences.\"{}\": is missing, must be its translation", file, excerpt(english)));
    }
    const std::size_t places = places_in(english);
    if (places_in(found->second) == places &&
        std::count(found->second.begin(), found->second.end(), '{') == static_cast<std::ptrdiff_t>(places) &&
        std::count(found->second.begin(), found->second.end(), '}') == static_cast<std::ptrdiff_t>(places)) {
      continue;
    }
    throw InputError(
        fmt::format("{}: sentences.\"{}\" = \"{}\": must have {} times {{}}, for a number or key", file,
                    excerpt(english), excerpt(found->second), places));
  }
  for (const auto& [sentence, own] : sentences) {
    if (english_sentences().contains(sentence)) continue;
    const std::string near = nearest_word(sentence, known);
    throw InputError(fmt::format("{}: sentences.\"{}\": is no sentence of the screens{}", file,
                                 excerpt(sentence), near.empty() ? "" : ", did you mean \"" + near + "\"?"));
  }
}

}  // namespace

const std::string& Language::operator()(const std::string& english) const {
  const auto found = sentences.find(english);
  return found == sentences.end() ? english : found->second;
}

std::string Language::letters() const {
  std::string all = name + consent;
  for (const auto& [english, own] : sentences) all += own;
  return all;
}

std::vector<std::string> builtin_languages() { return {"en", "zh"}; }

Language builtin_language(const std::string& name) {
  if (name == "en") return read_language(kEnglish, "en.toml");
  if (name == "zh") return read_language(kChinese, "zh.toml");
  throw InputError("language \"" + excerpt(name) + "\": unknown, must be en, zh or a file.toml");
}

Language read_language(const std::string& text, const std::string& file) {
  const scene::TomlFile parsed = scene::parse_toml(text, file);
  const scene::TomlTable root(parsed);
  root.allow_only({"name", "consent", "sentences"});
  Language language;
  const std::optional<std::string> name = root.text("name");
  if (!name) root.fail_missing("name", "must be the language's name");
  language.name = *name;
  language.consent = parsed.root["consent"].value_or(std::string());
  language.sentences = sentences_of(parsed);
  check_sentences(language.sentences, file);
  return language;
}

}  // namespace palpate::study
