#include "io/system/json_field.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "palpate/error.h"

namespace palpate {

using nlohmann::json;

constexpr std::size_t kLongestField = 200;  // bytes of a field's name in a message

std::string ascii_excerpt(std::string text) {
  constexpr std::size_t kLongest = 40;  // bytes
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

void JsonField::fail(const std::string& want) const {
  const std::string name = where_ + (name_.empty() ? "it" : excerpt(name_, kLongestField));
  if (!there()) throw InputError(name + ": missing, must be " + want);
  const bool by_kind = quote_ == Quote::kLine && !value_->is_primitive();
  const std::string value = by_kind ? std::string("an ") + value_->type_name()
                                    : value_->dump(-1, ' ', false, json::error_handler_t::replace);
  throw InputError(name + " = " + (quote_ == Quote::kLine ? excerpt(value) : ascii_excerpt(value)) +
                   ": must be " + want);
}

JsonField JsonField::within(const json* value, std::string name) const {
  JsonField field = *this;
  field.value_ = value == nullptr || value->is_null() ? nullptr : value;
  field.name_ = std::move(name);
  return field;
}

JsonField JsonField::at(const std::string& key) const {
  const std::string name = name_.empty() ? key : name_ + "." + key;
  if (!there()) return within(nullptr, name);
  if (!value_->is_object()) fail("an object");
  const auto found = value_->find(key);
  return within(found == value_->end() ? nullptr : &*found, name);
}

bool JsonField::has(const std::string& key) const { return there() && value_->contains(key); }

std::vector<std::pair<std::string, JsonField>> JsonField::members() const {
  if (!there() || !value_->is_object()) fail("an object");
  std::vector<std::pair<std::string, JsonField>> all;
  for (const auto& [key, value] : value_->items()) {
    if (!value.is_null()) all.emplace_back(key, at(key));
  }
  return all;
}

std::vector<JsonField> JsonField::elements(std::size_t most) const {
  std::vector<JsonField> all;
  if (!there()) return all;
  if (!value_->is_array()) fail("an array");
  if (value_->size() > most) {
    throw InputError(where_ + excerpt(name_, kLongestField) + ": has " + std::to_string(value_->size()) +
                     " elements, must have at most " + std::to_string(most));
  }
  all.reserve(value_->size());
  for (std::size_t i = 0; i < value_->size(); ++i) {
    all.push_back(within(&(*value_)[i], name_ + "[" + std::to_string(i) + "]"));
  }
  return all;
}

std::vector<JsonField> JsonField::exactly(std::size_t count) const {
  std::vector<JsonField> all = elements();
  if (all.size() != count) fail("an array of " + std::to_string(count));
  return all;
}

double JsonField::number(const char* want) const {
  if (!there() || !value_->is_number()) fail(want);
  return value_->get<double>();
}

double JsonField::number(double low, double high) const {
  const double value = number();
  if (!(value >= low && value <= high)) fail("a number from " + shortest(low) + " to " + shortest(high));
  return value;
}

double JsonField::positive(double most) const {
  const double value = number();
  if (!(value > 0.0 && value <= most)) fail("a number > 0 and <= " + shortest(most));
  return value;
}

std::optional<double> JsonField::optional_number() const {
  return there() ? std::optional(number()) : std::nullopt;
}

bool JsonField::flag() const {
  if (!there() || !value_->is_boolean()) fail("true or false");
  return value_->get<bool>();
}

std::string JsonField::text(const std::string& want) const {
  if (!there() || !value_->is_string()) fail(want);
  return value_->get<std::string>();
}

std::vector<std::string> JsonField::texts() const {
  std::vector<std::string> all;
  for (const JsonField& element : elements()) all.push_back(element.text());
  return all;
}

std::uint64_t JsonField::whole_from(std::int64_t least, std::uint64_t most) const {
  if (there() && value_->is_number_unsigned() && value_->get<std::uint64_t>() <= most) {
    return value_->get<std::uint64_t>();
  }
  if (there() && value_->is_number_integer() && !value_->is_number_unsigned() &&
      value_->get<std::int64_t>() >= least && value_->get<std::int64_t>() < 0) {
    return static_cast<std::uint64_t>(value_->get<std::int64_t>());
  }
  fail("a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace palpate
