#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "run/tasks/communicator.h"
#include "run/tasks/record.h"

namespace palpate::tasks {

/// Numbered tasks. A result depends only on the task's number (random numbers are a function of seed and
/// number), so any rank may compute it.
struct Tasks {
  std::size_t count = 0;
  std::function<std::string(std::size_t)> run;  // called on any rank
  // Key of a task's result in the record; empty function: not recorded.
  std::function<std::string(std::size_t)> key{};
  // Called on rank 0 for each finished task, in any order, one call at a time; recorded ones first.
  std::function<void(std::size_t)> done{};
  // Whether run() may be called on several threads at once; then a single process uses all of its processors.
  bool on_threads = false;
};

/// Results in the order of the tasks.
struct TaskResults {
  std::vector<std::string> results;
  std::size_t resumed = 0;  // results taken from the record
};

/// [setup] Runs the tasks that are not in the record, each on the next free rank, and returns all results on
/// every rank. The bytes do not depend on the number of ranks or threads. All ranks must make this call.
/// @param ranks null: this process only @param record null: nothing is recorded; needs tasks.key
/// @throws InputError on all ranks, after all tasks are done, with the message of the first task that threw;
/// on rank 0 the record's failure() is appended. Its result is not recorded.
TaskResults for_each_task(Communicator* ranks, const Tasks& tasks, Record* record = nullptr);

}  // namespace palpate::tasks
