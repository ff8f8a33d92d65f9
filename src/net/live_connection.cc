#include "net/live_connection.h"

#include <algorithm>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>

#include "io/system/clock.h"
#include "net/live_protocol.h"

namespace palpate::net {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;

LiveConnection::LiveConnection(std::uint64_t number, tcp::socket socket, ConnectionHandler& handler)
    : number_(number), handler_(handler), socket_(std::move(socket)), alarm_(socket_.get_executor()) {
  error_code ignored;
  tcp::socket& raw = beast::get_lowest_layer(socket_).socket();
  local_ = raw.local_endpoint(ignored);
  peer_ = raw.remote_endpoint(ignored).address();
  begun_ns_ = monotonic_ns();
  raw.set_option(tcp::no_delay(true), ignored);
  // A small send buffer limits the age of the states that a slow client receives, and the memory that the
  // system needs.
  raw.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
}

void LiveConnection::begin() {
  constexpr std::uint32_t kLongestHeader = 8192;  // bytes
  parser_.emplace();
  parser_->header_limit(kLongestHeader);
  parser_->body_limit(0);
  beast::get_lowest_layer(socket_).expires_after(kOpening);
  ++under_way_;
  http::async_read(socket_.next_layer(), incoming_, *parser_, [this](const error_code& error, std::size_t) {
    --under_way_;
    on_request(error);
  });
}

void LiveConnection::on_request(const error_code& error) {
  if (ended_) return;
  if (error) return end();
  const HttpRequest request = parser_->release();
  parser_.reset();
  if (std::optional<HttpResponse> refusal = handler_.refusal(*this, request)) {
    return answer_http(std::move(*refusal));
  }
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket's own time limits apply from here on
  socket_.set_option(websocket::stream_base::timeout{kOpening, kSilence, true});
  socket_.read_message_max(kLargestRequest);
  socket_.control_callback([this](websocket::frame_type, beast::string_view payload) {
    constexpr std::size_t kHeader = 6;  // bytes before the payload of a control frame
    read_bytes() -= std::min<std::uint64_t>(read_bytes(), kHeader + payload.size());
    count_control();
  });
  ++under_way_;
  socket_.async_accept(request, [this](const error_code& failure) {
    --under_way_;
    if (ended_) return;
    if (failure) return end();
    socket_.text(true);
    open_ = true;
    read_bytes() = 0;
    handler_.opened(*this);
    read();
  });
}

void LiveConnection::answer_http(HttpResponse response) {
  response_ = std::move(response);
  response_->keep_alive(false);
  response_->prepare_payload();
  ++under_way_;
  http::async_write(socket_.next_layer(), *response_, [this](const error_code& failure, std::size_t) {
    --under_way_;
    if (ended_) return;
    if (failure) return end();
    // The sending side is closed first. Closing with unread bytes sends a reset, and the client loses the
    // answer.
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().shutdown(tcp::socket::shutdown_send, ignored);
    end();
  });
}

void LiveConnection::read() {
  if (reading_ || ended_ || close_begun_ || waiting_.size() >= kReadOnBelow) return;
  reading_ = true;
  ++under_way_;
  socket_.async_read(incoming_, [this](const error_code& error, std::size_t) {
    --under_way_;
    reading_ = false;
    on_message(error);
  });
}

void LiveConnection::on_message(const error_code& error) {
  if (ended_) return;
  if (error) {
    if (!close_begun_) end();  // otherwise async_close ends the connection
    return;
  }
  const bool excess = !limit_.allows(monotonic_ns());
  excess_ = excess ? excess_ + 1 : 0;
  const auto data = incoming_.data();
  if (!closing_) {
    if (excess_ > kMaxExcess) {
      close(websocket::close_code::policy_error, "too many messages");
    } else {
      handler_.received(*this, {static_cast<const char*>(data.data()), data.size()}, socket_.got_text(),
                        excess);
    }
  }
  incoming_.consume(incoming_.size());
  read_bytes() = 0;
  if (!closing_) read();
}

/// Counts a control frame towards the message limit. The answer to a ping costs the same as the answer to a
/// message.
void LiveConnection::count_control() {
  if (limit_.allows(monotonic_ns()) || ++excess_ != kMaxExcess + 1) return;
  ++under_way_;
  asio::post(socket_.get_executor(), [this] {  // the library calls this function during a read
    --under_way_;
    close(websocket::close_code::policy_error, "too many messages");
  });
}

void LiveConnection::send(std::string text) {
  if (!is_open()) return;
  if (waiting_.size() >= kMaxWaiting) return drop();
  waiting_.push_back(std::move(text));
  write();
}

void LiveConnection::write() {
  if (writing_ || ended_ || close_begun_) return;
  if (!waiting_.empty()) {
    outgoing_ = std::move(waiting_.front());
    waiting_.pop_front();
  } else if (closing_) {
    close_begun_ = true;
    ++under_way_;
    socket_.async_close(*closing_, [this](const error_code&) {
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
  socket_.async_write(asio::buffer(outgoing_), [this](const error_code& error, std::size_t) {
    --under_way_;
    writing_ = false;
    if (ended_) return;
    if (error) return end();
    write();
    if (!closing_) read();
  });
}

void LiveConnection::close(websocket::close_code code, const std::string& why) {
  if (closing_ || ended_) return;
  closing_.emplace(code, why);
  closing_ns_ = monotonic_ns();
  stream(0.0);
  write();
}

void LiveConnection::drop() noexcept {
  if (!ended_) end();
}

void LiveConnection::end() noexcept {
  ended_ = true;
  error_code ignored;
  alarm_.cancel(ignored);
  beast::get_lowest_layer(socket_).socket().close(ignored);
  beast::get_lowest_layer(socket_).cancel();
  handler_.ended(*this);
}

void LiveConnection::stream(double rate_Hz) {
  ++streams_;
  error_code ignored;
  alarm_.cancel(ignored);
  frame_due_ = false;
  period_ = std::chrono::nanoseconds(rate_Hz > 0.0 ? static_cast<std::int64_t>(1e9 / rate_Hz) : 0);
  due_ = std::chrono::steady_clock::now();
  if (period_.count() > 0) wait_for_frame();
}

void LiveConnection::wait_for_frame() {
  alarm_.expires_at(due_);
  ++under_way_;
  alarm_.async_wait([this, stream = streams_](const error_code& error) {
    --under_way_;
    if (!error && !ended_ && stream == streams_) on_frame_due();
  });
}

/// Sends the frame that is due. Frames are due at equal intervals, whatever the client does. Frames that
/// became due while this thread slept count as left out.
void LiveConnection::on_frame_due() {
  const auto late = std::chrono::steady_clock::now() - due_;
  const auto skipped = late / period_;
  due_ += (skipped + 1) * period_;
  left_out_ += static_cast<std::uint64_t>(skipped);
  if (frame_due_) ++left_out_;
  frame_due_ = true;
  write();
  wait_for_frame();
}

}  // namespace palpate::net
