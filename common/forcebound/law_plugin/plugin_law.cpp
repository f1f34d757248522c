#include "forcebound/law_plugin/plugin_law.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "forcebound/driver/crash.hpp"
#include "forcebound/text/numbers.hpp"
#include "forcebound/text/printable.hpp"

namespace forcebound::law_plugin {
namespace {

static_assert(control::kDofMax <= FORCEBOUND_LAW_AXES_MAX && control::kJointsMax <= FORCEBOUND_LAW_JOINTS_MAX);

constexpr const char* kKind = "law";

template <class Numbers>
void put(const Numbers& numbers, std::span<double> into) {
  std::copy_n(numbers.data(), numbers.size(), into.begin());
}

/// Row by row, as C has it.
void put_rows(const control::Matrix& matrix, std::span<double> into) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      into[static_cast<std::size_t>(row * matrix.cols() + column)] = matrix(row, column);
    }
  }
}

forcebound_law_facts told(const control::DeviceFacts& facts, control::EnergyMemory memory) {
  forcebound_law_facts told{};
  told.size = sizeof told;
  told.degrees_of_freedom = facts.degrees_of_freedom();
  told.rotations = facts.rotations;
  told.joints = facts.joints();
  told.cartesian = facts.cartesian ? 1 : 0;
  told.full_memory = memory == control::EnergyMemory::full ? 1 : 0;
  facts.name.copy(told.name, sizeof told.name - 1);
  told.period_s = facts.period_s;
  put_rows(facts.damping, told.damping);
  put(facts.friction, told.friction);
  put(facts.encoder_step, told.encoder_step);
  put(facts.actuator_step, told.actuator_step);
  put(facts.speed_max, told.speed_max);
  told.force_N_max = facts.force_N_max;
  told.torque_N_m_max = facts.torque_N_m_max;
  told.hold_s_max = facts.releases ? facts.hold_s_max : 0;
  told.latency_s = facts.latency_s;
  return told;
}

bool is_name(const char* name) {
  if (name == nullptr || *name == 0) return false;
  return std::ranges::all_of(std::string_view(name), [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '-';
  });
}

std::span<const forcebound_law_parameter> parameters_of(const forcebound_law_functions& functions) {
  return {functions.parameters, functions.parameters == nullptr ? 0 : functions.parameter_count};
}

std::string text_of(const char* text) { return text == nullptr ? std::string() : text::printable(text); }

control::LawParameter parameter_of(const forcebound_law_parameter& parameter) {
  return {.name = parameter.name,
          .purpose = text_of(parameter.purpose),
          .least = parameter.least,
          .most = parameter.most,
          .standard = [standard = parameter.standard](const control::DeviceFacts&) { return standard; }};
}

void expect_good_parameters(const driver::SharedLibrary& library, const forcebound_law_functions& functions) {
  for (const forcebound_law_parameter& parameter : parameters_of(functions)) {
    if (parameter.name == nullptr || *parameter.name == 0) library.refuse("has a parameter without a name");
    if (std::isfinite(parameter.least) && std::isfinite(parameter.most) && parameter.least <= parameter.standard &&
        parameter.standard <= parameter.most) {
      continue;
    }
    library.refuse("its parameter '" + text_of(parameter.name) + "' must be standard from least to most, got " +
                   text::to_text(parameter.standard) + " from " + text::to_text(parameter.least) + " to " +
                   text::to_text(parameter.most));
  }
}

forcebound_law_functions functions_of(const driver::SharedLibrary& library) {
  const auto& table = library.table<forcebound_law_functions>(FORCEBOUND_LAW_INTERFACE);
  forcebound_law_functions functions{};
  std::memcpy(&functions, &table, std::min<std::size_t>(table.size, sizeof functions));
  library.expect_function(functions.create != nullptr, "create");
  library.expect_function(functions.tick != nullptr, "tick");
  library.expect_function(functions.destroy != nullptr, "destroy");
  if (!is_name(functions.name)) {
    library.refuse("its name must be of small letters, digits and '-', got '" + text_of(functions.name) + "'");
  }
  if (functions.promise < FORCEBOUND_LAW_PROMISES_NOTHING || functions.promise > FORCEBOUND_LAW_PASSIVE) {
    library.refuse("its promise must be 0 to 2, got " + std::to_string(functions.promise));
  }
  expect_good_parameters(library, functions);
  return functions;
}

}  // namespace

LawLibrary::LawLibrary(const std::string& file) : library_(kLaws, file), functions_(functions_of(library_)) {}

control::LawDescription described(const std::shared_ptr<const LawLibrary>& library) {
  const forcebound_law_functions& functions = library->functions();
  std::vector<control::LawParameter> parameters;
  for (const forcebound_law_parameter& parameter : parameters_of(functions)) {
    parameters.push_back(parameter_of(parameter));
  }
  return {.name = functions.name,
          .summary = functions.summary == nullptr ? "a law of " + library->file() : text_of(functions.summary),
          .reference = text_of(functions.reference),
          .claim = static_cast<control::LawClaim>(functions.promise),
          .shortens = functions.shortens != 0,
          .parameters = std::move(parameters),
          .make = [library](const control::DeviceFacts& facts, const control::LawOptions& options) {
            return std::make_unique<PluginLaw>(library, facts, options);
          }};
}

PluginLaw::PluginLaw(std::shared_ptr<const LawLibrary> library, const control::DeviceFacts& facts,
                     const control::LawOptions& options)
    : library_(std::move(library)), dof_(facts.degrees_of_freedom()) {
  const forcebound_law_functions& functions = library_->functions();
  std::vector<double> numbers;
  for (const forcebound_law_parameter& parameter : parameters_of(functions)) {
    numbers.push_back(options.parameters.at(parameter.name));
  }
  const forcebound_law_facts facts_told = told(facts, options.memory);
  std::array<char, FORCEBOUND_LAW_TEXT_BYTES> error{};
  int result = FORCEBOUND_LAW_FAILED;
  std::string why;
  try {
    const driver::CallInProgress in_progress(functions.name, "create", kKind);
    result = functions.create(&facts_told, numbers.data(), &law_, error.data(), error.size());
    error.back() = 0;
    why = error.data();
  } catch (const std::exception& thrown) {
    why = thrown.what();
  } catch (...) {
    why = "threw an exception";
  }
  if (result == FORCEBOUND_LAW_OK && law_ != nullptr) {
    reading_.size = sizeof reading_;
    return;
  }
  if (why.empty()) why = "failed without a reason";
  throw std::invalid_argument("law '" + std::string(functions.name) + "': " + text::printable(why));
}

PluginLaw::~PluginLaw() {
  const driver::CallInProgress in_progress(library_->functions().name, "destroy", kKind);
  try {
    library_->functions().destroy(law_);
  } catch (...) {  // it is gone all the same
  }
}

void PluginLaw::store_times(const control::Motion& motion, bool lost) noexcept {
  reading_.has = (lost ? FORCEBOUND_LAW_LOST : 0U) | (motion.write_failed ? FORCEBOUND_LAW_WRITE_FAILED : 0U);
  reading_.interval_s = motion.interval_s;
  reading_.latency_s = motion.latency_s;
  reading_.effect_s = motion.effect_s;
  reading_.held_s = motion.held_s;
  reading_.latency_s_max = motion.latency_s_max;
}

void PluginLaw::credit(const control::Motion& motion) noexcept {
  store_times(motion, false);
  put(motion.position, reading_.position);
  put(motion.joint, reading_.joint);
  put_rows(motion.jacobian, reading_.jacobian);
  if (motion.damping != nullptr) put_rows(motion.damping->matrix(), reading_.damping);
}

void PluginLaw::lose(const control::Motion& motion) noexcept {
  store_times(motion, true);
  (void)bound(Vector::Zero(dof_));
}

Vector PluginLaw::bound(const Vector& request_N) noexcept {
  const forcebound_law_functions& functions = library_->functions();
  forcebound_law_request request{};
  request.size = sizeof request;
  put(request_N, request.force_N);
  forcebound_law_force force{};
  force.size = sizeof force;
  try {
    const driver::CallInProgress in_progress(functions.name, "tick", kKind);
    if (functions.tick(law_, &reading_, &request, &force) == FORCEBOUND_LAW_OK) {
      if (std::isfinite(force.energy_J)) energy_J_ = force.energy_J;
      return Eigen::Map<const Eigen::VectorXd>(force.force_N, dof_);
    }
  } catch (...) {  // as one that fails
  }
  return Vector::Constant(dof_, std::numeric_limits<double>::quiet_NaN());
}

void PluginLaw::commit(const Vector& force_N) noexcept { put(force_N, reading_.held_N); }

}  // namespace forcebound::law_plugin
