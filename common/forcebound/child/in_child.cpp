#include "forcebound/child/in_child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include "forcebound/text/file.hpp"
#include "forcebound/text/lines.hpp"
#include "forcebound/text/numbers.hpp"

namespace forcebound::child {
namespace {

using Deadline = std::chrono::steady_clock::time_point;

/// The first byte of what a child sends.
constexpr char kAnswer = 'a';
constexpr char kError = 'e';
constexpr char kNoMemory = 'm';

void limit_to(int resource, std::size_t most) noexcept {
  ::rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max = std::min<::rlim_t>(most, limit.rlim_max);
  ::setrlimit(resource, &limit);
}

/// This process's data, as the limit on it counts it; 0: not known.
std::size_t data_bytes() {
  constexpr std::size_t kDataField = 5;
  const std::string numbers = text::read_file("/proc/self/statm");
  const std::vector<std::string_view> pages = text::split_at_blanks(numbers);
  const long page_bytes = ::sysconf(_SC_PAGESIZE);
  if (pages.size() <= kDataField || page_bytes <= 0) return 0;
  return text::whole_number<std::size_t>(pages[kDataField]).value_or(0) * static_cast<std::size_t>(page_bytes);
}

void send_all(int to, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t sent = ::write(to, bytes.data(), bytes.size());
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

struct Ends {
  int read = -1;
  int write = -1;
};

/// The child's part. Never returns.
[[noreturn]] void answer(const std::function<std::string()>& work, const ChildLimits& limits, std::size_t data_most,
                         const Ends& pipe) {
  ::close(pipe.read);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Not the parent's handlers, nor its priority.
  for (const int number : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(number, SIG_DFL);
  const ::sched_param ordinary{};
  ::sched_setscheduler(0, SCHED_OTHER, &ordinary);
  limit_to(RLIMIT_CORE, 0);
  if (!limits.opens_files) {
    limit_to(RLIMIT_FSIZE, 0);
    limit_to(RLIMIT_NOFILE, 0);  // what is open stays so
  }
  limit_to(RLIMIT_CPU, 1 + static_cast<std::size_t>(limits.time.count()) / 1000);
  if (kLimitsMemoryOfChildren && data_most > 0) limit_to(RLIMIT_DATA, data_most);
  try {
    const std::string result = work();
    send_all(pipe.write, {&kAnswer, 1});
    send_all(pipe.write, result);
  } catch (const std::bad_alloc&) {
    send_all(pipe.write, {&kNoMemory, 1});
  } catch (const std::exception& error) {
    send_all(pipe.write, {&kError, 1});
    send_all(pipe.write, error.what());
  } catch (...) {
    send_all(pipe.write, {&kError, 1});
  }
  ::_exit(0);
}

/// A child process; it does not outlive this.
class Child {
 public:
  Child(const std::function<std::string()>& work, const ChildLimits& limits) {
    const std::size_t data = kLimitsMemoryOfChildren ? data_bytes() : 0;
    // Another thread's child must not keep the end of our pipe open.
    static std::mutex guard;
    std::unique_lock lock(guard);
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "no pipe");
    const Ends pipe{.read = ends[0], .write = ends[1]};
    pid_ = ::fork();
    if (pid_ == 0) lock.unlock();  // the child's work may have children of its own
    if (pid_ == 0) answer(work, limits, data == 0 ? 0 : data + limits.memory_bytes, pipe);
    const int error = errno;
    ::close(pipe.write);
    from_ = pipe.read;
    if (pid_ > 0) return;
    ::close(from_);
    throw std::system_error(error, std::generic_category(), "no child process");
  }
  ~Child() {
    ::close(from_);
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    (void)wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// All that it sends until it closes its end. @throws std::runtime_error
  [[nodiscard]] std::string read_all(const ChildLimits& limits) const {
    const Deadline deadline = std::chrono::steady_clock::now() + limits.time;
    std::string all;
    std::array<char, 1 << 16> part{};
    while (true) {
      if (!readable_by(deadline)) {
        throw std::runtime_error("takes longer than " + text::to_text(1e-3 * static_cast<double>(limits.time.count())) +
                                 " s: expected less");
      }
      const ssize_t bytes = ::read(from_, part.data(), part.size());
      if (bytes == 0) return all;
      if (bytes < 0 && errno == EINTR) continue;
      if (bytes < 0) throw std::system_error(errno, std::generic_category(), "a child process cannot be heard");
      all.append(part.data(), static_cast<std::size_t>(bytes));
      if (all.size() <= limits.answer_bytes) continue;
      throw std::runtime_error("gives more than " + std::to_string(limits.answer_bytes) + " bytes: expected less");
    }
  }

  /// Waits for its end. @returns its status as waitpid tells it, 0 if that is not known
  int wait() noexcept {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0) {
      if (errno == EINTR) continue;
      status = 0;
      break;
    }
    pid_ = -1;
    return status;
  }

 private:
  [[nodiscard]] bool readable_by(Deadline deadline) const {
    while (true) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      if (left.count() <= 0) return false;
      ::pollfd polled{.fd = from_, .events = POLLIN, .revents = 0};
      const int ready = ::poll(&polled, 1, static_cast<int>(left.count()));
      if (ready > 0) return true;
      if (ready < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "no wait for a child");
    }
  }

  pid_t pid_ = -1;
  int from_ = -1;
};

std::string no_memory(const ChildLimits& limits) {
  return "needs more than " + std::to_string(limits.memory_bytes >> 20U) + " MiB of memory: expected less";
}

}  // namespace

std::string in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  Child child(work, limits);
  std::string output = child.read_all(limits);
  const int status = child.wait();
  if (output.empty() || WIFSIGNALED(status)) {
    const char* const signal = WIFSIGNALED(status) ? ::strsignal(WTERMSIG(status)) : "no answer";
    throw std::runtime_error("ends the process that does it: " + std::string(signal));
  }
  const char kind = output.front();
  output.erase(0, 1);
  if (kind == kNoMemory) throw std::runtime_error(no_memory(limits));
  if (kind != kAnswer) throw std::runtime_error(output.empty() ? "fails" : output);
  return output;
}

}  // namespace forcebound::child
