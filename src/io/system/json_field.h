#pragma once
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace palpate {

/// [setup] A text from outside, made safe for other programs: at most 40 bytes, in printable ASCII.
[[nodiscard]] std::string ascii_excerpt(std::string text);

/// A value of a JSON text from a file or a message, with its name in the text: "devices[0].base". All
/// functions are [setup]; they throw InputError "NAME = VALUE: must be ...", or "NAME: missing, must be ...",
/// in one line. The text must outlive it.
class JsonField final {
 public:
  /// How messages show a value: as one line, with arrays and objects by their kind; or as ascii_excerpt().
  enum class Quote { kLine, kAscii };

  /// The whole text. @param where start of all messages: "FILE: "
  explicit JsonField(const nlohmann::json& root, std::string where = "", Quote quote = Quote::kLine)
      : value_(&root), where_(std::move(where)), quote_(quote) {}

  /// Whether the text has it, with a value other than null.
  [[nodiscard]] bool there() const noexcept { return value_ != nullptr; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[noreturn]] void fail(const std::string& want) const;

  /// The member of an object; one that is null counts as missing.
  [[nodiscard]] JsonField at(const std::string& key) const;
  /// Whether the object has this member, also if it is null.
  [[nodiscard]] bool has(const std::string& key) const;
  /// The members of an object by their names, without those that are null.
  [[nodiscard]] std::vector<std::pair<std::string, JsonField>> members() const;
  /// The elements of an array; none if it is missing. @param most elements that it may have
  [[nodiscard]] std::vector<JsonField> elements(
      std::size_t most = std::numeric_limits<std::size_t>::max()) const;
  /// The elements of an array of exactly this size.
  [[nodiscard]] std::vector<JsonField> exactly(std::size_t count) const;

  /// A finite number; JSON has no others. @param want for the message
  [[nodiscard]] double number(const char* want = "a number") const;
  /// A number from `low` to `high`.
  [[nodiscard]] double number(double low, double high) const;
  /// A number > 0, at most `most`.
  [[nodiscard]] double positive(double most) const;
  [[nodiscard]] std::optional<double> optional_number() const;
  [[nodiscard]] bool flag() const;
  /// @param want for the message
  [[nodiscard]] std::string text(const std::string& want = "a text") const;
  [[nodiscard]] std::vector<std::string> texts() const;
  /// A whole number of the type's range, at most `most`.
  template <std::integral Whole>
  [[nodiscard]] Whole whole(Whole most = std::numeric_limits<Whole>::max()) const {
    return static_cast<Whole>(
        whole_from(std::numeric_limits<Whole>::min(), static_cast<std::uint64_t>(most)));
  }

 private:
  /// A value within this one. @param value null, or JSON's null: missing
  [[nodiscard]] JsonField within(const nlohmann::json* value, std::string name) const;
  /// The bits of a whole number from `least`, which is 0 or negative, to `most`.
  [[nodiscard]] std::uint64_t whole_from(std::int64_t least, std::uint64_t most) const;

  const nlohmann::json* value_;  // null: missing
  std::string where_;
  std::string name_{};  // "" for the whole text
  Quote quote_;
};

}  // namespace palpate
