#include "fit/sweep/sweep.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <sstream>
#include <utility>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/content_hash.h"
#include "core/base/portable_math.h"
#include "core/base/text.h"
#include "io/mesh_io/formats/formats.h"
#include "io/record/scene_json.h"
#include "io/scene/scene_keys.h"
#include "io/system/file_exists.h"
#include "io/system/input_file.h"
#include "io/system/json_text.h"
#include "io/system/path_text.h"
#include "io/system/whole_json.h"
#include "palpate/error.h"
#include "palpate/session.h"
#include "palpate/version.h"
#include "run/tasks/for_each_task.h"

namespace palpate::sweep {
namespace {

using Json = nlohmann::ordered_json;
using session::kRunQuantities;
using session::RunQuantity;

constexpr const char* kFailed = "failed: ";

std::size_t count_of(const std::vector<Axis>& axes) {
  std::size_t runs = 1;
  for (const Axis& axis : axes) {
    runs *= axis.values.size();
    if (runs <= kMaxRuns) continue;
    throw InputError(fmt::format("--set: more than {} runs; give fewer values", kMaxRuns));
  }
  return runs;
}

/// Values of a run, one per axis; the last axis varies fastest.
std::vector<std::string> values_of(const std::vector<Axis>& axes, std::size_t run) {
  std::vector<std::string> values(axes.size());
  for (std::size_t i = axes.size(); i-- > 0;) {
    values[i] = axes[i].values[run % axes[i].values.size()];
    run /= axes[i].values.size();
  }
  return values;
}

/// @throws InputError for a device that moves in real time: a sweep runs offline.
scene::Scene load_offline(const scene::Overrides& request) {
  scene::Scene scene = scene::load(request);
  for (const scene::DeviceSetup& device : scene.devices) {
    if (device.kind == "scripted" || device.kind == "emulated" || device.kind == "replay") continue;
    throw InputError("device " + device.kind + ": a sweep needs a scripted, emulated or replay device");
  }
  return scene;
}

void add(ContentHasher& hasher, const std::string& text) {
  hasher.add(std::as_bytes(std::span<const char>(text)));
}

void add_file(ContentHasher& hasher, const std::filesystem::path& file) {
  if (regular_file_exists(file)) add(hasher, InputFile(file, kRecordingInput).read_rest());
}

/// Hash of all common inputs: program, scene, the files that it names, and the axes. @param scene receives
/// the scene's name
std::string fingerprint_of(const SweepRequest& request, std::string& name) {
  const scene::Scene scene = load_offline(request.scene);
  name = scene.name;
  ContentHasher hasher;
  add(hasher, kVersion);
  add(hasher, record::scene_to_json(scene));
  hasher.add(request.duration_s.value_or(-1.0)).add(request.scene.fit_device ? 1 : 0);
  for (const scene::SourceFile& file : scene.files) add_file(hasher, file.path);
  for (const Axis& axis : request.axes) {
    add(hasher, axis.key);
    for (const std::string& value : axis.values) add(hasher, value);
  }
  return hasher.hash().hexadecimal();
}

/// One line per run with its key: fingerprint of the sweep, number of the run, and hashes of the files named
/// by its axis values, so that a run is repeated when one of them changes or appears.
std::string keys_of(const SweepRequest& request, const std::string& fingerprint) {
  std::map<std::string, std::string> contents;  // hashes of the files of a value
  for (const Axis& axis : request.axes) {
    for (const std::string& value : axis.values) {
      const std::vector<std::filesystem::path> files = files_of(request, axis, value);
      ContentHasher hasher;
      for (const std::filesystem::path& file : files) add_file(hasher, file);
      if (!files.empty()) contents[value] = '-' + hasher.hash().hexadecimal();
    }
  }
  std::string keys;
  for (std::size_t run = 0; run < count_of(request.axes); ++run) {
    keys += fmt::format("{}-{}", fingerprint, run);
    for (const std::string& value : values_of(request.axes, run)) {
      if (const auto found = contents.find(value); found != contents.end()) keys += found->second;
    }
    keys += '\n';
  }
  return keys;
}

std::string line_of(const std::string& key, const std::vector<Axis>& axes, const SweepRow& row) {
  Json json = {{"key", key}};
  for (std::size_t i = 0; i < axes.size(); ++i) json["set"][axes[i].key] = row.settings[i];
  for (std::size_t i = 0; i < row.quantities.size(); ++i) json[kRunQuantities[i].name] = row.quantities[i];
  json.update({{"missed_contact", row.missed_contact},
               {"faults", row.faults},
               {"fault", row.fault},
               {"ended", row.ended}});
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// @throws InputError or Json::exception when the line does not belong to these axes.
SweepRow row_of(const std::string& line, const std::vector<Axis>& axes) {
  const Json json = parse_json(line);
  SweepRow row;
  for (const Axis& axis : axes) row.settings.push_back(json.at("set").at(axis.key).get<std::string>());
  row.ended = json.at("ended").get<std::string>();
  row.missed_contact = json.at("missed_contact").get<bool>();
  row.faults = whole_number<std::uint64_t>(json, "faults");
  row.fault = json.at("fault").get<std::string>();
  if (row.ended.starts_with(kFailed)) return row;
  for (const RunQuantity& quantity : kRunQuantities) {
    row.quantities.push_back(json.at(quantity.name).get<double>());
  }
  return row;
}

SweepRow run_one(const SweepRequest& request, std::size_t run) {
  SweepRow row;
  row.settings = values_of(request.axes, run);
  try {
    scene::Overrides overrides = request.scene;
    for (std::size_t i = 0; i < request.axes.size(); ++i) {
      overrides.settings.push_back({request.axes[i].key, row.settings[i]});
    }
    session::Session session(load_offline(overrides),
                             {.duration_s = request.duration_s, .preparation = request.preparation});
    const session::RunResult result = session.run({.offline = true, .keep_fault = false});
    for (const RunQuantity& quantity : kRunQuantities) row.quantities.push_back(quantity.of(result));
    row.missed_contact = result.statistics.contact_ticks == 0;
    row.faults = result.loop.faults.size() + result.loop.further_faults;
    row.fault = haptics::name_of(result.loop.fault);
    row.ended = "done";
  } catch (const std::exception& error) {
    row.quantities.clear();
    row.ended = kFailed + one_line(error.what());
  }
  return row;
}

/// @throws InputError when the record contains runs of another sweep
void check_record(const std::filesystem::path& file, const std::string& fingerprint) {
  for (const auto& [key, line] : tasks::read_record(to_text(file), [](const std::string&) {})) {
    if (key.starts_with(fingerprint)) continue;
    throw InputError(to_text(file) +
                     ": holds runs of another sweep: the scene, a file that it names, a flag or the version "
                     "of palpate was different; give another --out, or delete this file to start again");
  }
}

std::vector<std::string> split(const std::string& text, char between) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(between); end != std::string::npos; end = text.find(between, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

/// Parses LOW:HIGH:N or LOW:HIGH:N:log; empty when the form is wrong. Values have at most 12 digits, so that
/// 0.1:0.7:7 contains exactly 0.2.
std::vector<std::string> spaced(const std::vector<std::string>& parts) {
  if (parts.size() < 3 || parts.size() > 4) return {};
  const std::optional<double> low = parse_number(parts[0]);
  const std::optional<double> high = parse_number(parts[1]);
  const std::optional<double> count = parse_number(parts[2]);
  const bool logarithmic = parts.size() == 4;
  if (!low || !high || !count || (logarithmic && (parts[3] != "log" || !(*low > 0.0)))) return {};
  if (!(*low < *high) || !std::isfinite(*high - *low)) return {};
  if (!(*count >= 2.0 && *count <= kMaxRuns) || *count != std::floor(*count)) return {};
  std::vector<std::string> values;
  for (double i = 0.0; i < *count; ++i) {
    const double share = i / (*count - 1.0);
    const double value =
        logarithmic ? portable::exp((1.0 - share) * portable::log(*low) + share * portable::log(*high))
                    : *low + share * (*high - *low);
    const double rounded = *parse_number(fmt::format("{:.12g}", value));
    const bool whole = rounded == std::floor(rounded) && std::abs(rounded) < 1e15;
    values.push_back(whole ? fmt::format("{:.0f}", rounded) : shortest(rounded));
  }
  return values;
}

}  // namespace

std::size_t SweepResult::failed() const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const SweepRow& row) { return row.failed(); }));
}

std::size_t SweepResult::missed() const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const SweepRow& row) { return row.missed_contact; }));
}

std::size_t SweepResult::with_fault() const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const SweepRow& row) { return row.faults > 0; }));
}

std::vector<std::filesystem::path> files_of(const SweepRequest& request, const Axis& axis,
                                            const std::string& value) {
  const std::filesystem::path file = request.scene.scene->parent_path() / to_path(value);
  if (axis.type != scene::KeyType::kText || !regular_file_exists(file)) return {};
  std::vector<std::filesystem::path> files = {file};
  try {
    for (const std::filesystem::path& buffer : mesh_io::gltf_buffer_files(file)) files.push_back(buffer);
  } catch (const InputError&) {  // the run itself reports the error
  }
  return files;
}

SweepResult run_sweep(const SweepRequest& request, tasks::Communicator& ranks, const Progress& progress) {
  const std::size_t runs = count_of(request.axes);
  SweepResult result{"", request.axes, {}, 0, {}};
  std::string lines_of_keys;
  tasks::on_rank_zero(ranks, [&] {
    const std::string fingerprint = fingerprint_of(request, result.scene);
    check_record(request.record, fingerprint);
    lines_of_keys = keys_of(request, fingerprint);
    std::filesystem::create_directories(request.record.parent_path());
  });
  std::istringstream in(ranks.broadcast(std::move(lines_of_keys)));
  std::vector<std::string> keys(runs);
  for (std::string& line : keys) std::getline(in, line);
  const auto key = [&keys](std::size_t run) { return keys[run]; };
  std::size_t done = 0;
  const auto arrived = [&](std::size_t) {
    ++done;
    if (progress)
      progress(static_cast<double>(done) / static_cast<double>(runs),
               fmt::format("{} of {} runs", done, runs));
  };
  const auto run = [&](std::size_t i) { return line_of(key(i), request.axes, run_one(request, i)); };
  tasks::Record record(to_text(request.record), ranks, [&request](const std::string& line) {
    if (row_of(line, request.axes).failed()) throw InputError("is run again");
  });
  auto [lines, resumed] = tasks::for_each_task(&ranks, {runs, run, key, arrived, true}, &record);
  result.resumed = resumed;
  result.record_failure = record.failure();
  for (const std::string& line : lines) result.rows.push_back(row_of(line, request.axes));
  return result;
}

bool Axis::number() const noexcept {
  return type == scene::KeyType::kNumber || type == scene::KeyType::kWhole;
}

Axis parse_axis(const std::string& flag, const std::string& text) {
  const std::size_t equals = text.find('=');
  const scene::SceneKey& key = scene::find_scene_key(flag, text.substr(0, equals));
  const std::string right = equals == std::string::npos ? "" : text.substr(equals + 1);
  Axis axis{key.path, key.type, {}};
  const bool range = axis.number() && right.find(':') != std::string::npos;
  axis.values = range ? spaced(split(right, ':')) : split(right, ',');
  if (right.empty() || axis.values.empty()) {
    throw InputError(
        fmt::format("{} {}: must be KEY=LOW:HIGH:N with LOW < HIGH and N from 2 to {}, :log after it for "
                    "even steps of the logarithm, or KEY=VALUE,VALUE,...",
                    flag, text, kMaxRuns));
  }
  for (const std::string& value : axis.values) key.check(flag, value);
  for (auto value = axis.values.begin(); value != axis.values.end(); ++value) {
    if (std::find(axis.values.begin(), value, *value) == value) continue;
    throw InputError(fmt::format("{} {}: has the value {} twice", flag, text, *value));
  }
  return axis;
}

}  // namespace palpate::sweep
