#pragma once

#include <memory>
#include <string>

#include "forcebound/server/offer/environment.hpp"
#include "library/forcebound.h"
#include "library/source/callback_counts.hpp"

namespace forcebound::library {

/// A program's callbacks, and the texts of its struct.
struct EnvironmentCallbacks {
  explicit EnvironmentCallbacks(const fb_environment& given);

  fb_environment table;
  std::string name;
  std::string simulated;
  CallbackCounts calls{};
};

/// The environment of one client by a program's callbacks. One that fails, throws or gives what is not finite is an
/// unsound answer: the server sends zero force, and counts it. One that is late is answered late, and counted.
class CallbackEnvironment final : public server::Environment {
 public:
  /// @throws std::runtime_error if `create` does not
  CallbackEnvironment(std::shared_ptr<EnvironmentCallbacks> callbacks, const server::ClientFacts& client);
  ~CallbackEnvironment() override;
  CallbackEnvironment(const CallbackEnvironment&) = delete;
  CallbackEnvironment& operator=(const CallbackEnvironment&) = delete;

  [[nodiscard]] server::Answer respond(const server::Motion& motion) noexcept override;

 private:
  std::shared_ptr<EnvironmentCallbacks> callbacks_;
  void* own_;
};

[[nodiscard]] server::EnvironmentKind kind_of(const std::shared_ptr<EnvironmentCallbacks>& callbacks);

}  // namespace forcebound::library
