// The ranks of an mpirun as a Crew. A library of its own, loaded by make_crew(), so that the program needs no
// MPI where it runs alone.
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include <mpi.h>

#include "science/identify/crew.h"

namespace {

using palpate::identify::Crew;

constexpr int kAsk = 1;   // to rank 0: the item just done and its result, or kNone; wants the next one
constexpr int kGive = 2;  // from rank 0: an item, or kNone when all are given out
constexpr std::int64_t kNone = -1;
constexpr std::size_t kPiece = 1 << 30;  // bytes: MPI counts in int

std::string ask_message(std::int64_t item, const std::string& result) {
  std::string message(sizeof item, '\0');
  std::memcpy(message.data(), &item, sizeof item);
  return message + result;
}

void broadcast(std::string& bytes) {
  std::uint64_t size = bytes.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  bytes.resize(size);
  for (std::size_t from = 0; from < bytes.size(); from += kPiece) {
    const auto count = static_cast<int>(std::min(kPiece, bytes.size() - from));
    MPI_Bcast(bytes.data() + from, count, MPI_BYTE, 0, MPI_COMM_WORLD);
  }
}

/// Rank 0's own share of the work, in a thread of its own, so that rank 0 answers the others meanwhile.
class OwnWork final {
 public:
  OwnWork(std::size_t count, const Crew::Work& work) : count_(count), thread_([this, &work] { run(work); }) {}
  ~OwnWork() { thread_.join(); }
  OwnWork(const OwnWork&) = delete;
  OwnWork& operator=(const OwnWork&) = delete;

  /// The next item for whoever asks; kNone when there is none left.
  std::int64_t take() {
    const std::lock_guard lock(mutex_);
    return next_ < count_ ? static_cast<std::int64_t>(next_++) : kNone;
  }

  /// One of the results that were done here; false when there is none.
  bool fetch(std::pair<std::size_t, std::string>& result) {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
    if (done_.empty()) return false;
    result = std::move(done_.front());
    done_.pop_front();
    return true;
  }

  /// Waits for a result of this thread, for at most a millisecond: others may ask meanwhile.
  void wait() {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(1), [this] { return !done_.empty() || failure_; });
  }

 private:
  void run(const Crew::Work& work) {
    try {
      for (std::int64_t item = take(); item != kNone; item = take()) {
        std::string result = work(static_cast<std::size_t>(item));
        const std::lock_guard lock(mutex_);
        done_.emplace_back(static_cast<std::size_t>(item), std::move(result));
        changed_.notify_one();
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      failure_ = std::current_exception();
      next_ = count_;
      changed_.notify_one();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t count_;
  std::size_t next_ = 0;
  std::deque<std::pair<std::size_t, std::string>> done_;
  std::exception_ptr failure_;
  std::thread thread_;  // last, so that all else stands when it begins
};

class MpiCrew final : public Crew {
 public:
  MpiCrew() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }

  /// Every member ends in the same way, or mpirun ends all: a member that leaves by a fault of its own must
  /// not wait for the others here.
  ~MpiCrew() override {
    if (!busy_) MPI_Finalize();
  }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  std::vector<std::string> share_out(std::size_t count, const Work& work, const Arrived& arrived) override {
    busy_ = true;
    std::vector<std::string> results(count);
    if (rank_ == 0) {
      give_out(count, work, arrived, results);
    } else {
      do_share(work);
    }
    for (std::string& result : results) broadcast(result);
    busy_ = false;
    return results;
  }

  std::string from_first(std::string bytes) override {
    broadcast(bytes);
    return bytes;
  }

 private:
  void give_out(std::size_t count, const Work& work, const Arrived& arrived,
                std::vector<std::string>& results) const {
    OwnWork own(count, work);
    std::size_t missing = count;
    int working = size_ - 1;
    const auto take_in = [&](std::size_t item, std::string result) {
      if (arrived) arrived(item, result);
      results[item] = std::move(result);
      --missing;
    };
    while (missing > 0 || working > 0) {
      std::pair<std::size_t, std::string> mine;
      while (own.fetch(mine)) take_in(mine.first, std::move(mine.second));
      int asked = 0;
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, kAsk, MPI_COMM_WORLD, &asked, &status);
      if (asked == 0) {
        own.wait();
        continue;
      }
      int size = 0;
      MPI_Get_count(&status, MPI_BYTE, &size);
      std::string message(static_cast<std::size_t>(size), '\0');
      MPI_Recv(message.data(), size, MPI_BYTE, status.MPI_SOURCE, kAsk, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      const std::int64_t next =
          own.take();  // first, so that its sender need not wait for files to be written
      MPI_Send(&next, 1, MPI_INT64_T, status.MPI_SOURCE, kGive, MPI_COMM_WORLD);
      if (next == kNone) --working;
      std::int64_t item = kNone;
      std::memcpy(&item, message.data(), sizeof item);
      if (item != kNone) take_in(static_cast<std::size_t>(item), message.substr(sizeof item));
    }
  }

  static void do_share(const Work& work) {
    std::int64_t item = kNone;
    std::string result;
    for (;;) {
      const std::string message = ask_message(item, result);
      MPI_Send(message.data(), static_cast<int>(message.size()), MPI_BYTE, 0, kAsk, MPI_COMM_WORLD);
      MPI_Recv(&item, 1, MPI_INT64_T, 0, kGive, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      if (item == kNone) return;
      result = work(static_cast<std::size_t>(item));
    }
  }

  int rank_ = 0;
  int size_ = 1;
  bool busy_ = false;  // others may wait for this member
};

}  // namespace

/// [setup] The crew of all ranks, to be deleted by the caller. Once a process.
extern "C" palpate::identify::Crew* palpate_make_mpi_crew() { return new MpiCrew; }
