#include "forcebound/server/environment/mesh_file.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/process.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::server {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

class MeshFile : public testing::Test {
 protected:
  [[nodiscard]] std::string path_of(const std::string& name) const { return folder_.file(name); }

  [[nodiscard]] std::string write(const std::string& name, const std::string& content) const {
    test::write_file(path_of(name), content);
    return path_of(name);
  }

  /// Expects that `content` is refused in one line that begins with the file and goes on with `where_and_what`.
  void expect_refusal(const std::string& name, const std::string& content, const std::string& where_and_what) const {
    const std::string path = write(name, content);
    try {
      (void)load_mesh(path);
      ADD_FAILURE() << name << " was accepted, not refused with " << where_and_what << "\n" << content;
    } catch (const scene::GeometryError& error) {
      EXPECT_THAT(error.what(), StartsWith(path + where_and_what)) << content;
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
    }
  }

 private:
  test::TemporaryFolder folder_;
};

constexpr const char* kTetrahedronObj =
    "# a tetrahedron\r\n"
    "v 0 0 0\nv 1 0 0\nv 0 1 0 0.5 0.5 0.5\nv 0 0 +1e0\n"
    "vn 0 0 1\nvt 0 0\n"
    "f 1 3 2\nf 1//1 2//1 4//1\nf -3/1/1 -2/1/1 -1/1/1\nf 1 4 3\n";

constexpr const char* kTetrahedronOff =
    "OFF\n4 4 6\n0 0 0\n1 0 0 # right\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n\n3 1 2 3\n3 0 3 2\n";

std::string text_stl(const std::string& last = "endsolid\n") {
  const auto facet = [](const char* a, const char* b, const char* c) {
    return std::string("facet normal 0 0 0\n outer loop\n") + "  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
           "\n endloop\nendfacet\n";
  };
  return "solid tetrahedron\n" + facet("0 0 0", "0 1 0", "1 0 0") + facet("0 0 0", "1 0 0", "0 0 1") +
         facet("1 0 0", "0 1 0", "0 0 1") + facet("0 0 0", "0 0 1", "0 1 0") + last;
}

std::string binary_stl(float last = 0) {
  const std::vector<float> facet{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, last};
  std::string content("solid, but binary");
  content.resize(84);
  content[80] = 1;
  content.append(reinterpret_cast<const char*>(facet.data()), 48);
  return content.append(2, '\0');
}

void expect_tetrahedron(const scene::TriangleMesh& mesh) {
  EXPECT_THAT(to_text(mesh.report()), StartsWith("4 triangles, 4 vertices, closed"));
  EXPECT_NEAR(mesh.report().volume_m3, 1.0 / 6, 1e-15);
  EXPECT_EQ(mesh.origin_m(), scene::Point(0.5, 0.5, 0.5));
}

TEST_F(MeshFile, ReadsObjOffAndBothKindsOfStl) {
  expect_tetrahedron(load_mesh(write("t.obj", kTetrahedronObj)));
  expect_tetrahedron(load_mesh(write("t.off", kTetrahedronOff)));
  expect_tetrahedron(load_mesh(write("T.STL", text_stl())));
  EXPECT_EQ(to_text(load_mesh(write("b.stl", binary_stl())).report()), "1 triangle, 3 vertices, open; 3 open edges");
}

TEST_F(MeshFile, ReadsTextStlInAnyLettersWithBlankLinesAndAnyEnd) {
  const auto with = [](std::string_view old, std::string_view other) {
    std::string text = text_stl();
    text.replace(text.rfind(old), old.size(), other);
    return text;
  };
  std::string capital = text_stl();
  std::ranges::transform(capital, capital.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (const std::string& text :
       {capital, with("solid tetrahedron", "Solid tetrahedron"), "\r\n \n" + text_stl(), with("endsolid", "ENDSOLID"),
        with("endsolid", "end solid"), with("endsolid", "End  Solid tetrahedron"), with("1 0 0", "1.0E+0 0 0"),
        with("solid tetrahedron", "solid K\xc3\xb6rper solid")}) {
    SCOPED_TRACE(text);
    expect_tetrahedron(load_mesh(write("t.stl", text)));
  }
}

TEST_F(MeshFile, ReadsABinaryStlWithBytesBehindItsLastTriangle) {
  for (const char* const begin : {"solid, but binary", "exported         "}) {
    const std::string header = begin;
    const std::string content = header + binary_stl().substr(header.size()) + "appends";
    EXPECT_EQ(to_text(load_mesh(write("b.stl", content)).report()), "1 triangle, 3 vertices, open; 3 open edges");
  }
}

TEST_F(MeshFile, ReadsTheStlFilesThatOthersReported) {
  const auto folder = recorded_data("reports");
  if (!folder) GTEST_SKIP() << "no reports in FORCEBOUND_DATA";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (entry.path().extension() != ".stl") continue;
    SCOPED_TRACE(entry.path());
    EXPECT_THAT(to_text(load_mesh(entry.path().string()).report()), StartsWith("12 triangles, 8 vertices, closed"));
    ++files;
  }
  EXPECT_EQ(files, 7);
}

TEST_F(MeshFile, PlacesTheMeshByScaleAndOffset) {
  const auto mesh = load_mesh(write("t.obj", kTetrahedronObj), {.scale = 1e-3, .offset_m = {1, 2, 3}});
  EXPECT_EQ(mesh.origin_m(), scene::Point(1 + 0.5e-3, 2 + 0.5e-3, 3 + 0.5e-3));
  EXPECT_NEAR(mesh.size_m(), 1e-3 * std::sqrt(0.75), 1e-18);
}

TEST_F(MeshFile, CutsPolygonsIntoTriangles) {
  const auto mesh = load_mesh(write("q.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n 3 4\n"));
  EXPECT_EQ(mesh.report().triangles, 2U);
  EXPECT_EQ(mesh.report().vertices, 4U);
  EXPECT_EQ(mesh.normals()[0], scene::Point(0, 0, 1));
}

TEST_F(MeshFile, RefusesAnObjWithFileAndLine) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_refusal("a.obj", "v 0 0 0\nv 1 nan 0\n", ":2: 'nan' is not a finite number");
  expect_refusal("a.obj", "v 0 0 0\nv 1 inf 0\n", ":2: 'inf' is not a finite number");
  expect_refusal("a.obj", "v 0 0 1e39\n", ":1: '1e39' is more than single precision holds");
  expect_refusal("a.obj", "v 0 0 zero\n", ":1: 'zero' is not a finite number");
  expect_refusal("a.obj", "v 0 0\n", ":1: a point needs three coordinates, got 2");
  expect_refusal("a.obj", points + "f 1 2 4\n", ":4: vertex '4' is not one of the 3 before this line");
  expect_refusal("a.obj", points + "f 0 1 2\n", ":4: vertex '0' is not one");
  expect_refusal("a.obj", points + "f -4 1 2\n", ":4: vertex '-4' is not one");
  expect_refusal("a.obj", points + "f 1 2 x\n", ":4: 'x' is not the index of a vertex");
  expect_refusal("a.obj", points + "f 1 2\n", ":4: a face needs three corners, got 2");
  expect_refusal("a.obj", points + "f 1 2 \\\n", ":4: the file ends within a face");
  expect_refusal("a.obj", points, ": ");
  expect_refusal("a.obj", points + "f 1 1 2\n", ": no triangles, but for 1 without an area");
  expect_refusal("a.obj", "", ": ");
}

TEST_F(MeshFile, RefusesAnOffWithFileAndLine) {
  const std::string points = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
  expect_refusal("a.off", "", ":1: expected OFF");
  expect_refusal("a.off", "ON\n", ":1: expected OFF");
  expect_refusal("a.off", "OFF\n3\n", ":2: expected the numbers");
  expect_refusal("a.off", "OFF\n3 -1 0\n", ":2: expected the number of faces, got '-1'");
  expect_refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0\n", ":4: a point needs three coordinates, got 2");
  expect_refusal("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", ":4: the file ends after 2 of 3 vertices");
  expect_refusal("a.off", points, ":5: the file ends after 0 of 1 faces");
  expect_refusal("a.off", points + "3 0 1 3\n", ":6: vertex '3' is not one of 0 to 2");
  expect_refusal("a.off", points + "4 0 1 2\n", ":6: a face of 4 corners has only 3");
  expect_refusal("a.off", points + "2 0 1\n", ":6: a face needs three corners, got 2");
}

TEST_F(MeshFile, RefusesAnStlWithFileAndWhere) {
  expect_refusal("a.stl", "", ": ends after 0 bytes, in the head");
  expect_refusal("a.stl", binary_stl().substr(0, 133), ": ends after 0 of 1 triangles");
  expect_refusal("a.stl", binary_stl(std::numeric_limits<float>::quiet_NaN()), ": triangle 1 has a coordinate");
  expect_refusal("a.stl", text_stl(""), ":29: the file ends without endsolid");
  expect_refusal("a.stl", "\n" + text_stl("end loop\n"), ":31: the file ends without endsolid");
  expect_refusal("a.stl", "SOLID\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 NaN\n", ":4: 'NaN' is not");
  expect_refusal("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 nan\n", ":4: 'nan' is not");
  expect_refusal("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\nendsolid\n",
                 ":6: a facet needs three vertices, got 1");
}

TEST_F(MeshFile, RefusesWhatItCannotOpenOrDoesNotKnow) {
  EXPECT_THAT([&] { (void)load_mesh(path_of("none.obj")); },
              ThrowsMessage<scene::GeometryError>(HasSubstr("none.obj: cannot be read")));
  EXPECT_THAT([&] { (void)load_mesh(write("a.ply", "")); },
              ThrowsMessage<scene::GeometryError>(path_of("a.ply") + ": a mesh is an .obj, .off or .stl file"));
}

TEST_F(MeshFile, OpensNoMaterialFile) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const auto triangles = [&](const std::string& rest) {
    return load_mesh(write("a.obj", points + rest)).report().triangles;
  };
  // With no such file, Assimp's own reader would take this file for the material file.
  EXPECT_EQ(triangles("f 1 2 3\nmtllib none.mtl\nmap_Kd x.png\n"), 1U);
  EXPECT_EQ(triangles("mtl\\\nlib none.mtl\nmap_Kd x.png\nf 1 2 3\n"), 1U);
  EXPECT_EQ(triangles("mtllib a.obj\nmap_Kd x.png\nf 1 2 3\n"), 1U);
  const std::string material = write("a.mtl", "map_Kd x.png\n");
  EXPECT_EQ(triangles("mtllib " + material + "\nf 1 2 3\n"), 1U);
}

TEST_F(MeshFile, ReadsARealMesh) {
  const auto path = recorded_data("meshes/spot.obj");
  if (!path) GTEST_SKIP() << "no meshes/spot.obj in FORCEBOUND_DATA";
  const auto mesh = load_mesh(path->string());
  EXPECT_EQ(mesh.report().triangles, 5856U);
  EXPECT_TRUE(mesh.report().closed()) << to_text(mesh.report());
  EXPECT_GT(mesh.report().volume_m3, 0);
}

}  // namespace
}  // namespace forcebound::server
