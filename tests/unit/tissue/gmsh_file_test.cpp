#include "forcebound/tissue/gmsh_file.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "forcebound/tissue/tetrahedral_mesh.hpp"
#include "tests/tools/data/recorded_data.hpp"

namespace forcebound::tissue {
namespace {

const std::string kOldFormat = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string kNewFormat = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
const std::string kFourNodes = "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n";
const std::string kOneTetrahedron = "$Elements\n1\n1 4 2 0 1 1 2 3 4\n$EndElements\n";

TetrahedralSoup read(const std::string& text) {
  std::istringstream stream(text);
  return read_gmsh(stream, "part.msh");
}

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(read(text));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

void expect_unit_tetrahedron(const TetrahedralSoup& soup) {
  ASSERT_EQ(soup.nodes.size(), 4U);
  ASSERT_EQ(soup.tetrahedra.size(), 1U);
  EXPECT_EQ(soup.tetrahedra[0].nodes, (std::array<std::size_t, 4>{0, 1, 2, 3}));
  EXPECT_EQ(soup.nodes[0], scene::Point(0, 0, 0));
  EXPECT_EQ(soup.nodes[3], scene::Point(0, 0, 1));
}

TEST(GmshFile, ReadsVersionTwo) {
  const TetrahedralSoup soup = read(kOldFormat + kFourNodes + kOneTetrahedron);
  expect_unit_tetrahedron(soup);
  EXPECT_EQ(soup.tetrahedra[0].line, 13U);
}

TEST(GmshFile, ReadsVersionFourWithSparseNumbersAndParametricNodes) {
  expect_unit_tetrahedron(read(kNewFormat +
                               "$Nodes\n2 4 7 90\n2 1 1 1\n90\n0 0 0 0.5 0.25\n3 1 0 3\n7\n8\n9\n1 0 0\n0 1 0\n0 0 1\n"
                               "$EndNodes\n$Elements\n1 1 5 5\n3 1 4 1\n5 90 7 8 9\n$EndElements\n"));
}

TEST(GmshFile, ReadsVersionOne) {
  expect_unit_tetrahedron(
      read("$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 1 1 4 1 2 3 4\n$ENDELM\n"));
}

TEST(GmshFile, ReadsElementsBeforeNodesAndLinesFromWindowsWithTabs) {
  std::string text = kOldFormat + kOneTetrahedron + kFourNodes;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.replace(at, 1, "\r\n");
  for (char& letter : text) letter = letter == ' ' ? '\t' : letter;
  expect_unit_tetrahedron(read(text));
}

TEST(GmshFile, PassesOverOtherSectionsAndElements) {
  expect_unit_tetrahedron(read(kOldFormat + "$PhysicalNames\n1\n3 1 \"liver\"\n$EndPhysicalNames\n" + kFourNodes +
                               "$Elements\n3\n1 15 2 0 1 1\n2 2 2 0 1 1 2 3\n3 4 0 1 2 3 4\n$EndElements\n"));
}

TEST(GmshFile, ReadsNegativeTagsOfEntitiesPhysicalGroupsAndPartitions) {
  // Gmsh's manual: ghost cells have negative partitions; the sign of a physical group or entity is its orientation.
  for (const char* tags : {"2 -3 7", "2 3 -7", "5 1 1 2 1 -2", "0", "3 -1 -1 -1"}) {
    SCOPED_TRACE(tags);
    expect_unit_tetrahedron(read(kOldFormat + kFourNodes + "$Elements\n1\n1 4 " + tags + " 1 2 3 4\n$EndElements\n"));
  }
  expect_unit_tetrahedron(
      read("$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 -1 -1 4 1 2 3 4\n$ENDELM\n"));
  expect_unit_tetrahedron(read(kNewFormat +
                               "$Nodes\n1 4 1 4\n3 -2 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
                               "$Elements\n1 1 1 1\n3 -2 4 1\n1 1 2 3 4\n$EndElements\n"));
}

TEST(GmshFile, RefusesTagsThatAreNoNumbersAndOtherNegativeNumbers) {
  const std::string expected = ": expected element 1 of 1: number, type, number of tags, tags, nodes";
  for (const char* row : {"1 4 2 0 x 1 2 3 4", "1 4 2 0 1.5 1 2 3 4", "1 4 -2 0 1 1 2 3 4", "1 -4 2 0 1 1 2 3 4",
                          "1 4 2 0 1 1 2 3 -4", "1 4 2 0"}) {
    EXPECT_EQ(refusal(kOldFormat + kFourNodes + "$Elements\n1\n" + row + "\n$EndElements\n"),
              "part.msh:13: '" + std::string(row) + "'" + expected);
  }
}

TEST(GmshFile, ReadsTheFilesWithNegativeTagsThatOthersReported) {
  const auto folder = recorded_data("reports");
  if (!folder) GTEST_SKIP() << "no reports in FORCEBOUND_DATA";
  for (const char* name : {"ghosts.msh", "negative_physical.msh", "v41_negative_entity.msh"}) {
    const TetrahedralSoup soup = load_gmsh((*folder / name).string());
    EXPECT_EQ(soup.nodes.size(), 48U) << name;
    EXPECT_EQ(soup.tetrahedra.size(), 108U) << name;
  }
}

TEST(TetrahedralMesh, InTwoPiecesThatTouchSaysSo) {
  const std::string apart =
      "$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 0\n6 1 0 0\n7 0 1 0\n8 0 0 -1\n$EndNodes\n"
      "$Elements\n2\n1 4 0 1 2 3 4\n2 4 0 5 6 7 8\n$EndElements\n";
  const TetrahedralMesh two(read(kOldFormat + apart));
  EXPECT_EQ(two.pieces(), 2);
  EXPECT_EQ(two.coincident_nodes(), 3);
  EXPECT_EQ(pieces_in_words(two), ", in 2 pieces, which are not joined where 3 nodes lie on others");
  const TetrahedralMesh one(read(kOldFormat + kFourNodes + kOneTetrahedron));
  EXPECT_EQ(one.pieces(), 1);
  EXPECT_EQ(pieces_in_words(one), "");
  if (const auto folder = recorded_data("reports")) {
    const TetrahedralMesh reported(load_gmsh((*folder / "dup_nodes.msh").string()));
    EXPECT_EQ(reported.pieces(), 2);
    EXPECT_GT(reported.coincident_nodes(), 0);
  }
}

TEST(GmshFile, RefusesWhatNoSectionBeginsWith) {
  EXPECT_EQ(refusal(""), "part.msh:1: the file is empty: expected $MeshFormat");
  EXPECT_EQ(refusal("solid cube\n"), "part.msh:1: 'solid cube': expected a section such as $Nodes");
  EXPECT_EQ(refusal(kFourNodes), "part.msh:1: '$Nodes': expected $MeshFormat (or $NOD, version 1) first");
  EXPECT_EQ(refusal(kOldFormat + "$Comments\nnever ends\n"),
            "part.msh:5: the file ends within $Comments: expected $EndComments");
}

TEST(GmshFile, RefusesBinaryFilesAndOtherVersions) {
  EXPECT_EQ(refusal("$MeshFormat\n4.1 1 8\n"),
            "part.msh:2: the file is binary: expected ASCII, as Gmsh writes it with Mesh.Binary = 0");
  EXPECT_EQ(refusal("$MeshFormat\n4 0 8\n$EndMeshFormat\n"),
            "part.msh:2: version 4 is not read: expected 2.2 or 4.1 (Gmsh writes them with -format msh22 or msh41)");
  EXPECT_THAT(refusal("$MeshFormat\n2.2 0 4\n"), testing::StartsWith("part.msh:2: '2.2 0 4': expected version"));
  EXPECT_THAT(refusal("$MeshFormat\nnan 0 8\n"), testing::StartsWith("part.msh:2: 'nan 0 8': expected version"));
}

TEST(GmshFile, RefusesNodesThatAreNotThereOrTwice) {
  EXPECT_EQ(refusal(kOldFormat + "$Nodes\n2\n1 0 0 0\n1 0 0 1\n$EndNodes\n"),
            "part.msh:7: node 1 for the second time: expected each number once");
  EXPECT_EQ(refusal(kOldFormat + kFourNodes + "$Elements\n1\n1 4 2 0 1 1 2 3 5\n$EndElements\n"),
            "part.msh:13: node 5 does not exist: expected one of the 4 nodes of this file");
  EXPECT_EQ(refusal(kOldFormat + kFourNodes + kFourNodes),
            "part.msh:11: nodes for the second time: expected one section of them");
  EXPECT_EQ(refusal(kOldFormat), "part.msh:3: the file ends without nodes: expected a section $Nodes");
}

TEST(GmshFile, RefusesInvalidNumbers) {
  EXPECT_EQ(refusal(kOldFormat + "$Nodes\n1\n1 0 nan 0\n"),
            "part.msh:6: '1 0 nan 0': expected node 1 of 1: its number and x y z");
  EXPECT_EQ(refusal(kOldFormat + "$Nodes\n1\n-1 0 0 0\n"),
            "part.msh:6: '-1 0 0 0': expected node 1 of 1: its number and x y z");
  EXPECT_EQ(refusal(kOldFormat + "$Nodes\n99999999999999999999999\n"),
            "part.msh:5: '99999999999999999999999': expected the number of nodes");
  EXPECT_EQ(refusal(kOldFormat + "$Nodes\n18446744073709551615\n1 0 0 0\n"),
            "part.msh:6: the file ends here: expected node 2 of 18446744073709551615: its number and x y z");
}

TEST(GmshFile, RefusesElementsThatAreNotWholeOrOfSecondOrder) {
  EXPECT_EQ(refusal(kOldFormat + kFourNodes + "$Elements\n1\n1 4 2 0 1 1 2 3\n$EndElements\n"),
            "part.msh:13: '1 4 2 0 1 1 2 3': expected a tetrahedron's four nodes, got 3");
  EXPECT_EQ(refusal(kOldFormat + kFourNodes + "$Elements\n1\n1 4 900 0 1 1 2 3\n$EndElements\n"),
            "part.msh:13: '1 4 900 0 1 1 2 3': expected element 1 of 1: number, type, number of tags, tags, nodes");
  EXPECT_EQ(refusal(kOldFormat + kFourNodes + "$Elements\n1\n1 11 0 1 2 3 4 1 2 3 4 1 2\n$EndElements\n"),
            "part.msh:13: a tetrahedron of second order (type 11): expected linear ones, type 4 (Mesh.ElementOrder = "
            "1)");
  EXPECT_EQ(refusal(kOldFormat + kFourNodes + "$Elements\n1\n1 2 0 1 2 3\n$EndElements\n"),
            "part.msh:14: the file has no tetrahedra: expected at least one element of type 4 in a section $Elements");
}

TEST(GmshFile, RefusesAHeaderThatDoesNotFitItsBlocks) {
  EXPECT_EQ(refusal(kNewFormat + "$Nodes\n1 2 1 4\n3 1 0 1\n1\n0 0 0\n$EndNodes\n"),
            "part.msh:5: 2 nodes with numbers from 1 to 4: expected what the blocks below have, 1 node with numbers "
            "from 1 to 1");
}

TEST(GmshFile, RefusesEveryTruncation) {
  const std::string whole = kOldFormat + kFourNodes + kOneTetrahedron;
  for (std::size_t length = 0; length + 1 < whole.size(); ++length) {
    EXPECT_THAT(refusal(whole.substr(0, length)), testing::MatchesRegex("part\\.msh:[0-9]+: [^\n]+")) << length;
  }
}

TEST(GmshFile, LoadsTheLiver) {
  const auto path = recorded_data("meshes/liver.msh");
  if (!path) GTEST_SKIP() << "meshes/liver.msh is not there";
  const TetrahedralSoup soup = load_gmsh(path->string());
  EXPECT_EQ(soup.nodes.size(), 181U);
  EXPECT_EQ(soup.tetrahedra.size(), 596U);
  EXPECT_EQ(soup.nodes[0], scene::Point(-0.979259, 2.23512, 2.61245));
  EXPECT_EQ(soup.tetrahedra[1].nodes, (std::array<std::size_t, 4>{90, 142, 6, 139}));
}

TEST(GmshFile, RefusesEveryMalformedFileWithFileAndLine) {
  const auto folder = recorded_data("meshes/malformed");
  if (!folder) GTEST_SKIP() << "meshes/malformed is not there";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    const std::string path = entry.path().string();
    if (!path.ends_with(".msh")) continue;
    ++files;
    try {
      static_cast<void>(load_gmsh(path));
      ADD_FAILURE() << path << " was accepted";
    } catch (const std::runtime_error& error) {
      const std::string what = error.what();
      ASSERT_THAT(what, testing::StartsWith(path + ":"));
      EXPECT_THAT(what.substr(path.size()), testing::MatchesRegex(":[0-9]+: [^\n]*expected [^\n]+"));
      RecordProperty(entry.path().filename().string(), what.substr(path.size()));
    }
  }
  EXPECT_GE(files, 10);
}

}  // namespace
}  // namespace forcebound::tissue
