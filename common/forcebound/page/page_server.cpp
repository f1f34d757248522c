#include "forcebound/page/page_server.hpp"

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <chrono>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "forcebound/page/internal/connection.hpp"
#include "forcebound/page/internal/line_viewer.hpp"
#include "forcebound/page/internal/owner.hpp"
#include "forcebound/page/internal/socket_viewer.hpp"

namespace forcebound::page {
namespace {

using Tcp = internal::asio::ip::tcp;

constexpr std::chrono::nanoseconds kBeat = std::chrono::nanoseconds{std::chrono::seconds{1}} / kBeatsPerSecond;

std::string in_address(const std::string& host) {
  return host.find(':') != std::string::npos && !host.starts_with('[') ? "[" + host + "]" : host;
}

/// Counts that one thread writes and any reads.
struct SharedCounts {
  std::atomic<std::uint64_t> requests{0};
  std::atomic<std::uint64_t> refused{0};
  std::atomic<std::uint64_t> turned_away{0};
  std::atomic<std::uint64_t> viewers{0};
  std::atomic<std::uint64_t> viewers_dropped{0};
  std::atomic<std::uint64_t> messages{0};
  std::atomic<std::uint64_t> skipped{0};
  std::atomic<std::uint64_t> faults{0};
};

}  // namespace

struct PageServer::Parts final : internal::Owner {
  Parts(const Settings& chosen, Subject& shown, const Subprotocol& subprotocol)
      : settings_(chosen), subprotocol_(subprotocol.name), acceptor_(io_), timer_(io_) {
    groups_.emplace_back(*this, shown, internal::Audience::page);
    if (subprotocol.subject != nullptr) {
      groups_.emplace_back(*this, *subprotocol.subject, internal::Audience::subprotocol);
    }
    listen();
    let_in_.reserve(settings_.limits.connections + 1);
    hosts_.emplace(settings_.host, port_);
    timer_.expires_after(kBeat);
    wait_for_beat();
    thread_ = std::jthread([this] { serve(); });
  }

  ~Parts() override {
    io_.stop();
    thread_.join();
    viewers_.clear();
  }

  /// Until it is stopped. What fails for lack of memory costs one viewer, not the program.
  void serve() noexcept {
    while (!io_.stopped()) {
      try {
        io_.run();
        return;
      } catch (const std::exception&) {
        ++counts_.faults;
      }
    }
  }

  void listen() {
    try {
      std::string host = settings_.host;
      if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
      Tcp::resolver resolver(io_);
      const Tcp::endpoint at = *resolver.resolve(host, std::to_string(settings_.port)).begin();
      acceptor_.open(at.protocol());
      acceptor_.set_option(Tcp::acceptor::reuse_address(true));
      acceptor_.bind(at);
      acceptor_.listen();
      acceptor_.non_blocking(true);
      port_ = acceptor_.local_endpoint().port();
    } catch (const boost::system::system_error& error) {
      throw std::runtime_error("no page at " + in_address(settings_.host) + ":" + std::to_string(settings_.port) +
                               ": " + error.code().message() + "; another port is accepted, or 0 for a free one");
    }
  }

  // The beat.

  void wait_for_beat() {
    timer_.async_wait([this](const boost::system::error_code& error) {
      if (error) return;
      // What was missed is left out.
      const auto next = timer_.expiry() + kBeat;
      timer_.expires_at(std::max(next, decltype(timer_)::clock_type::now()));
      accept_some();
      for (Group& group : groups_) guarded([&group] { group.subject().beat(group); });
      for (const auto& viewer : snapshot()) viewer->beat();
      wait_for_beat();
    });
  }

  /// Viewers may leave meanwhile.
  [[nodiscard]] std::vector<std::shared_ptr<internal::Viewer>> snapshot() const {
    std::vector<std::shared_ptr<internal::Viewer>> all;
    all.reserve(viewers_.size());
    for (const auto& [id, viewer] : viewers_) all.push_back(viewer);
    return all;
  }

  template <class Work>
  void guarded(Work work) noexcept {
    try {
      work();
    } catch (const std::exception&) {
      ++counts_.faults;
    }
  }

  // Connections.

  /// Taken at the beat, a few at a time: whoever opens thousands waits for the others, and takes no more of the
  /// processor. Where there is no room, the one that was there longest without showing the token makes it: whoever
  /// keeps connections open keeps nobody else out.
  void accept_some() {
    for (std::size_t i = 0; i < settings_.limits.connections_per_beat; ++i) {
      boost::system::error_code error;
      Tcp::socket socket(io_);
      acceptor_.accept(socket, error);
      if (error) return;
      guarded([&] {
        const auto connection = std::make_shared<internal::Connection>(std::move(socket), *this);
        strangers_.push_back(connection.get());
        if (strangers_.size() + let_in_.size() > settings_.limits.connections) turn_away(*strangers_.front());
        if (!strangers_.empty() && strangers_.back() == connection.get()) connection->start();
      });
    }
  }

  void turn_away(internal::Connection& connection) noexcept {
    ++counts_.turned_away;
    std::erase(strangers_, &connection);
    connection.turn_away(
        "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nConnection: close\r\nContent-Length: 34\r\n"
        "\r\n503 too many connections are open\n");
  }

  // Owner.

  [[nodiscard]] const Settings& settings() const noexcept override { return settings_; }
  [[nodiscard]] const HostCheck& hosts() const noexcept override { return *hosts_; }
  [[nodiscard]] std::string metrics() override {
    std::string text;
    guarded([&] { text = groups_.front().subject().metrics() + own_metrics(); });
    return text;
  }
  void answered(bool refused) noexcept override {
    ++counts_.requests;
    counts_.refused += refused ? 1U : 0U;
  }
  void let_in(internal::Connection& connection) noexcept override {
    if (std::erase(strangers_, &connection) > 0) let_in_.push_back(&connection);  // for which there is room
  }
  void connection_ended(internal::Connection& connection) noexcept override {
    std::erase(strangers_, &connection);
    std::erase(let_in_, &connection);
  }
  [[nodiscard]] bool has_room_for_viewer() const noexcept override {
    return viewers_.size() < settings_.limits.viewers;
  }
  [[nodiscard]] const std::string& subprotocol() const noexcept override { return subprotocol_; }
  void admit(internal::beast::tcp_stream stream, const internal::Request& request, internal::Way way,
             internal::Audience audience) override {
    const ViewerId id = ++last_viewer_;
    std::shared_ptr<internal::Viewer> viewer;
    if (way == internal::Way::lines) {
      viewer = std::make_shared<internal::LineViewer>(id, std::move(stream), *this, audience);
    } else {
      viewer = std::make_shared<internal::SocketViewer>(id, std::move(stream), *this, audience);
    }
    viewers_.emplace(id, viewer);
    viewer->start(request);
  }
  void joined(internal::Viewer& viewer) override {
    ++counts_.viewers;
    Group& group = group_of(viewer);
    guarded([&] { group.subject().greet(viewer.id(), group); });
  }
  void left(internal::Viewer& viewer) noexcept override {
    const ViewerId id = viewer.id();
    Group& group = group_of(viewer);
    viewers_.erase(id);
    group.subject().leave(id);
  }
  void received(internal::Viewer& viewer, std::string_view content, internal::Form form) override {
    ++counts_.messages;
    Group& group = group_of(viewer);
    guarded([&] {
      if (form == internal::Form::text) {
        group.subject().receive(viewer.id(), content, group);
      } else {
        group.subject().receive_binary(viewer.id(), content, group);
      }
    });
  }
  void count_skipped() noexcept override { ++counts_.skipped; }
  void count_dropped() noexcept override { ++counts_.viewers_dropped; }

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  [[nodiscard]] const SharedCounts& counts() const noexcept { return counts_; }

 private:
  /// Those who look at one subject.
  class Group final : public Viewers {
   public:
    Group(Parts& parts, Subject& subject, internal::Audience audience)
        : parts_(parts), subject_(subject), audience_(audience) {}

    [[nodiscard]] Subject& subject() const noexcept { return subject_; }

    void send(ViewerId id, Text text, Worth worth) override { send(id, text, worth, internal::Form::text); }
    void send_binary(ViewerId id, Text content, Worth worth) override {
      send(id, content, worth, internal::Form::binary);
    }
    void send_to_all(Text text, Worth worth) override {
      for (const auto& viewer : parts_.snapshot()) {
        if (viewer->audience() == audience_) viewer->send(text, worth, internal::Form::text);
      }
    }
    [[nodiscard]] std::size_t count() const noexcept override {
      return static_cast<std::size_t>(std::ranges::count_if(
          parts_.viewers_, [this](const auto& one) { return one.second->audience() == audience_; }));
    }

   private:
    void send(ViewerId id, const Text& text, Worth worth, internal::Form form) {
      const auto found = parts_.viewers_.find(id);
      if (found == parts_.viewers_.end()) return;
      const auto viewer = found->second;  // it may leave meanwhile
      viewer->send(text, worth, form);
    }

    Parts& parts_;
    Subject& subject_;
    internal::Audience audience_;
  };

  /// By Audience.
  Group& group_of(const internal::Viewer& viewer) noexcept {
    return groups_[static_cast<std::size_t>(viewer.audience())];
  }

  [[nodiscard]] std::string own_metrics() const {
    const auto line = [](const char* name, std::uint64_t count) {
      return "forcebound_page_" + std::string(name) + "_total " + std::to_string(count) + "\n";
    };
    return line("refused", counts_.refused) + line("viewers", counts_.viewers) +
           line("viewers_dropped", counts_.viewers_dropped) + line("skipped", counts_.skipped);
  }

  Settings settings_;
  std::string subprotocol_;
  std::vector<Group> groups_;
  std::optional<HostCheck> hosts_;
  std::uint16_t port_ = 0;
  SharedCounts counts_;
  std::vector<internal::Connection*> strangers_;  // who has not shown the token, the oldest first
  std::vector<internal::Connection*> let_in_;
  ViewerId last_viewer_ = 0;
  std::map<ViewerId, std::shared_ptr<internal::Viewer>> viewers_;
  // What waits in it refers to all above.
  internal::asio::io_context io_{1};
  Tcp::acceptor acceptor_;
  internal::asio::steady_timer timer_;
  std::jthread thread_;
};

PageServer::PageServer(const Settings& settings, Subject& subject, const Subprotocol& subprotocol)
    : parts_(std::make_unique<Parts>(settings, subject, subprotocol)) {}

PageServer::~PageServer() = default;

std::string PageServer::address() const {
  std::string host = parts_->settings().host;
  if (host == "0.0.0.0" || host == "::" || host == "[::]") host = "localhost";
  return "http://" + in_address(host) + ":" + std::to_string(parts_->port()) + "/?token=" + parts_->settings().token;
}

std::uint16_t PageServer::port() const noexcept { return parts_->port(); }

Counts PageServer::counts() const noexcept {
  const SharedCounts& shared = parts_->counts();
  return {.requests = shared.requests,
          .refused = shared.refused,
          .turned_away = shared.turned_away,
          .viewers = shared.viewers,
          .viewers_dropped = shared.viewers_dropped,
          .messages = shared.messages,
          .skipped = shared.skipped,
          .faults = shared.faults};
}

}  // namespace forcebound::page
