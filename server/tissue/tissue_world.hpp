#pragma once

#include <cstddef>
#include <vector>

#include "forcebound/server/effects/medium.hpp"
#include "forcebound/server/tissue/corotational_tissue.hpp"
#include "forcebound/server/tissue/tissue_contact.hpp"

namespace forcebound::server {

/// The probes on a tissue at a moment. One motion is one step; the time between two does not matter.
class TissueWorld : public MediumState {
 public:
  int join() override;
  void leave(int seat) override;
  void move(int seat, const Point& position_m, const Point& velocity_m_per_s) noexcept final;
  void advance(double elapsed_s) noexcept final;
  MediumTouch touch(int seat) noexcept final;
  [[nodiscard]] bool sound() const noexcept final { return sound_; }
  [[nodiscard]] MediumFaults faults() const noexcept final { return faults_; }

 protected:
  struct Seat {
    bool taken = false;
    TissueState state{};
    MediumTouch touch{};
  };

  explicit TissueWorld(int seats);

  /// One probe has moved there.
  virtual TissueResult step(std::size_t seat, const Point& probe_m) noexcept = 0;

  [[nodiscard]] std::vector<Seat>& seats() noexcept { return seats_; }

 private:
  [[nodiscard]] Seat& at(int seat) noexcept { return seats_[static_cast<std::size_t>(seat)]; }

  std::vector<Seat> seats_;
  bool sound_ = true;
  MediumFaults faults_;
};

class LinearTissueWorld final : public TissueWorld {
 public:
  LinearTissueWorld(const TissueModel& model, int seats) : TissueWorld(seats), model_(model) {}

 private:
  TissueResult step(std::size_t seat, const Point& probe_m) noexcept override;

  const TissueModel& model_;
};

class CorotationalTissueWorld final : public TissueWorld {
 public:
  CorotationalTissueWorld(const CorotationalTissue& tissue, int seats);

 private:
  TissueResult step(std::size_t seat, const Point& probe_m) noexcept override;

  const CorotationalTissue& tissue_;
  std::vector<double> displacement_m_;
  CorotationalWorkspace workspace_;
};

}  // namespace forcebound::server
