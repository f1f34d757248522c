#include "forcebound/client/page/view_tap.hpp"

#include <algorithm>
#include <array>
#include <boost/lockfree/spsc_queue.hpp>

namespace forcebound::client {

struct ViewTap::Queue {
  struct Kept {
    view::Assembly::Piece piece;  // without its content
    std::size_t bytes = 0;
    std::array<std::byte, view::kPieceBytes> content;
  };

  Queue() : kept(kCapacity) {
    // Touched here, not in the tick: the first use of a page of memory costs a fault.
    while (kept.push(Kept{})) {
    }
    kept.consume_all([](const Kept&) {});
  }
  boost::lockfree::spsc_queue<Kept> kept;
};

ViewTap::ViewTap() : queue_(std::make_unique<Queue>()) {}
ViewTap::~ViewTap() = default;

void ViewTap::on_view(const wire::ViewPiece& piece) noexcept {
  Queue::Kept kept;
  if (piece.content.size() > kept.content.size()) return;
  kept.piece = {.session = piece.session,
                .view = piece.view,
                .pieces = piece.pieces,
                .number = piece.number,
                .first = piece.first};
  kept.bytes = piece.content.size();
  std::ranges::copy(piece.content, kept.content.begin());
  (void)queue_->kept.push(kept);
}

void ViewTap::drain(const std::function<void(const view::Assembly::Piece&)>& use) {
  queue_->kept.consume_all([&use](const Queue::Kept& kept) {
    view::Assembly::Piece piece = kept.piece;
    piece.content = std::span(kept.content).first(kept.bytes);
    use(piece);
  });
}

}  // namespace forcebound::client
