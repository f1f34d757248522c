#pragma once

#include <functional>
#include <memory>

#include "forcebound/client/session/view_sink.hpp"
#include "forcebound/view/assembly.hpp"

namespace forcebound::client {

/// Carries what the server tells of how the scene looks to the thread of a page. A full queue drops it: something newer
/// follows.
///
/// Real time: `on_view` is noexcept, allocates nothing and never waits. One thread calls it, one other thread `drain`.
class ViewTap final : public ViewSink {
 public:
  /// Pieces: of half a second.
  static constexpr std::size_t kCapacity = 160;

  ViewTap();
  ~ViewTap() override;

  void on_view(const wire::ViewPiece& piece) noexcept override;

  /// Calls `use` for each that waits, in their order.
  void drain(const std::function<void(const view::Assembly::Piece&)>& use);

 private:
  struct Queue;
  std::unique_ptr<Queue> queue_;
};

}  // namespace forcebound::client
