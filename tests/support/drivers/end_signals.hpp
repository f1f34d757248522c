#pragma once

#include <sys/signalfd.h>

#include <csignal>

namespace forcebound::test {

/// Takes SIGINT and SIGTERM from this thread and those that it makes: to be called before there are any, so that no
/// thread is ended by them. @returns a file descriptor that can be read once one has come; -1: there is none
[[nodiscard]] inline int end_signals() noexcept {
  sigset_t ends{};
  sigemptyset(&ends);
  sigaddset(&ends, SIGINT);
  sigaddset(&ends, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);
  return ::signalfd(-1, &ends, SFD_CLOEXEC);
}

}  // namespace forcebound::test
