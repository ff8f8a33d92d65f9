#include "io/websocket/connection.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/http.hpp>

#include "io/system/clock.h"
#include "io/websocket/stream.h"

namespace palpate::websocket {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using HttpRequest = http::request<http::string_body>;

struct Connection::Socket {
  explicit Socket(tcp::socket socket) : stream(std::move(socket)) {}
  [[nodiscard]] tcp::socket& raw() noexcept { return beast::get_lowest_layer(stream).socket(); }
  [[nodiscard]] std::uint64_t& read_bytes() noexcept {
    return beast::get_lowest_layer(stream).rate_policy().bytes;
  }

  Stream stream;
  beast::flat_buffer incoming;
  std::optional<http::request_parser<http::string_body>> parser;
  std::optional<http::response<http::string_body>> response;
};

namespace {

Request request_of(const HttpRequest& from) {
  Request request{
      beast::websocket::is_upgrade(from), from.method() == http::verb::get, std::string(from.target()), {}};
  const auto [first, last] = from.equal_range(http::field::origin);
  for (auto field = first; field != last; ++field) request.origins.push_back(std::string(field->value()));
  return request;
}

}  // namespace

Connection::Connection(std::uint64_t number, tcp::socket socket, ConnectionHandler& handler,
                       std::size_t largest)
    : number_(number),
      handler_(handler),
      largest_(largest),
      socket_(std::make_unique<Socket>(std::move(socket))),
      alarm_(socket_->stream.get_executor()) {
  error_code ignored;
  tcp::socket& raw = socket_->raw();
  local_ = raw.local_endpoint(ignored);
  peer_ = raw.remote_endpoint(ignored).address();
  begun_ns_ = monotonic_ns();
  raw.set_option(tcp::no_delay(true), ignored);
  // A small send buffer limits the age of the states that a slow client receives, and the memory that the
  // system needs.
  raw.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
}

Connection::~Connection() = default;

void Connection::begin() {
  constexpr std::uint32_t kLongestHeader = 8192;  // bytes
  auto& parser = socket_->parser.emplace();
  parser.header_limit(kLongestHeader);
  parser.body_limit(0);
  beast::get_lowest_layer(socket_->stream).expires_after(kOpening);
  ++under_way_;
  http::async_read(socket_->stream.next_layer(), socket_->incoming, parser,
                   [this](const error_code& error, std::size_t) {
                     --under_way_;
                     on_request(error);
                   });
}

void Connection::on_request(const error_code& error) {
  if (ended_) return;
  if (error) return end();
  const HttpRequest request = socket_->parser->release();
  socket_->parser.reset();
  if (std::optional<Response> refusal = handler_.refusal(*this, request_of(request))) {
    return answer_http(std::move(*refusal));
  }
  Stream& channel = socket_->stream;
  beast::get_lowest_layer(channel).expires_never();  // the WebSocket's own time limits apply from here on
  channel.set_option(beast::websocket::stream_base::timeout{kOpening, kSilence, true});
  channel.read_message_max(largest_);
  channel.control_callback([this](beast::websocket::frame_type, beast::string_view payload) {
    constexpr std::size_t kHeader = 6;  // bytes before the payload of a control frame
    std::uint64_t& bytes = socket_->read_bytes();
    bytes -= std::min<std::uint64_t>(bytes, kHeader + payload.size());
    count_control();
  });
  ++under_way_;
  channel.async_accept(request, [this](const error_code& failure) {
    --under_way_;
    if (ended_) return;
    if (failure) return end();
    socket_->stream.text(true);
    open_ = true;
    socket_->read_bytes() = 0;
    handler_.opened(*this);
    read();
  });
}

void Connection::answer_http(Response response) {
  auto& answer = socket_->response.emplace(static_cast<http::status>(response.status), 11U);
  for (const auto& [name, value] : response.fields) answer.set(name, value);
  answer.body() = std::move(response.body);
  answer.keep_alive(false);
  answer.prepare_payload();
  ++under_way_;
  http::async_write(socket_->stream.next_layer(), answer, [this](const error_code& failure, std::size_t) {
    --under_way_;
    if (ended_) return;
    if (failure) return end();
    // The sending side is closed first. Closing with unread bytes sends a reset, and the client loses the
    // answer.
    error_code ignored;
    socket_->raw().shutdown(tcp::socket::shutdown_send, ignored);
    end();
  });
}

void Connection::read() {
  if (reading_ || ended_ || close_begun_ || waiting_.size() >= kReadOnBelow) return;
  reading_ = true;
  ++under_way_;
  socket_->stream.async_read(socket_->incoming, [this](const error_code& error, std::size_t) {
    --under_way_;
    reading_ = false;
    on_message(error);
  });
}

void Connection::on_message(const error_code& error) {
  if (ended_) return;
  if (error) {
    if (!close_begun_) end();  // otherwise async_close ends the connection
    return;
  }
  const bool excess = !limit_.allows(monotonic_ns());
  excess_ = excess ? excess_ + 1 : 0;
  const auto data = socket_->incoming.data();
  if (!closing_) {
    if (excess_ > kMaxExcess) {
      close(CloseCode::kPolicy, "too many messages");
    } else {
      handler_.received(*this, {static_cast<const char*>(data.data()), data.size()},
                        socket_->stream.got_text(), excess);
    }
  }
  socket_->incoming.consume(socket_->incoming.size());
  socket_->read_bytes() = 0;
  if (!closing_) read();
}

/// Counts a control frame towards the message limit. The answer to a ping costs the same as the answer to a
/// message.
void Connection::count_control() {
  if (limit_.allows(monotonic_ns()) || ++excess_ != kMaxExcess + 1) return;
  ++under_way_;
  asio::post(socket_->stream.get_executor(), [this] {  // the library calls this function during a read
    --under_way_;
    close(CloseCode::kPolicy, "too many messages");
  });
}

void Connection::send(std::string text) {
  if (!is_open()) return;
  if (waiting_.size() >= kMaxWaiting) return drop();
  waiting_.push_back(std::move(text));
  write();
}

void Connection::write() {
  if (writing_ || ended_ || close_begun_) return;
  if (!waiting_.empty()) {
    outgoing_ = std::move(waiting_.front());
    waiting_.pop_front();
  } else if (closing_) {
    close_begun_ = true;
    ++under_way_;
    const beast::websocket::close_reason reason(static_cast<beast::websocket::close_code>(closing_->first),
                                                closing_->second);
    socket_->stream.async_close(reason, [this](const error_code&) {
      --under_way_;
      if (!ended_) end();
    });
    return;
  } else if (frame_due_) {
    frame_due_ = false;
    outgoing_ = handler_.next_frame(*this);
    if (outgoing_.empty()) return;
  } else {
    return;
  }
  writing_ = true;
  ++under_way_;
  socket_->stream.async_write(asio::buffer(outgoing_), [this](const error_code& error, std::size_t) {
    --under_way_;
    writing_ = false;
    if (ended_) return;
    if (error) return end();
    write();
    if (!closing_) read();
  });
}

void Connection::close(CloseCode code, const std::string& why) {
  if (closing_ || ended_) return;
  closing_.emplace(code, why);
  closing_ns_ = monotonic_ns();
  stream(0.0);
  write();
}

bool Connection::is_endless() const noexcept {
  return open_ && socket_->read_bytes() > kMaxOverhead * largest_;
}

void Connection::drop() noexcept {
  if (!ended_) end();
}

void Connection::end() noexcept {
  ended_ = true;
  error_code ignored;
  alarm_.cancel(ignored);
  socket_->raw().close(ignored);
  beast::get_lowest_layer(socket_->stream).cancel();
  handler_.ended(*this);
}

void Connection::stream(double rate_Hz) {
  ++streams_;
  error_code ignored;
  alarm_.cancel(ignored);
  frame_due_ = false;
  period_ = std::chrono::nanoseconds(rate_Hz > 0.0 ? static_cast<std::int64_t>(1e9 / rate_Hz) : 0);
  due_ = std::chrono::steady_clock::now();
  if (period_.count() > 0) wait_for_frame();
}

void Connection::wait_for_frame() {
  alarm_.expires_at(due_);
  ++under_way_;
  alarm_.async_wait([this, stream = streams_](const error_code& error) {
    --under_way_;
    if (!error && !ended_ && stream == streams_) on_frame_due();
  });
}

/// Sends the frame that is due. Frames are due at equal intervals, whatever the client does. Frames that
/// became due while this thread slept count as left out.
void Connection::on_frame_due() {
  const auto late = std::chrono::steady_clock::now() - due_;
  const auto skipped = late / period_;
  due_ += (skipped + 1) * period_;
  left_out_ += static_cast<std::uint64_t>(skipped);
  if (frame_due_) ++left_out_;
  frame_due_ = true;
  write();
  wait_for_frame();
}

}  // namespace palpate::websocket
