#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>

#include "forcebound/client/rendering/foresight.hpp"
#include "forcebound/client/rendering/surface_contact.hpp"
#include "forcebound/control/vector.hpp"
#include "forcebound/local_model/device_point.hpp"
#include "forcebound/local_model/dragged_mass.hpp"
#include "forcebound/time/clock.hpp"
#include "forcebound/wire/messages.hpp"

namespace forcebound::client {

using control::Vector;
using local_model::DraggedMass;

/// What of the server's newest answer is rendered how: the one place that decides it.
///
///     T = s h + q sum of  w_i (s_i f_i(x) - s h_i) + o
///
/// h is the answer's force, of which the scene at the client may compute some parts itself; it is held, with the share
/// s that the late-force policy leaves of it. Of h the parts h_i are replaced by what their local models say at the
/// device's own place x, as far as these hold there (w_i) and have foretold the answers better than holding did (q, see
/// Foresight). Where another answer would request another T on the same tick, the difference o fades with a time
/// constant of 5 ms: that of what the device can show of both. A force without a model is held as it is, and nothing
/// fades.
///
/// When the server is silent, what moves by itself and what is held fades: s_i = s. A surface at rest and a dragged
/// mass stay as far as their models hold, s_i = 1, but of what else pulls at the mass the same share s is left: what
/// the hand meets beyond that, only the server knows. What others can move fades as well, at rest or not, and so does
/// all of a session that the server ended.
///
/// A model that is unsound (local_model::is_sound) is counted and left out, and so is whatever turns out not to be
/// finite.
///
/// Real time: noexcept, no allocation.
class AnswerRendering {
 public:
  static constexpr double kFade_s = 5e-3;

  struct Tick {
    Nanoseconds now{0};       ///< of the reading
    const Vector& place;      ///< where the environment is asked [m]; finite
    bool server_parts_alone;  ///< the other parts run at the client, by the scene that was handed over
    double share = 1;         ///< s
    ModelAge age{};           ///< of the state that the newest answer tells of
    double force_N_max = std::numeric_limits<double>::infinity();  ///< of the device
  };

  struct Rendered {
    Vector correction_N{};   ///< T - s h, with rows of the place
    Vector model_N{};        ///< sum of w_i s_i f_i; no rows: no model counts here
    bool held = false;       ///< some of h is held
    bool fades = true;       ///< some of T would fade if the server were silent
    double deviation_m = 0;  ///< how far the newest answer moved a dragged mass
    /// In the newest answer's models, by how they foretold the answers: see Foresight. Absent: it has none.
    std::optional<double> trust{};
  };

  /// The server ended that session.
  void end(std::uint64_t session) noexcept { ended_ = session; }

  [[nodiscard]] Rendered render(const wire::EnvironmentForce& newest, const Tick& tick) noexcept;

  /// The least radius within which a model in use holds; infinite: none is in use.
  [[nodiscard]] double least_radius_m() const noexcept;
  /// Of the device, on the last tick.
  [[nodiscard]] double speed_m_per_s() const noexcept { return device_.velocity_m_per_s.norm(); }

  /// Models that were unsound, or whose force was not finite.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  struct Sum {
    bool foretells = false;              // some model holds, whose force an answer tells
    Point foretold_N = Point::Zero();    // sum of w_i (f_i - h_i)
    Point correction_N = Point::Zero();  // q sum of w_i (s_i f_i - s h_i)
    Point model_N = Point::Zero();       // q sum of w_i s_i f_i
    Point replaced_N = Point::Zero();    // q sum of w_i h_i
    double weight = 0;                   // the largest of what has a share
    bool stands = true;                  // s_i = 1 for all of it
  };

  void look(const Tick& tick) noexcept;
  void advance(const ModelAge& age, Nanoseconds now) noexcept;
  void forget_models() noexcept;
  void store_answer(const wire::EnvironmentForce& newest, const Tick& tick) noexcept;
  [[nodiscard]] Sum go_over_to(const wire::EnvironmentForce& newest, const Tick& tick, const ModelAge& age_before,
                               double share_before) noexcept;
  void fade_over_to_mass(const ModelAge& age, const Tick& tick) noexcept;
  [[nodiscard]] Point shown_N(const Sum& sum, double share, const Tick& tick) const noexcept;
  [[nodiscard]] Sum sum(const ModelAge& age, double share) const noexcept;
  [[nodiscard]] Point held_N(bool server_parts_alone) const noexcept;

  std::uint64_t sequence_ = 0;  // of the motion that the answer in use is for; 0: there was none
  std::uint64_t session_ = 0;   // that it is of
  ModelAge age_{};              // of the state that it tells of, on the last tick
  double share_ = 0;            // on the last tick
  Vector force_N_{};            // of that answer
  Vector server_parts_N_{};
  local_model::LocalModel model_{};  // less surfaces and mass, whose states follow
  std::array<SurfaceContact, local_model::LocalModel::kSurfacesMax> surfaces_{};
  DraggedMass mass_{};
  Foresight foresight_{};
  DevicePoint device_{};
  double elapsed_s_ = 0;  // since the tick before
  Nanoseconds last_{0};
  bool looked_ = false;
  std::optional<std::uint64_t> ended_{};  // session
  Point fading_N_ = Point::Zero();        // o
  std::uint64_t refused_ = 0;
};

}  // namespace forcebound::client
