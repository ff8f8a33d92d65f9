#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace palpate::tasks {

/// A message that has arrived.
struct Message {
  int from = 0;  // rank of the sender
  std::string bytes;
};

/// The processes that share a calculation, as MPI's communicator of all ranks. This class is one process
/// alone; the ranks of an `mpirun` derive from it. [setup], one thread.
class Ranks {
 public:
  Ranks() = default;
  virtual ~Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  /// This process, from 0; rank 0 reads, writes and prints.
  [[nodiscard]] virtual int rank() const { return 0; }
  [[nodiscard]] virtual int size() const { return 1; }
  /// Returns what rank 0 passed; every rank must call it.
  virtual std::string broadcast(std::string bytes) { return bytes; }
  /// Sends bytes to another rank.
  virtual void send(int /*to*/, const std::string& /*bytes*/) {}
  /// Takes the next message. @param wait until there is one; else none when none has arrived
  virtual std::optional<Message> receive(bool /*wait*/) { return std::nullopt; }
};

/// [setup] Calls `act` on rank 0 alone. Every rank makes the same call.
/// @throws InputError on every rank alike, with the message of what `act` threw
void on_first(Ranks& ranks, const std::function<void()>& act);

/// What a launcher such as mpirun tells this process in its environment.
struct Launch {
  int rank = 0;
  int size = 1;
};

/// [any]
[[nodiscard]] Launch launch_of_environment();

/// [setup] The ranks of this process: alone, or, when launched as one of several, by MPI, which is loaded
/// from palpate_mpi.so beside the program or in ../lib/palpate.
/// @throws InputError when launched as one of several and that library is missing or cannot start.
[[nodiscard]] std::unique_ptr<Ranks> make_ranks();

}  // namespace palpate::tasks
