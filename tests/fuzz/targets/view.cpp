#include <nlohmann/json.hpp>
#include <string>

#include "forcebound/view/assembly.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {
namespace {

constexpr std::uint64_t kSession = 1;

void must_be_json(const std::string& text) {
  must(text.empty() || nlohmann::json::accept(text), "a message that no page can read");
}

/// A description, its hash made right, in pieces.
void describe(std::string_view text, view::Assembly& assembly) {
  const view::Description description{.text = std::string(text), .hash = view::hash_of(text)};
  for (std::uint32_t number = 0; number < description.pieces(); ++number) {
    (void)assembly.add({.session = kSession,
                        .view = description.hash,
                        .pieces = description.pieces(),
                        .number = number,
                        .content = description.piece(number)});
  }
  if (assembly.scene()) must_be_json(view::scene_message(0, assembly.scene()->shown));
}

}  // namespace

// Two bytes: how long the description is, which follows; then movements, each with its group, first item and content.
void fuzz_view(Bytes bytes) {
  constexpr int kMovementsMost = 64;
  Script script(bytes);
  const Bytes text = script.take(script.value<std::uint16_t>());
  view::Assembly assembly;
  describe(text_of(text), assembly);
  for (int i = 0; i < kMovementsMost && !script.ended(); ++i) {
    view::Assembly::Piece piece{.session = kSession, .view = view::hash_of(text_of(text))};
    piece.pieces = script.byte() % 3;
    piece.number = script.byte();
    piece.first = script.value<std::uint16_t>();
    piece.content = script.take(script.byte());
    (void)assembly.add(piece);
    must_be_json(assembly.take_moved(0));
  }
}

}  // namespace forcebound::fuzz
