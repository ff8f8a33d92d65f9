#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "science/tasks/ranks.h"
#include "science/tasks/record.h"

namespace palpate::tasks {

/// Numbered tasks. The result of each depends on its number alone (random numbers are a function of seed and
/// number), so that it does not matter which rank computes it.
struct Tasks {
  std::size_t count = 0;
  std::function<std::string(std::size_t)> run;  // called on any rank
  // Key of a task in the record; its result is then the record's line with that key. None: not recorded.
  std::function<std::string(std::size_t)> key{};
  // Called on rank 0 for each task that is done, in any order; first for those that the record has.
  std::function<void(std::size_t)> done{};
};

/// Results in the order of the tasks.
struct TaskResults {
  std::vector<std::string> results;
  std::size_t resumed = 0;  // that were taken from the record
};

/// [setup] Runs the tasks that the record has not, each on the next rank that is free, and returns all
/// results to every rank: the same bytes on any number of ranks. Every rank makes the same call.
/// @param ranks null: this process alone @param record null: nothing is kept; needs tasks.key
/// @throws InputError on every rank alike, when all tasks are done, with the message of the first task that
/// threw, on rank 0 with record's failure() after it; its result is not recorded.
TaskResults for_each_task(Ranks* ranks, const Tasks& tasks, Record* record = nullptr);

}  // namespace palpate::tasks
