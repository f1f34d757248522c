#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "forcebound/scene/dynamic_model.hpp"
#include "forcebound/tissue/corotational_tissue.hpp"
#include "forcebound/tissue/other_contacts.hpp"
#include "forcebound/tissue/tissue_contact.hpp"

namespace forcebound::tissue {

/// The probes on a tissue at a moment. One motion is one step; the time between two does not matter.
class TissueWorld : public scene::DynamicModelState {
 public:
  int join() override;
  void leave(int seat) override;
  void move(int seat, const scene::Point& position_m, const scene::Point& velocity_m_per_s) noexcept final;
  void advance(double elapsed_s) noexcept final;
  scene::ModelTouch touch(int seat) noexcept final;
  [[nodiscard]] bool describe(int seat, local_model::LocalModel& model) noexcept final;
  [[nodiscard]] bool sound() const noexcept final { return sound_; }
  [[nodiscard]] scene::DynamicModelFaults faults() const noexcept final { return faults_; }

  struct Seat {
    bool taken = false;
    TissueState state{};
    TissueResult result{};  ///< of the last step
    scene::Point normal = scene::Point::UnitX();
  };

  [[nodiscard]] const Seat& seat(int index) const noexcept { return seats_[static_cast<std::size_t>(index)]; }

 protected:
  TissueWorld(int seats, const TetrahedralMesh& mesh);

  /// One probe has moved there.
  virtual TissueResult step(std::size_t seat, const scene::Point& probe_m) noexcept = 0;

  /// The contact of the probe that has moved last. @returns whether there is one
  [[nodiscard]] virtual bool describe_last(const Seat& seat, local_model::Surface& surface) noexcept = 0;

  [[nodiscard]] std::vector<Seat>& seats() noexcept { return seats_; }
  [[nodiscard]] const std::vector<Seat>& seats() const noexcept { return seats_; }

 private:
  [[nodiscard]] Seat& at(int seat) noexcept { return seats_[static_cast<std::size_t>(seat)]; }

  std::vector<Seat> seats_;
  TissueExtent extent_;
  double modelled_radius_m_;
  bool sound_ = true;
  scene::DynamicModelFaults faults_;
};

/// Each step is that of one probe while the contacts of the others follow it, so that the order of the motions does not
/// matter to probes that stay at their places: see OtherContacts. Where a probe touches is looked for at its own
/// motions only: the others feel its last contacts until then.
///
/// Where contacts of others pull, the step is done again without them. A fifth time is not: what was found last is felt
/// then, in which a contact may still pull, and counts as not converged.
class LinearTissueWorld final : public TissueWorld {
 public:
  LinearTissueWorld(const TissueModel& model, int seats);

  [[nodiscard]] std::vector<scene::VisiblePart> visible() const override;
  /// Under the forces of each probe's own last motion.
  [[nodiscard]] std::size_t sample(std::size_t first, std::span<float> to) const noexcept override;

 private:
  TissueResult step(std::size_t seat, const scene::Point& probe_m) noexcept override;
  bool describe_last(const Seat& seat, local_model::Surface& surface) noexcept override;
  /// Adds the displacement of nodes of the surface by a force on one place.
  void add_displacement(const SurfacePlace& place, const scene::Point& force_N, Eigen::Index first,
                        Eigen::Ref<Eigen::VectorXf> to) const noexcept;
  TissueResult step_among(OtherContacts& others, std::size_t seat, const scene::Point& probe_m) noexcept;
  int gather(OtherContacts& others, std::size_t seat) noexcept;

  const TissueModel& model_;
  std::unique_ptr<OtherContacts> others_;  // none where there is one seat
};

class CorotationalTissueWorld final : public TissueWorld {
 public:
  CorotationalTissueWorld(const CorotationalTissue& tissue, int seats);

  [[nodiscard]] std::vector<scene::VisiblePart> visible() const override;
  [[nodiscard]] std::size_t sample(std::size_t first, std::span<float> to) const noexcept override;

 private:
  TissueResult step(std::size_t seat, const scene::Point& probe_m) noexcept override;
  bool describe_last(const Seat& seat, local_model::Surface& surface) noexcept override;

  OtherProbes ties_beside(std::size_t seat) noexcept;
  OtherProbes spheres_beside(std::size_t seat) noexcept;

  const CorotationalTissue& tissue_;
  std::vector<SurfaceTie> ties_;         // of points, or
  std::vector<scene::Point> centers_m_;  // of spheres: room for all but one
  CorotationalBody body_;
};

}  // namespace forcebound::tissue
