#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/base/parallel.h"
#include "io/system/test/temporary_folder.h"
#include "palpate/error.h"
#include "run/tasks/communicator.h"
#include "run/tasks/for_each_task.h"
#include "run/tasks/record.h"

namespace palpate::tasks {
namespace {

using testing::ElementsAre;

/// Ranks as threads of this process, each with a queue of messages.
class Mailboxes final {
 public:
  explicit Mailboxes(int ranks) : boxes_(static_cast<std::size_t>(ranks)), broadcasts_(boxes_.size()) {}

  [[nodiscard]] int size() const { return static_cast<int>(boxes_.size()); }
  void put(int to, Message message, bool broadcast = false) {
    const std::lock_guard lock(mutex_);
    (broadcast ? broadcasts_ : boxes_)[static_cast<std::size_t>(to)].push_back(std::move(message));
    changed_.notify_all();
  }
  std::optional<Message> take(int rank, bool wait, bool broadcast = false) {
    std::unique_lock lock(mutex_);
    std::deque<Message>& box = (broadcast ? broadcasts_ : boxes_)[static_cast<std::size_t>(rank)];
    if (wait) changed_.wait(lock, [&box] { return !box.empty(); });
    if (box.empty()) return std::nullopt;
    Message message = std::move(box.front());
    box.pop_front();
    return message;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::deque<Message>> boxes_;
  std::vector<std::deque<Message>> broadcasts_;
};

class ThreadRank final : public Communicator {
 public:
  ThreadRank(Mailboxes& boxes, int rank) : boxes_(boxes), rank_(rank) {}
  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return boxes_.size(); }
  std::string broadcast(std::string bytes) override {
    if (rank_ != 0) return boxes_.take(rank_, true, true)->bytes;
    for (int to = 1; to < size(); ++to) boxes_.put(to, {0, bytes}, true);
    return bytes;
  }
  void send(int to, const std::string& bytes) override { boxes_.put(to, {rank_, bytes}); }
  std::optional<Message> receive(bool wait) override { return boxes_.take(rank_, wait); }

 private:
  Mailboxes& boxes_;
  int rank_;
};

/// Results of a collective call on all ranks.
template <typename Call>
std::vector<std::string> on_ranks(int count, const Call& call) {
  Mailboxes boxes(count);
  std::vector<std::string> returned(static_cast<std::size_t>(count));
  std::vector<std::thread> threads;
  for (int rank = 0; rank < count; ++rank) {
    threads.emplace_back([&, rank] {
      ThreadRank ranks(boxes, rank);
      returned[static_cast<std::size_t>(rank)] = call(ranks);
    });
  }
  for (std::thread& thread : threads) thread.join();
  return returned;
}

std::string joined(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + ' ';
  return all;
}

std::string line_of(std::size_t task) {
  return R"({"key":"k)" + std::to_string(task) + R"(","square":)" + std::to_string(task * task) + "}";
}

Tasks recorded_squares(std::size_t count, std::atomic<int>& runs) {
  return {count,
          [&runs](std::size_t i) {
            ++runs;
            return line_of(i);
          },
          [](std::size_t i) { return "k" + std::to_string(i); },
          {}};
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(ForEachTask, ReturnsTheResultsInTheOrderOfTheTasks) {
  const auto square = [](std::size_t i) { return std::to_string(i * i); };
  EXPECT_THAT(for_each_task(nullptr, {4, square}).results, ElementsAre("0", "1", "4", "9"));
  EXPECT_TRUE(for_each_task(nullptr, {0, square}).results.empty());
}

TEST(ForEachTask, GivesEveryRankTheSameOnAnyNumberOfRanks) {
  for (const int count : {1, 2, 3, 9}) {
    const auto each = on_ranks(count, [](Communicator& ranks) {
      const auto cube = [](std::size_t i) { return std::to_string(i * i * i); };
      std::string all;
      for (const std::size_t tasks : {0U, 1U, 5U, 0U, 5U}) {
        all += joined(for_each_task(&ranks, {tasks, cube}).results) + '|';
      }
      return all;
    });
    EXPECT_THAT(each, testing::Each(testing::StrEq("|0 |0 1 8 27 64 ||0 1 8 27 64 |"))) << count;
  }
}

TEST(ForEachTask, OnThreadsKeepsTheOrderAndReportsOneTaskAtATime) {
  std::set<std::size_t> reported;  // without a lock
  bool inside = false;
  Tasks tasks{200, [](std::size_t i) { return std::to_string(i * i); }, {}, {}, true};
  tasks.done = [&](std::size_t i) {
    EXPECT_FALSE(std::exchange(inside, true));
    EXPECT_TRUE(reported.insert(i).second);
    inside = false;
  };
  const std::vector<std::string> results = for_each_task(nullptr, tasks).results;
  ASSERT_EQ(results.size(), 200U);
  for (std::size_t i = 0; i < 200; ++i) EXPECT_EQ(results[i], std::to_string(i * i));
  EXPECT_EQ(reported.size(), 200U);
}

TEST(ForEachTask, UsesAsManyThreadsAsAllowed) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  const auto run = [&](std::size_t) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
    return std::string();
  };
  for_each_task(nullptr, {100, run, {}, {}, false});
  EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
  {
    const ThreadLimit one(1);
    for_each_task(nullptr, {100, run, {}, {}, true});
    EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
  }
  for_ranges(100, 1, [&](std::size_t begin, std::size_t) { (void)run(begin); });
  const bool several = threads.size() > 1;  // not on one processor, nor in a build without threads
  threads.clear();
  for_each_task(nullptr, {100, run, {}, {}, true});
  EXPECT_EQ(threads.size() > 1, several);
}

TEST(ForEachTask, ReportsEachTaskToTheFirstRankOnce) {
  std::vector<std::size_t> done;
  (void)on_ranks(3, [&done](Communicator& ranks) {
    Tasks tasks{7, [](std::size_t) { return std::string("x"); }};
    tasks.done = [&](std::size_t i) {
      EXPECT_EQ(ranks.rank(), 0);
      done.push_back(i);
    };
    (void)for_each_task(&ranks, tasks);
    return std::string();
  });
  EXPECT_THAT(done, testing::UnorderedElementsAre(0, 1, 2, 3, 4, 5, 6));
}

TEST(ForEachTask, ThrowsTheFirstTasksErrorOnEveryRankWhenAllAreDone) {
  std::atomic<int> runs{0};
  const auto each = on_ranks(3, [&runs](Communicator& ranks) -> std::string {
    const auto run = [&runs](std::size_t i) -> std::string {
      ++runs;
      if (i == 2 || i == 5) throw std::runtime_error("task " + std::to_string(i) + " cannot be done");
      return "";
    };
    try {
      (void)for_each_task(&ranks, {8, run});
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  });
  EXPECT_THAT(each, testing::Each(testing::StrEq("task 2 cannot be done")));
  EXPECT_EQ(runs, 8);
}

TEST(Record, ABrokenOffCalculationGoesOnFromItOnAnyNumberOfRanks) {
  for (const int count : {1, 3}) {
    const test::TemporaryFolder folder;
    const std::string file = (folder.path() / "record.jsonl").string();
    std::ofstream(file) << line_of(1) << '\n' << line_of(3) << '\n' << line_of(0).substr(0, 9);
    std::atomic<int> runs{0};
    const auto each = on_ranks(count, [&](Communicator& ranks) {
      Record record(file, ranks, [](const std::string&) {});
      const TaskResults found = for_each_task(&ranks, recorded_squares(5, runs), &record);
      return joined(found.results) + std::to_string(found.resumed);
    });
    const std::string all =
        line_of(0) + ' ' + line_of(1) + ' ' + line_of(2) + ' ' + line_of(3) + ' ' + line_of(4) + " 2";
    EXPECT_THAT(each, testing::Each(testing::StrEq(all)));
    EXPECT_EQ(runs, 3);
    const auto lines = read_record(file, [](const std::string&) {});
    EXPECT_EQ(lines.size(), 5U);  // includes lines added after the truncated one
  }
}

TEST(Record, DoesNotKeepATaskThatFailed) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "record.jsonl").string();
  Communicator alone;
  Record record(file, alone, [](const std::string&) {});
  Tasks tasks{2, [](std::size_t i) { return i == 0 ? throw InputError("no") : line_of(i); },
              [](std::size_t i) { return "k" + std::to_string(i); }};
  EXPECT_THROW((void)for_each_task(&alone, tasks, &record), InputError);
  EXPECT_EQ(text_of(file), "\n" + line_of(1) + "\n");
}

TEST(Record, ALineThatIsNotAResultIsNotTaken) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "record.jsonl").string();
  std::ofstream(file) << line_of(0) << "\n[1]\n{\"key\":7}\n{\"square\":4}\n" << line_of(2) << '\n';
  const auto refuse_two = [](const std::string& line) {
    if (line == line_of(2)) throw InputError("not a result");
  };
  EXPECT_THAT(read_record(file, refuse_two), ElementsAre(testing::Pair("k0", line_of(0))));
  EXPECT_TRUE(read_record(file + ".missing", refuse_two).empty());
}

TEST(Record, AFileThatCannotBeWrittenIsReportedOnEveryRank) {
  const auto each = on_ranks(2, [](Communicator& ranks) -> std::string {
    try {
      const Record record("/nowhere/record.jsonl", ranks, [](const std::string&) {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  });
  EXPECT_THAT(each, testing::Each(testing::StrEq("/nowhere/record.jsonl: cannot be written")));
}

/// Limits the size of all files of this process during its lifetime.
class SmallFiles final {
 public:
  explicit SmallFiles(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~SmallFiles() { setrlimit(RLIMIT_FSIZE, &before_); }
  SmallFiles(const SmallFiles&) = delete;
  SmallFiles& operator=(const SmallFiles&) = delete;

 private:
  rlimit before_{};
};

TEST(Record, ALineThatCannotBeAppendedIsRemembered) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "record.jsonl").string();
  Communicator alone;
  Record record(file, alone, [](const std::string&) {});
  record.add(line_of(0));
  EXPECT_EQ(record.failure(), "");
  const SmallFiles full(8);
  record.add(line_of(1));
  EXPECT_EQ(record.failure(),
            file + ": cannot be written any more: File too large; what was finished since is not in it");
  const Tasks tasks{1, [](std::size_t) -> std::string { throw InputError("no"); },
                    [](std::size_t) { return std::string("other"); }};
  EXPECT_THAT([&] { (void)for_each_task(&alone, tasks, &record); },
              testing::ThrowsMessage<InputError>("no; " + record.failure()));
}

TEST(Communicator, WhatTheFirstThrowsIsThrownOnEveryRank) {
  const auto each = on_ranks(3, [](Communicator& ranks) -> std::string {
    try {
      on_rank_zero(ranks, [&ranks] { throw std::runtime_error("rank " + std::to_string(ranks.rank())); });
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  });
  EXPECT_THAT(each, testing::Each(testing::StrEq("rank 0")));
}

TEST(Communicator, ReadsTheLaunchersEnvironment) {
  EXPECT_EQ(launch_of_environment().size, 1);
  setenv("PMI_SIZE", "4", 1);
  setenv("PMI_RANK", "2", 1);
  EXPECT_EQ(launch_of_environment().size, 4);
  EXPECT_EQ(launch_of_environment().rank, 2);
  EXPECT_THROW((void)make_communicator(), InputError);  // palpate_mpi.so is not beside the tests
  setenv("PMI_SIZE", "many", 1);
  EXPECT_EQ(launch_of_environment().size, 1);
  unsetenv("PMI_SIZE");
  unsetenv("PMI_RANK");
}

}  // namespace
}  // namespace palpate::tasks
