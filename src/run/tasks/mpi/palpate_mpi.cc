// The ranks of an mpirun. A separate library, loaded by make_communicator(), so that a single process needs
// no MPI.
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <mpi.h>

#include "run/tasks/communicator.h"

namespace {

using palpate::tasks::Message;

class MpiCommunicator final : public palpate::tasks::Communicator {
 public:
  MpiCommunicator() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~MpiCommunicator() override { MPI_Finalize(); }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }

  std::string broadcast(std::string bytes) override {
    constexpr std::size_t kPiece = 1 << 30;  // bytes: MPI counts are of type int
    std::uint64_t size = bytes.size();
    MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    bytes.resize(size);
    for (std::size_t from = 0; from < bytes.size(); from += kPiece) {
      const auto count = static_cast<int>(std::min(kPiece, bytes.size() - from));
      MPI_Bcast(bytes.data() + from, count, MPI_BYTE, 0, MPI_COMM_WORLD);
    }
    return bytes;
  }

  void send(int to, const std::string& bytes) override {
    MPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, 0, MPI_COMM_WORLD);
  }

  std::optional<Message> receive(bool wait) override {
    int arrived = 1;
    MPI_Status status;
    if (wait) {
      MPI_Probe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &status);
    } else {
      MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &arrived, &status);
    }
    if (arrived == 0) return std::nullopt;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Message message{status.MPI_SOURCE, std::string(static_cast<std::size_t>(size), '\0')};
    MPI_Recv(message.bytes.data(), size, MPI_BYTE, message.from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return message;
  }

 private:
  int rank_ = 0;
  int size_ = 1;
};

}  // namespace

/// [setup] Communicator of all ranks, to be deleted by the caller. Once per process.
extern "C" palpate::tasks::Communicator* palpate_make_mpi_ranks() { return new MpiCommunicator; }
