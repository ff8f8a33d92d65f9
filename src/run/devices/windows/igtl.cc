// The device igtl, in a program without OpenIGTLink.
#include "run/devices/igtl.h"

namespace palpate::devices {

IgtlSource parse_igtl_source(const std::string& text) {
  return {net::parse_igtl_address(text, "device igtl:"), {}};  // refuses it
}

IgtlDevice::IgtlDevice(const std::string& source, const IgtlTimes& times, const OnWait& /*on_wait*/)
    : IgtlDevice(parse_igtl_source(source), times) {}

IgtlDevice::IgtlDevice(IgtlSource source, const IgtlTimes& times)
    : times_(times), source_(std::move(source)), listener_(-1), reader_({}) {}

IgtlDevice::~IgtlDevice() = default;

haptics::DeviceState IgtlDevice::read(std::uint64_t /*tick*/, double /*time*/) noexcept { return {}; }

bool IgtlDevice::write(const haptics::ForceCommand& /*command_D*/) noexcept { return false; }

void IgtlDevice::stop() noexcept {}

std::string IgtlDevice::last_error() const { return {}; }

std::string IgtlDevice::description() const { return {}; }

}  // namespace palpate::devices
