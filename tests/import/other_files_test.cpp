// Files that stand in for others: pointers of Git LFS, and kinds that other programs convert.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <simvis/part_importer.h>
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

const std::string kPointer =
    "version https://git-lfs.github.com/spec/v1\n"
    "oid sha256:4d7a214614ab2935c943f9e0ff69d22eadbb8f32b1258daaa5e2ca24d17e2393\nsize 12345\n";

std::string part_error(const TemporaryFolder& folder, const std::string& file) {
  return error_of([&] {
    build_scene(parse_commands("<part file='" + file + "' name='P' insert_at='ROOT'/>", "s.xml", folder.path()));
  });
}

TEST_CASE("every reader says of a pointer of Git LFS what it is") {
  const std::vector<std::string> endings = known_part_endings();
  CHECK(endings.size() >= 15);
  for (const std::string& ending : endings) {
    CAPTURE(ending);
    const TemporaryFolder folder;
    write_text(folder / ("p" + ending), kPointer);
    CHECK(contains(part_error(folder, "p" + ending), "is a pointer of Git LFS, not the file itself"));
  }
}

TEST_CASE("a mesh that is a pointer of Git LFS is left out with that reason") {
  const TemporaryFolder folder;
  write_text(folder / "m.stl", kPointer);
  write_text(folder / "r.urdf",
             "<robot name='r'><link name='l'><visual><geometry><mesh filename='m.stl'/></geometry></visual>"
             "<visual><geometry><sphere radius='1'/></geometry></visual></link></robot>");
  const BuiltScene built =
      build_scene(parse_commands("<part file='r.urdf' name='P' insert_at='ROOT'/>", "s.xml", folder.path()));
  REQUIRE(built.scene.warnings().size() == 1);
  CHECK(contains(built.scene.warnings()[0], "is a pointer of Git LFS"));
}

TEST_CASE("files of kinds that other programs convert are refused with the name of one") {
  struct Row {
    const char *file, *converter;
  };
  for (const Row& row :
       {Row{"a.FBX", "Blender converts FBX to .glb"}, Row{"a.3ds", "assimp converts 3DS to .obj"},
        Row{"a.off", "MeshLab converts OFF to .ply"}, Row{"a.step", "FreeCAD converts STEP"},
        Row{"a.x3d", "Blender converts X3D"}, Row{"a.laz", "laszip decompresses LAZ"},
        Row{"a.splat", "splat-transform"}, Row{"a.ksplat", "splat-transform"}, Row{"a.sog", "splat-transform"},
        Row{"a.3mf", "assimp converts 3MF to .obj"}, Row{"a.drc", "draco_decoder converts Draco to .ply"},
        Row{"a.xyz", "CloudCompare"}, Row{"a.pts", "CloudCompare"}, Row{"a.wbt", "Webots exports worlds of Webots"},
        Row{"a.proto", "VRML 97, a .wrl"}}) {
    CAPTURE(row.file);
    const TemporaryFolder folder;
    write_text(folder / row.file, "x");
    const std::string error = part_error(folder, row.file);
    CHECK(contains(error, "is of an unknown kind, expected one of: "));
    CHECK(contains(error, row.converter));
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
