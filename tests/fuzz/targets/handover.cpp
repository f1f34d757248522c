#include "forcebound/handover/scene_assembly.hpp"
#include "tests/fuzz/input.hpp"

namespace forcebound::fuzz {

// First two bytes: the manifest's length, as far as there are so many bytes; the rest are further pieces. The hash that
// is announced is the manifest's, so that it is read whatever it is.
void fuzz_handover(Bytes bytes) {
  Script script(bytes);
  const std::size_t manifest_bytes = script.value<std::uint16_t>();
  const Bytes manifest = script.take(manifest_bytes);
  const Bytes content = bytes.subspan(std::min<std::size_t>(bytes.size(), 2));
  const std::size_t others =
      (content.size() - manifest.size() + handover::kPieceBytesMax - 1) / handover::kPieceBytesMax;
  const handover::Announcement announcement{.hash = handover::hash_of(manifest),
                                            .manifest_bytes = manifest.size(),
                                            .pieces = handover::manifest_pieces(manifest.size()) + others};
  const handover::Limits limits{
      .triangles = 1000, .heights = 1000, .shape_bytes = 1U << 20U, .nodes_of_a_build = 100'000};
  may_refuse([&] {
    handover::SceneAssembly assembly(announcement, scene::Registry::standard(), limits);
    for (std::size_t piece = 0; piece < handover::manifest_pieces(manifest.size()); ++piece) {
      const std::size_t begin = piece * handover::kPieceBytesMax;
      assembly.add(piece, manifest.subspan(begin, std::min(handover::kPieceBytesMax, manifest.size() - begin)));
    }
    must(assembly.can_build(), "the manifest is there, but nothing can be built");
    (void)assembly.build();
    for (std::size_t piece = assembly.pieces_here(); piece < announcement.pieces; ++piece) {
      assembly.add(piece, script.take(handover::kPieceBytesMax));
    }
    (void)assembly.build();
  });
  may_refuse([&] {
    handover::SceneAssembly assembly(announcement, scene::Registry::standard(), limits);
    assembly.add_content(content);
    (void)assembly.build();
  });
}

}  // namespace forcebound::fuzz
