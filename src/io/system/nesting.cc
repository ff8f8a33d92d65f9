#include "io/system/nesting.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace palpate {
namespace {

/// Reads the lexical structure of a TOML text: strings, comments, brackets, and the parts of keys.
class TomlNesting final {
 public:
  TomlNesting(std::string_view text, int levels) : text_(text), levels_(levels) {}

  std::optional<std::size_t> first_too_deep() {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;  // byte order mark
    while (at_ < text_.size()) {
      const std::size_t index = at_;
      read_one();
      if (header_ + around_ + parts_ > levels_) return index;
    }
    return std::nullopt;
  }

 private:
  void read_one() {
    const char c = text_[at_];
    const bool at_start = std::exchange(statement_begins_, false);
    switch (c) {
      case ' ':
      case '\t':
      case '\r':
        statement_begins_ = at_start;
        break;
      case '\n':
        statement_begins_ = open_.empty();
        if (open_.empty()) parts_ = 1;
        break;
      case '#':
        at_ = std::min(text_.find('\n', at_), text_.size());
        return;
      case '"':
      case '\'':
        skip_string(c);
        return;
      case '.':
        ++parts_;
        break;
      case ',':
        parts_ = 1;
        break;
      case '[':
      case '{':
        if (at_start) {
          begin_header();
        } else {
          open();
        }
        break;
      case ']':
      case '}':
        close();
        break;
      default:
        break;
    }
    ++at_;
  }

  /// [a.b] or [[a.b]]: the parts of the key count for all lines until the next header.
  void begin_header() {
    header_ = 0;
    in_header_ = true;
    open_.push_back(0);
  }

  void open() {
    open_.push_back(in_header_ ? 0 : parts_);
    around_ += open_.back();
    if (!in_header_) parts_ = 1;
  }

  void close() {
    if (open_.empty()) return;  // not valid
    around_ -= open_.back();
    open_.pop_back();
    if (!in_header_ || !open_.empty()) return;
    in_header_ = false;
    header_ = std::exchange(parts_, 1);
  }

  /// Skips a string in one or three quotes.
  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool multi_line = text_.substr(at_).starts_with(three);
    const std::string end = multi_line ? three : std::string(1, quote);
    at_ += end.size();
    while (at_ < text_.size() && !text_.substr(at_).starts_with(end)) {
      if (text_[at_] == '\n' && !multi_line) return;  // not valid
      at_ += quote == '"' && text_[at_] == '\\' ? 2 : 1;
    }
    at_ = std::min(at_ + end.size(), text_.size());
    if (!multi_line) return;
    constexpr int kMaxBeforeEnd = 2;  // quotes that belong to the string: """a"""""
    for (int i = 0; i < kMaxBeforeEnd && at_ < text_.size() && text_[at_] == quote; ++i) ++at_;
  }

  std::string_view text_;
  int levels_;
  std::size_t at_ = 0;
  bool statement_begins_ = true;  // at a line's begin, outside all brackets
  bool in_header_ = false;
  int header_ = 0;         // parts of the last table header's key
  int parts_ = 1;          // of the key that is read; a number's or date's dots count too
  int around_ = 0;         // levels of the brackets around
  std::vector<int> open_;  // levels that each of these brackets adds
};

}  // namespace

std::optional<std::size_t> json_nested_deeper_at(std::string_view text, int levels) noexcept {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '\\') {
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && (c == '[' || c == '{')) {
      if (++depth > levels) return i;
    } else if (!quoted && (c == ']' || c == '}')) {
      --depth;
    }
  }
  return std::nullopt;
}

std::optional<std::size_t> toml_nested_deeper_at(std::string_view text, int levels) {
  return TomlNesting(text, levels).first_too_deep();
}

}  // namespace palpate
