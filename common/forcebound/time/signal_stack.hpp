#pragma once

#include <signal.h>

#include <array>
#include <cstddef>
#include <memory>

namespace forcebound::time {

/// A stack for the handlers of signals on this thread, so that too deep a recursion can be told of. To be made and
/// destroyed on that thread.
class SignalStack {
 public:
  SignalStack() : stack_(std::make_unique<std::array<std::byte, kBytes>>()) {
    stack_t stack{};
    stack.ss_sp = stack_->data();
    stack.ss_size = stack_->size();
    ::sigaltstack(&stack, &before_);
  }
  ~SignalStack() { ::sigaltstack(&before_, nullptr); }
  SignalStack(const SignalStack&) = delete;
  SignalStack& operator=(const SignalStack&) = delete;

 private:
  static constexpr std::size_t kBytes = std::size_t{1} << 16U;

  std::unique_ptr<std::array<std::byte, kBytes>> stack_;
  stack_t before_{};
};

}  // namespace forcebound::time
