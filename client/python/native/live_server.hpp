#pragma once

#include <memory>
#include <string>
#include <vector>

#include "forcebound/server/runtime/embedded_server.hpp"
#include "forcebound/server/simulator/simulator_environment.hpp"
#include "python/native/arrays.hpp"

namespace forcebound::python {

/// The server of the programs with a simulator that Python steps. Its thread is of C++ alone and never waits for
/// Python, which asks and reports with the GIL held: by one thread at a time.
class LiveServer {
 public:
  struct Settings {
    server::EmbeddedServer::Settings server{};
    server::SimulatorOffer offer{};
    server::ProbeFacts probe{};
  };

  /// @throws what server::Simulator and server::EmbeddedServer do
  explicit LiveServer(const Settings& settings);

  /// @throws std::runtime_error for a second time
  void start();
  /// Once more, nothing. @throws std::runtime_error with what the thread failed with
  void stop();

  /// (client, interval_s, place, velocity, device, buttons, [(body, place, impulse), ...]) for each probe.
  /// @throws std::runtime_error unless it runs
  [[nodiscard]] py::list ask();

  /// @param touches objects with the fields of server::Touch
  /// @throws as ask, and as whole_from, doubles_from and server::Simulator::report
  void report(py::handle client, const py::sequence& touches);

  [[nodiscard]] bool is_running() const noexcept { return server_.is_running(); }
  [[nodiscard]] std::string address() const;
  /// JSON.
  [[nodiscard]] std::string summary() const;

 private:
  void expect_running() const;

  std::shared_ptr<server::Simulator> simulator_;
  std::vector<server::Simulator::Probe> probes_;
  server::EmbeddedServer server_;
};

}  // namespace forcebound::python
