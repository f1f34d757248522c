#include <gmock/gmock.h>

#include "tests/unit/handover/handed_over.hpp"

// A mesh of so many pieces that their hashes travel in lists.

namespace forcebound::handover {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

const Point kTop_m(0, 0, 0.05);

class AListedMesh : public ::testing::Test {
 protected:
  static const PackedScene& packed() {
    static const std::shared_ptr<const PackedScene> kPacked = pack(*scene());
    return *kPacked;
  }
  static const std::shared_ptr<const Scene>& scene() {
    static const std::shared_ptr<const Scene> kScene = mesh_scene(test::ball(kTop_m.z(), 120));
    return kScene;
  }
  static std::size_t of_manifest() { return manifest_pieces(packed().announcement().manifest_bytes); }
  static v1::SceneManifest manifest() {
    std::string bytes;
    for (std::size_t i = 0; i < of_manifest(); ++i) {
      const auto piece = packed().piece(i);
      bytes.append(reinterpret_cast<const char*>(piece.data()), piece.size());
    }
    v1::SceneManifest read;
    EXPECT_TRUE(read.ParseFromString(bytes));
    return read;
  }
  static std::size_t lists() { return manifest().geometries(0).hashes().size() / 8; }

  /// What is said of the pieces behind a changed manifest, and of the first list if it is changed.
  static std::string refusal_of_lists(const v1::SceneManifest& changed, const std::string& first_list = {}) {
    const std::string bytes = changed.SerializeAsString();
    const auto raw = std::as_bytes(std::span(bytes));
    const std::size_t pieces = manifest_pieces(raw.size());
    const std::size_t others = packed().announcement().pieces - of_manifest();
    return refusal_of([&] {
      SceneAssembly assembly({.hash = hash_of(raw), .manifest_bytes = raw.size(), .pieces = pieces + others},
                             scene::Registry::standard());
      for (std::size_t i = 0; i < pieces; ++i) {
        const std::size_t begin = i * kPieceBytesMax;
        assembly.add(i, raw.subspan(begin, std::min(kPieceBytesMax, raw.size() - begin)));
      }
      for (std::size_t i = 0; i < others; ++i) {
        const bool is_changed = i == 0 && !first_list.empty();
        assembly.add(pieces + i, is_changed ? std::as_bytes(std::span(first_list)) : packed().piece(of_manifest() + i));
      }
      (void)assembly.build();
    });
  }
  /// With the hash that agrees.
  static std::string refusal_of_first_list(const std::function<void(v1::PieceList&)>& change) {
    const auto piece = packed().piece(of_manifest());
    v1::PieceList list;
    EXPECT_TRUE(list.ParseFromArray(piece.data(), static_cast<int>(piece.size())));
    change(list);
    const std::string changed = list.SerializeAsString();
    const Hash hash = hash_of(std::as_bytes(std::span(changed)));
    v1::SceneManifest with_hash = manifest();
    with_hash.mutable_geometries(0)->mutable_hashes()->replace(0, 8, reinterpret_cast<const char*>(hash.data()), 8);
    return refusal_of_lists(with_hash, changed);
  }
};

TEST_F(AListedMesh, HasAManifestOfFewPieces) {
  ASSERT_GT(packed().announcement().pieces, 600U);
  EXPECT_LE(25 * of_manifest(), packed().announcement().pieces / 10);
  EXPECT_GT(lists(), 10U);
}

TEST_F(AListedMesh, IsMadeAgainToTheBitWhateverOvertakesItsLists) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    SceneAssembly assembly = assembled(packed(), seed);
    ASSERT_TRUE(assembly.whole());
    SceneAssembly again = assembly_of(packed());
    again.add_content(assembly.content());
    ASSERT_TRUE(again.whole());
    for (SceneAssembly* const one : {&assembly, &again}) {
      scene::SceneState there(one->build().scene, 3);
      scene::SceneState here(scene(), 3);
      for (int i = 0; i < 40; ++i) {
        const Vector position = Point(1e-3, 0, 0.052 - 1e-4 * i);
        ASSERT_EQ(there.answer(position, i * 1ms).force, here.answer(position, i * 1ms).force) << seed << ' ' << i;
      }
    }
  }
}

TEST_F(AListedMesh, IsKnownNearADeviceBeforeItsOtherListsHaveArrived) {
  SceneAssembly assembly = assembly_of(packed());
  std::size_t lists_taken = 0;
  for (std::size_t i = 0; i < packed().announcement().pieces; ++i) {
    if (i >= of_manifest() && packed().where_m(i).exteriorDistance(kTop_m) > 0.01) continue;
    lists_taken += i >= of_manifest() && i < of_manifest() + lists() ? 1 : 0;
    assembly.add(i, packed().piece(i));
  }
  EXPECT_GT(lists_taken, 0U);
  EXPECT_LT(lists_taken, lists());
  EXPECT_GT(assembly.known_within_m(kTop_m), 0.0099);
  EXPECT_EQ(assembly.known_within_m(-kTop_m), 0);
}

TEST_F(AListedMesh, RefusesAListThatWasTamperedWith) {
  std::string list(packed().piece(of_manifest()).size(), 'x');
  EXPECT_THAT(refusal_of_lists(manifest(), list), HasSubstr("another hash than the manifest says"));
}

TEST_F(AListedMesh, RefusesListsOfAServerThatLies) {
  EXPECT_EQ(refusal_of_first_list([](v1::PieceList&) {}), "accepted");
  EXPECT_THAT(refusal_of_first_list([](v1::PieceList& list) { list.mutable_hashes()->pop_back(); }),
              HasSubstr("another length than the manifest says"));
  EXPECT_THAT(refusal_of_first_list([](v1::PieceList& list) { list.clear_boxes(); }),
              HasSubstr("another length than the manifest says"));
  EXPECT_THAT(refusal_of_first_list([](v1::PieceList& list) { list.mutable_hashes()->front() ^= 1; }),
              HasSubstr("another hash than the manifest says"));
  EXPECT_THAT(refusal_of_first_list([](v1::PieceList& list) {
                std::ranges::fill(list.mutable_boxes()->begin(), list.mutable_boxes()->begin() + 6, '\0');
                std::ranges::fill(list.mutable_boxes()->begin() + 6, list.mutable_boxes()->begin() + 12, '\xFF');
              }),
              HasSubstr("outside of its box"));
}

TEST_F(AListedMesh, RefusesAManifestOfMoreOrFewerPiecesThanItsLists) {
  for (const std::uint32_t listed : {1U, 1'000'000U, 4'000'000'000U}) {
    v1::SceneManifest changed = manifest();
    changed.mutable_geometries(0)->set_listed(listed);
    EXPECT_THAT(refusal_of_lists(changed), HasSubstr("contradicts itself")) << listed;
  }
}

}  // namespace
}  // namespace forcebound::handover
