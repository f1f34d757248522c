#include "forcebound/server/environment/mesh_parser.hpp"
#include "forcebound/server/environment/schema.hpp"

namespace forcebound::server {
namespace {

SchemaKey place_of_shape(std::string_view key, std::string_view meaning) {
  return described(scene::PointParameter{.key = key, .meaning = meaning});
}

SchemaKey moved(std::string_view key) {
  return described(
      scene::PointParameter{.key = key, .meaning = "added to every vertex", .preset = scene::Point::Zero()});
}

SchemaKey direction(std::string_view key, std::string_view meaning) {
  return described(scene::PointParameter{.key = key, .meaning = meaning, .is_direction = true});
}

SchemaKey positive_of_shape(std::string_view key, std::string_view meaning) {
  return described(scene::NumberParameter{.key = key, .meaning = meaning, .least = 0, .least_excluded = true});
}

SchemaKey size_of_shape() { return {"size_m", "from face to face, along the axes", "a list of numbers, each > 0"}; }

SchemaKey mesh_file() { return {"file", "OBJ, STL or OFF", "a file beside the scene's"}; }

/// The file and where it lies, then what is a shape's own.
std::vector<SchemaKey> keys_of_mesh(std::vector<SchemaKey> own) {
  std::vector<SchemaKey> keys{mesh_file()};
  for (SchemaKey& key : placement_keys()) keys.push_back(std::move(key));
  for (SchemaKey& key : own) keys.push_back(std::move(key));
  return keys;
}

SchemaTable straight(std::string title, std::string text) {
  return {std::move(title),
          std::move(text),
          {place_of_shape("from_m", "one end of the axis"), place_of_shape("to_m", "the other end"),
           positive_of_shape("radius_m", "around it")}};
}

}  // namespace

SchemaKey rotation_key(std::string_view meaning) {
  return {std::string(kRotationKey), std::string(meaning), "a list of 3 numbers", "[0, 0, 0]"};
}

std::vector<SchemaKey> placement_keys() {
  return {described(kMeshScale),
          rotation_key("roll, pitch and yaw: turned about the scene's x, then y, then z axis, after `scale`"),
          {std::string(kOffsetKey), "added to every vertex, after `rotation_deg`", "a point", "[0, 0, 0]"}};
}

std::vector<SchemaTable> shape_tables() {
  return {
      {"half_space",
       "Everything behind a plane: a wall, a table.",
       {place_of_shape("through_m", "a point of the plane"), direction("normal", "out of what is solid")}},
      {"sphere",
       "A ball; a disc on two axes.",
       {place_of_shape("center_m", "its center"), positive_of_shape("radius_m", "from the center to the surface")}},
      {"cavity",
       "Everything but a ball: the inside of a sphere or circle.",
       {place_of_shape("center_m", "its center"), positive_of_shape("radius_m", "from the center to the surface")}},
      {"box", "A block along the axes.", {place_of_shape("center_m", "its center"), size_of_shape()}},
      straight("capsule", "A rod with round ends; at least 2 axes."),
      straight("cylinder", "A rod with flat ends; at least 2 axes, where it is a rectangle."),
      {"torus",
       "A ring; 3 axes.",
       {place_of_shape("center_m", "its center"), direction("axis", "through the hole"),
        positive_of_shape("major_radius_m", "from the center to the middle of the tube"),
        positive_of_shape("minor_radius_m", "of the tube, less than the other")}},
      {"height_field",
       "A relief over a grid, solid below; 3 axes. Its heights stand in the scene or in a file, one of the two.",
       {place_of_shape("origin_m", "of the first height's column"),
        positive_of_shape("spacing_m", "of the grid, along x and y"),
        {"heights_m", "rows follow each other along y, their numbers along x", "a list of rows of numbers",
         "read from `file`"},
        {"file", "the same, separated by commas, one row to a line", "a file beside the scene's", "`heights_m`"}}},
      {"mesh", "Triangles from a file, felt through a god object; 3 axes.",
       keys_of_mesh({described(kMeshDetail),
                     {"two_sided", "whether it is felt from behind as well", "`true` or `false`", "`false`"}})},
      {"distance_field",
       "A closed mesh as its signed distance on a grid: edges are rounded by about a grid step, and the cost does not "
       "depend on the mesh; 3 axes.",
       keys_of_mesh({described(kMeshDetail), positive_of_shape("spacing_m", "of the grid")})},
      {"lathe",
       "A closed profile turned about the z axis, as a mesh: pots, bowls, rings; 3 axes.",
       {{"profile_m", "anticlockwise about its inside, with the radius to the right and the height up",
         "a list of [radius, height]"},
        described(kLatheSegments),
        moved("origin_m")}},
  };
}

}  // namespace forcebound::server
