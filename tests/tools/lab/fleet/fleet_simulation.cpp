#include "tests/tools/lab/fleet/fleet_simulation.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <queue>
#include <set>
#include <stdexcept>
#include <utility>

#include "forcebound/control/classic_text.hpp"
#include "forcebound/text/numbers.hpp"
#include "tests/tools/netem/random.hpp"

namespace forcebound::lab {
namespace {

constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();
constexpr double kMotionsPerSecond = 1000;

struct Client {
  std::size_t server = kNowhere;
  double asked_s = 0;         ///< when it began to want a server
  double leaves_s = 0;        ///< when its stay is over
  double failed_s = -1;       ///< when its node failed; below zero: it is no such client
  std::uint32_t place = 0;    ///< among its server's clients
  std::uint32_t session = 0;  ///< counts its sessions, so that events of an earlier one are known
  bool begun = false;         ///< had a session
};

enum class ServerState : std::uint8_t { starting, ready, in_use, gone };

struct Server {
  ServerState state = ServerState::starting;
  std::vector<std::uint32_t> clients{};
  double busy_until_s = 0;  ///< with handshakes
};

enum class What : std::uint8_t { arrives, notices, asks, leaves, roams, looks, starts, fails, shows };

struct Event {
  double time_s = 0;
  std::uint64_t number = 0;  ///< of two at the same time the older comes first
  What what = What::shows;
  std::size_t whom = 0;
  std::uint32_t session = 0;
  bool operator>(const Event& other) const { return std::pair(time_s, number) > std::pair(other.time_s, other.number); }
};

class Fleet {
 public:
  explicit Fleet(const FleetSettings& settings) : settings_(settings), random_(settings.seed) {}

  FleetResult run() {
    clients_.resize(settings_.clients);
    double at_s = 0;
    for (std::size_t i = 0; i < settings_.clients; ++i) {
      // So many within that time that the last is expected at its end.
      at_s += exponential(settings_.arrive_s / static_cast<double>(settings_.clients));
      plan(at_s, What::arrives, i);
    }
    for (std::size_t i = 0; i < settings_.failures_s.size(); ++i) plan(settings_.failures_s[i], What::fails, i);
    // The fleet has its spares before the first client comes.
    for (std::size_t i = 0; i < settings_.spares; ++i) ready_.insert(new_server(ServerState::ready));
    plan(0, What::looks, 0);
    plan(0, What::shows, 0);
    while (!events_.empty() && !is_over()) {
      const Event event = events_.top();
      events_.pop();
      now_s_ = event.time_s;
      handle(event);
    }
    for (auto* values : {&result_.waits_s, &result_.outages_s, &result_.handshakes_s}) std::ranges::sort(*values);
    result_.sessions_mean = counted_s_ > 0 ? session_seconds_ / counted_s_ : 0;
    return std::move(result_);
  }

 private:
  [[nodiscard]] double exponential(double mean_s) {
    constexpr double kDraws = 4294967296.0;
    return -mean_s * std::log((static_cast<double>(random_.draw()) + 0.5) / kDraws);
  }

  [[nodiscard]] bool is_over() const noexcept { return gone_clients_ == settings_.clients; }

  void plan(double time_s, What what, std::size_t whom, std::uint32_t session = 0) {
    events_.push({time_s, next_event_++, what, whom, session});
  }

  void handle(const Event& event) {
    switch (event.what) {
      case What::arrives:
        return arrive(event.whom);
      case What::notices:
        return request(event.whom, now_s_);
      case What::asks:
        return ask(event.whom);
      case What::leaves:
        return leave(event.whom, event.session);
      case What::roams:
        return roam(event.whom, event.session);
      case What::looks:
        return look();
      case What::starts:
        return start(event.whom);
      case What::fails:
        return fail_node();
      case What::shows:
        return show();
    }
  }

  void arrive(std::size_t number) {
    ++result_.arrived;
    ++waiting_;
    clients_[number].asked_s = now_s_;
    request(number, now_s_);
  }

  /// Its turn at the allocator, which answers one after the other.
  void request(std::size_t number, double from_s) {
    allocator_until_s_ = std::max(allocator_until_s_, from_s) + settings_.allocate_s;
    plan(allocator_until_s_, What::asks, number);
  }

  void ask(std::size_t number) {
    Client& client = clients_[number];
    if (client.begun && now_s_ >= client.leaves_s) {
      ++result_.left_meanwhile;
      ++gone_clients_;
      --waiting_;
      return;
    }
    const std::size_t chosen = choose();
    if (chosen == kNowhere) {
      ++result_.refused;
      return request(number, now_s_ + settings_.retry_s);
    }
    seat(number, chosen);
  }

  /// A server with a place: in use first, then one that waits.
  [[nodiscard]] std::size_t choose() const {
    if (!free_.empty()) return free_.begin()->second;
    return ready_.empty() ? kNowhere : *ready_.begin();
  }

  void seat(std::size_t number, std::size_t chosen) {
    Server& server = servers_[chosen];
    if (server.state == ServerState::ready) {
      ready_.erase(chosen);
      server.state = ServerState::in_use;
      ++in_use_;
    }
    update_free(chosen, [&] { server.clients.push_back(static_cast<std::uint32_t>(number)); });
    Client& client = clients_[number];
    client.server = chosen;
    client.place = static_cast<std::uint32_t>(server.clients.size() - 1);
    ++client.session;
    --waiting_;
    result_.sessions_most = std::max(result_.sessions_most, ++sessions_);
    result_.sessions_of_server_most = std::max(result_.sessions_of_server_most, server.clients.size());
    const double there_s = handshake(server);
    if (client.failed_s >= 0) {
      ++result_.back;
      result_.outages_s.push_back(there_s - client.failed_s);
      client.failed_s = -1;
    } else {
      result_.waits_s.push_back(there_s - client.asked_s);
      client.leaves_s = there_s + exponential(settings_.stay_s);
    }
    client.begun = true;
    plan(std::max(client.leaves_s, there_s), What::leaves, number, client.session);
    plan_roam(number);
  }

  /// One on a server, behind those that wait there, in the time that motions leave. @returns when it is done
  double handshake(Server& server) {
    const double load = static_cast<double>(server.clients.size()) * kMotionsPerSecond * settings_.motion_s;
    constexpr double kLeast = 0.01;  // of the core, in an overload
    const double takes_s = settings_.handshake_s / std::max(1 - load, kLeast);
    server.busy_until_s = std::max(server.busy_until_s, now_s_) + takes_s;
    result_.handshakes_s.push_back(server.busy_until_s - now_s_);
    return server.busy_until_s;
  }

  void plan_roam(std::size_t number) {
    if (settings_.roam_s > 0)
      plan(now_s_ + exponential(settings_.roam_s), What::roams, number, clients_[number].session);
  }

  void roam(std::size_t number, std::uint32_t session) {
    const Client& client = clients_[number];
    if (client.server == kNowhere || client.session != session) return;
    ++result_.roamed;
    handshake(servers_[client.server]);
    plan_roam(number);
  }

  void leave(std::size_t number, std::uint32_t session) {
    if (clients_[number].server == kNowhere || clients_[number].session != session) return;
    unseat(number);
    ++result_.left;
    ++gone_clients_;
  }

  void unseat(std::size_t number) {
    Client& client = clients_[number];
    const std::size_t at = client.server;
    Server& server = servers_[at];
    update_free(at, [&] {
      clients_[server.clients.back()].place = client.place;
      server.clients[client.place] = server.clients.back();
      server.clients.pop_back();
    });
    client.server = kNowhere;
    --sessions_;
    if (!server.clients.empty()) return;
    // Ready again.
    free_.erase({settings_.places, at});
    server.state = ServerState::ready;
    --in_use_;
    ready_.insert(at);
  }

  /// Keeps the list of servers in use with places right around a change of one's clients.
  template <class Change>
  void update_free(std::size_t at, const Change& change) {
    const Server& server = servers_[at];
    free_.erase({settings_.places - server.clients.size(), at});
    change();
    const std::size_t free = settings_.places - server.clients.size();
    if (free > 0) free_.insert({free, at});
  }

  [[nodiscard]] std::size_t servers() const noexcept { return in_use_ + ready_.size() + starting_; }

  std::size_t new_server(ServerState state) {
    servers_.push_back({.state = state});
    return servers_.size() - 1;
  }

  void look() {
    std::size_t waiting = ready_.size() + starting_;
    for (; waiting < settings_.spares && servers() < settings_.servers_most; ++waiting) {
      ++starting_;
      plan(now_s_ + settings_.start_s, What::starts, new_server(ServerState::starting));
    }
    // The newest first: their nodes empty again.
    for (; waiting > settings_.spares && !ready_.empty(); --waiting) {
      const auto last = std::prev(ready_.end());
      servers_[*last].state = ServerState::gone;
      ready_.erase(last);
    }
    plan(now_s_ + settings_.look_s, What::looks, 0);
  }

  void start(std::size_t number) {
    if (servers_[number].state != ServerState::starting) return;
    --starting_;
    servers_[number].state = ServerState::ready;
    ready_.insert(number);
    result_.servers_most = std::max(result_.servers_most, in_use_ + ready_.size());
  }

  /// Servers were given to nodes in the order of their start.
  void fail_node() {
    std::vector<std::size_t> sessions((servers_.size() + settings_.servers_of_node - 1) / settings_.servers_of_node);
    for (std::size_t i = 0; i < servers_.size(); ++i)
      sessions[i / settings_.servers_of_node] += servers_[i].clients.size();
    if (sessions.empty()) return;
    const auto node = static_cast<std::size_t>(std::distance(sessions.begin(), std::ranges::max_element(sessions)));
    const std::size_t end = std::min(servers_.size(), (node + 1) * settings_.servers_of_node);
    for (std::size_t i = node * settings_.servers_of_node; i < end; ++i) fail_server(i);
  }

  void fail_server(std::size_t number) {
    while (servers_[number].state == ServerState::in_use) {
      const std::size_t client = servers_[number].clients.back();
      unseat(client);
      clients_[client].failed_s = now_s_;
      ++result_.failed_over;
      ++waiting_;
      notice_later(client);
    }
    ready_.erase(number);
    if (servers_[number].state == ServerState::starting) --starting_;
    servers_[number].state = ServerState::gone;
  }

  void notice_later(std::size_t number) {
    constexpr double kDraws = 4294967296.0;
    const double spread = static_cast<double>(random_.draw()) / kDraws;
    plan(now_s_ + settings_.notice_s + settings_.spread_s * spread, What::notices, number);
  }

  void show() {
    constexpr double kStep_s = 1;
    result_.servers_most = std::max(result_.servers_most, in_use_ + ready_.size());
    result_.moments.push_back({.time_s = now_s_,
                               .sessions = sessions_,
                               .waiting = waiting_,
                               .in_use = in_use_,
                               .ready = ready_.size(),
                               .starting = starting_});
    if (now_s_ >= settings_.arrive_s / 2 && now_s_ < settings_.arrive_s) {
      session_seconds_ += static_cast<double>(sessions_) * kStep_s;
      counted_s_ += kStep_s;
    }
    plan(now_s_ + kStep_s, What::shows, 0);
  }

  const FleetSettings& settings_;
  netem::Random random_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t next_event_ = 0;
  double now_s_ = 0;
  double allocator_until_s_ = 0;
  std::vector<Client> clients_;
  std::vector<Server> servers_;
  std::set<std::pair<std::size_t, std::size_t>> free_;  // places free and number, of servers in use that have some
  std::set<std::size_t> ready_;
  std::size_t in_use_ = 0;
  std::size_t starting_ = 0;
  std::size_t sessions_ = 0;
  std::size_t waiting_ = 0;
  std::size_t gone_clients_ = 0;
  double session_seconds_ = 0;
  double counted_s_ = 0;
  FleetResult result_;
};

void expect(bool holds, const std::string& what) {
  if (!holds) throw std::invalid_argument(what);
}

}  // namespace

FleetResult simulate_fleet(const FleetSettings& settings) {
  expect(settings.clients > 0 && settings.places > 0 && settings.servers_of_node > 0 && settings.servers_most > 0,
         "clients, places of a server, servers of a node and servers must be at least 1");
  expect(settings.spares > 0 && settings.spares <= settings.servers_most,
         "spares must be from 1 to the number of servers, got " + std::to_string(settings.spares));
  expect(settings.arrive_s > 0 && settings.stay_s > 0 && settings.look_s > 0 && settings.retry_s > 0,
         "times of arrival, stay, look and retry must be above 0");
  const double load = static_cast<double>(settings.places) * kMotionsPerSecond * settings.motion_s;
  expect(load < 1, std::to_string(settings.places) + " places make " + text::to_text(load) +
                       " of a core, which must be below 1: fewer places, or motions that cost less");
  return Fleet(settings).run();
}

double mean_wait_s(double load, double service_s) {
  expect(load >= 0 && load < 1, "the load of a core must be from 0 to below 1, got " + text::to_text(load));
  return load * service_s / (2 * (1 - load));
}

double at_share(const std::vector<double>& ascending, double share) {
  if (ascending.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(ascending.size())));
  return ascending[std::clamp<std::size_t>(rank, 1, ascending.size()) - 1];
}

std::string fleet_csv(const FleetResult& result) {
  control::ClassicText csv;
  csv << "time_s,sessions,waiting,in_use,ready,starting\n";
  for (const FleetMoment& at : result.moments) {
    csv << at.time_s << ',' << at.sessions << ',' << at.waiting << ',' << at.in_use << ',' << at.ready << ','
        << at.starting << '\n';
  }
  return csv.str();
}

}  // namespace forcebound::lab
