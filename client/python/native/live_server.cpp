#include "python/native/live_server.hpp"

#include <array>
#include <limits>
#include <span>
#include <stdexcept>

#include "forcebound/net/endpoint.hpp"
#include "python/native/fields.hpp"

namespace forcebound::python {
namespace {

using server::Point;
using server::Simulator;
using server::Touch;

py::array_t<double> three_of(const Point& point) { return array_of(point.data(), 3); }

py::tuple tuple_of(const Simulator::Probe& probe) {
  py::list pushes;
  for (const Simulator::Push& push : std::span(probe.pushes).first(probe.push_count))
    pushes.append(py::make_tuple(push.body, three_of(push.place_m), three_of(push.impulse_Ns)));
  return py::make_tuple(probe.client, probe.interval_s, three_of(probe.place_m), three_of(probe.velocity_m_per_s),
                        three_of(probe.device_m), probe.buttons, pushes);
}

/// W, or a number for all directions.
Eigen::Matrix3d mobility_from(py::handle value, const char* name) {
  const py::array array = doubles_from(value, name);
  if (array.ndim() == 0) return number_from(value, name) * Eigen::Matrix3d::Identity();
  return matrix_from(array, 3, 3, name);
}

Touch touch_from(py::handle given, const std::string& touch) {
  if (!py::hasattr(given, "dry_friction_N")) {
    throw py::type_error(touch + ": expected a Touch, got " + py::str(py::type::of(given)).cast<std::string>());
  }
  const auto read = [&](const char* field, const auto& from) {
    return from(py::object(given.attr(field)), (touch + "." + field).c_str());
  };
  const auto point = [](py::handle value, const char* name) -> Point { return vector_from(value, 3, name); };
  const auto body = [](py::handle value, const char* name) {
    return static_cast<std::uint32_t>(whole_from(value, name, 0, std::numeric_limits<std::uint32_t>::max()));
  };
  return {.body = read("body", body),
          .place_m = read("place_m", point),
          .normal = read("normal", point),
          .velocity_m_per_s = read("velocity_m_per_s", point),
          .mobility_per_kg = read("mobility_per_kg", mobility_from),
          .others_N = read("others_N", point),
          .spring_N_per_m = read("spring_N_per_m", number_from),
          .damper_N_s_per_m = read("damper_N_s_per_m", number_from),
          .dry_friction_N = read("dry_friction_N", number_from),
          .friction = read("friction", number_from),
          .radius_m = read("radius_m", number_from)};
}

std::vector<Touch> touches_from(const py::sequence& given) {
  std::vector<Touch> touches;
  for (std::size_t i = 0; i < given.size(); ++i)
    touches.push_back(touch_from(py::object(given[i]), "touches[" + std::to_string(i) + "]"));
  return touches;
}

}  // namespace

LiveServer::LiveServer(const Settings& settings)
    : simulator_(std::make_shared<Simulator>(settings.probe, static_cast<int>(settings.server.options.sessions_max))),
      probes_(settings.server.options.sessions_max),
      server_(settings.server, server::simulator_environment(settings.offer, simulator_), settings.offer.simulated) {}

void LiveServer::start() {
  if (!server_.start()) throw std::runtime_error("a server runs once: make another");
}

void LiveServer::stop() {
  if (server_.stop() == server::EmbeddedServer::Stopped::with_failure) throw std::runtime_error(server_.failure());
}

void LiveServer::expect_running() const {
  if (server_.is_running()) return;
  const std::string failure = server_.failure();
  throw std::runtime_error(failure.empty() ? "the server does not run: start it, or make another if it was stopped"
                                           : failure);
}

py::list LiveServer::ask() {
  expect_running();
  py::list all;
  for (const Simulator::Probe& probe : std::span(probes_).first(simulator_->probes(probes_)))
    all.append(tuple_of(probe));
  return all;
}

void LiveServer::report(py::handle client, const py::sequence& touches) {
  expect_running();
  std::uint64_t whose = 0;
  std::vector<Touch> met;
  try {
    whose = static_cast<std::uint64_t>(whole_from(client, "client", 1, std::numeric_limits<std::int64_t>::max()));
    met = touches_from(touches);
  } catch (...) {
    simulator_->count_refused();
    throw;
  }
  if (simulator_->report(whose, met)) return;
  throw std::invalid_argument("client " + std::to_string(whose) +
                              " is not there: accepted are those that were asked for last");
}

std::string LiveServer::address() const { return net::to_string(server_.address()); }

std::string LiveServer::summary() const {
  const Simulator::Counts counts = simulator_->counts();
  const std::array own{server::EmbeddedServer::OwnCount{"reports", counts.reports},
                       server::EmbeddedServer::OwnCount{"reports_refused", counts.reports_refused},
                       server::EmbeddedServer::OwnCount{"silences", counts.silences}};
  return server_.summary("Python, forcebound " FORCEBOUND_VERSION, own);
}

}  // namespace forcebound::python
