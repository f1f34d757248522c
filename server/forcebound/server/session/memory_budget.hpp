#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <unordered_map>

namespace forcebound::server {

/// How much memory sessions may take.
struct MemoryLimits {
  std::size_t session_most = std::size_t{256} << 20U;  ///< of one session's environment [byte]
  std::size_t all_most = 0;                            ///< of the whole program [byte]; 0: no such limit
  /// What the program has allocated now [byte]; null: it is not known, and there are no limits. May take a millisecond.
  std::function<std::size_t()> in_use{};
};

/// Knows what an environment takes for a session, from the last one that was made, and who is not let in for that.
///
/// Memory that another thread takes or frees while an environment is made counts as the environment's. Not thread-safe.
class MemoryBudget {
 public:
  explicit MemoryBudget(MemoryLimits limits) : limits_(std::move(limits)) {}

  struct Refusal {
    bool for_now = true;  ///< with fewer sessions it would fit
    std::string text;     ///< what would be accepted; empty: it fits
  };

  /// Before an environment is made.
  [[nodiscard]] Refusal refusal_of(const std::string& scene) const;

  /// After it was made and is still there. @param before what `in_use` said before it was made
  [[nodiscard]] Refusal refusal_of_made(const std::string& scene, std::size_t before);

  /// Whether there are limits, so that it has to measure.
  [[nodiscard]] bool measures() const noexcept { return static_cast<bool>(limits_.in_use); }

  [[nodiscard]] std::size_t in_use() const { return limits_.in_use ? limits_.in_use() : 0; }

 private:
  [[nodiscard]] Refusal decide(const std::string& scene, std::size_t takes, std::size_t with_it) const;

  MemoryLimits limits_;
  std::unordered_map<std::string, std::size_t> takes_;  ///< by scene
};

}  // namespace forcebound::server
