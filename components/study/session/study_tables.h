#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "io/scene/toml_reader.h"

#include "study/session/study.h"

namespace palpate::study {

/// A task of a study file with its table, for messages.
struct ReadTask {
  StudyTask task;
  scene::TomlTable table;
};

/// [setup] Reads a [[task]] table. @param study with its conditions and safety limits @throws InputError
[[nodiscard]] ReadTask read_task(const scene::TomlTable& table, const Study& study);

/// [setup] Sorts the tasks so that each follows those that it takes a value from, and checks these. @throws
/// InputError
[[nodiscard]] std::vector<ReadTask> sort_tasks(std::vector<ReadTask> tasks);

/// [setup] Checks the forces of all tasks of the study, which `tables` belong to. @throws InputError
void check_forces(const Study& study, const std::vector<ReadTask>& tables);

/// [setup] The text of a key, which must be one of `known`. @throws InputError with the nearest
[[nodiscard]] std::string choice(const scene::TomlTable& table, std::string_view key,
                                 const std::vector<std::string>& known, const std::string& otherwise);

/// [setup] @throws InputError always: the key's value, the valid ones and the nearest.
[[noreturn]] void fail_choice(const scene::TomlTable& table, std::string_view key, const std::string& value,
                              const std::vector<std::string>& known);

/// [setup] A whole number from `low` to `high`. @throws InputError
[[nodiscard]] int count(const scene::TomlTable& table, std::string_view key, int low, int high,
                        int otherwise);

/// [setup] A name of letters, digits, '.', '-' and '_', at most 40 of them. @throws InputError
[[nodiscard]] std::string name_in(const scene::TomlTable& table, std::string_view key);

}  // namespace palpate::study
