#pragma once
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace palpate::identify {

/// Those who share a calculation: this process alone, or all ranks of an `mpirun`. Every member makes the
/// same calls in the same order. Work comes as numbered items whose result depends on their number alone
/// (random numbers are a function of seed and number), so who computed what changes no bit. [setup], one
/// thread.
class Crew {
 public:
  /// Computes one item.
  using Work = std::function<std::string(std::size_t)>;
  /// Told on rank 0 of each result as it arrives, in any order.
  using Arrived = std::function<void(std::size_t, const std::string&)>;

  Crew() = default;
  virtual ~Crew() = default;
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  /// Which member this is, from 0; rank 0 reads, writes and prints.
  [[nodiscard]] virtual int rank() const = 0;
  [[nodiscard]] virtual int size() const = 0;

  /// Has items 0 .. count-1 computed, each by the next member that is free; returns all results in the order
  /// of their numbers, to every member. `work` must not throw but for faults that end the program.
  virtual std::vector<std::string> share_out(std::size_t count, const Work& work, const Arrived& arrived) = 0;

  /// Gives every member what rank 0 has.
  virtual std::string from_first(std::string bytes) = 0;
};

/// This process alone: the items one after the other.
class LocalCrew final : public Crew {
 public:
  [[nodiscard]] int rank() const override { return 0; }
  [[nodiscard]] int size() const override { return 1; }
  std::vector<std::string> share_out(std::size_t count, const Work& work, const Arrived& arrived) override;
  std::string from_first(std::string bytes) override { return bytes; }
};

/// What a launcher such as mpirun says of this process in its environment.
struct Launch {
  int rank = 0;
  int size = 1;
};

/// [any]
[[nodiscard]] Launch launch_of_environment();

/// [setup] The crew of this process: alone, or, when launched as one of several, by MPI, which is loaded from
/// palpate_mpi.so beside the program or in ../lib/palpate.
/// @throws InputError when launched as one of several and that library is missing or cannot start.
[[nodiscard]] std::unique_ptr<Crew> make_crew();

}  // namespace palpate::identify
