#include "forcebound/server/session/server.hpp"

#include <new>
#include <stdexcept>
#include <variant>

namespace forcebound::server {
namespace {

ServerOptions checked(ServerOptions options, const EnvironmentLibrary& environments) {
  if (!environments.find(options.scene)) throw std::invalid_argument(environments.unknown_text(options.scene));
  if (options.sessions_max == 0 || options.idle_timeout <= Nanoseconds{0} || options.hellos_per_s_max < 1 ||
      !(options.motions_per_promised > 0) || !(options.session_compute_max > 0) || !(options.load_max > 0)) {
    throw std::invalid_argument(
        "sessions_max, idle_timeout, motions_per_promised, hellos_per_s_max, session_compute_max and load_max must be "
        "> 0");
  }
  return options;
}

/// Of a kind that clients send, or of none: its body is then unreadable.
bool is_for_servers(const wire::Heading& heading) noexcept {
  return heading.is<wire::MotionSample>() || heading.is<wire::Hello>() || heading.is<wire::Bye>() ||
         heading.kind >= std::variant_size_v<wire::Message>;
}

}  // namespace

Server::Server(ServerOptions options, EnvironmentLibrary environments, net::DatagramLink& link,
               const time::Clock& clock, std::function<std::uint64_t()> random, ServerObserver* observer)
    : options_(checked(std::move(options), environments)),
      random_(std::move(random)),
      observer_(observer == nullptr ? nobody_ : *observer),
      replies_(link, counters_, observer_),
      table_(options_.sessions_max, replies_, counters_, observer_),
      housekeeping_(options_, table_),
      capacity_(options_, table_, housekeeping_, counters_),
      admission_(options_, std::move(environments),
                 {.table = table_, .capacity = capacity_, .counters = counters_, .random = random_}, clock.now()),
      answerer_(options_, {.table = table_,
                           .replies = replies_,
                           .counters = counters_,
                           .observer = observer_,
                           .clock = clock,
                           .random = random_}) {}

void Server::on_datagram(std::span<const std::byte> datagram, const net::Address& from, Nanoseconds now,
                         const ClientRights& rights) {
  receive(datagram, {.address = from, .rights = rights}, now);
  answer_waiting();
}

std::optional<std::size_t> Server::receive(std::span<const std::byte> datagram, const Sender& sender, Nanoseconds now) {
  const net::Address& from = sender.address;
  if (!sender.judged) ++counters_.datagrams;
  const auto heading = wire::heading_of(datagram);
  if (const auto* malformed = std::get_if<wire::Malformed>(&heading)) {
    ++counters_.malformed[*malformed];
    return std::nullopt;
  }
  // What can be dropped by its heading is: a flood of it must cost little.
  const auto& begins = std::get<wire::Heading>(heading);
  if (begins.is<wire::MotionSample>() && !table_.has_or_had(begins.session)) {
    answerer_.refuse(begins.session, datagram.size(), from, now);
    return std::nullopt;
  }
  if (!is_for_servers(begins)) {
    ++counters_.unexpected;
    return std::nullopt;
  }
  const auto decoded = codec_.decode(datagram, begins);
  if (const auto* malformed = std::get_if<wire::Malformed>(&decoded)) {
    ++counters_.malformed[*malformed];
    return std::nullopt;
  }
  const auto& message = std::get<wire::Message>(decoded);
  if (table_.is_of_another(message, sender.rights.key)) {
    ++counters_.datagrams_of_others;
    return std::nullopt;
  }
  if (const auto* motion = std::get_if<wire::MotionSample>(&message)) {
    answerer_.receive(*motion, datagram.size(), from, now);
  } else if (const auto* hello = std::get_if<wire::Hello>(&message)) {
    return on_hello(*hello, sender, now);
  } else if (const auto* bye = std::get_if<wire::Bye>(&message)) {
    table_.close_by_client(*bye, datagram.size(), from);
  }
  return std::nullopt;
}

std::optional<std::size_t> Server::on_hello(const wire::Hello& hello, const Sender& sender, Nanoseconds now) {
  try {
    const Decision decision = admission_.decide(hello, sender, now);
    if (const auto* elsewhere = std::get_if<Elsewhere>(&decision)) return elsewhere->worker;
    if (std::holds_alternative<RoundTripWanted>(decision)) replies_.ask_for_round_trip(hello, sender.address);
    if (const auto* refused = std::get_if<Refused>(&decision)) replies_.refuse(hello, sender.address, *refused);
    if (const auto* let_in = std::get_if<LetIn>(&decision)) replies_.welcome(let_in->session, let_in->repeated);
  } catch (const std::bad_alloc&) {
    replies_.refuse_for_lack_of_memory(hello, sender.address);
  }
  return std::nullopt;
}

void Server::refuse_hello(std::span<const std::byte> datagram, const net::Address& from, std::string_view why) {
  const auto decoded = codec_.decode(datagram);
  const auto* const message = std::get_if<wire::Message>(&decoded);
  const auto* const hello = message == nullptr ? nullptr : std::get_if<wire::Hello>(message);
  if (hello == nullptr) return;
  try {
    replies_.refuse(*hello, from, {wire::RefusalReason::server_full, std::string(why)});
  } catch (const std::bad_alloc&) {
    replies_.refuse_for_lack_of_memory(*hello, from);
  }
}

void Server::stop() {
  table_.close_each([](const Session&) { return CloseReason::server_stops; });
}

std::size_t Server::end_sessions(const std::function<bool(const Session&)>& which) {
  return table_.close_each(
      [&](const Session& session) { return which(session) ? std::optional(CloseReason::was_asked_to) : std::nullopt; });
}

ServerCounters Server::counters() const noexcept {
  ServerCounters total = counters_;
  for (const auto& [number, session] : table_.all()) total.add(session.made.environment->faults());
  return total;
}

}  // namespace forcebound::server
