#include "run/tasks/communicator.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <utility>

#include <fmt/core.h>

#include "io/system/plugin.h"
#include "io/system/shared_library.h"
#include "palpate/error.h"

namespace palpate::tasks {
namespace {

constexpr const char* kLibrary = "palpate_mpi.so";

int number_in(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  if (text == nullptr) return otherwise;
  char* end = nullptr;
  const long value = std::strtol(text, &end, 10);
  const bool whole = end != text && *end == '\0' && value >= 0 && value < 1'000'000;
  return whole ? static_cast<int>(value) : otherwise;
}

[[noreturn]] void fail(const Launch& launch, const std::string& why) {
  throw InputError(
      fmt::format("mpirun started {} of this program, but {}; install palpate-mpi, build it with "
                  "libopenmpi-dev installed, or start one without mpirun",
                  launch.size, why));
}

}  // namespace

void on_rank_zero(Communicator& ranks, const std::function<void()>& act) {
  std::string error;
  try {
    if (ranks.rank() == 0) act();
  } catch (const std::exception& thrown) {
    error = thrown.what();
  }
  error = ranks.broadcast(std::move(error));
  if (!error.empty()) throw InputError(error);
}

Launch launch_of_environment() {
  struct Launcher {
    const char* size;
    const char* rank;
  };
  // Open MPI's mpirun; MPICH's and others that use PMI
  constexpr std::array<Launcher, 2> kLaunchers = {
      {{"OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"}, {"PMI_SIZE", "PMI_RANK"}}};
  for (const Launcher& launcher : kLaunchers) {
    const int size = number_in(launcher.size, 0);
    if (size > 0) return {std::min(number_in(launcher.rank, 0), size - 1), size};
  }
  return {};
}

std::unique_ptr<Communicator> make_communicator() {
  const Launch launch = launch_of_environment();
  if (launch.size == 1) return std::make_unique<Communicator>();
  for (const std::filesystem::path& file : find_plugin(kLibrary)) {
    const SharedLibrary library =
        open_library(file, Loading::kShared);  // plug-ins of Open MPI need its symbols
    if (library.handle == nullptr) fail(launch, file.string() + " cannot be loaded: " + library.error);
    using Make = Communicator* (*)();
    const auto make = reinterpret_cast<Make>(find_function(library.handle, "palpate_make_mpi_ranks"));
    if (make == nullptr) fail(launch, file.string() + " is not of this program");
    std::unique_ptr<Communicator> ranks(make());
    if (ranks->size() != launch.size) {
      fail(launch, fmt::format("{} sees {}: it is of another MPI than mpirun", file.string(), ranks->size()));
    }
    return ranks;
  }
  fail(launch, std::string(kLibrary) + " is not beside it");
}

}  // namespace palpate::tasks
