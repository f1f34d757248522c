#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>

#include "forcebound/text/file.hpp"
#include "forcebound/v1/handover.pb.h"
#include "tests/tools/temporary_folder.hpp"
#include "tests/unit/handover/handed_over.hpp"

// Manifests of a server that lies, with a hash that agrees.

namespace forcebound::handover {
namespace {

using testing::HasSubstr;

v1::SceneManifest with_object(const std::string& kind) {
  v1::SceneManifest manifest;
  manifest.set_name("hostile");
  manifest.set_degrees_of_freedom(3);
  v1::ScenePart* const object = manifest.add_objects();
  object->set_name("object");
  object->set_shape(kind);
  v1::SceneEffect* const surface = object->add_effects();
  surface->set_name("surface");
  v1::NamedValue* const stiffness = surface->add_values();
  stiffness->set_key("stiffness_N_per_m");
  stiffness->set_number(1000);
  return manifest;
}

v1::NamedValue* value(v1::SceneManifest& manifest, const std::string& key) {
  v1::NamedValue* const added = manifest.mutable_objects(0)->add_shape_values();
  added->set_key(key);
  return added;
}

v1::SceneManifest with_sphere(double radius_m) {
  v1::SceneManifest manifest = with_object("sphere");
  value(manifest, "center_m")->mutable_point();
  value(manifest, "radius_m")->set_number(radius_m);
  return manifest;
}

/// What an assembly says of it, all pieces and the building included.
std::string refusal_of_manifest(const v1::SceneManifest& manifest, std::size_t geometry_pieces = 0) {
  const std::string bytes = manifest.SerializeAsString();
  const auto raw = std::as_bytes(std::span(bytes));
  const std::size_t pieces = manifest_pieces(raw.size());
  return refusal_of([&] {
    SceneAssembly assembly({.hash = hash_of(raw), .manifest_bytes = raw.size(), .pieces = pieces + geometry_pieces},
                           scene::Registry::standard());
    for (std::size_t i = 0; i < pieces; ++i) {
      const std::size_t begin = i * kPieceBytesMax;
      assembly.add(i, raw.subspan(begin, std::min(kPieceBytesMax, raw.size() - begin)));
    }
    (void)assembly.build();
  });
}

TEST(AHostileManifest, IsAcceptedIfItIsSound) { EXPECT_EQ(refusal_of_manifest(with_sphere(0.02)), "accepted"); }

TEST(AHostileManifest, IsHeldToWhatASceneFileIsHeldTo) {
  EXPECT_EQ(refusal_of_manifest(with_sphere(-1)), "radius_m must be > 0 and <= 1000, got -1");
  EXPECT_EQ(refusal_of_manifest(with_sphere(std::nan(""))), "radius_m must be a finite number, got nan");
  EXPECT_THAT(refusal_of_manifest(with_object("blob")), HasSubstr("unknown kind 'blob'"));

  v1::SceneManifest lacking = with_object("sphere");
  EXPECT_THAT(refusal_of_manifest(lacking), HasSubstr("is missing"));
  v1::SceneManifest of_another_type = with_object("sphere");
  value(of_another_type, "center_m")->mutable_point();
  value(of_another_type, "radius_m")->set_text("wide");
  EXPECT_THAT(refusal_of_manifest(of_another_type),
              HasSubstr("radius_m must be > 0 and <= 1000, got a value of another type"));

  v1::SceneManifest twice = with_sphere(0.02);
  *twice.mutable_objects(0)->add_effects() = twice.objects(0).effects(0);
  EXPECT_THAT(refusal_of_manifest(twice), HasSubstr("asked for twice"));
  v1::SceneManifest unknown = with_sphere(0.02);
  unknown.mutable_objects(0)->mutable_effects(0)->set_name("wi\nnd");
  EXPECT_THAT(refusal_of_manifest(unknown), HasSubstr("unknown effect 'wi?nd'"));
}

TEST(AHostileManifest, GetsNoFileOfThisMachineRead) {
  const test::TemporaryFolder folder;
  text::write_file(folder.file("secret.csv"), "0,0\n0,0\n");
  v1::SceneManifest relief = with_object("height_field");
  value(relief, "origin_m")->mutable_point();
  value(relief, "spacing_m")->set_number(0.01);
  value(relief, "file")->set_text(folder.file("secret.csv"));
  EXPECT_EQ(refusal_of_manifest(relief), "object 'object': a height_field needs a geometry");
  v1::SceneManifest mesh = with_object("mesh");
  value(mesh, "file")->set_text("/dev/zero");
  EXPECT_EQ(refusal_of_manifest(mesh), "object 'object': a mesh needs a geometry");
}

/// Of so many flat heights in one piece.
void add_heights(v1::SceneManifest& manifest, double spacing_m) {
  v1::Geometry* const geometry = manifest.add_geometries();
  geometry->mutable_origin();
  geometry->set_spacing(spacing_m);
  geometry->set_columns(2);
  geometry->set_rows(2);
  geometry->set_hashes(std::string(8, 'x'));
}

TEST(AHostileManifest, GetsNoGeometryUsedByAShapeThatHasNoneNorTwice) {
  v1::SceneManifest sphere = with_sphere(0.02);
  add_heights(sphere, 0.01);
  sphere.mutable_objects(0)->set_geometry(1);
  EXPECT_EQ(refusal_of_manifest(sphere, 1), "object 'object': a sphere has no geometry");

  v1::SceneManifest shared = with_object("height_field");
  add_heights(shared, 0.01);
  shared.mutable_objects(0)->set_geometry(1);
  *shared.add_objects() = shared.objects(0);
  EXPECT_THAT(refusal_of_manifest(shared, 1), HasSubstr("refers to the geometry of another part"));

  v1::SceneManifest none = with_object("height_field");
  none.mutable_objects(0)->set_geometry(1);
  EXPECT_THAT(refusal_of_manifest(none), HasSubstr("refers to a geometry that the manifest lacks"));
}

TEST(AHostileManifest, GetsNoPieceTakenThatLiesOutsideOfItsBox) {
  const auto packed = pack(*mesh_scene(test::ball(0.03, 20)));
  const std::size_t of_manifest = manifest_pieces(packed->announcement().manifest_bytes);
  std::string bytes;
  for (std::size_t i = 0; i < of_manifest; ++i) {
    const auto piece = packed->piece(i);
    bytes.append(reinterpret_cast<const char*>(piece.data()), piece.size());
  }
  v1::SceneManifest manifest;
  ASSERT_TRUE(manifest.ParseFromString(bytes));
  const auto taken = [&] {
    const std::string changed = manifest.SerializeAsString();
    const auto raw = std::as_bytes(std::span(changed));
    return refusal_of([&] {
      SceneAssembly assembly(
          {.hash = hash_of(raw), .manifest_bytes = raw.size(), .pieces = packed->announcement().pieces},
          scene::Registry::standard());
      for (std::size_t i = 0; i < of_manifest; ++i) {
        const std::size_t begin = i * kPieceBytesMax;
        assembly.add(i, raw.subspan(begin, std::min(kPieceBytesMax, raw.size() - begin)));
      }
      assembly.add(of_manifest, packed->piece(of_manifest));
    });
  };
  EXPECT_EQ(taken(), "accepted");
  std::string& boxes = *manifest.mutable_geometries(0)->mutable_boxes();
  std::ranges::fill(boxes, '\0');
  EXPECT_EQ(taken(), "a piece of a mesh lies outside of its box");
}

TEST(AHostileManifest, GetsNoHeightsWithoutASpacing) {
  for (const double spacing_m : {0.0, -1.0, std::nan(""), 1e300}) {
    v1::SceneManifest relief = with_object("height_field");
    add_heights(relief, spacing_m);
    relief.mutable_objects(0)->set_geometry(1);
    EXPECT_THAT(refusal_of_manifest(relief, 1), HasSubstr("height field of the manifest")) << spacing_m;
  }
}

TEST(AHostileManifest, GetsNoHeightsThatLieNowhere) {
  for (const auto set : {&v1::PointValue::set_x, &v1::PointValue::set_y, &v1::PointValue::set_z}) {
    for (const double nowhere_m : {std::nan(""), HUGE_VAL, 2e6}) {
      v1::SceneManifest relief = with_object("height_field");
      add_heights(relief, 0.01);
      (relief.mutable_geometries(0)->mutable_origin()->*set)(nowhere_m);
      relief.mutable_objects(0)->set_geometry(1);
      EXPECT_THAT(refusal_of_manifest(relief, 1), HasSubstr("height field of the manifest")) << nowhere_m;
    }
  }
}

/// What is said of a large mesh whose manifest a server changed.
std::string refusal_of_a_large_mesh(const std::function<void(v1::SceneManifest&)>& change) {
  static const auto kPacked = pack(*mesh_scene(test::ball(0.03, 50)));
  const std::size_t of_manifest = manifest_pieces(kPacked->announcement().manifest_bytes);
  std::string bytes;
  for (std::size_t i = 0; i < of_manifest; ++i) {
    const auto piece = kPacked->piece(i);
    bytes.append(reinterpret_cast<const char*>(piece.data()), piece.size());
  }
  v1::SceneManifest manifest;
  EXPECT_TRUE(manifest.ParseFromString(bytes));
  EXPECT_EQ(manifest.geometries_size(), 2);
  change(manifest);
  const std::string changed = manifest.SerializeAsString();
  const auto raw = std::as_bytes(std::span(changed));
  const std::size_t now_of_manifest = manifest_pieces(raw.size());
  const std::size_t of_geometry = kPacked->announcement().pieces - of_manifest;
  return refusal_of([&] {
    SceneAssembly assembly(
        {.hash = hash_of(raw), .manifest_bytes = raw.size(), .pieces = now_of_manifest + of_geometry},
        scene::Registry::standard());
    for (std::size_t i = 0; i < now_of_manifest; ++i) {
      const std::size_t begin = i * kPieceBytesMax;
      assembly.add(i, raw.subspan(begin, std::min(kPieceBytesMax, raw.size() - begin)));
    }
    for (std::size_t i = 0; i < of_geometry; ++i) assembly.add(now_of_manifest + i, kPacked->piece(of_manifest + i));
    (void)assembly.build();
  });
}

TEST(AHostileManifest, GetsNoCoarseLevelTakenWhoseErrorIsNoneOrALie) {
  const auto with_error = [](double error_m) {
    return refusal_of_a_large_mesh(
        [error_m](v1::SceneManifest& manifest) { manifest.mutable_geometries(1)->set_error_m(error_m); });
  };
  EXPECT_EQ(with_error(5e-4), "accepted");
  EXPECT_THAT(with_error(std::nan("")), HasSubstr("its error within 0 to 0.001 m, got nan"));
  EXPECT_THAT(with_error(std::numeric_limits<double>::infinity()), HasSubstr("got inf"));
  EXPECT_THAT(with_error(-1e-4), HasSubstr("got -1e-04"));
  EXPECT_THAT(with_error(2e-3), HasSubstr("got 0.002"));
  EXPECT_THAT(with_error(1e-6), HasSubstr("a coarse level of a mesh says that it is within 1"));
}

TEST(AHostileManifest, GetsNoCoarseLevelTakenThatIsOpenOrOfWhatHasNone) {
  EXPECT_THAT(
      refusal_of_a_large_mesh([](v1::SceneManifest& manifest) { manifest.mutable_geometries(1)->set_open_edges(3); }),
      HasSubstr("must be closed"));
  for (const std::uint32_t of : {2U, 3U, 4'000'000'000U}) {
    EXPECT_THAT(refusal_of_a_large_mesh(
                    [of](v1::SceneManifest& manifest) { manifest.mutable_geometries(1)->set_coarse_of(of); }),
                HasSubstr("the only one of a part's mesh"))
        << of;
  }
  EXPECT_THAT(
      refusal_of_a_large_mesh([](v1::SceneManifest& manifest) { manifest.mutable_geometries(0)->set_coarse_of(2); }),
      HasSubstr("the only one of a part's mesh"));
  EXPECT_EQ(
      refusal_of_a_large_mesh([](v1::SceneManifest& manifest) { manifest.mutable_geometries(1)->clear_coarse_of(); }),
      "accepted")
      << "it is a geometry that nothing uses, as for a client that knows of no coarse levels";
}

}  // namespace
}  // namespace forcebound::handover
