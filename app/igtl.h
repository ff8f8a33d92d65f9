#pragma once
#include <memory>
#include <optional>
#include <string>

#include "net/igtl_server.h"

namespace palpate::app {

/// Help text of --igtl.
inline constexpr const char* kIgtlHelp =
    "[ADDRESS:]PORT: show the run to 3D Slicer and other OpenIGTLink clients, on this machine only unless "
    "ADDRESS is 0.0.0.0 or an address of this machine in a network";

/// The server that --igtl asks for. It sends the state of each run to OpenIGTLink clients such as 3D Slicer.
/// Without --igtl there is no server. All members: [setup].
class IgtlService final {
 public:
  /// Starts to listen. @param where value of --igtl, [ADDRESS:]PORT; nullopt: no server
  /// @throws InputError naming --igtl when the value is invalid or the server cannot listen at it.
  explicit IgtlService(const std::optional<std::string>& where);

  /// Null without --igtl.
  [[nodiscard]] net::IgtlServer* server() noexcept { return server_.get(); }
  /// Reports the server's address, and whether other machines can reach it, on standard error.
  void report_where() const;
  /// Call it after the last run. Ends the server and reports its statistics. @return the statistics; nullopt
  /// without a server
  std::optional<net::IgtlStatistics> finish();

 private:
  net::IgtlAddress address_;
  std::unique_ptr<net::IgtlServer> server_;
};

}  // namespace palpate::app
