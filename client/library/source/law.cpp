#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcebound/baselines/baselines.hpp"
#include "forcebound/baselines/law_file.hpp"
#include "forcebound/baselines/running_law.hpp"
#include "library/source/errors.hpp"
#include "library/source/facts.hpp"
#include "library/source/law.hpp"
#include "library/source/structs.hpp"

namespace forcebound::library {
namespace {

using control::Vector;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

static_assert(control::kDofMax == FB_AXES_MAX && control::kJointsMax == FB_JOINTS_MAX);

constexpr std::size_t kMotionLeast = offsetof(fb_motion, joint);
constexpr std::size_t kMotionOfJointsLeast = offsetof(fb_motion, latency_s);

const control::LawRegistry& laws() {
  static const control::LawRegistry kLaws = baselines::shipped_laws();
  return kLaws;
}

void set_zero(double* force_N, std::size_t axes) noexcept {
  if (force_N != nullptr) std::fill_n(force_N, std::min<std::size_t>(axes, FB_AXES_MAX), 0.0);
}

/// Counts the tick before as one that was lost, since nobody knows what it measured.
void lose(fb_law& law) noexcept {
  ++law.calls_refused;
  control::Motion& motion = law.running.motion();
  law.running.time_by_facts();
  motion.interval_s = std::numeric_limits<double>::quiet_NaN();
  motion.position.setConstant(std::numeric_limits<double>::quiet_NaN());
  law.force_N = law.running.release();
}

/// The time that is not in its range, as "latency_s must be 0 to 1e6 s"; null: all are.
const char* wrong_time(const fb_motion& given) noexcept {
  constexpr double kMost_s = 1e6;
  const auto within = [&](unsigned bit, double seconds, double least) {
    return (given.has & bit) == 0 || (seconds >= least && seconds <= kMost_s);  // not a number: neither
  };
  if (!within(FB_HAS_LATENCY, given.latency_s, 0)) return "latency_s must be 0 to 1e6 s";
  if (!within(FB_HAS_LATENCY_MAX, given.latency_s_max, 0)) return "latency_s_max must be 0 to 1e6 s";
  if (!within(FB_HAS_EFFECT, given.effect_s, -kMost_s)) return "effect_s must be -1e6 to 1e6 s";
  if (!within(FB_HAS_HELD, given.held_s, -kMost_s)) return "held_s must be -1e6 to 1e6 s";
  return nullptr;
}

void set_motion(const fb_motion& given, baselines::RunningLaw& running) noexcept {
  const control::DeviceFacts& facts = running.facts();
  control::Motion& motion = running.motion();
  running.time_by_facts();
  motion.interval_s = given.interval_s;
  motion.write_failed = given.write_failed != 0;
  motion.position = Eigen::Map<const Eigen::VectorXd>(given.position, facts.degrees_of_freedom());
  if (!facts.cartesian) {
    motion.joint = Eigen::Map<const Eigen::VectorXd>(given.joint, facts.joints());
    motion.jacobian = Eigen::Map<const RowMajor>(given.jacobian, facts.degrees_of_freedom(), facts.joints());
  }
  if ((given.has & FB_HAS_LATENCY) != 0) motion.latency_s = given.latency_s;
  if ((given.has & FB_HAS_LATENCY_MAX) != 0) motion.latency_s_max = given.latency_s_max;
  if ((given.has & FB_HAS_EFFECT) != 0) motion.effect_s = given.effect_s;
  if ((given.has & FB_HAS_HELD) != 0) motion.held_s = given.held_s;
}

fb_status refused_axes(const char* function, const fb_law& law, std::size_t axes) noexcept {
  std::array<char, 256> why{};
  (void)std::snprintf(why.data(), why.size(), "axes must be %d, the degrees of freedom of device '%.100s', got %zu",
                      law.running.facts().degrees_of_freedom(), law.running.facts().name.c_str(), axes);
  return refused(function, why.data());
}

[[nodiscard]] std::size_t axes_of(const fb_law& law) noexcept {
  return static_cast<std::size_t>(law.running.facts().degrees_of_freedom());
}

control::LawOptions options_of(const std::string& name, const fb_law_options* options, fb_status& status) {
  if (options == nullptr) return {};
  const Given<fb_law_options> given("fb_law_create", "fb_law_options", options, sizeof(std::size_t));
  status = given.status();
  if (status != FB_OK) return {};
  control::LawOptions chosen;
  if (given->parameters != nullptr) {
    chosen.parameters = baselines::parse_law_parameters(given->parameters, "parameters", name, laws());
  }
  if (given->full_memory != 0) chosen.memory = control::EnergyMemory::full;
  return chosen;
}

fb_status create(const std::string& name, const fb_facts& facts, const fb_law_options* options, fb_law** law) {
  if (laws().find(name).make_server_side) {
    throw std::invalid_argument("law '" + name + "' has another half at the server: only a client takes it");
  }
  fb_status status = FB_OK;
  control::LawOptions chosen = options_of(name, options, status);
  if (status != FB_OK) return status;
  *law = std::make_unique<fb_law>(facts.device.facts, name, std::move(chosen)).release();
  return FB_OK;
}

}  // namespace
}  // namespace forcebound::library

using namespace forcebound;  // NOLINT(google-build-using-namespace)

const char* fb_law_name(size_t index) {
  static const std::vector<std::string> kNames = library::laws().names();
  return index < kNames.size() ? kNames[index].c_str() : nullptr;
}

fb_status fb_law_create(const char* name, const fb_facts* facts, const fb_law_options* options, fb_law** law) {
  if (name == nullptr || facts == nullptr || law == nullptr) {
    return library::refused("fb_law_create", "name, facts or law is null");
  }
  return library::guarded("fb_law_create", [&] { return library::create(name, *facts, options, law); });
}

void fb_law_destroy(fb_law* law) { delete law; }

fb_status fb_law_tick(fb_law* law, const fb_motion* motion, const double* request_N, double* force_N, size_t axes) {
  constexpr const char* kFunction = "fb_law_tick";
  if (law == nullptr) {
    library::set_zero(force_N, axes);
    return library::refused(kFunction, "law is null");
  }
  const bool cartesian = law->running.facts().cartesian;
  const library::Given<fb_motion> given(kFunction, "fb_motion", motion,
                                        cartesian ? library::kMotionLeast : library::kMotionOfJointsLeast);
  fb_status status = given.status();
  if (status == FB_OK && force_N == nullptr) status = library::refused(kFunction, "force_N is null");
  if (status == FB_OK && axes != library::axes_of(*law)) status = library::refused_axes(kFunction, *law, axes);
  if (const char* const wrong = status == FB_OK ? library::wrong_time(*given) : nullptr; wrong != nullptr) {
    status = library::refused(kFunction, wrong);
  }
  if (status != FB_OK) {
    library::set_zero(force_N, axes);
    library::lose(*law);
    return status;
  }
  library::set_motion(*given, law->running);
  const auto rows = static_cast<Eigen::Index>(axes);
  law->force_N = request_N == nullptr ? law->running.release()
                                      : law->running.tick(Eigen::Map<const Eigen::VectorXd>(request_N, rows));
  Eigen::Map<Eigen::VectorXd>(force_N, rows) = law->force_N;
  return FB_OK;
}

fb_status fb_law_confirm(fb_law* law, double latency_s, double* force_N, size_t axes) {
  constexpr const char* kFunction = "fb_law_confirm";
  library::set_zero(force_N, axes);
  if (law == nullptr || force_N == nullptr) return library::refused(kFunction, "law or force_N is null");
  if (axes != library::axes_of(*law)) return library::refused_axes(kFunction, *law, axes);
  law->force_N = law->running.bounder().confirmed(law->force_N, latency_s);
  Eigen::Map<Eigen::VectorXd>(force_N, static_cast<Eigen::Index>(axes)) = law->force_N;
  return FB_OK;
}

fb_status fb_law_ledger(const fb_law* law, fb_ledger* ledger) {
  if (law == nullptr) return library::refused("fb_law_ledger", "law is null");
  const control::PassivityLaw& account = law->running.bounder().law();
  const control::ForceBounder::Counts& counts = law->running.bounder().counts();
  fb_ledger now{};
  now.energy_J = account.energy_J();
  now.share_credited = account.xi();
  now.requests_not_finite = counts.requests_not_finite;
  now.readings_not_finite = counts.readings_not_finite;
  now.readings_too_far = counts.readings_too_far;
  now.writes_failed = counts.writes_failed;
  now.effects_outside_facts = counts.effects_outside_facts;
  now.releases_outside_facts = counts.releases_outside_facts;
  now.intervals_impossible = counts.intervals_impossible;
  now.saturated = counts.saturated;
  now.forces_not_finite = counts.forces_not_finite;
  now.forces_withdrawn = counts.withdrawn;
  now.calls_refused = law->calls_refused;
  return library::give("fb_law_ledger", "fb_ledger", now, ledger, offsetof(fb_ledger, audited));
}
