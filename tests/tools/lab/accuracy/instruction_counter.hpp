#pragma once

#include <cstdint>
#include <optional>

namespace forcebound::lab {

/// Counts this thread's instructions outside of the kernel, if the kernel permits it: in containers and virtual
/// machines it often does not.
class InstructionCounter {
 public:
  InstructionCounter() noexcept;
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  /// So far; none: they cannot be counted here.
  [[nodiscard]] std::optional<std::uint64_t> count() const noexcept;

 private:
  int file_;
};

}  // namespace forcebound::lab
