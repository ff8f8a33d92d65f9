#pragma once
#include <memory>
#include <optional>
#include <string>

#include "net/igtl_server.h"

namespace palpate::app {

/// What --igtl says of itself.
inline constexpr const char* kIgtlHelp =
    "[ADDRESS:]PORT: show the run to 3D Slicer and other OpenIGTLink clients, of this machine alone "
    "unless ADDRESS is 0.0.0.0 or another of its own";

/// What --igtl asks for: a server that shows runs to OpenIGTLink clients, or none. [setup]
class IgtlService final {
 public:
  /// Listens from here on. @param where what stands behind --igtl; none: no server
  /// @throws InputError naming --igtl when it is no port, or cannot be listened at.
  explicit IgtlService(const std::optional<std::string>& where);

  /// Null: there is none.
  [[nodiscard]] net::IgtlServer* server() noexcept { return server_.get(); }
  /// Tells people where it is, and who can reach it.
  void report_where() const;
  /// After the last run: ends the server and tells how it went. @return that; nothing without a server
  std::optional<net::IgtlStatistics> finish();

 private:
  net::IgtlAddress address_;
  std::unique_ptr<net::IgtlServer> server_;
};

}  // namespace palpate::app
