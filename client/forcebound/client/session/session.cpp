#include "forcebound/client/session/session.hpp"

#include <utility>
#include <variant>

namespace forcebound::client {
namespace {

SessionLink::Options link_options(const Session::Options& options, const control::DeviceFacts& device,
                                  std::string_view server_law, bool shows_scene) {
  return {.server = options.server,
          .server_in_words = options.server_in_words,
          .facts = {.device = device.name,
                    .scene = options.scene,
                    .server_law = std::string(server_law),
                    .degrees_of_freedom = device.translations(),
                    .period_s = device.period_s,
                    .force_N_max = device.force_N_max,
                    .renders_locally = options.local != nullptr,
                    .shows_scene = shows_scene,
                    .shows_torque = device.rotations > 0},
          .seed = options.seed,
          .policy = options.policy,
          .send_rate = options.send_rate};
}

Renderer::Options renderer_options(const Session::Options& options, const control::DeviceFacts& device) {
  return {.local = options.local,
          .policy = options.policy,
          .force = {.slew_per_s = options.force_slew_N_per_s, .most = device.force_N_max},
          .torque = {.slew_per_s = options.torque_slew_N_m_per_s, .most = device.torque_N_m_max}};
}

}  // namespace

Session::Session(const Options& options, device::HapticDevice& device, std::unique_ptr<control::PassivityLaw> law,
                 net::DatagramLink& link, const time::Clock& clock, Sinks sinks)
    : events_(sinks.events),
      actuation_(device, std::move(law), clock, events_),
      link_(link_options(options, device.facts(), actuation_.law().server_law(), sinks.view != nullptr), link, clock,
            events_),
      renderer_(renderer_options(options, device.facts()), events_),
      recorder_(sinks.ticks),
      view_(sinks.view) {}

void Session::tick(Nanoseconds now) noexcept {
  now_ = now;
  const std::optional<device::Reading> reading = actuation_.read(now);
  if (!reading) {
    receive(now);
    link_.keep_connected(now);
    return;
  }
  const ToolPoint point = renderer_.point_of(*reading, law().proxy_position(reading->position));
  const std::uint64_t motion = send_motion(*reading, point.place);
  receive(now);
  link_.keep_connected(now);

  const double elapsed_s = actuation_.begin_choosing(*reading);
  const Renderer::Rendered rendered = renderer_.render({.now = now,
                                                        .reading = *reading,
                                                        .elapsed_s = elapsed_s,
                                                        .point = point,
                                                        .newest = link_.forces().newest(),
                                                        .newest_arrival = link_.forces().newest_arrival(),
                                                        .clocks = link_.clocks()});
  link_.plan_motions(rendered.need);
  const Actuation::Command command = actuation_.command(
      now, *reading,
      {.force_N = rendered.request.force_N, .torque_N_m = rendered.request.torque_N_m, .silent = rendered.silent});
  recorder_.record({.now = now,
                    .reading = *reading,
                    .point = point,
                    .motion_sequence = motion,
                    .rendered = rendered,
                    .command = command,
                    .state = state(),
                    .newest = link_.forces().newest()});
}

std::uint64_t Session::send_motion(const device::Reading& reading, const Vector& place) noexcept {
  if (!link_.is_motion_due(reading, place)) return 0;
  return link_.send({.device_time = reading.latched,
                     .position = place,
                     .server_law_numbers = law().outgoing(),
                     .pieces = renderer_.begin_motion(reading.latched),
                     .handle = reading.handle,
                     .energy_given_J = law().energy_given_J()});
}

void Session::receive(Nanoseconds now) noexcept {
  for (MessageLink::Received in_tick; const auto arrival = link_.receive(now, in_tick);) pass_on(*arrival, now);
}

void Session::pass_on(const SessionLink::Arrival& arrival, Nanoseconds now) noexcept {
  if (const auto* force = std::get_if<wire::EnvironmentForce>(&arrival.message)) {
    if (arrival.newest) actuation_.receive(force->server_law_numbers);
    recorder_.record(*force, arrival.at);
  } else if (const auto* welcome = std::get_if<wire::Welcome>(&arrival.message)) {
    actuation_.begin_server_side();
    renderer_.begin_session(*welcome);
    events_.report(Event::Kind::welcomed, now, recorder_.begin_session(*welcome));
  } else if (const auto* piece = std::get_if<wire::ScenePiece>(&arrival.message)) {
    renderer_.receive(*piece);
  } else if (const auto* view = std::get_if<wire::ViewPiece>(&arrival.message)) {
    if (view_ != nullptr) view_->on_view(*view);
  } else if (const auto* bye = std::get_if<wire::Bye>(&arrival.message)) {
    renderer_.end_session(bye->session);
  }
}

bool Session::close(Nanoseconds now) noexcept {
  now_ = now;
  actuation_.stop(now);
  link_.begin_closing(now);
  receive(now);
  return link_.close(now);
}

record::RunTotals Session::totals() const {
  record::RunTotals totals;
  recorder_.add_to(totals);
  actuation_.add_to(totals);
  link_.add_to(totals, now_);
  renderer_.add_to(totals);
  return totals;
}

}  // namespace forcebound::client
