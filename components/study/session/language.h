#pragma once
#include <map>
#include <string>
#include <vector>

namespace palpate::study {

/// Sentences of the participant's screens in one language.
struct Language {
  std::string name;                              // as the language calls itself
  std::map<std::string, std::string> sentences;  // by the English ones
  std::string consent;                           // instead of a consent file; empty: none

  /// [any] A sentence in this language; itself when it is not one of the screens' (a consent text, a number).
  [[nodiscard]] const std::string& operator()(const std::string& english) const;
  /// [any] All texts, for the fonts' letters.
  [[nodiscard]] std::string letters() const;
};

/// [any] Names of the built-in languages: en, zh.
[[nodiscard]] std::vector<std::string> builtin_languages();
/// [setup] @throws InputError for another name
[[nodiscard]] Language builtin_language(const std::string& name);
/// [setup] Reads a language file. @param file for messages @throws InputError naming a sentence that is
/// missing, unknown or has other places for numbers than the English one
[[nodiscard]] Language read_language(const std::string& text, const std::string& file);

}  // namespace palpate::study
