#include "palpate/scene/tissue_file.h"

#include <algorithm>

#include "palpate/base/error.h"
#include "palpate/base/text.h"
#include "palpate/base/units.h"
#include "palpate/scene/load.h"
#include "palpate/scene/names.h"
#include "palpate/scene/toml_reader.h"

namespace palpate::scene {
namespace {

model::LawKind read_law(const TomlTable& table) {
  const std::string law = table.text("law").value_or("layered");
  if (law == model::to_string(model::LawKind::kSmooth)) return model::LawKind::kSmooth;
  if (law != model::to_string(model::LawKind::kLayered)) {
    table.fail("law", "must be \"layered\" or \"smooth\"");
  }
  return model::LawKind::kLayered;
}

std::vector<model::RelaxationTerm> read_relaxation(const TomlTable& table) {
  std::vector<model::RelaxationTerm> terms;
  double sum = 0.0;
  for (const TomlTable& entry : table.tables("relaxation")) {
    entry.allow_only({"share", "time_s"});
    model::RelaxationTerm term;
    term.share = entry.required_number("share", kPositive);
    term.time = entry.required_number("time_s", kPositive);
    sum += term.share;
    if (!(sum < 1.0)) {
      entry.fail("share", "the shares of all terms must sum to less than 1, these to " + shortest(sum));
    }
    if (terms.size() == model::kMostRelaxationTerms) {
      entry.fail("share", "one term too many, must be at most " +
                              std::to_string(model::kMostRelaxationTerms) + " [[tissue.relaxation]]");
    }
    terms.push_back(term);
  }
  return terms;
}

model::ReachParameters read_reach(const TomlTable& table) {
  model::ReachParameters reach;
  table.allow_only({"contact_ratio", "first_bar_ratio", "bar_ratio", "weight_ratio", "depth_exponent"});
  reach.contact_ratio = table.number("contact_ratio").value_or(reach.contact_ratio);
  reach.first_bar_ratio = table.number("first_bar_ratio").value_or(reach.first_bar_ratio);
  reach.bar_ratio = table.number("bar_ratio").value_or(reach.bar_ratio);
  reach.weight_ratio = table.number("weight_ratio").value_or(reach.weight_ratio);
  reach.depth_exponent = table.number("depth_exponent").value_or(reach.depth_exponent);
  return reach;
}

model::ContactParameters read_contact(const TomlTable& table) {
  model::ContactParameters contact;
  table.allow_only(
      {"friction", "tangential_N_per_m", "damping_N_s_per_m", "reference_radius_mm", "grip_limit_N"});
  contact.friction = table.number("friction").value_or(contact.friction);
  contact.tangential_stiffness = table.number("tangential_N_per_m");
  contact.damping = table.number("damping_N_s_per_m").value_or(contact.damping);
  if (const auto radius = table.number("reference_radius_mm"))
    contact.reference_radius = *radius * kMillimetre;
  contact.grip_limit = table.number("grip_limit_N").value_or(contact.grip_limit);
  return contact;
}

model::SourceParameters read_source(const TomlTable& table) {
  model::SourceParameters source;
  table.allow_only({"indenter", "radius_mm"});
  source.indenter = table.text("indenter").value_or("");
  source.radius = table.required_number("radius_mm", kPositive) * kMillimetre;
  return source;
}

model::TissueParameters read_parameters(const TomlTable& table, const std::string& default_name) {
  model::TissueParameters tissue;
  table.allow_only({"name", "law", "k1_N_per_m", "beta", "q", "rest_length_mm", "max_length_mm",
                    "min_length_mm", "t1_us", "relaxation", "reach", "contact", "source"});
  tissue.name = table.text("name").value_or(default_name);
  tissue.law = read_law(table);
  tissue.k1 = table.required_number("k1_N_per_m");
  tissue.beta = table.required_number("beta");
  tissue.q = table.required_number("q");
  tissue.rest_length = table.required_number("rest_length_mm") * kMillimetre;
  tissue.max_length = table.required_number("max_length_mm") * kMillimetre;
  tissue.min_length = table.required_number("min_length_mm") * kMillimetre;
  tissue.t1 = table.required_number("t1_us") * kMicrosecond;
  tissue.relaxation = read_relaxation(table);
  if (const auto reach = table.table("reach")) tissue.reach = read_reach(*reach);
  if (const auto contact = table.table("contact")) tissue.contact = read_contact(*contact);
  if (const auto source = table.table("source")) tissue.source = read_source(*source);
  return tissue;
}

/// A length in millimetres, as short as it reads back.
std::string millimetres(double metres) {
  const double rounded = metres / kMillimetre;
  return shortest(rounded);
}

std::string real(double value) {
  const std::string text = shortest(value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : one_line(text)) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

model::TissueParameters read_tissue_file(const std::filesystem::path& file) {
  const TomlFile toml = read_toml(file);
  const TomlTable root(toml);
  root.allow_only({"tissue"});
  const std::optional<TomlTable> table = root.table("tissue");
  if (!table) root.fail_missing("tissue", "a tissue file must have a table [tissue]");
  model::TissueParameters tissue = read_parameters(*table, file.stem().string());
  try {
    model::validate(tissue);
  } catch (const ParameterError& error) {
    table->fail(error);
  }
  return tissue;
}

std::string to_toml(const model::TissueParameters& tissue) {
  std::string out =
      "[tissue]\nname = " + quoted(tissue.name) + "\nlaw = " + quoted(model::to_string(tissue.law)) + "\n";
  const auto line = [&out](const char* key, const std::string& value) {
    out += std::string(key) + " = " + value + "\n";
  };
  line("k1_N_per_m", real(tissue.k1));
  line("beta", real(tissue.beta));
  line("q", real(tissue.q));
  line("rest_length_mm", millimetres(tissue.rest_length));
  line("max_length_mm", millimetres(tissue.max_length));
  line("min_length_mm", millimetres(tissue.min_length));
  line("t1_us", real(tissue.t1 / kMicrosecond));
  for (const model::RelaxationTerm& term : tissue.relaxation) {
    out += "[[tissue.relaxation]]\n";
    line("share", real(term.share));
    line("time_s", real(term.time));
  }
  out += "[tissue.reach]\n";
  line("contact_ratio", real(tissue.reach.contact_ratio));
  line("first_bar_ratio", real(tissue.reach.first_bar_ratio));
  line("bar_ratio", real(tissue.reach.bar_ratio));
  line("weight_ratio", real(tissue.reach.weight_ratio));
  line("depth_exponent", real(tissue.reach.depth_exponent));
  out += "[tissue.contact]\n";
  line("friction", real(tissue.contact.friction));
  if (tissue.contact.tangential_stiffness)
    line("tangential_N_per_m", real(*tissue.contact.tangential_stiffness));
  line("damping_N_s_per_m", real(tissue.contact.damping));
  line("reference_radius_mm", millimetres(tissue.contact.reference_radius));
  line("grip_limit_N", real(tissue.contact.grip_limit));
  if (tissue.source) {
    out += "[tissue.source]\n";
    if (!tissue.source->indenter.empty()) line("indenter", quoted(tissue.source->indenter));
    line("radius_mm", millimetres(tissue.source->radius));
  }
  return out;
}

model::TissueParameters load_tissue(const std::string& name_or_file) {
  if (means_file(name_or_file)) return read_tissue_file(name_or_file);
  return model::tissue_preset(name_or_file);
}

}  // namespace palpate::scene
