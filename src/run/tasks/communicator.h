#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace palpate::tasks {

/// A received message.
struct Message {
  int from = 0;  // rank of the sender
  std::string bytes;
};

/// Communicator: the processes that share a calculation, as all ranks in MPI. This class is a single process;
/// the ranks of an `mpirun` derive from it. [setup], one thread.
class Communicator {
 public:
  Communicator() = default;
  virtual ~Communicator() = default;
  Communicator(const Communicator&) = delete;
  Communicator& operator=(const Communicator&) = delete;

  /// Number of this process, from 0; rank 0 reads, writes and prints.
  [[nodiscard]] virtual int rank() const { return 0; }
  [[nodiscard]] virtual int size() const { return 1; }
  /// Returns the argument of rank 0 on all ranks; all must call it.
  virtual std::string broadcast(std::string bytes) { return bytes; }
  /// Sends bytes to another rank.
  virtual void send(int /*to*/, const std::string& /*bytes*/) {}
  /// Receives the next message. @param wait false: returns nothing when no message has arrived
  virtual std::optional<Message> receive(bool /*wait*/) { return std::nullopt; }
};

/// [setup] Calls `act` on rank 0 only. All ranks must make this call. @throws InputError on all ranks, with
/// the message of the exception of `act`
void on_rank_zero(Communicator& ranks, const std::function<void()>& act);

/// Rank and number of processes of a launcher such as mpirun.
struct Launch {
  int rank = 0;
  int size = 1;
};

/// [any] Read from the environment of this process.
[[nodiscard]] Launch launch_of_environment();

/// [setup] The communicator of this process: a single process or, when launched as one of several, MPI,
/// loaded from palpate_mpi.so beside the program or in ../lib/palpate. @throws InputError when launched as
/// one of several and that library is missing or fails to start.
[[nodiscard]] std::unique_ptr<Communicator> make_communicator();

}  // namespace palpate::tasks
