#pragma once

#include <vector>

#include "forcebound/server/bodies/body_medium.hpp"

namespace forcebound::server {

/// The bodies at a moment.
class BodyWorld final : public MediumState {
 public:
  /// One probe: a body of the model, and whether it is ours to park, on three slides.
  struct Probe {
    int body = -1;
    int slides = -1;  ///< the first of its three coordinates and velocities; -1: a body of the author's own
    bool taken = false;
    bool placed = false;  ///< has been somewhere since it was taken
    Point device_m = Point::Zero();
    Point device_m_per_s = Point::Zero();
    double silent_s = 0;            ///< simulated since the device was heard of
    Point force_N = Point::Zero();  ///< on the device, after the last step
  };

  BodyWorld(ModelPointer model, const Coupling& coupling, std::vector<Probe> probes);

  int join() override;
  void leave(int seat) override;
  void move(int seat, const Point& position_m, const Point& velocity_m_per_s) noexcept override;
  void advance(double elapsed_s) noexcept override;
  MediumTouch touch(int seat) noexcept override;
  [[nodiscard]] bool sound() const noexcept override { return sound_; }
  [[nodiscard]] MediumFaults faults() const noexcept override { return faults_; }

  [[nodiscard]] const mjModel_& model() const noexcept { return *model_; }
  [[nodiscard]] const mjData_& data() const noexcept { return *data_; }
  [[nodiscard]] mjData_& data() noexcept { return *data_; }

 private:
  void park(std::size_t probe) noexcept;
  void place(Probe& probe, const Point& position_m) noexcept;
  void pull(Probe& probe, const Point& device_m, const Point& device_m_per_s) noexcept;
  void step_once(double before_end_s) noexcept;

  ModelPointer model_;
  DataPointer data_;
  Coupling coupling_;
  std::vector<Probe> probes_;
  double left_s_ = 0;
  bool sound_ = true;
  MediumFaults faults_;
};

}  // namespace forcebound::server
