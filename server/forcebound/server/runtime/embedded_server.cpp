#include "forcebound/server/runtime/embedded_server.hpp"

#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <stop_token>
#include <utility>

#include "forcebound/server/offer/environment_library.hpp"
#include "forcebound/text/setting_names.hpp"
#include "forcebound/time/real_time.hpp"

namespace forcebound::server {
namespace {

ServerOptions options_of(const EmbeddedServer::Settings& settings, const std::string& scene) {
  ServerOptions options = settings.options;
  options.scene = scene;
  return options;
}

EnvironmentLibrary library_of(const EnvironmentKind& kind) {
  EnvironmentLibrary environments;
  environments.add(kind);
  return environments;
}

}  // namespace

EmbeddedServer::Reached EmbeddedServer::reached_by(const Settings& settings, const std::string& scene) {
  try {
    expect_bounds(settings.keys);
    const net::Address address = net::resolve(net::parse_endpoint(settings.listen));
    expect_encryption(settings.keys, address);
    return {.address = address, .keys = read_keys(settings.keys, {scene})};
  } catch (const std::invalid_argument& refusal) {
    if (settings.by_options) throw;
    throw std::invalid_argument(text::with_setting_names(refusal.what()));
  }
}

EmbeddedServer::EmbeddedServer(const Settings& settings, const EnvironmentKind& kind, std::string simulated)
    : EmbeddedServer(settings, kind, std::move(simulated), reached_by(settings, kind.name)) {}

EmbeddedServer::EmbeddedServer(const Settings& settings, const EnvironmentKind& kind, std::string simulated,
                               Reached reached)
    : name_(kind.name),
      simulated_(std::move(simulated)),
      encryption_(encryption_name(reached.keys)),
      encryption_in_words_(server::encryption_in_words(settings.keys, reached.keys)),
      priority_(settings.priority),
      server_(listen_at(reached.address), options_of(settings, kind.name), library_of(kind), settings.observer,
              std::move(reached.keys)) {}

bool EmbeddedServer::start() {
  const std::scoped_lock lock(mutex_);
  if (started_) return false;
  thread_ = std::jthread([this](const std::stop_token& wanted) { run(wanted); });
  started_ = true;
  running_ = true;
  return true;
}

void EmbeddedServer::run(const std::stop_token& wanted) {
  runs_on_ = std::this_thread::get_id();
  // Refused, it is as late as other threads.
  if (priority_ > 0) (void)time::ask_for_first_in_first_out(priority_);
  std::string failure;
  try {
    server_.run(wanted);
  } catch (const std::exception& error) {
    failure = error.what();
  } catch (...) {
    failure = "an exception of an unknown kind";
  }
  const std::scoped_lock lock(mutex_);
  failure_ = std::move(failure);
  running_ = false;
}

EmbeddedServer::Stopped EmbeddedServer::stop() {
  if (runs_on_ == std::this_thread::get_id()) return Stopped::not_by_itself;
  const std::scoped_lock ending(ending_);
  {
    const std::scoped_lock lock(mutex_);
    if (!started_) return Stopped::never_started;
  }
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  return failure().empty() ? Stopped::now : Stopped::with_failure;
}

std::string EmbeddedServer::failure() const {
  const std::scoped_lock lock(mutex_);
  return failure_;
}

std::string EmbeddedServer::summary(std::string_view program, std::span<const OwnCount> own) const {
  const UdpServer::Figures figures = server_.figures();
  nlohmann::ordered_json counts;
#define FORCEBOUND_WRITE(subject, name, words) counts[#name] = figures.counters.name;
  FORCEBOUND_SERVER_COUNTS(FORCEBOUND_WRITE)
#undef FORCEBOUND_WRITE
  for (const wire::MalformedRow& row : wire::kMalformed) {
    counts["malformed_" + std::string(row.word)] = figures.counters.malformed[row.reason];
  }
  nlohmann::ordered_json summary{{"program", program},        {"address", net::to_string(address())},
                                 {"environment", name_},      {"simulated", simulated_},
                                 {"encryption", encryption_}, {"clients", figures.sessions},
                                 {"busy", figures.busy}};
  for (const OwnCount& count : own) summary[std::string(count.name)] = count.count;
  summary["counts"] = counts;
  return summary.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace forcebound::server
