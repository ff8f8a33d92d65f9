#include "run/tasks/for_each_task.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "core/base/parallel.h"
#include "palpate/error.h"

namespace palpate::tasks {
namespace {

/// Outcome of a task. As bytes: + or -, then the text.
struct Outcome {
  bool failed = false;
  std::string text;  // the result, or the message of the exception
};

Outcome run_task(const Tasks& tasks, std::size_t task) {
  try {
    return {false, tasks.run(task)};
  } catch (const std::exception& error) {
    return {true, error.what()};
  }
}

std::string bytes_of(const Outcome& outcome) { return (outcome.failed ? '-' : '+') + outcome.text; }

Outcome outcome_of(const std::string& bytes) { return {bytes.front() == '-', bytes.substr(1)}; }

/// The remaining tasks, which are handed out one by one, and a thread on rank 0 that runs some of them while
/// rank 0 serves the other ranks.
class OwnWork final {
 public:
  OwnWork(const Tasks& tasks, const std::vector<std::size_t>& missing)
      : tasks_(tasks), missing_(missing), thread_([this] { run(); }) {}
  ~OwnWork() { thread_.join(); }
  OwnWork(const OwnWork&) = delete;
  OwnWork& operator=(const OwnWork&) = delete;

  /// Index into `missing` of the next task; the size of `missing` when all are handed out.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    return next_ < missing_.size() ? next_++ : next_;
  }

  /// Outcomes of this thread since the last call; waits for them for at most a millisecond.
  std::vector<std::pair<std::size_t, Outcome>> fetch() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(1), [this] { return !done_.empty(); });
    return std::exchange(done_, {});
  }

 private:
  void run() {
    for (std::size_t i = take(); i < missing_.size(); i = take()) {
      Outcome outcome = run_task(tasks_, missing_[i]);
      const std::lock_guard lock(mutex_);
      done_.emplace_back(i, std::move(outcome));
      changed_.notify_one();
    }
  }

  const Tasks& tasks_;
  const std::vector<std::size_t>& missing_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t next_ = 0;
  std::vector<std::pair<std::size_t, Outcome>> done_;
  std::thread thread_;  // last member: it uses all others
};

/// Hands out tasks on request. A message to rank 0 is the index of a task, a blank and its outcome, or is
/// empty at first; the answer is the next index.
template <typename Arrived>
void serve(Communicator& ranks, const Tasks& tasks, const std::vector<std::size_t>& missing,
           const Arrived& arrived) {
  OwnWork own(tasks, missing);
  std::size_t waiting = missing.size();
  int working = ranks.size() - 1;
  while (waiting > 0 || working > 0) {
    for (auto& [index, outcome] : own.fetch()) {
      arrived(index, std::move(outcome));
      --waiting;
    }
    while (const std::optional<Message> message = ranks.receive(false)) {
      const std::size_t next = own.take();  // answer first, so that the sender does not wait for file output
      ranks.send(message->from, std::to_string(next));
      if (next == missing.size()) --working;
      if (message->bytes.empty()) continue;
      const std::size_t space = message->bytes.find(' ');
      arrived(std::stoul(message->bytes), outcome_of(message->bytes.substr(space + 1)));
      --waiting;
    }
  }
}

void work_for_first(Communicator& ranks, const Tasks& tasks, const std::vector<std::size_t>& missing) {
  std::string answer;
  for (;;) {
    ranks.send(0, answer);
    const std::size_t index = std::stoul(ranks.receive(true)->bytes);
    if (index == missing.size()) return;
    answer = std::to_string(index) + ' ' + bytes_of(run_task(tasks, missing[index]));
  }
}

/// noexcept: if a rank threw here, the others would wait for ever; instead it terminates, and the launcher
/// ends all.
template <typename Arrived>
std::vector<Outcome> run_all(Communicator& ranks, const Tasks& tasks, const std::vector<std::size_t>& missing,
                             const Arrived& arrived) noexcept {
  std::vector<Outcome> outcomes(missing.size());
  if (missing.empty()) return outcomes;
  const auto take_in = [&](std::size_t index, Outcome outcome) {
    arrived(missing[index], outcome);
    outcomes[index] = std::move(outcome);
  };
  if (ranks.size() == 1) {
    std::mutex mutex;
    for_ranges(missing.size(), tasks.on_threads ? 1 : missing.size(),
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) {
                   Outcome outcome = run_task(tasks, missing[i]);
                   const std::lock_guard lock(mutex);
                   take_in(i, std::move(outcome));
                 }
               });
    return outcomes;
  }
  if (ranks.rank() == 0) {
    serve(ranks, tasks, missing, take_in);
  } else {
    work_for_first(ranks, tasks, missing);
  }
  for (Outcome& outcome : outcomes) outcome = outcome_of(ranks.broadcast(bytes_of(outcome)));
  return outcomes;
}

}  // namespace

TaskResults for_each_task(Communicator* ranks, const Tasks& tasks, Record* record) {
  Communicator alone;
  Communicator& all = ranks == nullptr ? alone : *ranks;
  TaskResults found;
  found.results.resize(tasks.count);
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < tasks.count; ++i) {
    const std::string* line = record == nullptr ? nullptr : record->find(tasks.key(i));
    if (line == nullptr) {
      missing.push_back(i);
      continue;
    }
    found.results[i] = *line;
    ++found.resumed;
    if (tasks.done && all.rank() == 0) tasks.done(i);
  }
  const auto arrived = [&](std::size_t task, const Outcome& outcome) {
    if (record != nullptr && !outcome.failed) record->add(outcome.text);
    if (tasks.done) tasks.done(task);
  };
  std::vector<Outcome> outcomes = run_all(all, tasks, missing, arrived);
  const std::string unkept = record == nullptr || record->failure().empty() ? "" : "; " + record->failure();
  for (std::size_t i = 0; i < missing.size(); ++i) {
    if (outcomes[i].failed) throw InputError(outcomes[i].text + unkept);
    found.results[missing[i]] = std::move(outcomes[i].text);
  }
  return found;
}

}  // namespace palpate::tasks
