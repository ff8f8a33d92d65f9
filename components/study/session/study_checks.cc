#include <algorithm>

#include <fmt/core.h>

#include "core/base/text.h"

#include "study/session/study_tables.h"

namespace palpate::study {
namespace {

std::vector<std::string> names_of(const std::vector<ReadTask>& tasks) {
  std::vector<std::string> names;
  for (const ReadTask& read : tasks) names.push_back(read.task.name);
  return names;
}

/// The task that sets the noise threshold; null without one.
const ReadTask* find_setter(const std::vector<ReadTask>& tasks) {
  const ReadTask* setter = nullptr;
  for (const ReadTask& read : tasks) {
    if (!read.task.sets_threshold) continue;
    if (setter != nullptr) {
      read.table.fail("sets_share_of", "only one task may set it, and " + setter->task.name + " does");
    }
    setter = &read;
  }
  return setter;
}

const ReadTask& source_of(const std::vector<ReadTask>& tasks, const ReadTask& read) {
  const scene::TomlTable signal = *read.table.table("signal");
  const auto found = std::find_if(tasks.begin(), tasks.end(), [&](const ReadTask& other) {
    return other.task.name == read.task.signal->task;
  });
  if (found == tasks.end()) fail_choice(signal, "from_task", read.task.signal->task, names_of(tasks));
  const StudyTask& source = found->task;
  const bool without_noise =
      std::any_of(source.arms.begin(), source.arms.end(), [](const Arm& arm) { return arm.share == 0.0; });
  if (source.stimulus() != Stimulus::kForce || source.signal || !without_noise) {
    signal.fail("from_task", "must be a force-detection task with force_mN, in which one arm has no noise");
  }
  return *found;
}

/// Names of the tasks that a task takes values from.
std::vector<std::string> needs_of(const std::vector<ReadTask>& tasks, const ReadTask& read,
                                  const ReadTask* setter) {
  std::vector<std::string> needs;
  if (read.task.signal) needs.push_back(source_of(tasks, read).task.name);
  if (!read.task.has_noise()) return needs;
  if (setter == nullptr) {
    read.table.fail(read.table.has("shares") ? "shares" : "conditions",
                    "needs a task of kind noise-threshold with sets_share_of = \"threshold\"");
  }
  needs.push_back(setter->task.name);
  return needs;
}

}  // namespace

std::vector<ReadTask> sort_tasks(std::vector<ReadTask> tasks) {
  const std::vector<std::string> names = names_of(tasks);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i)) {
      tasks[i].table.fail("name", "is the name of an earlier task, must be another");
    }
  }
  const ReadTask* setter = find_setter(tasks);
  std::vector<std::vector<std::string>> needs;
  for (const ReadTask& read : tasks) needs.push_back(needs_of(tasks, read, setter));
  // No cycle is possible: only tasks without a signal are sources, and the setter needs nothing.
  std::vector<ReadTask> sorted;
  std::vector<bool> used(tasks.size());
  const auto ready = [&](std::size_t task) {
    return std::all_of(needs[task].begin(), needs[task].end(), [&](const std::string& name) {
      return std::any_of(sorted.begin(), sorted.end(),
                         [&](const ReadTask& read) { return read.task.name == name; });
    });
  };
  while (sorted.size() < tasks.size()) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (used[i] || !ready(i)) continue;
      used[i] = true;
      sorted.push_back(tasks[i]);
      break;
    }
  }
  return sorted;
}

void check_forces(const Study& study, const std::vector<ReadTask>& tables) {
  constexpr double kRounding = 1e-9;  // N
  for (const ReadTask& read : tables) {
    const ForceBound bound = force_bound(study, read.task);
    if (bound.sum() <= study.max_force + kRounding) continue;
    read.table.fail("name", fmt::format("its largest force is {} N = {} (tissue) + {} (commanded) + {} (6 "
                                        "standard deviations of noise), must be at most "
                                        "safety.max_force_N, {} N",
                                        brief(bound.sum()), brief(bound.tissue), brief(bound.commanded),
                                        brief(bound.noise), shortest(study.max_force)));
  }
}

}  // namespace palpate::study
