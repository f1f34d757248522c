#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace forcebound::lab {

using Work = std::vector<std::function<void()>>;

/// Runs pieces of work on every processor.
class Workers {
 public:
  /// @param progress is told how many pieces of all that are expected are done; it must outlive the workers
  explicit Workers(const std::function<void(std::size_t, std::size_t)>& progress) : progress_(progress) {}

  void expect(std::size_t pieces) { all_ += pieces; }

  /// Rethrows the first exception.
  void work_off(const Work& work) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    {
      std::vector<std::jthread> workers;
      for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
        workers.emplace_back([&] {
          for (std::size_t piece = next++; piece < work.size(); piece = next++) {
            try {
              work[piece]();
            } catch (...) {
              const std::scoped_lock lock(mutex_);
              if (!failure) failure = std::current_exception();
              next = work.size();
            }
            const std::scoped_lock lock(mutex_);
            progress_(++done_, all_);
          }
        });
      }
    }
    if (failure) std::rethrow_exception(failure);
  }

 private:
  const std::function<void(std::size_t, std::size_t)>& progress_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::size_t all_ = 0;
};

}  // namespace forcebound::lab
