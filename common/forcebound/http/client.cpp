#include "forcebound/http/client.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <cstdint>
#include <stdexcept>

namespace forcebound::http {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::uint64_t kBodyMost = std::uint64_t{1} << 20U;

/// Asynchronous steps, one after the other, all within one limit.
class Steps {
 public:
  Steps(const Url& url, std::chrono::nanoseconds limit) : url_(url), timer_(io_) {
    timer_.expires_after(std::chrono::duration_cast<asio::steady_timer::duration>(limit));
    timer_.async_wait([this](error_code) { expired_ = true; });
  }

  [[nodiscard]] asio::io_context& io() noexcept { return io_; }

  /// Starts a step and waits for its end. @param start gets the handler, of an error_code and anything else
  template <class Start>
  void wait(const Start& start) {
    ended_ = false;
    start([this](const error_code& error, const auto&...) {
      error_ = error;
      ended_ = true;
    });
    while (!ended_ && !expired_) io_.run_one();
    if (!ended_) fail("no answer in time");
    if (error_) fail(error_.message());
  }

  [[noreturn]] void fail(const std::string& why) const { throw std::runtime_error(url_.text() + ": " + why); }

 private:
  const Url& url_;
  asio::io_context io_;
  asio::steady_timer timer_;
  bool expired_ = false;
  bool ended_ = false;
  error_code error_{};
};

/// The request and its answer on a stream that is connected.
template <class Stream>
Response exchange(Steps& steps, Stream& stream, const Url& url, const Request& request) {
  namespace http = beast::http;
  http::request<http::string_body> message(http::string_to_verb(request.method), url.target, 11);
  message.set(http::field::host, url.authority());
  message.set(http::field::user_agent, "forcebound/" FORCEBOUND_VERSION);
  message.set(http::field::connection, "close");
  if (!request.body.empty()) {
    message.set(http::field::content_type, "application/json");
    message.body() = request.body;
  }
  message.prepare_payload();
  steps.wait([&](const auto& handler) { http::async_write(stream, message, handler); });
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> answer;
  answer.body_limit(kBodyMost);
  steps.wait([&](const auto& handler) { http::async_read(stream, buffer, answer, handler); });
  return {.status = static_cast<int>(answer.get().result_int()), .body = std::move(answer.get().body())};
}

asio::ssl::context tls_with(const Url& url, const Certificates& files) {
  asio::ssl::context tls(asio::ssl::context::tls_client);
  tls.set_verify_mode(asio::ssl::verify_peer);
  error_code error;
  const auto expect = [&](const std::string& file) {
    if (error) throw std::runtime_error(url.text() + ": cannot use '" + file + "': " + error.message());
  };
  if (files.authority.empty()) {
    tls.set_default_verify_paths(error);
    expect("the system's certificates");
  } else {
    tls.load_verify_file(files.authority, error);
    expect(files.authority);
  }
  if (!files.certificate.empty()) {
    tls.use_certificate_chain_file(files.certificate, error);
    expect(files.certificate);
    tls.use_private_key_file(files.key, asio::ssl::context::pem, error);
    expect(files.key);
  }
  return tls;
}

/// What OpenSSL does not check by itself: that the certificate is of this host. Names are asked for by SNI too.
void expect_host(asio::ssl::stream<tcp::socket&>& stream, const Url& url) {
  error_code not_numeric;
  asio::ip::make_address(url.host, not_numeric);
  if (not_numeric) SSL_set_tlsext_host_name(stream.native_handle(), url.host.c_str());
  stream.set_verify_callback(asio::ssl::host_name_verification(url.host));
}

}  // namespace

std::string_view refusal() noexcept { return {}; }

Response ask(const Url& url, const Request& request, std::chrono::nanoseconds limit, const Certificates& certificates) {
  Steps steps(url, limit);
  tcp::resolver resolver(steps.io());
  tcp::resolver::results_type addresses;
  steps.wait([&](const auto& handler) {
    resolver.async_resolve(url.host, url.port, [&, handler](const error_code& error, const auto& found) {
      addresses = found;
      handler(error);
    });
  });
  tcp::socket socket(steps.io());
  steps.wait([&](const auto& handler) { asio::async_connect(socket, addresses, handler); });
  if (!url.encrypted) return exchange(steps, socket, url, request);
  asio::ssl::context tls = tls_with(url, certificates);
  asio::ssl::stream<tcp::socket&> stream(socket, tls);
  expect_host(stream, url);
  steps.wait([&](const auto& handler) { stream.async_handshake(asio::ssl::stream_base::client, handler); });
  return exchange(steps, stream, url, request);
}

}  // namespace forcebound::http
