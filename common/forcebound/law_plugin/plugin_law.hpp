#pragma once

#include <memory>
#include <string_view>

#include "forcebound/control/law_description.hpp"
#include "forcebound/driver/shared_library.hpp"
#include "forcebound/law_plugin/forcebound_law.h"

namespace forcebound::law_plugin {

using control::Vector;

/// How laws of forcebound_law.h are found and loaded.
inline constexpr driver::PluginKind kLaws{.name = "law",
                                          .prefix = "forcebound-law-",
                                          .folder = "laws",
                                          .entry = "forcebound_law_entry",
                                          .header = "forcebound_law.h"};

/// The library of a law, which stays open as long as this lives.
class LawLibrary {
 public:
  /// @throws std::runtime_error in one line: what the file is not, which interface it has, or who else may write it
  explicit LawLibrary(const std::string& file);

  /// Its functions. What a law of an older interface lacks is null.
  [[nodiscard]] const forcebound_law_functions& functions() const noexcept { return functions_; }
  [[nodiscard]] const std::string& file() const noexcept { return library_.file(); }

 private:
  driver::SharedLibrary library_;
  forcebound_law_functions functions_;
};

/// The law as others are: by its name, with its parameters and what it promises.
[[nodiscard]] control::LawDescription described(const std::shared_ptr<const LawLibrary>& library);

/// A law of forcebound_law.h at work.
///
/// A tick that fails, throws, or gives what is not finite gives NaN, of which control::ForceBounder makes zero force
/// and counts it (forces_not_finite). A force that takes effect later than the law was told is not allowed, and so
/// becomes zero there too.
///
/// Real time: what is noexcept allocates nothing, and takes as long as the law.
class PluginLaw final : public control::PassivityLaw {
 public:
  /// @throws std::invalid_argument in one line: what the law says about the device or its parameters
  PluginLaw(std::shared_ptr<const LawLibrary> library, const control::DeviceFacts& facts,
            const control::LawOptions& options);
  ~PluginLaw() override;
  PluginLaw(const PluginLaw&) = delete;
  PluginLaw& operator=(const PluginLaw&) = delete;

  [[nodiscard]] std::string_view name() const noexcept override { return library_->functions().name; }
  void credit(const control::Motion& motion) noexcept override;
  void lose(const control::Motion& motion) noexcept override;
  [[nodiscard]] Vector bound(const Vector& request_N) noexcept override;
  [[nodiscard]] bool allows(const Vector& /*force_N*/, double latency_s) const noexcept override {
    return latency_s <= reading_.latency_s_max;
  }
  void commit(const Vector& force_N) noexcept override;
  [[nodiscard]] double energy_J() const noexcept override { return energy_J_; }

 private:
  void store_times(const control::Motion& motion, bool lost) noexcept;

  std::shared_ptr<const LawLibrary> library_;
  forcebound_law* law_ = nullptr;
  forcebound_law_reading reading_{};
  Eigen::Index dof_;
  double energy_J_ = 0;
};

}  // namespace forcebound::law_plugin
