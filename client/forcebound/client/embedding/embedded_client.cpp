#include "forcebound/client/embedding/embedded_client.hpp"

#include <stdexcept>
#include <utility>

#include "forcebound/baselines/law_file.hpp"
#include "forcebound/client/runtime/event_queue.hpp"
#include "forcebound/law_plugin/known_laws.hpp"
#include "forcebound/text/setting_names.hpp"

namespace forcebound::client {
namespace {

Client::Settings described(const EmbeddedClient::Settings& settings, const control::DeviceFacts& facts) {
  const control::LawRegistry laws = law_plugin::known_laws();
  Client::Settings client = settings.client;
  client.law_parameters = baselines::describe(laws.parameters(client.law, facts, settings.law_options.parameters));
  client.guarantee = laws.guarantee(client.law);
  return client;
}

}  // namespace

EmbeddedClient::EmbeddedClient(const Settings& settings, device::HapticDevice& device,
                               const std::vector<record::TickSink*>& sinks, Reports reports) try
    : reports_(std::move(reports)),
      client_(described(settings, device.facts()), device,
              law_plugin::known_laws().make(settings.client.law, device.facts(), settings.law_options), sinks) {
} catch (const std::invalid_argument& refusal) {
  throw std::invalid_argument(text::with_setting_names(refusal.what()));
}

void EmbeddedClient::look() {
  Event event;
  while (client_.events().take(event)) reports_.event(event);
  for (const std::string& problem : {client_.take_server_problem(), client_.take_recording_fault()}) {
    if (!problem.empty()) reports_.problem(text::with_setting_names(problem));
  }
}

void EmbeddedClient::run() {
  if (begun_.exchange(true)) throw std::runtime_error("a client runs once: make another");
  client_.run(stop_, [this](time::Nanoseconds, time::Nanoseconds) { look(); });
  look();
  ended_ = true;
}

std::string EmbeddedClient::summary() const {
  if (!ended_) throw std::runtime_error("there is no summary before the client has ended");
  return client_.summary().to_json();
}

std::string EmbeddedClient::why_no_session() const {
  if (!ended_) throw std::runtime_error("whether there was a session is known when the client has ended");
  return text::with_setting_names(client_.why_no_session());
}

}  // namespace forcebound::client
