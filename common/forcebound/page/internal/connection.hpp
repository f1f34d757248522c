#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "forcebound/page/internal/owner.hpp"

namespace forcebound::page::internal {

/// One request over HTTP and its answer, or its upgrade to a viewer's WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(asio::ip::tcp::socket socket, Owner& owner)
      : owner_(owner), stream_(std::move(socket)), received_(2 * owner.settings().limits.header_bytes) {
    parser_.header_limit(static_cast<std::uint32_t>(owner.settings().limits.header_bytes));
    parser_.body_limit(std::uint64_t{0});
  }
  ~Connection() { owner_.connection_ended(*this); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void start() {
    stream_.expires_after(owner_.settings().limits.request);
    http::async_read(stream_, received_, parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) { self->received(error); });
  }

  /// Ends it for want of room. @param why the answer, if none has begun
  void turn_away(std::string_view why) noexcept {
    beast::error_code ignored;
    if (!response_) {
      stream_.socket().non_blocking(true, ignored);
      stream_.socket().send(asio::buffer(why.data(), why.size()), 0, ignored);
      stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
    }
    stream_.close();
  }

 private:
  using Response = http::response<http::string_body>;

  void received(beast::error_code error) {
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      return refuse(http::status::request_header_fields_too_large, "the headers are longer than 8 KiB");
    }
    if (error == http::error::body_limit || error == http::error::unexpected_body) {
      return refuse(http::status::payload_too_large, "a request has no body here");
    }
    if (error && error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message) {
      return refuse(http::status::bad_request, "no HTTP request");
    }
    if (error) return;  // it went away, or took too long
    answer(parser_.get());
  }

  void answer(const Request& request) {
    const std::string_view host = value(request, http::field::host);
    if (!owner_.hosts().accepts(host)) {
      return refuse(http::status::forbidden, "this page is not at the host that was asked for");
    }
    const std::string_view target(request.target().data(), request.target().size());
    const bool has_token = shows_token(request, target);
    const std::string_view origin = value(request, http::field::origin);
    // Viewers that speak the subprotocol are pages from elsewhere. The token lets them in, which no browser adds
    // itself.
    const bool from_elsewhere = has_token && speaks_subprotocol(request);
    if (!origin.empty() && !from_elsewhere && !owner_.hosts().accepts_origin(origin)) {
      return refuse(http::status::forbidden, "pages of another origin have no access");
    }
    if (request.method() != http::verb::get) return refuse(http::status::method_not_allowed, "GET is accepted alone");
    const std::string_view path = path_of(target);
    if (has_token) owner_.let_in(*this);
    if (!has_token && (path == "/" || path == "/live" || path == "/metrics")) return refuse_without_token();
    if (path == "/live" || (path == "/" && is_upgrade(request))) return answer_live(request);
    if (path == "/metrics") return send(http::status::ok, "text/plain; version=0.0.4; charset=utf-8", owner_.metrics());
    const std::string_view name = path == "/" ? "index.html" : path.substr(path.starts_with('/') ? 1 : 0);
    const Assets& assets = owner_.settings().assets;
    const auto found = assets.find(name);
    if (found == assets.end()) return refuse(http::status::not_found, "there is no such file of the page");
    send(http::status::ok, found->second.type, found->second.content);
  }

  void answer_live(const Request& request) {
    constexpr unsigned kChunks = 11;  // since HTTP/1.1
    const bool by_socket = is_upgrade(request);
    if (!by_socket && request.version() < kChunks) {
      return refuse(http::status::http_version_not_supported, "lines are sent by HTTP/1.1");
    }
    const bool has_subprotocol = speaks_subprotocol(request);
    if (by_socket && !has_subprotocol && !value(request, http::field::sec_websocket_protocol).empty()) {
      const std::string& known = owner_.subprotocol();
      return refuse(http::status::bad_request,
                    "unknown WebSocket subprotocol; accepted is " + (known.empty() ? "none" : known + ", or none"));
    }
    if (!owner_.has_room_for_viewer()) return refuse(http::status::too_many_requests, "too many viewers already");
    owner_.answered(false);
    owner_.admit(std::move(stream_), request, by_socket ? Way::socket : Way::lines,
                 has_subprotocol ? Audience::subprotocol : Audience::page);
  }

  static bool is_upgrade(const Request& request) { return beast::websocket::is_upgrade(request); }

  [[nodiscard]] bool speaks_subprotocol(const Request& request) const {
    if (owner_.subprotocol().empty() || !is_upgrade(request)) return false;
    return http::token_list(request[http::field::sec_websocket_protocol]).exists(owner_.subprotocol());
  }

  [[nodiscard]] bool shows_token(const Request& request, std::string_view target) const {
    const std::string& token = owner_.settings().token;
    return equal_in_constant_time(query_value(target, "token"), token) ||
           equal_in_constant_time(bearer_token(value(request, http::field::authorization)), token);
  }

  void refuse_without_token() {
    refuse(http::status::unauthorized, "the token is missing or wrong: open the address that the program printed");
  }

  static std::string_view value(const Request& request, http::field field) {
    const auto text = request[field];
    return {text.data(), text.size()};
  }

  void refuse(http::status status, const std::string& why) {
    send(status, "text/plain; charset=utf-8", std::to_string(static_cast<unsigned>(status)) + " " + why + "\n");
  }

  void send(http::status status, const std::string& type, std::string body) {
    constexpr unsigned kVersion = 11;
    constexpr unsigned kRefusals = 400;
    owner_.answered(static_cast<unsigned>(status) >= kRefusals);
    response_ = std::make_unique<Response>(status, kVersion);
    response_->set(http::field::content_type, type);
    response_->set(http::field::cache_control, "no-store");
    // Nothing from elsewhere, and nowhere else: the token in the address stays here.
    response_->set("Content-Security-Policy",
                   "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
                   "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    response_->set("Cross-Origin-Opener-Policy", "same-origin");
    response_->set("Cross-Origin-Resource-Policy", "same-origin");
    response_->set("Referrer-Policy", "no-referrer");
    response_->set("X-Content-Type-Options", "nosniff");
    if (status == http::status::method_not_allowed) response_->set(http::field::allow, "GET");
    if (status == http::status::unauthorized) response_->set(http::field::www_authenticate, "Bearer");
    response_->keep_alive(false);
    response_->body() = std::move(body);
    response_->prepare_payload();
    stream_.expires_after(owner_.settings().limits.request);
    http::async_write(stream_, *response_, [self = shared_from_this()](beast::error_code, std::size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    });
  }

  Owner& owner_;
  beast::tcp_stream stream_;
  beast::flat_buffer received_;
  http::request_parser<http::empty_body> parser_;
  std::unique_ptr<Response> response_;
};

}  // namespace forcebound::page::internal
